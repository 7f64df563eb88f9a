"""ArduPilot's Copter: its parameters that are judged, and its modes on the wire. Read in its sources, never flown.

Source: ArduCopter 4.6, ArduCopter/Parameters.cpp, libraries/AC_Fence/AC_Fence.cpp, libraries/AP_BattMonitor, and
ArduCopter/mode.h for the numbers of modes. It has no parameter by which moved sticks take over: its mode switch does.
"""

from __future__ import annotations

import math

from groundstation.messages import Severity
from groundstation.vehicle.failsafes import Judged, Verdict, among, speed

_OK, _CAUTION, _DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM
# Setpoints that end: it flies its last velocity for so long and stops, s; its default is 3.
_TIMEOUT_S, _TIMEOUT_MOST_S = 1.0, 3.0
# The bits of FS_OPTIONS that let Guided go on when the transmitter is lost, and all there are.
_GUIDED, _OPTIONS = 4, 63
_CENTIMETRES = 0.01

# GUIDED, BRAKE and RTL. Landing is a command of its own. LOITER obeys the sticks, so nobody is asked to hold there.
MODES = frozenset({(4.0, 0.0), (17.0, 0.0), (6.0, 0.0)})
# The first with GUID_TIMEOUT.
SINCE = (4, 1)


def _timeout(value: float) -> Verdict:
    means = f"stops {value:g} s after the setpoints end"
    if not 0.0 < value <= _TIMEOUT_MOST_S:
        return Verdict(_DANGER, means, f"set it to {_TIMEOUT_S:g} s: until then it flies on blindly")
    if value > _TIMEOUT_S:
        return Verdict(_CAUTION, means, f"{_TIMEOUT_S:g} s or less is better")
    return Verdict(_OK, means)


def _options(value: float) -> Verdict:
    if not (math.isfinite(value) and value == int(value) and 0 <= value <= _OPTIONS):
        return Verdict(_DANGER, f"{value:g} has no known meaning", "set 16, its default")
    if int(value) & _GUIDED:
        means = "losing the transmitter does nothing in Guided"
        return Verdict(_CAUTION, means, "take bit 2 (4) out if one is to be the way out")
    return Verdict(_OK, "losing the transmitter counts in Guided")


_RTL, _LAND = Verdict(_OK, "Return"), Verdict(_OK, "Land")
_SMART_RTL, _SMART_LAND = Verdict(_OK, "SmartRTL or Return"), Verdict(_OK, "SmartRTL or Land")
_BRAKE = Verdict(_OK, "Brake or Land")
_MISSION = Verdict(_OK, "the mission's landing, or Return")
_STATION_LOST = {
    0: Verdict(_CAUTION, "nothing when this station is lost", "set Return (1), Land (5) or Brake (7)"),
    1: _RTL,
    3: _SMART_RTL,
    4: _SMART_LAND,
    5: _LAND,
    6: _MISSION,
    7: _BRAKE,
}
_STICKS_LOST = {
    0: Verdict(_CAUTION, "nothing when the transmitter is lost", "set Return (1), Land (3) or Brake (7)"),
    1: _RTL,
    2: Verdict(_OK, "Return, but in a mission"),
    3: _LAND,
    4: _SMART_RTL,
    5: _SMART_LAND,
    6: _MISSION,
    7: _BRAKE,
}
_FENCE = {
    0: Verdict(_CAUTION, "only a report at its own fence", "set Brake (4) if a fence is relied on"),
    1: Verdict(_OK, "Return or Land at its own fence"),
    2: Verdict(_OK, "Land at its own fence"),
    3: Verdict(_OK, "SmartRTL, Return or Land at its own fence"),
    4: Verdict(_OK, "Brake or Land at its own fence"),
    5: Verdict(_OK, "SmartRTL or Land at its own fence"),
}
_BATTERY = {
    0: Verdict(_CAUTION, "only a warning when the battery is low", "set Land (1) or Return (2)"),
    1: _LAND,
    2: _RTL,
    3: _SMART_RTL,
    4: _SMART_LAND,
    5: Verdict(_DANGER, "Terminate", "set Land (1) or Return (2): this lets it fall"),
    6: _MISSION,
    7: _BRAKE,
}


def _choice(name: str, table: dict[int, Verdict]) -> Judged:
    return Judged(name, whole=True, judge=among(table, "ArduPilot"))


SPEEDS = ("WPNAV_SPEED", "WPNAV_SPEED_UP", "WPNAV_SPEED_DN")
JUDGED = (
    Judged("GUID_TIMEOUT", whole=False, judge=_timeout),
    _choice("FS_GCS_ENABLE", _STATION_LOST),
    _choice("FS_THR_ENABLE", _STICKS_LOST),
    Judged("FS_OPTIONS", whole=True, judge=_options),
    _choice("FENCE_ACTION", _FENCE),
    _choice("BATT_FS_LOW_ACT", _BATTERY),
    *(
        Judged(name, whole=False, judge=speed(way, _CENTIMETRES))
        for name, way in zip(SPEEDS, ("around", "up", "down"), strict=True)
    ),
)
