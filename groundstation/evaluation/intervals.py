"""Estimates with 95 % confidence intervals: Wilson's for rates, Student's for means."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

# Two-sided, 95 %: of the normal distribution, and of Student's with one to six degrees of freedom.
_Z = 1.959963984540054
_FEW = (12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469)


class Interval(NamedTuple):
    """An estimate with its interval, NaN where there are too few to tell; `size` is how many it is from."""

    value: float
    low: float
    high: float
    size: int

    @property
    def half(self) -> float:
        """Half the width."""
        return 0.5 * (self.high - self.low)

    @property
    def leaves_out_zero(self) -> bool:
        """A difference with such an interval is told from none."""
        return self.low > 0.0 or self.high < 0.0


def wilson(successes: int, count: int) -> Interval:
    """Return a rate with Wilson's interval (1927, Probable inference, the law of succession).

    It stays within 0 and 1, and says something even where all or none succeed.
    """
    if count == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    share, z2 = successes / count, _Z * _Z
    centre = (share + z2 / (2 * count)) / (1 + z2 / count)
    spread = _Z * math.sqrt(share * (1 - share) / count + z2 / (4 * count * count)) / (1 + z2 / count)
    return Interval(share, max(0.0, centre - spread), min(1.0, centre + spread), count)


def mean(values: Sequence[float]) -> Interval:
    """Return a mean with Student's interval; two values are the least that have one."""
    count = len(values)
    if count == 0:
        return Interval(math.nan, math.nan, math.nan, 0)
    array = np.asarray(values, dtype=float)
    value = float(array.mean())
    if count == 1:
        return Interval(value, math.nan, math.nan, 1)
    half = student(count - 1) * float(array.std(ddof=1)) / math.sqrt(count)
    return Interval(value, value - half, value + half, count)


def student(freedom: int) -> float:
    """Return the quantile t with P(|T| > t) = 0.05 at `freedom` degrees, right to three digits.

    From seven degrees on by the expansion about the normal quantile (Abramowitz and Stegun 26.7.5).
    """
    if freedom <= len(_FEW):
        return _FEW[freedom - 1]
    z, n = _Z, float(freedom)
    return (
        z
        + (z**3 + z) / (4.0 * n)
        + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * n**2)
        + (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / (384.0 * n**3)
    )
