"""How what comes next is asked for, as hints say it: keys where there is a screen, words where there is none."""

from __future__ import annotations

from typing import NamedTuple


class Ways(NamedTuple):
    """How each is asked for, within a sentence.

    Attributes:
        arm, takeoff, engage, disengage, hold, land, clutch: The act or choice of that name.
        centre: What centres the on-screen stick.
        pushed: The on-screen stick is pushed with keys.
    """

    arm: str
    takeoff: str
    engage: str
    disengage: str
    hold: str
    land: str
    clutch: str
    centre: str
    pushed: bool


KEYS = Ways("Shift+A", "t", "e", "x", "h", "l", "c", "space", pushed=True)
WORDS = Ways(
    "'arm'", "'take off'", "'engage'", "'release'", "'hold'", "'land'", "'clutch'", "'centre'", pushed=False
)


def begun(words: str) -> str:
    """Return words as a sentence begins with them where they are of more than one letter: Space, but e."""
    return words[0].upper() + words[1:] if len(words) > 1 else words
