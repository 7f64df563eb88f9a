"""Fence and rally items into zones and points."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from pymavlink.dialects.v20 import common as m

from sim.autopilot.plan import Circle, Point2, Polygon, Zone
from sim.kinematics import Vector3
from sim.mavlink.items import RELATIVE, Item, ItemError, fixed, position

_POLYGONS = {
    m.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: True,
    m.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False,
}
_CIRCLES = {m.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION: True, m.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION: False}


def zones(items: Sequence[Item]) -> tuple[Zone, ...]:
    """Return the fence that items describe: each polygon's vertices one after the other, each with their number.

    Raises:
        ItemError: They do not describe one.
    """
    found: list[Zone] = []
    at = 0
    while at < len(items):
        item = items[at]
        if item.command in _POLYGONS:
            corners = _corners(items[at:])
            found.append(Polygon(corners, _POLYGONS[item.command]))
            at += len(corners)
            continue
        if item.command in _CIRCLES:
            found.append(_circle(item))
        elif item.command != m.MAV_CMD_NAV_FENCE_RETURN_POINT:
            raise ItemError(m.MAV_MISSION_UNSUPPORTED, f"command {item.command} is no fence")
        at += 1
    return tuple(found)


def _corners(items: Sequence[Item]) -> tuple[Point2, ...]:
    first = items[0]
    number = first.params[0]
    if not (3 <= number <= len(items)) or number != int(number):
        raise ItemError(m.MAV_MISSION_INVALID_PARAM1, "a polygon with too few corners")
    corners = items[: int(number)]
    if any(item.command != first.command or item.params[0] != number for item in corners):
        raise ItemError(m.MAV_MISSION_INVALID_PARAM1, "a polygon with too few corners")
    return tuple(fixed(item) for item in corners)


def _circle(item: Item) -> Circle:
    radius = item.params[0]
    if not isfinite(radius) or radius <= 0.0:
        raise ItemError(m.MAV_MISSION_INVALID_PARAM1, "a circle without radius")
    return Circle(fixed(item), radius, _CIRCLES[item.command])


def rally_points(items: Sequence[Item], home_height: float) -> tuple[Vector3, ...]:
    """Return the rally points that items describe; heights above home become the world's.

    Raises:
        ItemError: One of them is no rally point.
    """
    found: list[Vector3] = []
    for item in items:
        if item.command != m.MAV_CMD_NAV_RALLY_POINT:
            raise ItemError(m.MAV_MISSION_UNSUPPORTED, f"command {item.command} is no rally point")
        x, y = fixed(item)
        z = position(item)[2]
        if z is None:
            raise ItemError(m.MAV_MISSION_INVALID_PARAM7, "no height is given")
        found.append((x, y, z + (home_height if item.frame in RELATIVE else 0.0)))
    return tuple(found)
