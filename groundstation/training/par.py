"""What a flight is held against: what the reference operator reached on the same seed, or on others in the mean."""

from __future__ import annotations

import math

import msgspec

from groundstation.training.measures import Measures
from groundstation.training.reference import EXPERT, Reference


def par_in(reference: Reference | None, seed: int) -> tuple[Measures | None, str]:
    """Return the par for a seed, and in words where it comes from.

    Args:
        reference: Of the mission that is flown; None where nobody has flown it for reference.
        seed: Of the flight.
    """
    flights = reference.flights.get(EXPERT, {}) if reference else {}
    if seed in flights:
        return flights[seed], f"the {EXPERT} operator on seed {seed}"
    if not flights:
        return None, ""
    return _mean(list(flights.values())), f"the {EXPERT} operator, mean of {len(flights)} other seeds"


def _mean(flights: list[Measures]) -> Measures:
    """Return the mean of each measure over the flights that have it; nobody collides in the mean."""
    means: dict[str, float] = {}
    for name in Measures.__struct_fields__:
        known = [value for each in flights if math.isfinite(value := float(getattr(each, name)))]
        if known and name != "collisions":
            means[name] = math.fsum(known) / len(known)
    return msgspec.convert(means, Measures)
