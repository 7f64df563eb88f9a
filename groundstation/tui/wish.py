"""What a pilot wants to fly when a screen is left: the next run is made of it."""

from __future__ import annotations

from typing import NamedTuple


class Wish(NamedTuple):
    """A mission, by name, and who flies it."""

    mission: str
    pilot: str


class Ending(NamedTuple):
    """How a screen was left: the exit code, and what shall be flown next, if anything."""

    code: int
    wish: Wish | None = None
