"""From an act on the command line to what shall happen."""

from __future__ import annotations

import argparse
from collections.abc import Callable

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
from groundstation.training.happening import Calm, Happening

WANTED: dict[str, Callable[[argparse.Namespace], Happening]] = {
    "wind": lambda asked: WindChange(
        velocity=(asked.east, asked.north, asked.up), turbulence=asked.turbulence
    ),
    "gust": lambda asked: GustNow(velocity=(asked.east, asked.north, asked.up), duration_s=asked.seconds),
    "delay": lambda asked: Delay(round_trip_s=asked.round_trip / 1e3, jitter_s=asked.jitter / 1e3),
    "loss": lambda asked: Loss(share=asked.amount / 1e2),
    "link-loss": lambda asked: LinkLoss(duration_s=asked.amount),
    "device-loss": lambda asked: DeviceLoss(duration_s=asked.amount),
    "gps-loss": lambda asked: GpsLoss(duration_s=asked.amount),
    "battery": lambda asked: BatteryLeft(remaining=asked.amount / 1e2),
    "calm": lambda _: Calm(),
}
