"""What a flight of a mission is measured by. `docs/scoring.md` gives each formula."""

from __future__ import annotations

import math

import msgspec
from msgspec import Struct


class Measures(Struct, frozen=True, omit_defaults=True):
    """A flight in numbers; NaN where there is nothing to be measured. JSON knows no NaN: there they are left out.

    Attributes:
        time_s: From take-off to landing, s.
        reached: Share of the mission's points that were reached, 0 to 1.
        rms_error_m: Root mean square of |p̃| on x, y, z while coupled, m.
        path_error_m: Root mean square of the distance to the mission's path while coupled, m.
        final_error_m: Distance to the target at the end of the hold, m.
        landing_error_m: From the middle of the pad to where it landed, in the plane, m.
        least_clearance_m: From the hull to the nearest obstacle, the least in the air, m.
        collisions: Contacts with obstacles.
        gates_missed: Share of the gates not flown through, 0 to 1.
        smoothness: Spectral arc length of the vehicle's speed while coupled: negative, nearer to 0 is smoother.
        disagreement_mps: Mean of |v_ref − v_safe| while coupled, m/s: how much the guard had to change.
        effort_n: Mean force the hand held against while coupled, N.
    """

    time_s: float = math.nan
    reached: float = math.nan
    rms_error_m: float = math.nan
    path_error_m: float = math.nan
    final_error_m: float = math.nan
    landing_error_m: float = math.nan
    least_clearance_m: float = math.nan
    collisions: int = 0
    gates_missed: float = math.nan
    smoothness: float = math.nan
    disagreement_mps: float = math.nan
    effort_n: float = math.nan

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not math.isfinite(getattr(self, name)):
                # What has no end is no measure; of all the NaN only the default itself is left out of JSON.
                msgspec.structs.force_setattr(self, name, math.nan)


class Track(Struct, frozen=True):
    """Where a flight went: a row of x, y, z (world, m) every `every_s` from take-off on."""

    every_s: float
    points: tuple[tuple[float, float, float], ...] = ()
