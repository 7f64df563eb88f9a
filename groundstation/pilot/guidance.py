"""Guidance towards a mission's way: a virtual fixture round a path, as strong as who learns needs it.

With d from where the vehicle will be in a moment to the nearest point of the path, the hand is guided by

    f = s k (|d| − r) d/|d|   outside of a tube of radius r, nothing within

(virtual fixtures: Rosenberg 1993; guidance that is no stronger than needed: Marchal-Crespo and Reinkensmeyer 2009).
It turns what the hand asks for and never asks for more: it is nothing while the handle is at its centre, and of it
what leads further outward along the handle's own displacement is left out. So it moves no vehicle without the hand.
The nearest point is looked for near the one before only: where a path crosses itself, the other branch does not pull.
At first, and where the vehicle is far from there, all of the path is looked at, and of equally near pieces the first
counts: a path that leads round begins where it ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

from drivers.device import ZERO3, DeviceInfo, Vector3
from groundstation.config import Settings
from groundstation.frames import Vector4
from groundstation.messages import Cue, MappingMode
from groundstation.pilot.controller import world_rates
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.surroundings import Surroundings

# The vehicle is guided by where it will be after this, s.
AHEAD_S = 0.4
# So far back and on along the path from the nearest point the next one is looked for, m.
_BACK_M, _ON_M = 1.5, 2.5
# Further than this from it the vehicle is somewhere else, and a later piece must be nearer by that much, m.
_LOST_M, _NEARER_M = 2.0, 0.5
# Of its travel the handle is at its centre within this, and guided in full from twice as far on, as a share.
CENTRE = 0.05
_SHORTEST_M = 1e-6
NOWHERE = math.nan
"""The station of a vehicle that is not flown: then all of the path is looked at."""
_GUIDANCE = int(Cue.GUIDANCE)


class Segment(NamedTuple):
    """A straight piece of the path: where it begins along it, m, and in the world, its direction, its length, m."""

    station: float
    start: Vector3
    along: Vector3
    length: float


class Tube(NamedTuple):
    """What guides, and how strongly.

    Attributes:
        stiffness: N a metre outside.
        radius: m.
        limit: Largest force, N.
    """

    stiffness: float
    radius: float
    limit: float


class Guidance:
    """Guides along one path.

    Args:
        path: Its points, world, m.
        tube: Around it.
        workspace: Radius in which the handle moves, m.
    """

    def __init__(self, path: Sequence[Vector3], tube: Tube, workspace: float) -> None:
        self._segments = segments_of(path)
        self._tube = tube
        self._centre = CENTRE * workspace

    def look(
        self, station: float, inputs: Inputs, p: Vector4, turn: float, share: float
    ) -> tuple[float, Vector3]:
        """Return where along the path the vehicle is, m, and what of the force towards it is felt, world, N.

        Args:
            station: Where it was at the tick before, m; `NOWHERE` where it was not flown.
            inputs: Of this tick.
            p: Where the vehicle is seen, world, m and rad.
            turn: Angle from the world's axes to the handle's, rad.
            share: Of the force that preset, link and device leave, 0 to 1.
        """
        choices = inputs.choices
        station, force = self.towards(station, p, inputs.vehicle.velocity)
        led = choices.cues & _GUIDANCE and choices.mapping is MappingMode.RATE and not choices.clutched
        if not led or not share or force is ZERO3:
            return station, ZERO3
        x, y, z, _ = world_rates((*inputs.hand.position, 0.0), turn)
        f, g, h = self.turned(force, (x, y, z))
        return station, (share * f, share * g, share * h)

    def towards(self, station: float, position: Vector4, velocity: Vector4) -> tuple[float, Vector3]:
        """Return where along the path the vehicle is, m, and the force towards it, world, N.

        Args:
            station: As in `look`.
            position: Of the vehicle, world, m.
            velocity: Likewise, m/s.
        """
        x, y, z = (
            position[0] + AHEAD_S * velocity[0],
            position[1] + AHEAD_S * velocity[1],
            position[2] + AHEAD_S * velocity[2],
        )
        nearest, away, (u, v, w) = station, math.inf, ZERO3
        nearer = _NEARER_M if math.isnan(station) else 0.0
        for begin, (a, b, c), (i, j, k), length in self._segments:
            low, high = max(0.0, station - _BACK_M - begin), min(length, station + _ON_M - begin)
            # NaN is greater than nothing: without a station all of the path is looked at.
            if low > high:
                continue
            share = min(max((x - a) * i + (y - b) * j + (z - c) * k, low), high)
            p, q, r = a + share * i - x, b + share * j - y, c + share * k - z
            distance = sqrt(p * p + q * q + r * r)
            if distance < away - nearer:
                nearest, away, (u, v, w) = begin + share, distance, (p, q, r)
        if away > _LOST_M:
            nearest = NOWHERE
        stiffness, radius, limit = self._tube
        if not radius < away < math.inf:
            return nearest, ZERO3
        size = min(stiffness * (away - radius), limit) / away
        return nearest, (size * u, size * v, size * w)

    def turned(self, force: Vector3, displacement: Vector3) -> Vector3:
        """Return what of a force turns what the hand asks for.

        Args:
            force: Towards the path, world, N.
            displacement: Of the handle, turned into the world, m.
        """
        (f, g, h), (x, y, z) = force, displacement
        out = sqrt(x * x + y * y + z * z)
        meant = min(out / self._centre - 1.0, 1.0)
        if meant <= 0.0:
            return ZERO3
        outward = max((f * x + g * y + h * z) / (out * out), 0.0)
        return meant * (f - outward * x), meant * (g - outward * y), meant * (h - outward * z)


def guidance_for(settings: Settings, surroundings: Surroundings, device: DeviceInfo) -> Guidance | None:
    """Return what guides along the way of a mission, or None where nothing does."""
    strength, cues = surroundings.guidance, settings.cues
    if not strength or len(surroundings.way) < 2:
        return None
    limit = strength * cues.guidance_limit * device.force_limit
    tube = Tube(strength * cues.guidance, cues.tube, min(limit, cues.part_limit))
    return Guidance(surroundings.way, tube, device.workspace)


def segments_of(path: Sequence[Vector3]) -> tuple[Segment, ...]:
    """Return the pieces of a path; what is too short to have a direction is left out."""
    segments: list[Segment] = []
    station = 0.0
    for start, end in pairwise(path):
        length = math.dist(start, end)
        if length < _SHORTEST_M:
            continue
        along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length, (end[2] - start[2]) / length)
        segments.append(Segment(station, start, along, length))
        station += length
    return tuple(segments)
