"""What a key lets happen at once: each kind gentle, firm or hard, for who watches a flight types no numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.happening import Happening
from sim.kinematics import Vector3

STRENGTHS = ("gentle", "firm", "hard")
FIRM = 1
_GUST_S = 4.0


@dataclass(frozen=True, slots=True)
class Offer:
    """Something that can be let happen.

    Attributes:
        key: That does it.
        name: For people.
        amounts: Of each strength, in the unit that `make` takes.
        make: Makes it happen: an amount, and where moving air goes to, rad counter-clockwise from east.
    """

    key: str
    name: str
    amounts: tuple[float, float, float]
    make: Callable[[float, float], Happening]

    def at(self, strength: int, toward: float = 0.0) -> Happening:
        """Return it in a strength, an index of `STRENGTHS`."""
        return self.make(self.amounts[strength], toward)


def _air(speed: float, toward: float) -> Vector3:
    return round(speed * math.cos(toward), 3), round(speed * math.sin(toward), 3), 0.0


OFFERS = (
    Offer("w", "wind", (2.0, 5.0, 8.0), lambda speed, toward: WindChange(velocity=_air(speed, toward))),
    Offer(
        "g", "gust", (4.0, 7.0, 10.0), lambda v, toward: GustNow(velocity=_air(v, toward), duration_s=_GUST_S)
    ),
    Offer("d", "delay", (0.1, 0.3, 0.6), lambda seconds, _: Delay(round_trip_s=seconds)),
    Offer("l", "frames lost", (0.05, 0.15, 0.3), lambda share, _: Loss(share=share)),
    Offer("k", "link lost", (2.0, 5.0, 10.0), lambda seconds, _: LinkLoss(duration_s=seconds)),
    Offer("u", "device lost", (3.0, 8.0, 15.0), lambda seconds, _: DeviceLoss(duration_s=seconds)),
    Offer("n", "GPS lost", (5.0, 10.0, 20.0), lambda seconds, _: GpsLoss(duration_s=seconds)),
    # Below PX4's thresholds for low, critical and emergency as they are by default.
    Offer("b", "battery", (0.14, 0.06, 0.04), lambda share, _: BatteryLeft(remaining=share)),
)
