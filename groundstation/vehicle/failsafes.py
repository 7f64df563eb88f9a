"""What the vehicle does by itself when the hand, the link or the battery fails, judged from its parameters. Pure.

Which those are is in its autopilot's profile: `groundstation.vehicle.px4`, `groundstation.vehicle.ardupilot`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from groundstation.messages import Severity


class Verdict(NamedTuple):
    """How a parameter is set.

    Attributes:
        severity: ALARM forbids to couple the hand.
        means: What the vehicle does, in words.
        remedy: What to do, or "".
    """

    severity: Severity
    means: str
    remedy: str = ""


class Judged(NamedTuple):
    """A parameter that the hand's life hangs on.

    Attributes:
        name: The autopilot's.
        whole: It is an integer.
        judge: Judges a value.
    """

    name: str
    whole: bool
    judge: Callable[[float], Verdict]


UNREAD = Verdict(Severity.ALARM, "not read from the vehicle", "wait for the link; F9 reads it again")


def among(table: Mapping[int, Verdict], whose: str) -> Callable[[float], Verdict]:
    """Return a judge of a choice: each value that means something has its verdict, others are dangerous."""
    unknown = f"set one that {whose} documents"

    def judge(value: float) -> Verdict:
        known = table.get(int(value)) if math.isfinite(value) and value == int(value) else None
        return known or Verdict(Severity.ALARM, f"{value:g} has no known meaning", unknown)

    return judge


def speed(way: str, unit: float = 1.0) -> Callable[[float], Verdict]:
    """Return a judge of a largest speed, given in `unit` m/s: it must be one that can be flown."""

    def judge(value: float) -> Verdict:
        if not 0.0 < value * unit < math.inf:
            return Verdict(Severity.ALARM, f"no speed {way} at all", "set the speed that is allowed")
        return Verdict(Severity.INFO, f"up to {value * unit:g} m/s {way}; never asked for more")

    return judge


def verdict(judged: Judged, values: Mapping[str, float]) -> Verdict:
    """Judge a parameter by what has been read; what has not been is a danger."""
    value = values.get(judged.name)
    return UNREAD if value is None else judged.judge(value)


def unsafe(parameters: Iterable[Judged], values: Mapping[str, float]) -> str:
    """Return why the vehicle's parameters keep the hand from being coupled, or ""."""
    every = tuple(parameters)
    unread = [each.name for each in every if each.name not in values]
    if unread:
        more = f" and {len(unread) - 1} more" if len(unread) > 1 else ""
        return f"the vehicle's {unread[0]}{more} is not read yet; see Preflight (F7)"
    for each in every:
        judged = each.judge(values[each.name])
        if judged.severity is Severity.ALARM:
            return f"{each.name} = {values[each.name]:g} ({judged.means}); {judged.remedy}"
    return ""
