"""A command's parameters, whichever message brought them."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple


class Request(NamedTuple):
    """A command, whether it came as COMMAND_LONG or COMMAND_INT.

    Attributes:
        params: Parameters 1 to 7; NaN where unset. 5 and 6 are degrees where they are a place.
        frame: MAV_FRAME of the place.
    """

    params: tuple[float, ...]
    frame: int

    def whole(self, number: int) -> int | None:
        """Return parameter `number` as an integer, or None where it is none."""
        value = self.params[number - 1]
        return int(value) if isfinite(value) and value == int(value) else None
