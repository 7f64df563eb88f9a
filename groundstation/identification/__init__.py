"""From flights to a dynamic model: identification, its validation, and the flight that excites the vehicle."""
