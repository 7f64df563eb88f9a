"""The missions of a folder in the order in which they are learned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from groundstation.training.mission import MISSIONS_FOLDER, SUFFIX, Mission, load_mission


class Lesson(NamedTuple):
    """A mission and the file it is in."""

    path: Path
    mission: Mission


def lessons(folder: Path = MISSIONS_FOLDER) -> list[Lesson]:
    """Return a folder's missions in their order: by level, then what others need first; free flights come last.

    Raises:
        MissionError: One of them is wrong.
    """
    found = [Lesson(path, load_mission(path)) for path in sorted(folder.glob(f"*{SUFFIX}"))]
    needs = {lesson.mission.name: lesson.mission.needs for lesson in found}

    def place(lesson: Lesson) -> tuple[bool, int, int, str]:
        mission = lesson.mission
        return not mission.judged, mission.level, depth(mission.name, needs), mission.name

    return sorted(found, key=place)


def depth(name: str, needs: Mapping[str, Sequence[str]], above: tuple[str, ...] = ()) -> int:
    """Return how many missions lie one behind the other before this one; what leads in a circle counts once."""
    before = (other for other in needs.get(name, ()) if other in needs and other not in (*above, name))
    return max((1 + depth(other, needs, (*above, name)) for other in before), default=0)


def circle(name: str, needs: Mapping[str, Sequence[str]]) -> bool:
    """Say whether a mission needs itself, by way of others."""
    seen: set[str] = set()
    waiting = list(needs.get(name, ()))
    while waiting:
        other = waiting.pop()
        if other == name:
            return True
        if other not in seen:
            seen.add(other)
            waiting += needs.get(other, ())
    return False
