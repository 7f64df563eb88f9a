"""PX4: its parameters that are judged, and its modes on the wire.

Source: PX4 v1.15 parameter reference, src/modules/commander/commander_params.c, src/modules/navigator/
{navigator,geofence}_params.c, src/modules/mc_pos_control/multicopter_position_control_limits_params.c; modes from
src/modules/commander/px4_custom_mode.h.
"""

from __future__ import annotations

import math

from groundstation.messages import Severity
from groundstation.vehicle.failsafes import Judged, Verdict, among, speed

# A vehicle that loses its setpoints flies its last velocity for so long, s: the docs' bar, and where it ends.
_LOSS_S, _LOSS_MOST_S = 1.0, 2.0
_OK, _CAUTION, _DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM
# The bit of COM_RCL_EXCEPT that excuses Offboard, and all there are.
_OFFBOARD, _EXCUSES = 4, 31

# AUTO with its sub-modes LOITER and RTL, and OFFBOARD. Take-off and landing are commands of their own.
# Before it, COM_OBL_ACT said what is done without a transmitter, which is not read here.
SINCE = (1, 14)
TAKEOFF_ALTITUDE = "MIS_TAKEOFF_ALT"
MODES = frozenset({(4.0, 3.0), (4.0, 5.0), (6.0, 0.0)})


def _loss_time(value: float) -> Verdict:
    means = f"acts {value:g} s after the setpoints end"
    if not 0.0 <= value <= _LOSS_MOST_S:
        return Verdict(_DANGER, means, f"set it to {_LOSS_S:g} s or less: until then it flies on blindly")
    if value > _LOSS_S:
        return Verdict(_CAUTION, means, f"{_LOSS_S:g} s or less is better")
    return Verdict(_OK, means)


_ENDS_FLIGHT = "set Hold, Return or Land: this lets it fall"
_SETPOINTS_END = {
    0: Verdict(_OK, "Position; without sticks, NAV_RCL_ACT"),
    1: Verdict(_CAUTION, "Altitude: it drifts with the wind", "set Hold (5) or Land (4)"),
    2: Verdict(_CAUTION, "Stabilized: somebody must fly it by hand", "set Hold (5) or Land (4)"),
    3: Verdict(_OK, "Return"),
    4: Verdict(_OK, "Land"),
    5: Verdict(_OK, "Hold"),
    6: Verdict(_DANGER, "Terminate", _ENDS_FLIGHT),
    7: Verdict(_DANGER, "Disarm", _ENDS_FLIGHT),
}
_LOST = {
    1: Verdict(_OK, "Hold"),
    2: Verdict(_OK, "Return"),
    3: Verdict(_OK, "Land"),
    5: Verdict(_DANGER, "Terminate", _ENDS_FLIGHT),
    6: Verdict(_DANGER, "Disarm", _ENDS_FLIGHT),
}
_STATION_LOST = _LOST | {
    0: Verdict(_CAUTION, "nothing when this station is lost", "set Hold (1), Return (2) or Land (3)")
}
_STICKS_LOST = _LOST | {
    0: Verdict(_DANGER, "nothing when the transmitter is lost", "set Hold, Return or Land")
}
_STICKS = {
    0: Verdict(_CAUTION, "moving the sticks never takes over", "set 3; until then use the mode switch"),
    1: Verdict(_CAUTION, "sticks do not take over from Offboard", "set 3; until then use the mode switch"),
    2: Verdict(_OK, "sticks take over from Offboard"),
    3: Verdict(_OK, "sticks take over from Offboard and from autonomous modes"),
}
_FENCE = {
    0: Verdict(_CAUTION, "nothing at the vehicle's own fence", "set Hold (2) if a fence is relied on"),
    1: Verdict(_CAUTION, "only a warning at its own fence", "set Hold (2) if a fence is relied on"),
    2: Verdict(_OK, "Hold at its own fence"),
    3: Verdict(_OK, "Return at its own fence"),
    4: Verdict(_DANGER, "Terminate at its own fence", "set Hold (2): this lets it fall"),
    5: Verdict(_OK, "Land at its own fence"),
}
_BATTERY = {
    0: Verdict(_CAUTION, "only a warning when the battery is low", "set Land (2) or Return, then Land (3)"),
    1: Verdict(_OK, "Return when the battery is critical"),
    2: Verdict(_OK, "Land when the battery is critical"),
    3: Verdict(_OK, "Return when it is critical, Land when it is nearly empty"),
}

_STICKS_FROM = {
    0: Verdict(_OK, "sticks from a transmitter only"),
    1: Verdict(_CAUTION, "sticks by MAVLink only: no transmitter takes over", "set 0 or 3"),
    2: Verdict(_OK, "sticks from a transmitter or by MAVLink"),
    3: Verdict(_OK, "sticks from a transmitter or by MAVLink, the first heard"),
    4: Verdict(
        _CAUTION, "sticks are ignored: nobody takes over by hand", "set 0 or 3 if there is a transmitter"
    ),
    5: Verdict(_OK, "sticks by priority, a transmitter first"),
    6: Verdict(_CAUTION, "sticks by priority, MAVLink first", "set 5"),
    7: Verdict(_OK, "sticks by priority, a transmitter first"),
    8: Verdict(_CAUTION, "sticks by priority, MAVLink first", "set 7"),
}


def _excused(value: float) -> Verdict:
    if not (math.isfinite(value) and value == int(value) and 0 <= value <= _EXCUSES):
        return Verdict(_DANGER, f"{value:g} has no known meaning", "set 0")
    if int(value) & _OFFBOARD:
        means = "losing the transmitter does nothing in Offboard"
        return Verdict(_CAUTION, means, "take bit 2 (4) out if one is to be the way out")
    return Verdict(_OK, "losing the transmitter counts in Offboard")


def _choice(name: str, table: dict[int, Verdict]) -> Judged:
    return Judged(name, whole=True, judge=among(table, "PX4"))


SPEEDS = ("MPC_XY_VEL_MAX", "MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN")
JUDGED = (
    Judged("COM_OF_LOSS_T", whole=False, judge=_loss_time),
    _choice("COM_OBL_RC_ACT", _SETPOINTS_END),
    _choice("NAV_RCL_ACT", _STICKS_LOST),
    _choice("NAV_DLL_ACT", _STATION_LOST),
    _choice("COM_RC_IN_MODE", _STICKS_FROM),
    Judged("COM_RCL_EXCEPT", whole=True, judge=_excused),
    _choice("COM_RC_OVERRIDE", _STICKS),
    _choice("GF_ACTION", _FENCE),
    _choice("COM_LOW_BAT_ACT", _BATTERY),
    *(
        Judged(name, whole=False, judge=speed(way))
        for name, way in zip(SPEEDS, ("around", "up", "down"), strict=True)
    ),
)
