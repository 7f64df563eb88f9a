"""A flight's story: the moments in which it lost its points, each with its time, its place and what it cost.

What all moments cost adds up to what the score lacks: nothing is lost that is not told.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple, TypeVar

import numpy as np

from groundstation.frames import Vector3
from groundstation.training.measurer import Measurer
from groundstation.training.rows import HandRow, VehicleRow
from groundstation.training.score import UNFINISHED, Part, Score
from groundstation.training.smoothness import RATE_HZ, evenly, parted

# A guard that changes less than this lets pass what the hand asks for, m/s.
_GUARDING_MPS = 0.05
# The speed is looked at through a window this long, so that it is motion and not noise, s.
_WINDOW_S = 0.4

# What cost less is not worth a line, points.
_LEAST = 0.5

Row = TypeVar("Row", VehicleRow, HandRow)


class Moment(NamedTuple):
    """When and where points were lost.

    Attributes:
        part: Of the score; "unfinished" for what was not flown.
        t, until: From when to when, s on the clock of the flight.
        lost: Points.
        words: What happened.
        place: Where the vehicle was, world, m.
    """

    part: str
    t: float
    until: float
    lost: float
    words: str
    place: Vector3


class Stretch(NamedTuple):
    """A time and what was the worst of it."""

    t: float
    until: float
    worst: float


def story_of(measurer: Measurer, score: Score) -> tuple[Moment, ...]:
    """Return where a flight lost points, what cost most first.

    Args:
        measurer: Has seen the flight.
        score: What the flight was worth.
    """
    moments = [moment for part in score.parts for moment in _moments(part, measurer)]
    unflown = math.fsum(part.weight * (part.quality - part.share) for part in score.parts)
    if unflown > 0.0:
        words = f"{score.reached:.0%} of the mission's points were reached"
        moments.append(_at_the_end(measurer, UNFINISHED, unflown, words))
    return tuple(sorted(moments, key=lambda moment: (-moment.lost, moment.t)))


def worth_telling(story: Sequence[Moment]) -> list[Moment]:
    """Return those moments of a story that cost enough to be told."""
    return [moment for moment in story if moment.lost >= _LEAST]


def clock(seconds: float) -> str:
    """Return a time since take-off, as in 1:07.3; "–" where it is not known."""
    if not math.isfinite(seconds):
        return "–"
    minutes, rest = divmod(round(10.0 * max(seconds, 0.0)), 600)
    return f"{minutes}:{rest / 10.0:04.1f}"


def _moments(part: Part, measurer: Measurer) -> Iterator[Moment]:
    """Yield what the quality of one part cost."""
    lost = part.weight * (1.0 - part.quality)
    if lost <= 0.0:
        return
    found = list(_TELLERS[part.name](part, measurer))
    if not found:
        yield _at_the_end(measurer, part.name, lost, _NOTHING.get(part.name, "the hand was never coupled"))
    for stretch, words in found:
        place = _place(measurer, stretch.t)
        yield Moment(part.name, stretch.t, stretch.until, lost / len(found), words, place)


Told = Iterator[tuple[Stretch, str]]
_NOTHING = {
    "precision": "the target was not held",
    "landing": "it did not land",
    "clearance": "the nearest was not seen",
}


def _time(part: Part, measurer: Measurer) -> Told:
    t = measurer.took_off_t + part.good
    over = part.value - part.good
    yield Stretch(t, measurer.end_t, over), f"{over:.1f} s longer than {part.good:.1f} s"


def _following(part: Part, measurer: Measurer) -> Told:
    del part
    for worst in _worst(measurer.hand_rows, lambda row: row.error):
        leash = any(row.on_leash for row in measurer.hand_rows if worst.t <= row.t <= worst.until)
        words = f"the drone was {worst.worst:.2f} m behind the hand"
        yield worst, f"{words}, on the leash" if leash else words


def _path(part: Part, measurer: Measurer) -> Told:
    del part
    for worst in _worst(measurer.vehicle_rows, lambda row: row.off_the_way):
        yield worst, f"{worst.worst:.2f} m off the way"


def _precision(part: Part, measurer: Measurer) -> Told:
    if not math.isnan(part.value):
        yield (
            Stretch(measurer.held_t, measurer.held_t, part.value),
            f"held {part.value:.2f} m from the target",
        )


def _landing(part: Part, measurer: Measurer) -> Told:
    if not math.isnan(part.value):
        words = f"landed {part.value:.2f} m from the middle of the pad"
        yield Stretch(measurer.end_t, measurer.end_t, part.value), words


def _clearance(part: Part, measurer: Measurer) -> Told:
    del part
    for t, name in measurer.collisions:
        yield Stretch(t, t, 0.0), f"touched {name!r}"
    if not measurer.collisions:
        for worst in _worst(measurer.vehicle_rows, lambda row: -row.clearance, share=None):
            name = measurer.nearest(_place(measurer, worst.t))
            yield worst, f"{-worst.worst:.2f} m from {name!r}"


def _gates(part: Part, measurer: Measurer) -> Told:
    del part
    rows = measurer.vehicle_rows
    for gate in measurer.director.missed:
        words = f"gate {gate.name!r} was not flown through"
        passed = min(rows, key=lambda row: math.dist(row.position, gate.center), default=None)
        t = passed.t if passed else measurer.end_t
        yield Stretch(t, t, 0.0), words


def _smoothness(part: Part, measurer: Measurer) -> Told:
    del part
    jerkiest: Stretch | None = None
    for stretch in parted([(row.t, row.speed) for row in measurer.vehicle_rows], _WINDOW_S):
        speed = evenly(*zip(*stretch, strict=True))
        window = round(_WINDOW_S * RATE_HZ)
        if len(speed) < 2 * window:
            continue
        calm = np.convolve(speed, np.full(window, 1.0 / window), mode="valid")
        jerk = np.abs(np.diff(calm, 2)) * RATE_HZ**2
        at, most = int(np.argmax(jerk)), float(np.max(jerk))
        if jerkiest is None or most > jerkiest.worst:
            t = stretch[0][0] + (at + 1) / RATE_HZ
            jerkiest = Stretch(t, t + _WINDOW_S, most)
    if jerkiest:
        yield jerkiest, f"the jerkiest moment, {jerkiest.worst:.1f} m/s³"


def _agreement(part: Part, measurer: Measurer) -> Told:
    del part
    longest: Stretch | None = None
    for guarding, group in groupby(measurer.hand_rows, lambda row: row.disagreement > _GUARDING_MPS):
        rows = list(group)
        found = Stretch(rows[0].t, rows[-1].t, max(row.disagreement for row in rows))
        if guarding and (longest is None or found.until - found.t > longest.until - longest.t):
            longest = found
    if longest:
        lasted = longest.until - longest.t
        yield longest, f"the guard held back for {lasted:.1f} s, by up to {longest.worst:.2f} m/s"


def _effort(part: Part, measurer: Measurer) -> Told:
    del part
    for worst in _worst(measurer.hand_rows, lambda row: row.force):
        yield worst, f"the hand held against {worst.worst:.1f} N"


_TELLERS: dict[str, Callable[[Part, Measurer], Told]] = {
    "time": _time,
    "following": _following,
    "path": _path,
    "precision": _precision,
    "landing": _landing,
    "clearance": _clearance,
    "gates": _gates,
    "smoothness": _smoothness,
    "agreement": _agreement,
    "effort": _effort,
}


def _worst(
    rows: Sequence[Row], value: Callable[[Row], float], share: float | None = 0.7
) -> Iterator[Stretch]:
    """Yield the time in which a value was at its largest: all around it above `share` of it; None: its moment."""
    known = [(row.t, value(row)) for row in rows if not math.isnan(value(row))]
    if not known:
        return
    peak = max(range(len(known)), key=lambda place: known[place][1])
    first = last = peak
    t, worst = known[peak]
    if share is not None:
        while first > 0 and known[first - 1][1] >= share * worst:
            first -= 1
        while last < len(known) - 1 and known[last + 1][1] >= share * worst:
            last += 1
        t = known[first][0]
    yield Stretch(t, known[last][0], worst)


def _place(measurer: Measurer, t: float) -> Vector3:
    """Return where the vehicle was then, as far as it is known."""
    rows = measurer.vehicle_rows
    if not rows or t >= measurer.end_t:
        return measurer.place
    return min(rows, key=lambda row: abs(row.t - t)).position


def _at_the_end(measurer: Measurer, part: str, lost: float, words: str) -> Moment:
    return Moment(part, measurer.end_t, measurer.end_t, lost, words, measurer.place)
