"""Failsafes as one table: what is wrong → what to do about it; the most severe action wins.

After PX4 v1.15's failsafe framework (src/modules/commander/failsafe): an action first holds for COM_FAIL_ACT_T; the
operator may take over by another mode, or by the sticks; what a vehicle cannot do falls through to the next worse.
Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters


class Act(IntEnum):
    """What a failsafe does, the more severe the higher."""

    NONE = 0
    WARN = 1
    POSITION = 2
    ALTITUDE = 3
    HOLD = 4
    RETURN = 5
    LAND = 6
    DESCEND = 7
    DISARM = 8
    TERMINATE = 9


class Takeover(IntEnum):
    """How the operator may end an action, the more restricted the higher."""

    ALWAYS = 0
    # As ALWAYS after a delay of COM_FAIL_ACT_T in Hold; without that delay as BY_MODE.
    DELAYED = 1
    BY_MODE = 2
    NEVER = 3


class Level(IntEnum):
    """How bad the battery is."""

    FINE = 0
    LOW = 1
    CRITICAL = 2
    EMERGENCY = 3


class Situation(NamedTuple):
    """What the failsafes judge by.

    Attributes:
        mode: The one the operator wants.
        flyable: The modes that could be flown now.
        sticks_lost: No fresh sticks.
        sticks_needed: They were there when the vehicle was armed, or later.
        station_lost: No ground station's heartbeat for COM_DL_LOSS_T, after there was one.
        stream_lost: No setpoint for COM_OF_LOSS_T.
        breach: How the fence is breached, or "".
        battery: Its level; `battery_at_arming` is what was accepted then.
        overtime: In the air for longer than COM_FLT_TIME_MAX.
        tilted: Leaning beyond FD_FAIL_R or FD_FAIL_P for their time.
        just_armed: Within COM_LKDOWN_TKO of arming.
    """

    mode: Mode
    flyable: frozenset[Mode]
    sticks_lost: bool = True
    sticks_needed: bool = False
    station_lost: bool = False
    stream_lost: bool = False
    breach: str = ""
    battery: Level = Level.FINE
    battery_at_arming: Level = Level.FINE
    overtime: bool = False
    tilted: bool = False
    just_armed: bool = False


class Row(NamedTuple):
    """One failing condition.

    Attributes:
        cause: In words; it names the condition.
        act: What to do.
        takeover: How the operator may end it.
        stays: The action outlives its condition, until the operator changes the mode.
        detail: More words.
    """

    cause: str
    act: Act
    takeover: Takeover = Takeover.DELAYED
    stays: bool = False
    detail: str = ""


_MODES = {
    Act.POSITION: Mode.POSITION,
    Act.ALTITUDE: Mode.ALTITUDE,
    Act.HOLD: Mode.HOLD,
    Act.RETURN: Mode.RETURN,
    Act.LAND: Mode.LAND,
    Act.DESCEND: Mode.DESCEND,
}
_LINK = {1: Act.HOLD, 2: Act.RETURN, 3: Act.LAND, 5: Act.TERMINATE, 6: Act.DISARM}
_FENCE = {1: Act.WARN, 2: Act.HOLD, 3: Act.RETURN, 4: Act.TERMINATE, 5: Act.LAND}
_STREAM = {
    0: Act.POSITION,
    1: Act.ALTITUDE,
    3: Act.RETURN,
    4: Act.LAND,
    5: Act.HOLD,
    6: Act.TERMINATE,
    7: Act.DISARM,
}
_BATTERY = {
    0: {},
    2: {Level.CRITICAL: Act.LAND, Level.EMERGENCY: Act.LAND},
    3: {Level.CRITICAL: Act.RETURN, Level.EMERGENCY: Act.LAND},
}
_BATTERY_WORDS = {
    Level.LOW: "Low battery level, return advised",
    Level.CRITICAL: "Critical battery level, land now",
    Level.EMERGENCY: "Emergency battery level, land immediately",
}
# The bit of COM_RCL_EXCEPT and COM_DLL_EXCEPT that excuses a mode.
_EXCUSED = {
    Mode.MISSION: 1,
    Mode.HOLD: 2,
    Mode.TAKEOFF: 2,
    Mode.RETURN: 2,
    Mode.LAND: 2,
    Mode.OFFBOARD: 4,
}
_BREAKER_ON = 121212


def rows(situation: Situation, parameters: Parameters) -> list[Row]:
    """Return what is wrong now, each with what is to be done about it."""
    found: list[Row] = []
    excuse = _EXCUSED.get(situation.mode, 0)
    if situation.sticks_lost and situation.sticks_needed and not int(parameters["COM_RCL_EXCEPT"]) & excuse:
        found.append(_link_row("Manual control lost", _LINK[int(parameters["NAV_RCL_ACT"])]))
    if situation.station_lost and situation.mode is not Mode.LAND:
        act = _LINK.get(int(parameters["NAV_DLL_ACT"]))
        if act is not None and not int(parameters["COM_DLL_EXCEPT"]) & excuse:
            found.append(_link_row("Ground station lost", act))
    if situation.breach and (act := _FENCE.get(int(parameters["GF_ACTION"]))):
        takeover = {Act.HOLD: Takeover.BY_MODE, Act.TERMINATE: Takeover.NEVER}.get(act, Takeover.DELAYED)
        found.append(Row("Geofence breached", act, takeover, stays=True, detail=situation.breach))
    if situation.battery is not Level.FINE:
        found.append(_battery_row(situation, int(parameters["COM_LOW_BAT_ACT"])))
    if situation.overtime:
        found.append(Row("Flight time exceeded", Act.RETURN))
    if situation.tilted:
        found.append(_tilt_row(situation, int(parameters["CBRK_FLIGHTTERM"])))
    if fallback := mode_row(situation, parameters):
        found.append(fallback)
    return found


def mode_row(situation: Situation, parameters: Parameters) -> Row | None:
    """Return what to do where the wanted mode cannot be flown, or None where it can."""
    cause, act, mode = "", Act.NONE, situation.mode
    if mode is Mode.OFFBOARD and situation.stream_lost:
        cause, act = "Offboard setpoints lost", _STREAM[int(parameters["COM_OBL_RC_ACT"])]
    elif mode not in situation.flyable:
        cause, act = "Position lost", Act.RETURN
        if mode is Mode.POSITION and not situation.sticks_lost:
            act = Act.LAND if parameters["COM_POSCTL_NAVL"] else Act.ALTITUDE
    if act in (Act.POSITION, Act.ALTITUDE) and situation.sticks_lost:
        act = _LINK[int(parameters["NAV_RCL_ACT"])]
    return Row(cause, act, Takeover.ALWAYS) if act else None


def possible(act: Act, flyable: frozenset[Mode]) -> Act:
    """Return an action, or the next more severe one that the vehicle can carry out."""
    while act in _MODES and _MODES[act] not in flyable:
        act = Act.TERMINATE if act is Act.DESCEND else Act(act + 1)
    return act


def mode_of(act: Act, wanted: Mode) -> Mode:
    """Return the mode an action flies in: the wanted one where it only warns."""
    return _MODES.get(act, wanted)


def _link_row(cause: str, act: Act) -> Row:
    takeover = Takeover.NEVER if act in (Act.TERMINATE, Act.DISARM) else Takeover.DELAYED
    return Row(cause, act, takeover, stays=True)


def _battery_row(situation: Situation, action: int) -> Row:
    act = Act.WARN
    if situation.battery > situation.battery_at_arming:
        act = _BATTERY[action].get(situation.battery, Act.WARN)
    return Row(_BATTERY_WORDS[situation.battery], act)


def _tilt_row(situation: Situation, breaker: int) -> Row:
    if situation.just_armed:
        return Row("Attitude failure", Act.DISARM, Takeover.NEVER)
    act = Act.WARN if breaker == _BREAKER_ON else Act.TERMINATE
    return Row("Attitude failure", act, Takeover.NEVER)
