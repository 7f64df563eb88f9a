"""Every conversion between the simulator's frames and the wire's: ENU ↔ NED, FLU ↔ FRD, local ↔ geodetic.

Inside: world ENU, vehicle FLU, yaw counter-clockwise from east. On the wire: NED, FRD, heading clockwise from north.
Radians, metres; degrees only in latitude and longitude.
"""

from __future__ import annotations

from math import atan2, cos, degrees, hypot, radians, sin, tau

from sim.kinematics import Vector3, wrap

EARTH_RADIUS = 6_371_000.0
# Where PX4's own simulation stands: degrees, degrees, m above sea level.
ORIGIN = (47.397742, 8.545594, 488.0)

Quaternion = tuple[float, float, float, float]


def ned(east: float, north: float, up: float) -> Vector3:
    """Turn ENU into NED."""
    return north, east, -up


def enu(north: float, east: float, down: float) -> Vector3:
    """Turn NED into ENU."""
    return east, north, -down


def frd(forward: float, left: float, up: float) -> Vector3:
    """Turn FLU into FRD; it is its own inverse."""
    return forward, -left, -up


def heading(yaw: float) -> float:
    """Turn a yaw into a heading (clockwise from north) within (−π, π]; it is its own inverse."""
    return wrap(tau / 4.0 - yaw)


def compass(yaw: float) -> float:
    """Turn a yaw, rad, into a compass heading from 0 up to 360 degrees."""
    return degrees(heading(yaw)) % 360.0


def quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation yaw, then pitch, then roll as w, x, y, z (angles of one convention, FRD in NED here)."""
    cr, sr = cos(0.5 * roll), sin(0.5 * roll)
    cp, sp = cos(0.5 * pitch), sin(0.5 * pitch)
    cy, sy = cos(0.5 * yaw), sin(0.5 * yaw)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def geodetic(east: float, north: float, up: float) -> Vector3:
    """Return latitude and longitude, degrees, and height above sea level, m, of a point near the origin."""
    latitude, longitude, height = ORIGIN
    return (
        latitude + degrees(north / EARTH_RADIUS),
        longitude + degrees(east / (EARTH_RADIUS * cos(radians(latitude)))),
        height + up,
    )


def local(latitude: float, longitude: float) -> tuple[float, float]:
    """Return east and north, m, of a point near the origin: `geodetic` solved for them."""
    latitude_0, longitude_0, _ = ORIGIN
    north = radians(latitude - latitude_0) * EARTH_RADIUS
    return radians(longitude - longitude_0) * EARTH_RADIUS * cos(radians(latitude_0)), north


def course(east: float, north: float) -> tuple[float, float]:
    """Return the speed over ground, m/s, and its direction from 0 up to 360 degrees clockwise from north."""
    return hypot(east, north), degrees(atan2(east, north)) % 360.0
