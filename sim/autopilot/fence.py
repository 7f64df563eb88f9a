"""The geofence: zones seen from above, and a cylinder about home. World ENU, metres.

Source: PX4 user guide, "GeoFence"; names in capitals are PX4's parameters.
"""

from __future__ import annotations

from math import hypot

from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Point2, Polygon, Zone
from sim.kinematics import Vector3, Vector4


def breach(point: Vector3, home: Vector3 | Vector4, zones: tuple[Zone, ...], parameters: Parameters) -> str:
    """Return what a point breaks, or "".

    It must be outside of every exclusion, inside one inclusion at least where there are any, and within
    GF_MAX_HOR_DIST and GF_MAX_VER_DIST of home (0: no limit).
    """
    far, high = parameters["GF_MAX_HOR_DIST"], parameters["GF_MAX_VER_DIST"]
    x, y, z = point
    if far > 0.0 and hypot(x - home[0], y - home[1]) > far:
        return f"farther than {far:g} m from home"
    if high > 0.0 and z - home[2] > high:
        return f"higher than {high:g} m above home"
    if not zones:
        return ""
    inclusions = [zone for zone in zones if zone.inclusion]
    if inclusions and not any(contains(zone, x, y) for zone in inclusions):
        return "outside of the inclusion zone"
    if any(not zone.inclusion and contains(zone, x, y) for zone in zones):
        return "inside an exclusion zone"
    return ""


def contains(zone: Zone, x: float, y: float) -> bool:
    """Say whether a point is within a zone, seen from above."""
    if isinstance(zone, Polygon):
        return inside(zone.corners, x, y)
    return hypot(x - zone.center[0], y - zone.center[1]) <= zone.radius


def inside(corners: tuple[Point2, ...], x: float, y: float) -> bool:
    """Say whether a polygon contains a point: a ray from it crosses the edges an odd number of times (Jordan)."""
    odd = False
    xa, ya = corners[-1]
    for xb, yb in corners:
        if (ya > y) != (yb > y) and x < (xb - xa) * (y - ya) / (yb - ya) + xa:
            odd = not odd
        xa, ya = xb, yb
    return odd


def zone_fault(zones: tuple[Zone, ...]) -> str:
    """Return why zones cannot be a fence, or ""."""
    for zone in zones:
        if isinstance(zone, Polygon):
            if len(zone.corners) < 3:
                return "a polygon needs three corners"
        elif zone.radius <= 0.0:
            return "a circle needs a radius"
    return ""
