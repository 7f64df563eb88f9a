"""What forbids arming, and what forbids a mode: pure judgements, in words. Names in capitals are PX4's parameters."""

from __future__ import annotations

from typing import NamedTuple

from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters

_HIGH_THROTTLE = 0.2
_NEEDS_STICKS = (Mode.POSITION, Mode.ALTITUDE)
_NEEDS_NO_POSITION = (Mode.ALTITUDE, Mode.DESCEND)


class State(NamedTuple):
    """What arming and changing modes depend on.

    Attributes:
        landed: The vehicle stands on something.
        terminated: The flight was terminated.
        position: Its position estimate is valid.
        streaming: Setpoints are coming at 2 Hz or more.
        sticks: Fresh sticks are there; `throttle` is how high theirs is, −1..1.
        remaining: Of the battery, 0..1.
        breach: How the fence is breached, or "".
        mission_fault: Why the mission cannot be flown, or "".
    """

    landed: bool
    terminated: bool
    position: bool
    streaming: bool
    sticks: bool
    throttle: float
    remaining: float
    breach: str
    mission_fault: str


def mode_obstacle(mode: Mode, state: State) -> str:
    """Return why a mode cannot be flown now, or ""."""
    if mode is Mode.OFFBOARD and not state.streaming:
        return "no setpoints are coming; stream them at 2 Hz or more before the switch"
    if mode in _NEEDS_STICKS and not state.sticks:
        return "no manual control signal"
    if mode is Mode.MISSION and state.mission_fault:
        return state.mission_fault
    if mode not in _NEEDS_NO_POSITION and not state.position:
        return "no valid position estimate"
    return ""


def arming_obstacles(mode: Mode, state: State, parameters: Parameters) -> list[str]:
    """Return all that forbids arming in a mode."""
    found: list[str] = []
    if state.terminated:
        found.append("flight was terminated; restart the vehicle")
    least = max(parameters["BAT_CRIT_THR"], parameters["COM_ARM_BAT_MIN"])
    if state.remaining <= least:
        found.append(f"battery at {state.remaining:.0%}; charge it")
    if not state.landed:
        found.append("not on the ground")
    if mode is Mode.OFFBOARD and not state.streaming:
        found.append("Offboard without setpoints; switch to Hold")
    elif mode in (Mode.LAND, Mode.RETURN):
        found.append(f"{mode.value} cannot take off; switch to Hold")
    elif why := mode_obstacle(mode, state):
        found.append(why)
    elif mode in _NEEDS_STICKS and state.throttle > _HIGH_THROTTLE:
        found.append("throttle is high; lower it")
    if state.breach and parameters["GF_ACTION"]:
        found.append(f"geofence breached: {state.breach}")
    if parameters["COM_ARM_MIS_REQ"] and state.mission_fault:
        found.append(f"a mission is required (COM_ARM_MIS_REQ): {state.mission_fault}")
    return found
