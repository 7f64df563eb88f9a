"""Debrief: passed or not and why, the score part by part, and the moments that cost points, each to be looked at."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

from textual import on
from textual.binding import Binding, BindingType
from textual.containers import Container
from textual.widget import Widget

from groundstation.progress.skills import Advice
from groundstation.training.director import Director, Stage
from groundstation.training.score import NO_PAR, Part, Score, measure
from groundstation.training.story import Moment, clock, worth_telling
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.rows import Row, gauge, quantity
from groundstation.tui.screens.page import Page
from groundstation.tui.screens.workload import WorkloadForm
from groundstation.tui.theme import Tone

_NAME = 13
_BAR = 24
_MEASURE = 11
# From here on the formula stands beside each part.
_WIDE = 110
# Keys that move by more than a line scroll the outcome; the others choose a moment.
_PAGE = 10


class Debrief(Page):
    """The outcome above or on the left, the moments that cost points below or on the right."""

    NAME = "debrief"
    HORIZONTAL_BREAKPOINTS = [(0, "-stacked"), (160, "-beside")]  # noqa: RUF012 - Textual's
    OWN_KEYS: ClassVar = (
        ("Enter", "Look at it", "screen.look"),
        ("v", "Viewer", "app.review"),
        ("w", "How hard?", "screen.workload"),
        ("n", "Next", "app.next"),
    )
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("v", "app.review", "View", show=False),
        Binding("enter", "look", "Look at the moment in the viewer", show=False),
        Binding("w", "workload", "How hard was it?", show=False),
        Binding("n", "app.next", "Next exercise", show=False),
    ]

    def __init__(self) -> None:
        super().__init__()
        self._story: list[Moment] = []

    def parts(self) -> Iterator[Widget]:
        """Yield the outcome and the story."""
        with Container(id="debrief"):
            yield Lines(self._outcome, "debrief", id="outcome")
            yield Lines(self._moments, "points lost", chosen=True, id="lost")

    def action_move(self, by: int) -> None:
        """Choose another moment; by a page, scroll the outcome."""
        if abs(by) == _PAGE:
            self.query_one("#outcome", Lines).move(by // 2)
        else:
            super().action_move(by)

    @on(Lines.Chosen)
    def action_look(self) -> None:
        """Open the viewer at the moment that is chosen."""
        if self.lines is not None and self.lines.at < len(self._story):
            self.flight.review_at(self._story[self.lines.at].t)
        else:
            self.flight.action_review()

    def action_workload(self) -> None:
        """Ask how hard it was; whoever does not want to say leaves with Esc."""
        self.app.push_screen(WorkloadForm(), self.flight.take_workload)

    def _outcome(self, frame: Frame, width: int) -> list[Row]:
        director = self.flight.director
        if director is None:
            return [_line("mission", "none: nothing to be judged by"), *_kept(frame)]
        if director.stage is Stage.WAITING:
            return [_line("mission", f"{director.mission.name}: not flown yet"), *_kept(frame)]
        score = frame.judgement.score if director.stage is Stage.DONE and frame.judgement else frame.score
        rows = [*_result(frame, director), *_next(self.flight.advice)]
        rows += _score(frame, score, self.flight.best, width)
        return [*rows, [], *_figures(director), [], *_kept(frame)]

    def _moments(self, frame: Frame, width: int) -> list[Row]:
        del width
        director, judgement = self.flight.director, frame.judgement
        if director is None or not director.mission.judged:
            return [[("nothing is judged", Tone.MUTED)]]
        if judgement is None or director.stage is not Stage.DONE:
            return [[("after the landing: where points were lost", Tone.MUTED)]]
        self._story = worth_telling(judgement.story)
        rows = [_moment(moment, judgement.took_off_t) for moment in self._story]
        return rows or [[("none worth telling", Tone.OK)]]


def _line(name: str, value: str, tone: Tone = Tone.STRONG) -> Row:
    return [(f"{name:<{_NAME}} ", Tone.MUTED), (value, tone)]


def _result(frame: Frame, director: Director) -> Iterator[Row]:
    yield _line("mission", f"{director.mission.name}: {director.mission.title}")
    landed = director.stage is Stage.DONE
    if not director.mission.judged or not landed or frame.judgement is None:
        yield _line("result", director.stage.value)
        return
    missing = frame.judgement.shortcomings
    if not missing:
        yield _line("result", "✓ passed", Tone.OK)
    for index, words in enumerate(missing):
        yield _line("" if index else "result", f"▲ {words}", Tone.WARN)


def _next(advice: Advice | None) -> Iterator[Row]:
    if advice is not None:
        yield [*_line("next (n)", advice.mission, Tone.KEY), (f"  {advice.why}", Tone.TEXT)]


def _score(frame: Frame, score: Score | None, best: Score | None, width: int) -> Iterator[Row]:
    if score is None:
        return
    yield [*_line("score", f"{score.points:.1f} of 100"), *_against(score, best)]
    before = {part.name: part.points for part in best.parts} if best else {}
    for part in score.parts:
        yield _part(part, before.get(part.name, math.nan), width)
    yield _line("par", frame.run.par_from or NO_PAR, Tone.MUTED)
    if frame.run.guidance > 0.0:
        yield _line("guidance", f"{frame.run.guidance:.0%} of the force that leads to the way", Tone.MUTED)


def _against(score: Score, best: Score | None) -> Row:
    """Compare with the pilot's own best."""
    if best is None:
        return []
    gained = score.points - best.points
    if gained > 0.0:
        return [(f"  your best so far, by {gained:.1f}", Tone.OK)]
    return [(f"  your best is {best.points:.1f}", Tone.MUTED)]


def _part(part: Part, before: float, width: int) -> Row:
    tone = Tone.OK if part.share >= 0.5 else Tone.WARN
    par = f"par {measure(part.par, part.unit)}" if math.isfinite(part.par) else ""
    than = f"{part.points - before:+5.1f} " if math.isfinite(before) else ""
    row: Row = [
        (f"  {part.name:<{_NAME - 2}} ", Tone.TEXT),
        *gauge(part.share, 1.0, min(_BAR, width // 6), tone, full=Tone.OK),
        (f" {part.points:4.1f} of {part.weight:4.1f} ", Tone.STRONG),
        (than, Tone.MUTED),
        (f" {measure(part.value, part.unit):<{_MEASURE}} ", Tone.TEXT),
        (f"{par:<{_MEASURE + 4}} ", Tone.MUTED),
    ]
    return [*row, (part.formula, Tone.FAINT)] if width > _WIDE else row


def _moment(moment: Moment, took_off_t: float) -> Row:
    return [
        (f"{clock(moment.t - took_off_t):>6} ", Tone.MUTED),
        (f"{f'−{moment.lost:.1f}':>5} ", Tone.WARN),
        (f"{moment.part:<10} ", Tone.TEXT),
        (moment.words, Tone.STRONG),
    ]


def _figures(director: Director) -> Iterator[Row]:
    figures = director.figures
    yield _line("way flown", quantity(figures.path, "m", 1))
    yield _line("largest force", quantity(figures.max_force, "N", 1))
    if director.mission.obstacle:
        touched = f"{figures.collisions} collisions" if figures.collisions else "no collision"
        yield _line("clearance", f"{quantity(figures.least_clearance, 'm')} at least, {touched}")


def _kept(frame: Frame) -> Iterator[Row]:
    servo = frame.snapshot.servo
    if servo is not None:
        yield _line(
            "servo",
            f"{servo.ticks} ticks, {servo.missed} lost, late {quantity(1000 * servo.run_p99, 'ms')} p99",
        )
    yield _line("recording", str(frame.run.recording), Tone.TEXT)
    yield _line("MAVLink log", str(frame.run.tlog), Tone.TEXT)
