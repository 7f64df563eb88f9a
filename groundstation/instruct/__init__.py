"""`groundstation instruct`: what an instructor at a second terminal sees of a flight, and does to it."""
