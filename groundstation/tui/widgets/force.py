"""The force on the hand, by axis and in all, against what the device can render."""

from __future__ import annotations

import math

from groundstation.messages import Severity
from groundstation.tui.frame import Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import Row, bar, fit, quantity
from groundstation.tui.theme import MARKS, TONES, Tone
from groundstation.tui.widgets.instrument import Instrument

_AXES = ("fwd", "left", "up")
_NEAR_LIMIT = 0.9


class Force(Instrument):
    """Signed bars: to the right is forward, left, up."""

    BORDER_TITLE = "force on the hand"
    EVERY = 2
    STALE_S = 0.2

    def data_age(self, frame: Frame) -> float:
        """Age of the handle's record."""
        return frame.age(frame.snapshot.handle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw a bar an axis, and the norm with the limit where there is room."""
        handle = frame.snapshot.handle
        force = tuple(handle.force) if handle else (math.nan,) * 3
        limit = frame.force_limit
        rows: list[Row] = []
        for axis, value in zip(_AXES, force, strict=True):
            text = quantity(value, "N", 2, 6, sign=True)
            rows.append(
                [
                    (f" {axis:<5}", Tone.MUTED),
                    *bar(value, limit, width - 16, Tone.FORCE),
                    (f" {text}", Tone.STRONG),
                ]
            )
        rows.append(fit(_norm(frame, math.hypot(*force), limit), width))
        return rows[:height]


def _norm(frame: Frame, norm: float, limit: float) -> Row:
    severity = Severity.WARNING if norm >= _NEAR_LIMIT * limit else Severity.INFO
    device = frame.snapshot.device
    renders = words(device.renders) if device else ""
    how = {"force": "felt", "rumble": "as rumble", "nothing": "drawn"}.get(renders, "")
    return [
        (" norm  ", Tone.MUTED),
        (f"{MARKS[severity]}{quantity(norm, 'N')}", TONES[severity]),
        (f" of {quantity(limit, 'N', 1)} {how}", Tone.MUTED),
    ]
