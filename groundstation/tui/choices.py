"""What the operator can choose at any time: how the handle leads, and what it feels. A table like that of the acts.

Each key goes on from what is in effect, as the pilot says it: rate becomes position, a cue that is on goes off.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from groundstation.console import Snapshot
from groundstation.messages import CommandKind, Cue, PilotState, Preset
from groundstation.tui.acts import pilot_silent, with_shift

# Within this a command has reached the pilot and what it changed is in the pilot's state, s.
_OBEYED_S = 0.1
_FIELDS = {
    CommandKind.MAPPING: "mapping",
    CommandKind.FINE: "fine",
    CommandKind.CLUTCH: "clutched",
    CommandKind.PRESET: "preset",
    CommandKind.CUES: "cues",
}


@dataclass(frozen=True, slots=True)
class Choice:
    """One choice of the operator.

    Attributes:
        name: In actions and tests.
        kind: The command it sends.
        key: The key that makes it.
        label: As palette and help name it.
        explains: One sentence for palette and help.
        after: Gives from the value in effect the one to ask for.
    """

    name: str
    kind: CommandKind
    key: str
    label: str
    explains: str
    after: Callable[[int], int]

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that make it."""
        return with_shift(self.key)

    def hindrance(self, snapshot: Snapshot) -> str:
        """Say from a snapshot why it cannot be made now, or "" where it can."""
        return pilot_silent(snapshot)


def in_effect(kind: CommandKind, pilot: PilotState) -> int:
    """Return the value of a kind of choice that the pilot flies with."""
    return int(getattr(pilot, _FIELDS[kind]))


class Wishes:
    """What has been asked for and may not be in the pilot's state yet: a second key at once builds on the first."""

    def __init__(self) -> None:
        self._sent: dict[CommandKind, tuple[int, float]] = {}

    def sent(self, kind: CommandKind, value: int, t: float) -> None:
        """Remember a command that was sent at time `t`."""
        self._sent[kind] = (value, t)

    def present(self, kind: CommandKind, pilot: PilotState) -> int:
        """Return the value to go on from: the one just asked for, else the one in effect."""
        value, t = self._sent.get(kind, (0, -math.inf))
        return value if pilot.t < t + _OBEYED_S else in_effect(kind, pilot)


def _other(value: int) -> int:
    return int(not value)


def _next_preset(value: int) -> int:
    """Go round the presets that have a guard: one that has none is asked for by name, never passed through."""
    return (value + 1) % len(Preset) or Preset.ASSISTED


def _cue(cue: Cue, key: str, explains: str) -> Choice:
    name = str(cue.name).lower()
    return Choice(
        name, CommandKind.CUES, key, f"{name.capitalize()} cue on/off", explains, lambda on: on ^ cue
    )


_K = CommandKind
CUES: dict[Cue, Choice] = {
    Cue.POSITION: _cue(Cue.POSITION, "1", "Pull to where the vehicle is."),
    Cue.ENVIRONMENT: _cue(Cue.ENVIRONMENT, "2", "Push away from what is near."),
    Cue.MISMATCH: _cue(Cue.MISMATCH, "3", "Force where it does not fly as told."),
    Cue.GUARD: _cue(Cue.GUARD, "4", "Force where the guard changes the command."),
    Cue.DAMPING: _cue(Cue.DAMPING, "5", "Resistance to the handle's motion."),
    Cue.GUIDANCE: _cue(Cue.GUIDANCE, "6", "Pull to the mission's way, while you learn."),
}
CHOICES = (
    Choice("mapping", _K.MAPPING, "m", "Mapping", "Rate or position.", _other),
    Choice("fine", _K.FINE, "f", "Fine", "Finer moves, or coarse again.", _other),
    Choice("clutch", _K.CLUTCH, "c", "Clutch", "The handle moves nothing, or takes hold again.", _other),
    Choice(
        "preset", _K.PRESET, "p", "Next preset", "Which cues and helps; paper by name only.", _next_preset
    ),
    *CUES.values(),
)
CHOICES_BY_NAME = {choice.name: choice for choice in CHOICES}
PRESETS_EXPLAINED = {
    Preset.PAPER: "Equations (4) and (5) alone: no guard, no compensation.",
    Preset.ASSISTED: "Guard and compensation; obstacles and guard are felt.",
    Preset.TRANSPARENT: "The vehicle alone is felt; the guard stays, silently.",
    Preset.TRAINING: "As assisted, slower, obstacles and guard felt more.",
}
