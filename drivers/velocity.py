"""Velocity from quantised positions: first-order adaptive windowing.

Janabi-Sharifi, Hayward and Chen 2000, Discrete-time adaptive windowing for velocity estimation (IEEE
Transactions on Control Systems Technology 8(6)), in its end-fit form: the velocity is the slope between the
newest sample and the oldest one for which the line between the two passes every sample in between within the
noise. Slow motion gets a long window and little noise, fast motion a short one and little delay. Differencing two
neighbours at 1 kHz instead makes 1 m/s out of every millimetre of quantisation; a fixed filter that removes this
delays a quick hand as much as a slow one.
"""

from __future__ import annotations

from collections import deque
from math import inf


class Windowed:
    """One axis.

    Args:
        noise: Largest distance between two measurements of the same place; one count for an encoder.
        longest: Most intervals the window spans.

    Each sample costs one pass over the window: "every sample is within the noise of the line" is an interval of
    slopes, and the intervals of all samples are intersected as the window grows.
    """

    def __init__(self, noise: float, longest: int = 20) -> None:
        # A sample exactly on the bound is within it, whatever rounding makes of it.
        self._noise = noise * (1.0 + 1e-6)
        self._past: deque[tuple[float, float]] = deque(maxlen=longest)

    def add(self, t: float, place: float) -> float:
        """Take a sample at `t`, s, later than the one before; return the velocity, unit of `place`/s."""
        noise = self._noise
        velocity, lowest, highest = 0.0, -inf, inf
        for then, there in self._past:
            elapsed = t - then
            way = place - there
            slope = way / elapsed
            if not lowest <= slope <= highest:
                break
            velocity = slope
            margin = noise / elapsed
            lowest = max(lowest, slope - margin)
            highest = min(highest, slope + margin)
        self._past.appendleft((t, place))
        return velocity

    def reset(self) -> None:
        """Forget all samples: the next one is at rest."""
        self._past.clear()
