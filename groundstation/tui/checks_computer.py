"""The check of this computer's own battery: it carries the stick and the link.

Source: Linux, Documentation/ABI/testing/sysfs-class-power. Elsewhere nothing is known, and nothing is said.
"""

from __future__ import annotations

import contextlib
import math
from functools import lru_cache
from pathlib import Path

from groundstation.messages import Severity
from groundstation.tui.check import Check

_SUPPLIES = Path("/sys/class/power_supply")
# Below the one it is told, below the other it is not flown; a battery is asked so often, s.
_LOW, _EMPTY, _EVERY_S = 50, 15, 30.0


def supply(now: float) -> Check:
    """Return how this computer is supplied."""
    return _supply(_SUPPLIES, int(now / _EVERY_S))


@lru_cache(maxsize=1)
def _supply(folder: Path, turn: int) -> Check:
    """Look anew every turn: a battery may take a tenth of a second to answer."""
    del turn
    return judged(discharging(folder))


def discharging(folder: Path) -> float:
    """Return what is left in the emptiest battery that is being emptied, per cent; NaN where none is.

    Args:
        folder: Where Linux shows what supplies power. Those of mice and keyboards are not the computer's.
    """
    left: list[float] = []
    for each in sorted(folder.glob("*/capacity")):
        with contextlib.suppress(OSError, ValueError):
            if _read(each.parent, "status") == "Discharging" and _read(each.parent, "scope") != "Device":
                left.append(float(each.read_text()))
    return min(left, default=math.nan)


def judged(left: float) -> Check:
    """Judge what is left, per cent; NaN: it runs on mains, or nothing is known."""
    if math.isnan(left):
        return Check("this computer", Severity.INFO, "not on a battery")
    state = f"on its battery, {left:.0f} % left"
    if left > _LOW:
        return Check("this computer", Severity.INFO, state)
    severity = Severity.WARNING if left > _EMPTY else Severity.ALARM
    return Check("this computer", severity, state, "charge it before you fly")


def _read(supply: Path, name: str) -> str:
    file = supply / name
    return file.read_text().strip() if file.exists() else ""
