"""The simulated vehicle on the wire: a MAVLink 2 endpoint that ground stations take for PX4."""
