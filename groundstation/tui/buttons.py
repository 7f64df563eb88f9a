"""What the haptic device's buttons do, as a map for people: from the settings, so that it is what they do."""

from __future__ import annotations

from groundstation.config import Buttons
from groundstation.messages import Handle

# In the order of a map that is read: what is used most first.
MEANINGS = {
    "enable": "enable, while held: let go, it releases the hand",
    "panic": "squeezed through: releases the hand",
    "clutch": "clutch, while held",
    "fine": "fine, while held",
    "turn_left": "turn left, while held",
    "turn_right": "turn right, while held",
    "mapping": "rate or position",
    "release": "release the hand",
    "hold": "hold",
    "land": "land",
    "return_home": "return",
}


def button_map(buttons: Buttons) -> list[tuple[int, str]]:
    """Return each button that does something, by number from 0, with what it does."""
    taken = [(int(getattr(buttons, name)), words) for name, words in MEANINGS.items()]
    return sorted((number, words) for number, words in taken if number >= 0)


def unmapped(buttons: Buttons) -> list[str]:
    """Return what no button does."""
    return [name.replace("_", " ") for name in MEANINGS if getattr(buttons, name) < 0]


def held(handle: Handle | None) -> set[int]:
    """Return the numbers of the buttons that are held now."""
    bits = int(handle.buttons) if handle is not None and handle.present else 0
    return {number for number in range(32) if bits >> number & 1}
