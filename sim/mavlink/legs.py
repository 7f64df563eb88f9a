"""Mission items into legs.

Which commands a mission may hold, and in which frame, is PX4's list (mavlink_mission.cpp); what their parameters mean
is MAVLink's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite, isinf, isnan, nan, radians

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.plan import Action, Leg
from sim.mavlink.items import ABSOLUTE, RELATIVE, Item, ItemError, position

_MOST_JUMPS = 0x7FFF

# What PX4 takes in a mission and this vehicle has no use for: with a place, and without (frame MAV_FRAME_MISSION).
_PASSED_OVER_PLACES = frozenset((m.MAV_CMD_NAV_ROI, m.MAV_CMD_DO_SET_ROI, m.MAV_CMD_DO_SET_ROI_LOCATION))
_PASSED_OVER = frozenset(
    (
        m.MAV_CMD_NAV_ROI,
        m.MAV_CMD_DO_SET_ROI,
        m.MAV_CMD_DO_SET_ROI_WPNEXT_OFFSET,
        m.MAV_CMD_DO_SET_ROI_NONE,
        m.MAV_CMD_DO_WINCH,
        m.MAV_CMD_DO_GRIPPER,
        m.MAV_CMD_DO_SET_HOME,
        m.MAV_CMD_DO_LAND_START,
        m.MAV_CMD_DO_DIGICAM_CONTROL,
        m.MAV_CMD_DO_MOUNT_CONFIGURE,
        m.MAV_CMD_DO_MOUNT_CONTROL,
        m.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
        m.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
        m.MAV_CMD_SET_CAMERA_FOCUS,
        m.MAV_CMD_SET_CAMERA_MODE,
        m.MAV_CMD_IMAGE_START_CAPTURE,
        m.MAV_CMD_IMAGE_STOP_CAPTURE,
        m.MAV_CMD_VIDEO_START_CAPTURE,
        m.MAV_CMD_VIDEO_STOP_CAPTURE,
        m.MAV_CMD_DO_CONTROL_VIDEO,
        m.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
        m.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL,
        m.MAV_CMD_DO_TRIGGER_CONTROL,
        m.MAV_CMD_CONDITION_DELAY,
        m.MAV_CMD_CONDITION_DISTANCE,
    )
)


def legs(items: Sequence[Item]) -> tuple[Leg, ...]:
    """Return the mission that items describe, one leg an item.

    Raises:
        ItemError: One of them cannot be flown.
    """
    for item in items:
        if item.command == m.MAV_CMD_DO_JUMP and not 0 <= item.params[0] < len(items):
            raise ItemError(m.MAV_MISSION_INVALID_PARAM1, "a jump to an item that is not there")
    return tuple(leg(item) for item in items)


def leg(item: Item) -> Leg:
    """Return what one item of a mission asks for.

    Raises:
        ItemError: It cannot be flown.
    """
    if item.frame == m.MAV_FRAME_MISSION:
        passed_over, makers = _PASSED_OVER, _WITHOUT_PLACE
    elif item.frame in ABSOLUTE + RELATIVE:
        passed_over, makers = _PASSED_OVER_PLACES, _WITH_PLACE
    else:
        raise ItemError(m.MAV_MISSION_UNSUPPORTED_FRAME, f"frame {item.frame} is not simulated")
    if item.command in passed_over:
        return Leg(Action.NOTHING)
    make = makers.get(item.command)
    if make is None:
        raise ItemError(
            m.MAV_MISSION_UNSUPPORTED, f"command {item.command} is not simulated in frame {item.frame}"
        )
    return make(item)


def _waypoint(item: Item) -> Leg:
    hold_s, radius = _positive(item, 1), _positive(item, 2)
    return _to_place(item, Action.WAYPOINT)._replace(hold_s=hold_s, radius=radius)


def _loiter_time(item: Item) -> Leg:
    return _to_place(item, Action.LOITER_TIME)._replace(hold_s=_positive(item, 1))


def _to_height(item: Item) -> Leg:
    """LOITER_TO_ALT: a multirotor that is there at that height has done it; its parameter 4 is no yaw."""
    return _to_place(item._replace(params=(0.0, 0.0, 0.0, nan)), Action.WAYPOINT)


def _to_place(item: Item, action: Action) -> Leg:
    yaw = item.params[3]
    if isinf(yaw):
        raise ItemError(m.MAV_MISSION_INVALID_PARAM4, "a yaw that is not a finite number")
    turned = None if isnan(yaw) else frames.heading(radians(yaw))
    return Leg(action, position(item), above_home=item.frame in RELATIVE, yaw=turned)


def _delay(item: Item) -> Leg:
    return Leg(Action.DELAY, hold_s=_positive(item, 1))


def _change_speed(item: Item) -> Leg:
    """A speed that is not above 0 is the usual one again, as PX4 takes it; throttle is not simulated."""
    speed = item.params[1]
    if isinf(speed) or isnan(speed):
        raise ItemError(m.MAV_MISSION_INVALID_PARAM2, "a speed that is not a finite number")
    return Leg(Action.CHANGE_SPEED, value=speed)


def _jump(item: Item) -> Leg:
    index, repeat = item.params[:2]
    if not isfinite(index) or index != int(index) or index < 0:
        raise ItemError(m.MAV_MISSION_INVALID_PARAM1, "a jump to an item that is not there")
    if not isfinite(repeat):
        raise ItemError(m.MAV_MISSION_INVALID_PARAM2, "a number of jumps that is none")
    return Leg(Action.JUMP, value=index, repeat=int(max(0.0, min(repeat, _MOST_JUMPS))))


_Makers = dict[int, Callable[[Item], Leg]]
_WITH_PLACE: _Makers = {
    m.MAV_CMD_NAV_WAYPOINT: _waypoint,
    m.MAV_CMD_NAV_LOITER_UNLIM: lambda item: _to_place(item, Action.LOITER),
    m.MAV_CMD_NAV_LOITER_TIME: _loiter_time,
    m.MAV_CMD_NAV_LOITER_TO_ALT: _to_height,
    m.MAV_CMD_NAV_LAND: lambda item: _to_place(item, Action.LAND),
    m.MAV_CMD_NAV_TAKEOFF: lambda item: _to_place(item, Action.TAKEOFF),
}
_WITHOUT_PLACE: _Makers = {
    m.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: Leg(Action.RETURN),
    m.MAV_CMD_NAV_DELAY: _delay,
    m.MAV_CMD_DO_CHANGE_SPEED: _change_speed,
    m.MAV_CMD_DO_JUMP: _jump,
}


def _positive(item: Item, number: int) -> float:
    """Return parameter `number`, 0 where it is unset or negative."""
    value = item.params[number - 1]
    if isinf(value):
        raise ItemError(m.MAV_MISSION_INVALID_PARAM1 + number - 1, f"parameter {number} is not finite")
    return 0.0 if isnan(value) else max(0.0, value)
