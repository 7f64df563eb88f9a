"""The shield: what is near, and what a velocity must be so that the vehicle stays out of it."""
