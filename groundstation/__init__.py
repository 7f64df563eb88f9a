"""Ground station for bilateral haptic teleoperation of multirotors."""

__version__ = "0.1.0"
