"""MAVLink's OBSTACLE_DISTANCE and DISTANCE_SENSOR, checked field by field and turned onto the vehicle's axes.

https://mavlink.io/en/messages/common.html#OBSTACLE_DISTANCE, #DISTANCE_SENSOR. Pure functions from JSON to metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from enum import Enum
from typing import Annotated, NamedTuple, TypeVar

import msgspec
from msgspec import Meta, Struct

from groundstation.frames import angle_from_bearing, yaw_from_heading
from groundstation.messages import RING_SECTORS

SECTOR = math.tau / RING_SECTORS
# MAV_FRAME_GLOBAL, _LOCAL_NED: from north on; MAV_FRAME_BODY_FRD: from forward on. PX4 knows the same three.
_FROM_NORTH, _FROM_FORWARD = frozenset({0, 1}), frozenset({12})
# MAV_SENSOR_ROTATION_NONE to _YAW_315 in steps of 45° clockwise; _PITCH_90 and _PITCH_270.
_LEVEL_ROTATIONS, _STEP_DEG = 8, 45.0
_UP, _DOWN = 24, 25
# Of DISTANCE_SENSOR's signal_quality: the signal is invalid.
_INVALID_SIGNAL = 1
_UNKNOWN_CM = 0xFFFF
_ROUNDING = 1e-6

Byte = Annotated[int, Meta(ge=0, le=0xFF)]
Centimetres = Annotated[int, Meta(ge=0, le=0xFFFF)]
Degrees = Annotated[float, Meta(ge=-360, le=360)]
Ring = tuple[float, ...]
NO_RING: Ring = (math.nan,) * RING_SECTORS
T = TypeVar("T", bound=Struct)


class DistanceError(ValueError):
    """A message of distances is not to be believed; the words say why."""


class Way(Enum):
    """Where a single beam looks."""

    LEVEL = "level"
    UP = "up"
    DOWN = "down"


class Scan(NamedTuple):
    """A ring of distances around the vehicle.

    Attributes:
        ring: `RING_SECTORS` distances counter-clockwise from forward, m; infinite: nothing, NaN: not known.
        limit: How far they see, m.
    """

    ring: Ring
    limit: float


class Beam(NamedTuple):
    """One distance.

    Attributes:
        way: Where it looks.
        angle: Of a level one, counter-clockwise from forward, rad.
        width: Its angle of view in the plane, rad.
        distance: m; infinite: nothing, NaN: not known.
        limit: How far it sees, m.
        source: Sensor and orientation; a later beam of the same takes its place.
    """

    way: Way
    angle: float
    width: float
    distance: float
    limit: float
    source: tuple[int, int]


class _ObstacleDistance(Struct):
    distances: Annotated[tuple[Centimetres, ...], Meta(min_length=1, max_length=RING_SECTORS)]
    max_distance: Annotated[int, Meta(ge=1, le=0xFFFF)]
    increment: Byte
    increment_f: Degrees
    angle_offset: Degrees
    frame: Byte


class _DistanceSensor(Struct):
    current_distance: Centimetres
    max_distance: Annotated[int, Meta(ge=1, le=0xFFFF)]
    id: Byte
    orientation: Byte
    horizontal_fov: Annotated[float, Meta(ge=0, le=6.2832)]
    signal_quality: Byte


def scan_from(fields: str, yaw: float) -> Scan:
    """Return the ring of an OBSTACLE_DISTANCE.

    A reading nearer than the sensor's least still says that something is there, and counts.

    Args:
        fields: The message as MAVSDK gives it, JSON.
        yaw: The vehicle's, rad; NaN where it is not known. Only a ring that counts from north needs it.

    Raises:
        DistanceError: A field is missing, out of range or not finite, or the ring cannot be placed.
    """
    told = _checked(fields, _ObstacleDistance)
    width_deg = told.increment_f or float(told.increment)
    if width_deg == 0.0:
        raise DistanceError("increment is 0")
    readings = (
        (told.angle_offset + place * width_deg, _metres(centimetres, told.max_distance + 1))
        for place, centimetres in enumerate(told.distances)
        if centimetres != _UNKNOWN_CM
    )
    if told.frame in _FROM_FORWARD:
        angles = ((angle_from_bearing(bearing), distance) for bearing, distance in readings)
    elif told.frame not in _FROM_NORTH:
        raise DistanceError(f"frame {told.frame} is none of 0, 1 (from north on) and 12 (from forward on)")
    elif math.isnan(yaw):
        raise DistanceError("it counts from north, and the vehicle's heading is not known")
    else:
        angles = ((yaw_from_heading(bearing) - yaw, distance) for bearing, distance in readings)
    return Scan(_ring_of(angles, math.radians(abs(width_deg))), told.max_distance / 100.0)


def beam_from(fields: str) -> Beam | None:
    """Return the beam of a DISTANCE_SENSOR; None where it looks askew.

    Args:
        fields: The message as MAVSDK gives it, JSON.

    Raises:
        DistanceError: A field is missing, out of range or not finite.
    """
    told = _checked(fields, _DistanceSensor)
    angle, way = 0.0, Way.LEVEL
    if told.orientation < _LEVEL_ROTATIONS:
        angle = angle_from_bearing(told.orientation * _STEP_DEG)
    elif told.orientation in {_UP, _DOWN}:
        way = Way.UP if told.orientation == _UP else Way.DOWN
    else:
        return None
    distance = _metres(told.current_distance, told.max_distance)
    if told.signal_quality == _INVALID_SIGNAL:
        distance = math.nan
    limit = told.max_distance / 100.0
    return Beam(way, angle, told.horizontal_fov, distance, limit, (told.id, told.orientation))


def merged(ring: Ring, beams: Iterable[Beam]) -> Ring:
    """Return a ring with level beams in it; where both see something, the nearer counts."""
    together = list(ring)
    for beam in beams:
        _lay(together, beam.angle, beam.width, beam.distance)
    return tuple(together)


def nearer(one: float, other: float) -> float:
    """Return the nearer of two distances, or the one that is known."""
    return other if math.isnan(one) else min(one, other)


def _ring_of(readings: Iterable[tuple[float, float]], width: float) -> Ring:
    ring = list(NO_RING)
    for angle, distance in readings:
        _lay(ring, angle, width, distance)
    return tuple(ring)


def _lay(ring: list[float], angle: float, width: float, distance: float) -> None:
    """Lay a reading into the sectors whose middles it covers, and into the nearest one at least."""
    half = min(0.5 * width, math.pi)
    first = math.ceil((angle - half) / SECTOR - _ROUNDING)
    after = math.ceil((angle + half) / SECTOR - _ROUNDING)
    if after <= first:
        first, after = round(angle / SECTOR), round(angle / SECTOR) + 1
    for sector in range(first, after):
        place = sector % RING_SECTORS
        ring[place] = nearer(ring[place], distance)


def _metres(centimetres: int, nothing_from: int) -> float:
    return math.inf if centimetres >= nothing_from else centimetres / 100.0


def _checked(fields: str, kind: type[T]) -> T:
    try:
        return msgspec.json.decode(fields, type=kind)
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        # MAVSDK writes what is not finite as null, which is no number.
        raise DistanceError(str(error)) from error
