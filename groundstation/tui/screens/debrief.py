"""Debrief: what the flight came to, part by part of its score, and the way to its recording."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.widget import Widget

from groundstation.training.director import Director, Stage
from groundstation.training.score import score_of
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.rows import Row, gauge, quantity
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import Tone

_NAME = 14
_BAR = 24
_ERROR = "p\u0303"


class Debrief(Page):
    """The outcome."""

    NAME = "debrief"
    OWN_KEYS: ClassVar = (("v", "Open the recording in the viewer", "app.review"),)
    BINDINGS: ClassVar[list[BindingType]] = [Binding("v", "app.review", "View", show=False)]

    def parts(self) -> Iterator[Widget]:
        """Yield the outcome."""
        yield Lines(self._rows, "debrief")

    def _rows(self, frame: Frame, width: int) -> list[Row]:
        director = self.flight.director
        if director is None:
            return [_line("mission", "none: nothing to be judged by"), *_kept(frame)]
        if director.stage is Stage.WAITING:
            return [_line("mission", f"{director.mission.name}: not flown yet"), *_kept(frame)]
        return [*_result(director), [], *_score(director, width), *_figures(director), [], *_kept(frame)]


def _line(name: str, value: str, tone: Tone = Tone.STRONG) -> Row:
    return [(f"{name:<{_NAME}} ", Tone.MUTED), (value, tone)]


def _result(director: Director) -> Iterator[Row]:
    yield _line("mission", f"{director.mission.name}: {director.mission.title}")
    if not director.mission.judged:
        yield _line("result", director.stage.value)
        return
    missing = director.shortcomings()
    if not missing:
        yield _line("result", "✓ completed", Tone.OK)
    for index, words in enumerate(missing):
        yield _line("" if index else "result", f"▲ {words}", Tone.WARN)


def _score(director: Director, width: int) -> Iterator[Row]:
    score = score_of(director.mission, director.figures)
    if score is None:
        return
    yield _line("score", f"{score.points:.0f} of 100")
    for part in score.parts:
        yield [
            (f"  {part.name:<{_NAME - 2}} ", Tone.TEXT),
            *gauge(part.share, 1.0001, min(_BAR, width // 4), Tone.OK),
            (f" {100 * part.share:3.0f} %", Tone.STRONG),
            # All our characters take one cell; a combining sign takes none.
            (f"  {part.formula.replace(_ERROR, 'the error')}", Tone.MUTED),
        ]
    yield []


def _figures(director: Director) -> Iterator[Row]:
    figures = director.figures
    yield _line("time", quantity(figures.duration, "s", 1))
    yield _line("way flown", quantity(figures.path, "m", 1))
    yield _line("error", f"{quantity(figures.rms_error, 'm')} RMS while engaged")
    if director.mission.target is not None:
        yield _line("at the target", quantity(figures.final_error, "m"))
    yield _line("largest force", quantity(figures.max_force, "N", 1))
    if director.mission.obstacle:
        touched = f"{figures.collisions} collisions" if figures.collisions else "no collision"
        yield _line("clearance", f"{quantity(figures.least_clearance, 'm')} at least, {touched}")
    if figures.gates:
        yield _line("gates", f"{figures.gates - figures.gates_missed} of {figures.gates} flown through")


def _kept(frame: Frame) -> Iterator[Row]:
    servo = frame.snapshot.servo
    if servo is not None:
        yield _line(
            "servo",
            f"{servo.ticks} ticks, {servo.missed} lost, late {quantity(1000 * servo.run_p99, 'ms')} p99",
        )
    yield _line("recording", str(frame.run.recording), Tone.TEXT)
    yield _line("MAVLink log", str(frame.run.tlog), Tone.TEXT)
