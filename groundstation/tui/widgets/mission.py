"""How the mission is going: what it asks for, how far it is, its clock, and the score so far with its parts."""

from __future__ import annotations

import math

from groundstation.messages import MissionProgress
from groundstation.training.director import Figures
from groundstation.training.mission import Mission as MissionFile
from groundstation.training.score import score_of
from groundstation.tui.frame import Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import UNKNOWN, Row, clock, gauge, quantity, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_LABEL = 13
# What is only known once the target has been held.
_AT_THE_END = frozenset({"precision", "time"})


class Mission(Instrument):
    """A row a thing, the most important first."""

    BORDER_TITLE = "mission"
    EVERY = 10
    STALE_S = 2.0

    def data_age(self, frame: Frame) -> float:
        """Age of the progress; without a mission there is none to be old."""
        return 0.0 if frame.run.mission is None else frame.age(frame.snapshot.progress)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw as many rows as there is room for."""
        mission = frame.run.mission
        if mission is None:
            return [[(" free flight: nothing is asked for", Tone.MUTED)]]
        rows = [_row("mission", (mission.title[: max(width - _LABEL - 2, 0)], Tone.TEXT))]
        rows += _progress(frame, mission, width)
        return [*rows, *_score(frame, mission, width)][:height]


def _row(label: str, *parts: tuple[str, Tone]) -> Row:
    return [(f" {label:<{_LABEL - 1}}", Tone.MUTED), *parts]


def _progress(frame: Frame, mission: MissionFile, width: int) -> list[Row]:
    progress, figures = frame.snapshot.progress, frame.figures
    if progress is None:
        return [_row("stage", (UNKNOWN, Tone.MUTED))]
    away = progress.target_distance
    target = f", target {quantity(away, 'm', 1)} away" if math.isfinite(away) else ""
    rows = [_row("stage", (words(progress.stage) + target, Tone.STRONG))]
    if progress.legs:
        done = min(progress.leg, progress.legs)
        rows.append(
            _measured("way", (done / progress.legs, f"{done} of {progress.legs} points"), width, Tone.TARGET)
        )
    if figures is not None:
        rows.append(_clock(figures.duration, mission.criteria.time_limit_s))
    return [*rows, _obstacles(progress, figures)]


def _clock(duration: float, limit: float) -> Row:
    late = duration > limit
    spent = (f"{'▲ ' if late else ''}{clock(duration)}", Tone.WARN if late else Tone.STRONG)
    return _row("clock", spent, (f" of {clock(limit)} min", Tone.MUTED))


def _obstacles(progress: MissionProgress, figures: Figures | None) -> Row:
    touched, tone = "no collision", Tone.TEXT
    if progress.collisions:
        touched, tone = (
            f"▲ {progress.collisions} collision{'s' if progress.collisions > 1 else ''}",
            Tone.WARN,
        )
    near = f", {quantity(progress.clearance, 'm', 1)} clear" if math.isfinite(progress.clearance) else ""
    flown = (
        f", {figures.gates - figures.gates_missed} of {figures.gates} gates"
        if figures and figures.gates
        else ""
    )
    return _row("obstacles", (touched, tone), (near + flown, Tone.TEXT))


def _measured(label: str, reached: tuple[float, str], width: int, tone: Tone) -> Row:
    """Return a row with a bar of a share, 0 to 1, and its figure."""
    share, figure = reached
    head = _row(label)
    strip = gauge(share, 1.0, width - width_of(head) - len(figure) - 2, tone)
    # More is better here: a full bar is no warning.
    return [
        *head,
        *((text, tone if of is Tone.WARN else of) for text, of in strip),
        (f" {figure}", Tone.STRONG),
    ]


def _score(frame: Frame, mission: MissionFile, width: int) -> list[Row]:
    """Return the score so far, and how much of each of its parts is reached."""
    figures = frame.figures
    score = score_of(mission, figures) if figures is not None else None
    if score is None or figures is None:
        return []
    held = not math.isnan(figures.final_error)
    rows = [_row("score", (f"{score.points:.0f}", Tone.STRONG), (" of 100 points so far", Tone.MUTED))]
    for part in score.parts:
        if part.name in _AT_THE_END and not held:
            rows.append(_row(f"  {part.name}", ("comes when the target is held", Tone.FAINT)))
        else:
            rows.append(
                _measured(f"  {part.name}", (part.share, f"{100.0 * part.share:3.0f} %"), width, Tone.OK)
            )
    return rows
