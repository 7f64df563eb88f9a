"""What an instructor or a mission's timetable lets happen: as it crosses the bus, and in words."""

from __future__ import annotations

import math
from typing import cast

import msgspec
from msgspec import Struct

from groundstation.frames import Vector3
from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    Event,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)

# Who lets it happen, where it is not the mission's timetable.
INSTRUCTOR = b"instructor"

_POINTS = ("east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east")
# Less than this is no wind, m/s.
_STILL = 0.05


class Calm(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind", tag="calm"):
    """All that was done is taken back: wind and link as before, device and GPS there again. A charge stays."""


Happening = Event | Calm

_DECODER = msgspec.json.Decoder(Happening)


def packed(happening: Happening) -> bytes:
    """Return it as JSON, for the bus and for a recording."""
    return msgspec.json.encode(happening)


def unpacked(data: bytes) -> Happening | None:
    """Return what JSON says, or None where that is nothing that can happen."""
    try:
        return cast("Happening", _DECODER.decode(data))
    except (msgspec.DecodeError, ValueError):
        return None


def words(happening: Happening) -> str:
    """Return in words what happens."""
    match happening:
        case WindChange(velocity=wind, turbulence=sigma):
            return _wind(wind) + (f", turbulence {sigma:g} m/s" if sigma else "")
        case GustNow(velocity=peak, duration_s=seconds):
            return f"gust {_from(peak)}, {seconds:g} s long"
        case Delay(round_trip_s=seconds, jitter_s=jitter):
            return f"round trip {1e3 * seconds:.0f} ms" + (f" ± {1e3 * jitter:.0f} ms" if jitter else "")
        case Loss(share=share):
            return f"{100.0 * share:g} % of frames lost"
        case LinkLoss(duration_s=seconds):
            return f"link lost for {seconds:g} s"
        case DeviceLoss(duration_s=seconds):
            return f"haptic device lost for {seconds:g} s"
        case BatteryLeft(remaining=share):
            return f"battery down to {100.0 * share:g} %"
        case GpsLoss(duration_s=seconds):
            return f"GPS lost for {seconds:g} s"
        case Calm():
            return "all taken back"


def _wind(velocity: Vector3) -> str:
    return f"wind {_from(velocity)}" if math.hypot(*velocity) > _STILL else "no wind"


def _from(velocity: Vector3) -> str:
    """Return strength and origin of moving air, as pilots tell it: by where it comes from."""
    east, north, up = velocity
    speed = math.hypot(*velocity)
    if math.hypot(east, north) < abs(up):
        return f"{speed:.1f} m/s {'upward' if up > 0.0 else 'downward'}"
    point = _POINTS[round(math.atan2(-north, -east) / (math.tau / 8)) % 8]
    return f"{speed:.1f} m/s from the {point}"
