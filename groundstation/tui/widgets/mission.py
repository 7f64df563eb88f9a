"""How the mission is going: what it asks for next, how far it is, its clock, and the score so far with its parts."""

from __future__ import annotations

import math

from groundstation.training.guide import Guide, Way
from groundstation.training.mission import Mission as MissionFile
from groundstation.tui.directions import title, way_of, whereabouts
from groundstation.tui.frame import Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import UNKNOWN, Row, clock, gauge, quantity, shortened, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_LABEL = 12
# What is only known later on.
_AT_THE_END = {"precision": "comes when the target is held", "landing": "comes with the landing"}


class Mission(Instrument):
    """A row a thing, the most important first."""

    BORDER_TITLE = "mission"
    EVERY = 10
    STALE_S = 2.0

    def data_age(self, frame: Frame) -> float:
        """Age of the progress; without a mission there is none to be old."""
        return math.nan if frame.run.mission is None else frame.age(frame.snapshot.progress)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw as many rows as there is room for."""
        mission = frame.run.mission
        if mission is None:
            return [[(" free flight: nothing is asked for", Tone.MUTED)]]
        rows = [_row("mission", (shortened(mission.title, width - _LABEL - 2), Tone.TEXT))]
        rows += _next(frame, width)
        rows += _progress(frame, mission, width)
        return [*rows, *_score(frame, width)][:height]


def _row(label: str, *parts: tuple[str, Tone]) -> Row:
    return [(f" {label:<{_LABEL - 1}}", Tone.MUTED), *parts]


def _next(frame: Frame, width: int) -> list[Row]:
    """Return what is to be reached next, where it is, and while it is stayed at how long has been."""
    guide, way = frame.guide, way_of(frame)
    if guide is None or way is None:
        return []
    rows = [
        _row("next", (shortened(title(guide), width - _LABEL - 2), Tone.TARGET)),
        _row("", (shortened(_where(guide, way), width - _LABEL - 2), Tone.STRONG)),
    ]
    if guide.held_s > 0.0 and guide.hold_s:
        head, figure = _row("stay"), f" {guide.held_s:.1f} of {guide.hold_s:g} s"
        room = width - width_of(head) - len(figure) - 1
        rows.append([*head, *gauge(guide.held_s, guide.hold_s, room, Tone.OK, Tone.OK), (figure, Tone.TEXT)])
    return rows


def _where(guide: Guide, way: Way) -> str:
    return f"{whereabouts(guide, way)}{f', then stay {guide.hold_s:g} s' if guide.hold_s else ''}"


def _progress(frame: Frame, mission: MissionFile, width: int) -> list[Row]:
    progress, figures = frame.snapshot.progress, frame.figures
    if progress is None:
        return [_row("stage", (UNKNOWN, Tone.MUTED))]
    stage = words(progress.stage)
    rows: list[Row] = []
    if progress.legs:
        done = min(progress.leg, progress.legs)
        figure = f" {done} of {progress.legs} points"
        head = _row("way")
        strip = gauge(done, progress.legs, width - width_of(head) - len(figure) - 1, Tone.TARGET)
        rows.append(
            [
                *head,
                *((text, Tone.TARGET if tone is Tone.WARN else tone) for text, tone in strip),
                (figure, Tone.TEXT),
            ]
        )
    target = (
        f", target {quantity(progress.target_distance, 'm', 1)} away"
        if math.isfinite(progress.target_distance)
        else ""
    )
    rows.insert(0, _row("stage", (f"{stage}{target}", Tone.STRONG)))
    if figures is not None:
        limit = mission.criteria.time_limit_s
        late = figures.duration > limit
        tone = Tone.WARN if late else Tone.STRONG
        rows.append(
            _row(
                "clock",
                (f"{'▲ ' if late else ''}{clock(figures.duration)}", tone),
                (f" of {clock(limit)} min", Tone.MUTED),
            )
        )
    touched = (
        (f"▲ {progress.collisions} collisions", Tone.WARN)
        if progress.collisions
        else ("no collision", Tone.TEXT)
    )
    gates = (
        [(f", {figures.gates - figures.gates_missed} of {figures.gates} gates", Tone.TEXT)]
        if figures and figures.gates
        else []
    )
    near = (f", {quantity(progress.clearance, 'm', 1)} clear", Tone.TEXT)
    return [*rows, _row("obstacles", touched, *([near] if math.isfinite(progress.clearance) else []), *gates)]


def _score(frame: Frame, width: int) -> list[Row]:
    """Return the score so far, and how much of each of its parts is reached."""
    score = frame.score
    if score is None:
        return []
    rows = [_row("score", (f"{score.points:.0f}", Tone.STRONG), (" of 100 points so far", Tone.MUTED))]
    for part in score.parts:
        head: Row = [(f"   {part.name:<{_LABEL - 1}}", Tone.MUTED)]
        if part.name in _AT_THE_END and math.isnan(part.value):
            rows.append([*head, (_AT_THE_END[part.name], Tone.FAINT)])
            continue
        figure = f" {100.0 * part.share:3.0f} %"
        strip = gauge(part.share, 1.0, width - width_of(head) - len(figure) - 1, Tone.OK)
        rows.append(
            [
                *head,
                *((text, Tone.OK if tone is Tone.WARN else tone) for text, tone in strip),
                (figure, Tone.STRONG),
            ]
        )
    return rows
