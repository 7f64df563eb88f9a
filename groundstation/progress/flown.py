"""A flight of a mission as a pilot's progress needs it."""

from __future__ import annotations

import datetime

from msgspec import Struct


class Flown(Struct, frozen=True):
    """A flight that landed. Pilot, start and attempt together say which one it was, in the log as in the store.

    Attributes:
        pilot: Who flew.
        mission: Its name.
        digest: Of the mission as it was then.
        started: When the program's run was started, ISO 8601.
        attempt: Which flight of that run, from 1.
        seed: Of all that was random.
        simulated: The vehicle was.
        device: The haptic device, as `driver:address`.
        duration_s: From take-off to landing, s.
        passed: None where the mission asks for nothing.
        points: 0 to 100; None likewise.
        parts: Share of each part of the score, 0 to 1.
        measures: What was measured; what does not exist is left out.
        recording: The file's name.
        program: The version that judged it.
        instructed: An instructor let something happen: it is practice, and neither passes nor fails the mission.
        number: In the store; 0 outside.
    """

    pilot: str
    mission: str
    digest: str
    started: str
    attempt: int = 1
    seed: int = 0
    simulated: bool = True
    device: str = ""
    duration_s: float = 0.0
    passed: bool | None = None
    points: float | None = None
    parts: dict[str, float] = {}
    measures: dict[str, float] = {}
    recording: str = ""
    program: str = ""
    instructed: bool = False
    number: int = 0

    @property
    def day(self) -> datetime.date:
        """When it was flown, by the pilot's own calendar."""
        return datetime.datetime.fromisoformat(self.started).date()

    @property
    def collisions(self) -> int:
        """Contacts with obstacles."""
        return round(self.measures.get("collisions", 0.0))
