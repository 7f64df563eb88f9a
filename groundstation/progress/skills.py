"""From what a pilot flew to what they can do, what is open to them, and what they should fly next. Pure.

A skill's level is a weighted mean of the points of the flights that trained it, in which each further flight has
`WEIGHT` and all before it the rest: it follows how a pilot flies now, and one bad day does not undo a month.
"""

from __future__ import annotations

import datetime
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from groundstation.progress.flown import Flown
from groundstation.progress.schedule import Repetition, repetition_of
from groundstation.training.mission import Mission

WEIGHT = 0.4
# A flight that was not passed counts so much of its points.
NOT_PASSED = 0.5
# Failed so often in a row a mission is left for a while: something before it is missing.
STUCK = 3


class Record(NamedTuple):
    """What a pilot has done with a mission.

    Attributes:
        mission: The mission.
        points: Of each flight with a score, oldest first.
        flights: How many there were.
        instructed: In how many of them an instructor let something happen: they are practice, and count no further.
        passed: The day it was passed first; None before.
        failed: How often in a row it was not passed, the last times.
        missing: Missions it needs that were not passed yet; it is open where there are none, or it was passed.
        repetition: When it is due again; None before it was passed.
    """

    mission: Mission
    points: tuple[float, ...] = ()
    flights: int = 0
    instructed: int = 0
    passed: datetime.date | None = None
    failed: int = 0
    missing: tuple[str, ...] = ()
    repetition: Repetition | None = None

    @property
    def open(self) -> bool:
        """All that it needs was passed, or it was itself."""
        return self.passed is not None or not self.missing

    @property
    def best(self) -> float | None:
        """The most points; None without a score."""
        return max(self.points, default=None)

    def due(self, today: datetime.date) -> bool:
        """Say whether it is to be repeated."""
        return self.repetition is not None and self.repetition.due <= today

    def repeated(self, last: Flown, today: datetime.date) -> bool:
        """Say whether its last flight was of today, and a repetition."""
        return last.day == today and self.passed is not None and self.passed < today


class Advice(NamedTuple):
    """What to fly next, and why, in words."""

    mission: str
    why: str


class Standing(NamedTuple):
    """How a pilot stands.

    Attributes:
        records: By mission's name, in the order of the curriculum.
        levels: By skill, 0 to 100; skills never trained are not among them.
        next: None where there is no mission that asks for anything.
    """

    records: Mapping[str, Record]
    levels: Mapping[str, float]
    next: Advice | None

    @property
    def weakest(self) -> str | None:
        """The skill with the lowest level; None before anything was flown."""
        return min(self.levels, key=lambda skill: self.levels[skill], default=None)

    @property
    def passed(self) -> int:
        """How many missions were passed."""
        return sum(record.passed is not None for record in self.records.values())


def standing_of(curriculum: Sequence[Mission], flights: Sequence[Flown], today: datetime.date) -> Standing:
    """Return how a pilot stands.

    Args:
        curriculum: In the order in which it is learned; what asks for nothing plays no part.
        flights: One pilot's, oldest first; of other missions, too.
        today: What is due depends on it.
    """
    missions = {mission.name: mission for mission in curriculum if mission.judged}
    practised = Counter(each.mission for each in flights if each.instructed)
    flights = [each for each in flights if not each.instructed]
    flown = {name: [each for each in flights if each.mission == name] for name in missions}
    passed = {name for name, theirs in flown.items() if any(each.passed for each in theirs)}
    records = {
        name: _record(mission, flown[name], passed, missions, practised[name])
        for name, mission in missions.items()
    }
    levels = levels_of(missions, flights)
    last = next((each for each in reversed(flights) if each.mission in missions), None)
    return Standing(records, levels, _advice(records, levels, last, today))


def levels_of(missions: Mapping[str, Mission], flights: Sequence[Flown]) -> dict[str, float]:
    """Return the level of each skill that was trained, 0 to 100.

    Args:
        missions: By name.
        flights: Oldest first.
    """
    levels: dict[str, float] = {}
    for each in flights:
        mission = missions.get(each.mission)
        if mission is None or each.points is None or each.instructed:
            continue
        worth = each.points if each.passed else NOT_PASSED * each.points
        for skill in mission.skills:
            before = levels.get(skill, worth)
            levels[skill] = before + WEIGHT * (worth - before)
    return levels


def _record(
    mission: Mission,
    theirs: Sequence[Flown],
    passed: set[str],
    missions: Mapping[str, Mission],
    practised: int,
) -> Record:
    failed = 0
    for each in reversed(theirs):
        if each.passed:
            break
        failed += 1
    return Record(
        mission,
        points=tuple(each.points for each in theirs if each.points is not None),
        flights=len(theirs) + practised,
        instructed=practised,
        passed=next((each.day for each in theirs if each.passed), None),
        failed=failed,
        missing=tuple(name for name in mission.needs if name in missions and name not in passed),
        repetition=repetition_of(theirs),
    )


def _advice(
    records: Mapping[str, Record], levels: Mapping[str, float], last: Flown | None, today: datetime.date
) -> Advice | None:
    """Return what to fly next: what is under way, what is due, what is new, what was too hard, what is weakest."""
    learning = [record for record in records.values() if record.passed is None and record.open]
    hard = [record for record in learning if record.failed >= STUCK]
    new = [record for record in learning if record not in hard]
    latest = records[last.mission] if last else None
    if latest and latest in new:
        return Advice(latest.mission.name, "not passed yet: fly it again")
    due = _weakest([record for record in records.values() if record.due(today)], levels)
    if due and not (new and latest and last and latest.repeated(last, today)):
        return Advice(due.mission.name, _why_due(due, levels, today))
    if new:
        return Advice(new[0].mission.name, _why_new(new[0], last))
    if hard:
        return _advice_on_hard(hard[0], records, latest)
    passed = [record for record in records.values() if record.passed is not None]
    weakest = _weakest([record for record in passed if record is not latest] or passed, levels)
    return Advice(weakest.mission.name, f"nothing is due{_keeps(weakest, levels)}") if weakest else None


def _advice_on_hard(hard: Record, records: Mapping[str, Record], latest: Record | None) -> Advice:
    """Return a mission that the hard one builds on where it was the last that was flown, else the hard one."""
    name = hard.mission.name
    before = [records[need] for need in hard.mission.needs if need in records]
    if latest is hard and before:
        easiest = min(before, key=lambda record: record.best or 0.0)
        return Advice(easiest.mission.name, f"{name} failed {hard.failed} times, and builds on it")
    return Advice(name, f"failed {hard.failed} times: take it slowly, part by part")


def _weakest(records: Sequence[Record], levels: Mapping[str, float]) -> Record | None:
    """Return the mission that trains the weakest skill; among equals the one flown worst."""
    return min(records, key=lambda record: (_level(record, levels), record.best or 0.0), default=None)


def _why_due(record: Record, levels: Mapping[str, float], today: datetime.date) -> str:
    days = (today - record.repetition.due).days if record.repetition else 0
    since = f"due for {days} day{'s' if days > 1 else ''}" if days else "due today"
    return f"{since}{_keeps(record, levels)}"


def _keeps(record: Record, levels: Mapping[str, float]) -> str:
    trained = [skill for skill in record.mission.skills if skill in levels]
    weakest = min(trained, key=lambda skill: levels[skill], default="")
    return f"; your weakest in it is {weakest}, {levels[weakest]:.0f} of 100" if weakest else ""


def _why_new(record: Record, last: Flown | None) -> str:
    if last is None:
        return "the first of all"
    needs = record.mission.needs
    return f"new; {' and '.join(needs)} passed" if needs else "new"


def _level(record: Record, levels: Mapping[str, float]) -> float:
    """Return the level of the weakest skill a mission trains."""
    return min((levels[skill] for skill in record.mission.skills if skill in levels), default=100.0)
