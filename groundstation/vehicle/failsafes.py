"""What the vehicle does by itself when the hand, the link or the battery fails, judged from its parameters.

Pure. Source: PX4 v1.15 parameter reference, src/modules/commander/commander_params.c and
src/modules/navigator/{navigator,geofence}_params.c.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from groundstation.messages import Severity

# A vehicle that loses its setpoints flies its last velocity for so long, s: the docs' bar, and where it ends.
_LOSS_S, _LOSS_MOST_S = 1.0, 2.0


class Verdict(NamedTuple):
    """How a failsafe is set.

    Attributes:
        severity: ALARM forbids to couple the hand.
        means: What the vehicle does, in words.
        remedy: What to do, or "".
    """

    severity: Severity
    means: str
    remedy: str = ""


class Failsafe(NamedTuple):
    """A parameter that the hand's life hangs on.

    Attributes:
        name: PX4's.
        whole: It is an integer.
        judge: Judges a value.
    """

    name: str
    whole: bool
    judge: Callable[[float], Verdict]


UNREAD = Verdict(Severity.ALARM, "not read from the vehicle", "wait for the link; F9 reads it again")
_OK, _CAUTION, _DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM


def _loss_time(value: float) -> Verdict:
    means = f"acts {value:g} s after the setpoints end"
    if not 0.0 <= value <= _LOSS_MOST_S:
        return Verdict(_DANGER, means, f"set it to {_LOSS_S:g} s or less: until then it flies on blindly")
    if value > _LOSS_S:
        return Verdict(_CAUTION, means, f"{_LOSS_S:g} s or less is better")
    return Verdict(_OK, means)


def _among(table: Mapping[int, Verdict]) -> Callable[[float], Verdict]:
    def judge(value: float) -> Verdict:
        known = table.get(int(value)) if math.isfinite(value) and value == int(value) else None
        return known or Verdict(_DANGER, f"{value:g} has no known meaning", "set one that PX4 documents")

    return judge


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

FAILSAFES = (
    Failsafe("COM_OF_LOSS_T", whole=False, judge=_loss_time),
    Failsafe("COM_OBL_RC_ACT", whole=True, judge=_among(_SETPOINTS_END)),
    Failsafe("NAV_RCL_ACT", whole=True, judge=_among(_STICKS_LOST)),
    Failsafe("NAV_DLL_ACT", whole=True, judge=_among(_STATION_LOST)),
    Failsafe("COM_RC_OVERRIDE", whole=True, judge=_among(_STICKS)),
    Failsafe("GF_ACTION", whole=True, judge=_among(_FENCE)),
    Failsafe("COM_LOW_BAT_ACT", whole=True, judge=_among(_BATTERY)),
)


def verdict(failsafe: Failsafe, values: Mapping[str, float]) -> Verdict:
    """Judge a failsafe by what has been read; what has not been is a danger."""
    value = values.get(failsafe.name)
    return UNREAD if value is None else failsafe.judge(value)


def unsafe(values: Mapping[str, float]) -> str:
    """Return why the vehicle's failsafes keep the hand from being coupled, or ""."""
    unread = [each.name for each in FAILSAFES if each.name not in values]
    if unread:
        more = f" and {len(unread) - 1} more" if len(unread) > 1 else ""
        return f"the vehicle's failsafe {unread[0]}{more} is not read yet; see Preflight (F7)"
    for failsafe in FAILSAFES:
        judged = failsafe.judge(values[failsafe.name])
        if judged.severity is Severity.ALARM:
            return f"{failsafe.name} = {values[failsafe.name]:g} ({judged.means}); {judged.remedy}"
    return ""
