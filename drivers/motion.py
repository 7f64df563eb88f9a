"""What a hand wants, as a function of time: programmed, or recorded in a file.

A recording is a CSV file with a header. Columns: `t`, s, rising; `x`, `y`, `z`, m from the centre, handle frame; and
where wanted `yaw`, rad, and `buttons`, bits.
"""

from __future__ import annotations

import csv
import math
from bisect import bisect_right
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from drivers.device import ZERO3, DeviceError, Vector3
from drivers.stick import LARGEST_POSITION, LARGEST_YAW

_COLUMNS = ("t", "x", "y", "z")
_LARGEST_TIME = 1e6


class Intention(NamedTuple):
    """Where a hand wants the handle to be: m from the centre, rad, handle frame; buttons as bits."""

    position: Vector3 = ZERO3
    yaw: float = 0.0
    buttons: int = 0


Motion = Callable[[float], Intention]
"""From seconds since the hand began to what it wants."""


def rest(t: float) -> Intention:  # noqa: ARG001 - a Motion
    """Stay in the centre."""
    return Intention()


def circle(radius: float, period: float) -> Motion:
    """Go round horizontally, from the centre out in the first period: radius in m, period in s."""

    def motion(t: float) -> Intention:
        angle = math.tau * t / period
        reach = radius * min(t / period, 1.0)
        return Intention((reach * math.cos(angle), reach * math.sin(angle), 0.0))

    return motion


def recorded(path: str) -> Motion:
    """Do what a recording says: straight between its samples, and at its end stay there.

    Raises:
        DeviceError: It cannot be read or is not a recording, with the line.
    """
    file = Path(path)
    try:
        with file.open(newline="", encoding="utf-8") as lines:
            samples = _samples(path, csv.DictReader(lines))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DeviceError(f"{path}: the recorded hand cannot be read ({error}); check the file.") from error
    times = [t for t, _ in samples]

    def motion(t: float) -> Intention:
        after = bisect_right(times, t + times[0])
        before_t, before = samples[after - 1]
        if after == len(samples):
            return before
        after_t, then = samples[after]
        share = (t + times[0] - before_t) / (after_t - before_t)
        (x, y, z), (u, v, w) = before.position, then.position
        position = (x + share * (u - x), y + share * (v - y), z + share * (w - z))
        return Intention(position, before.yaw + share * (then.yaw - before.yaw), before.buttons)

    return motion


def motion_named(address: str) -> Motion | None:
    """Return the motion that an address names: `rest`, `circle`, or a recording, `*.csv`; else None.

    Raises:
        DeviceError: The recording is not one.
    """
    if address == "rest":
        return rest
    if address == "circle":
        return circle(radius=0.02, period=4.0)
    return recorded(address) if address.endswith(".csv") else None


def _samples(path: str, rows: csv.DictReader[str]) -> list[tuple[float, Intention]]:
    missing = [name for name in _COLUMNS if name not in (rows.fieldnames or ())]
    if missing:
        raise DeviceError(
            f"{path}: the recorded hand has no column {', '.join(missing)}; its first line names them."
        )
    samples: list[tuple[float, Intention]] = []
    for row in rows:
        try:
            t, x, y, z = (float(row[name]) for name in _COLUMNS)
            yaw, buttons = float(row.get("yaw") or 0.0), int(row.get("buttons") or 0)
        except (TypeError, ValueError) as error:
            raise DeviceError(f"{path}: line {rows.line_num}: is not all numbers; correct it.") from error
        # A comparison with NaN is false, so what is not a number does not pass.
        sound = (
            (samples[-1][0] if samples else -_LARGEST_TIME) < t < _LARGEST_TIME
            and max(abs(x), abs(y), abs(z)) <= LARGEST_POSITION
            and not math.isnan(x + y + z)
            and abs(yaw) <= LARGEST_YAW
            and 0 <= buttons < 1 << 32
        )
        if not sound:
            raise DeviceError(
                f"{path}: line {rows.line_num}: time must rise, positions be within 1 m and yaw within π; correct it."
            )
        samples.append((t, Intention((x, y, z), yaw, buttons)))
    if not samples:
        raise DeviceError(f"{path}: the recorded hand has no samples; record one.")
    return samples
