"""What the link's state leaves of gains and speeds: all while it is good, less as it worsens, then a hold."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

from groundstation.config import Link


class Shares(NamedTuple):
    """What is left, 0 to 1: of stiffness and cues, and of the speeds."""

    gain: float = 1.0
    speed: float = 1.0


def shares(delay: float, loss: float, settings: Link) -> Shares:
    """Return what the link leaves: as the worse of delay and loss has it, falling evenly from good to poor.

    Args:
        delay: Round trip, s; NaN is not known, and nothing is taken for it.
        loss: Share of frames lost, 0 to 1.
        settings: Thresholds.
    """
    poor = max(
        _between(delay, settings.good_delay_s, settings.poor_delay_s),
        _between(loss, settings.good_loss, settings.poor_loss),
    )
    return Shares(1.0 - poor * (1.0 - settings.least_gain), 1.0 - poor * (1.0 - settings.least_speed))


def link_fault(delay: float, loss: float, settings: Link) -> str:
    """Return in words why the link is too poor to fly by, or ""."""
    if delay >= settings.hold_delay_s:
        return f"the round trip of {delay:.1f} s is too long to fly by hand"
    if loss >= settings.hold_loss:
        return f"{loss:.0%} of the vehicle's frames are lost"
    return ""


def _between(value: float, good: float, poor: float) -> float:
    """Return 0 up to the good value, 1 from the poor one on; 0 for what is not known."""
    if not isfinite(value):
        return 0.0
    return min(1.0, max(0.0, (value - good) / (poor - good)))
