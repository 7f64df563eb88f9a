"""The instructor's instruments: how the trainee is doing, and what a key lets happen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from groundstation.instruct.telling import status
from groundstation.training.happening import words
from groundstation.training.strengths import FIRM, OFFERS, STRENGTHS
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, fit, wrapped
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.widgets.overview import Overview

_NAME = 10
_TWO_COLUMNS = 70
_BACK = ("c", "take all back")


@dataclass(slots=True)
class Choice:
    """What the instructor has chosen: a strength, an index of `STRENGTHS`, and where air goes to, rad from east."""

    strength: int = FIRM
    toward: float = 0.0


class Trainee(Instrument):
    """How it is going, and what is in force.

    Args:
        in_force: Returns what was let happen and lasts, in words, at a time, s.
    """

    BORDER_TITLE = "trainee"
    EVERY = 3

    def __init__(self, in_force: Callable[[float], str], *, id: str) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self._in_force = in_force

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw names and words; long ones go on in the next line."""
        rows: list[Row] = []
        for name, told in status(frame.run, frame.snapshot, self._in_force(frame.now)):
            tone = Tone.WARN if name == "in force" and told != "nothing" else Tone.TEXT
            first, *rest = wrapped(told, max(width - _NAME - 1, 10))
            rows.append([(f" {name:<{_NAME - 1}}", Tone.MUTED), (first, tone)])
            rows.extend([[(" " * _NAME, Tone.TEXT), (piece, tone)] for piece in rest])
        return rows[:height]


class Offers(Instrument):
    """The keys, and what each would let happen now.

    Args:
        choice: The instructor's.
        real: The vehicle is: it is left alone.
    """

    BORDER_TITLE = "let happen"

    def __init__(self, choice: Choice, *, real: bool, id: str) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self._choice, self._real = choice, real

    def footnote(self, frame: Frame) -> str:
        """Return how to choose."""
        del frame
        return "1 2 3 strength  o wind from"

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw a line each."""
        del frame
        if self._real:
            return [[(" The vehicle is real: it is left alone.", Tone.WARN)]]
        choice = self._choice
        strengths: Row = [(" ", Tone.TEXT)]
        for index, name in enumerate(STRENGTHS):
            chosen = index == choice.strength
            strengths += [
                (f"{index + 1} ", Tone.KEY),
                (f" {name} ", Tone.CHIP if chosen else Tone.MUTED),
                (" ", Tone.TEXT),
            ]
        told = [(offer.key, words(offer.at(choice.strength, choice.toward))) for offer in OFFERS]
        cells: list[Row] = [[(f" {key} ", Tone.KEY), (text, Tone.TEXT)] for key, text in (*told, _BACK)]
        if width < _TWO_COLUMNS:
            return [strengths, *cells][:height]
        half = (len(cells) + 1) // 2
        beside = [*cells[half:], *[[] for _ in range(2 * half - len(cells))]]
        rows = [fit(left, width // 2) + right for left, right in zip(cells[:half], beside, strict=True)]
        return [strengths, *rows][:height]


class Map(Overview):
    """The trainee's map; its other keys are the instructor's here."""

    def footnote(self, frame: Frame) -> str:
        """Return its key."""
        del frame
        return "v view"
