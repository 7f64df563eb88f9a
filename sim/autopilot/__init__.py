"""A PX4-like autopilot in virtual time: arming, modes, failsafes, and the steering in each; no MAVLink in it."""
