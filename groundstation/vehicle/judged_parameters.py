"""The vehicle's parameters that are judged: asked for until they are told, and known as they were told last.

They are asked for without MAVSDK's parameter client, which has one thing after another, each until the vehicle has
answered: of a vehicle that went silent while all were being read it would ask for the rest without end.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Iterator
from typing import NamedTuple

from mavsdk import System
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkDirectError, MavlinkMessage

from groundstation.vehicle.failsafes import Judged
from groundstation.vehicle.overheard import Overheard

_AUTOPILOT, _BY_NAME = 1, -1
# What is not told within this is asked for again, s.
_AGAIN_S = 2.0


class Told(NamedTuple):
    """A value that the vehicle told, and the one before; None where there was none."""

    judged: Judged
    value: float
    before: float | None


class JudgedParameters:
    """Asks for them, and listens.

    Args:
        system: The vehicle.
        wanted: Those that are judged.
        bytewise: How it has whole numbers on the wire; see `groundstation.vehicle.overheard`.
        clock: Monotonic seconds.

    Attributes:
        values: As they were told last, by name.
    """

    def __init__(
        self, system: System, wanted: tuple[Judged, ...], *, bytewise: bool, clock: Callable[[], float]
    ) -> None:
        self._system_id, self._clock = system.get_system_id(), clock
        self._wanted = {each.name: each for each in wanted}
        self._direct = MavlinkDirect(system)
        self._overheard = Overheard(system, bytewise=bytewise)
        self._due = frozenset(self._wanted)
        self._next = 0.0
        self.values: dict[str, float] = {}

    def turn(self) -> Iterator[Told]:
        """Yield what was told, whoever asked for it, and ask when it is time; never waits."""
        for name, value in self._overheard.take():
            if judged := self._wanted.get(name):
                before = self.values.get(name)
                self.values[name] = value
                self._due -= {name}
                yield Told(judged, value, before)
        if self._due and (now := self._clock()) >= self._next:
            self._next = now + _AGAIN_S
            for name in self._wanted:
                if name in self._due:
                    self._ask(name)

    def ask_again(self) -> None:
        """Ask for all: a change may have been told while nobody could hear it."""
        self._due, self._next = frozenset(self._wanted), 0.0

    def forget(self) -> None:
        """The vehicle has started anew: what was told need not be true any more."""
        self.values.clear()
        self.ask_again()

    def _ask(self, name: str) -> None:
        fields = {
            "target_system": self._system_id,
            "target_component": _AUTOPILOT,
            "param_id": name,
            "param_index": _BY_NAME,
        }
        # What cannot be sent is lost like anything else on its way.
        with contextlib.suppress(MavlinkDirectError):
            self._direct.send_message(
                MavlinkMessage("PARAM_REQUEST_READ", 0, 0, self._system_id, _AUTOPILOT, json.dumps(fields))
            )
