"""A lightweight PX4-like multirotor that speaks MAVLink. Run it with ``python -m sim``."""
