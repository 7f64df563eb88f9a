"""Who or what steers the vehicle: PX4's flight modes, as far as they are simulated."""

from __future__ import annotations

from enum import Enum


class Mode(Enum):
    """A flight mode, by the name shown to the operator."""

    HOLD = "Hold"
    TAKEOFF = "Takeoff"
    OFFBOARD = "Offboard"
    RETURN = "Return"
    LAND = "Land"
    MISSION = "Mission"
    POSITION = "Position"
    ALTITUDE = "Altitude"
    # Entered by failsafes only: sinking without a position, as PX4 does when it has lost it.
    DESCEND = "Descend"
