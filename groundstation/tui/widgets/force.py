"""The force on the hand: by axis and in all against what the device can render, and what it is made of."""

from __future__ import annotations

import math
from collections.abc import Iterator

from groundstation.messages import Preset, Severity
from groundstation.tui.cues import parts
from groundstation.tui.frame import Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import UNKNOWN, Row, bar, fit, gauge, quantity, width_of
from groundstation.tui.theme import MARKS, TONES, Tone
from groundstation.tui.widgets.instrument import Instrument

_AXES = ("fwd", "left", "up")
_NEAR_LIMIT = 0.9
_LOW = 2
_SHORT = 3


class Force(Instrument):
    """Signed bars, to the right is forward, left, up, and the cues; in a low pane the total and the cues that act."""

    BORDER_TITLE = "force on the hand"
    EVERY = 3
    STALE_S = 0.2

    def data_age(self, frame: Frame) -> float:
        """Age of the handle's record."""
        return frame.age(frame.snapshot.handle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw as much as there is room for."""
        handle = frame.snapshot.handle
        force = tuple(handle.force) if handle else (math.nan,) * 3
        norm, limit = math.hypot(*force), frame.force_limit
        if height <= _LOW:
            return [_total(norm, limit, width), fit(_acting(frame, width), width)]
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
        rows.append(fit(_norm(frame, norm, limit), width))
        return [*rows, *_cues(frame, width)][:height]


def _total(norm: float, limit: float, width: int) -> Row:
    severity = _severity(norm, limit)
    figures = f" {MARKS[severity]}{quantity(norm, 'N', 2)} of {quantity(limit, 'N', 0)} "
    tone = Tone.STRONG if severity is Severity.INFO else TONES[severity]
    return [(" ", Tone.TEXT), *gauge(norm, limit, width - len(figures) - 1, Tone.FORCE), (figures, tone)]


def _norm(frame: Frame, norm: float, limit: float) -> Row:
    severity = _severity(norm, limit)
    device = frame.snapshot.device
    renders = words(device.renders) if device else ""
    how = {"force": "felt", "rumble": "as rumble", "nothing": "drawn"}.get(renders, "")
    return [
        (" norm  ", Tone.MUTED),
        (f"{MARKS[severity]}{quantity(norm, 'N')}", TONES[severity]),
        (f" of {quantity(limit, 'N', 1)} {how}", Tone.MUTED),
    ]


def _severity(norm: float, limit: float) -> Severity:
    return Severity.WARNING if norm >= _NEAR_LIMIT * limit else Severity.INFO


def _acting(frame: Frame, width: int) -> Row:
    """Return the cues that act, as many as there is room for."""
    if frame.pilot is None:
        return [(f" cues {UNKNOWN}", Tone.FAINT)]
    row: Row = []
    for part in parts(frame.pilot, guided=frame.guided):
        item: Row = [
            (f" {part.name[:_SHORT].upper()} ", Tone.FORCE),
            (quantity(part.norm, "N", 1), Tone.STRONG),
        ]
        if part.acts and width_of(row) + width_of(item) <= width:
            row += item
    return row or [(" no cue acts", Tone.FAINT)]


def _cues(frame: Frame, width: int) -> Iterator[Row]:
    """Yield a row a cue: its key, whether it takes part, and how strong it is."""
    if frame.pilot is None:
        return
    preset = Preset(frame.pilot.preset).name.lower()
    for part in parts(frame.pilot, guided=frame.guided):
        head: Row = [
            (f" {part.key}", Tone.KEY),
            (f" {part.mark} {part.name:<12}", Tone.TEXT if part.on and part.weighted else Tone.FAINT),
        ]
        if part.on and part.weighted:
            figure = f" {quantity(part.norm, 'N', 2, 6)}"
            strip = gauge(part.norm, frame.force_limit, width - width_of(head) - len(figure) - 1, Tone.FORCE)
            yield [*head, *strip, (figure, Tone.STRONG if part.acts else Tone.MUTED)]
        else:
            yield [*head, ("off" if part.weighted else f"not in {preset}", Tone.FAINT)]
