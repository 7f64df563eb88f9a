"""What the school knows of its pilots, for the screens: read when it is asked, and never a reason to stop."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from groundstation.errors import InputError
from groundstation.progress.flown import Flown
from groundstation.progress.opening import store_in
from groundstation.progress.skills import Standing, standing_of
from groundstation.progress.store import Store
from groundstation.training.briefing import briefing, par_words
from groundstation.training.curriculum import Lesson, lessons
from groundstation.training.measures import Measures
from groundstation.training.mission import Mission
from groundstation.training.reference import digest_of
from groundstation.training.score import Score, score_of


class Report(NamedTuple):
    """A pilot as the school knows them.

    Attributes:
        pilot: Who; "" for nobody named.
        standing: How they stand.
        flights: What they flew, oldest first.
        today: The day that was asked.
        words: What was wrong with the store, or "".
    """

    pilot: str
    standing: Standing
    flights: Sequence[Flown]
    today: datetime.date
    words: str = ""


class Desk:
    """Where one asks.

    Args:
        folder: Of the recordings, where the store is.
        course: The missions; those that come with the program where none are given.
        today: Tells the day.
    """

    def __init__(
        self,
        folder: Path,
        course: Sequence[Lesson] | None = None,
        today: Callable[[], datetime.date] = lambda: datetime.datetime.now().astimezone().date(),
    ) -> None:
        self._path = store_in(folder)
        self._course = {
            lesson.mission.name: lesson
            for lesson in (lessons() if course is None else course)
            if lesson.mission.judged
        }
        self._today = today

    def pilots(self) -> list[str]:
        """Return who has flown here; nobody where that cannot be read."""
        if not self._path.exists():
            return []
        try:
            with Store(self._path) as store:
                return store.pilots()
        except InputError:
            return []

    def report(self, pilot: str) -> Report:
        """Return how a pilot stands; one who cannot be looked up stands at the beginning."""
        flights, words = self._flights(pilot)
        today = self._today()
        standing = standing_of([lesson.mission for lesson in self._course.values()], flights, today)
        return Report(pilot, standing, flights, today, words)

    def briefing(self, name: str, width: int) -> list[str]:
        """Return all that a trainee needs to know of a mission, in lines."""
        path, mission = self._course[name]
        return briefing(mission, par_words(mission, path), width)

    def best(self, pilot: str, mission: Mission, par: Measures | None) -> Score | None:
        """Return the score of a pilot's best flight of a mission as it is, against a par; None without one."""
        flights, _ = self._flights(pilot)
        same = [each for each in flights if (each.mission, each.digest) == (mission.name, digest_of(mission))]
        scores = [
            score_of(mission, measures_of(each), par) for each in same if each.passed and not each.instructed
        ]
        return max((score for score in scores if score), key=lambda score: score.points, default=None)

    def _flights(self, pilot: str) -> tuple[list[Flown], str]:
        if not pilot or not self._path.exists():
            return [], ""
        try:
            with Store(self._path) as store:
                return store.flights(pilot), store.words
        except InputError as error:
            return [], str(error)


def measures_of(flown: Flown) -> Measures:
    """Return what a flight was measured by; what is not known any more is left out."""
    known = {name: value for name, value in flown.measures.items() if name in Measures.__struct_fields__}
    collisions = round(known.pop("collisions", 0.0))
    return Measures(**known, collisions=collisions)
