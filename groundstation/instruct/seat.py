"""The instructor's seat: a place on the bus of a flight that somebody else flies."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import TypeVar

from groundstation.bus import Bus
from groundstation.console import Console, Snapshot
from groundstation.messages import (
    INTERVENTION_ANSWER,
    CommandAnswer,
    CommandKind,
    InterventionAnswer,
    Severity,
)
from groundstation.run import Run, run_file
from groundstation.run_folder import Stay, sweep
from groundstation.training.asking import Asker
from groundstation.training.happening import Happening, unpacked
from groundstation.training.in_force import InForce

T = TypeVar("T")

SOURCE = "instructor"
# Looked for so often, s.
_TURN_S = 0.02
# Numbers of commands that no other process of the run uses: theirs begin with 1.
_NUMBERS = 1_000_000


class Seat:
    """What an instructor sees and does.

    Args:
        run: The flight.
        bus: A place on its bus.

    Attributes:
        run: As given.
        in_force: What was let happen so far, by whomever.
    """

    def __init__(self, run: Run, bus: Bus) -> None:
        self.run = run
        self._bus = bus
        self._console = Console(bus, SOURCE, first=os.getpid() * _NUMBERS)
        self._asker = Asker(bus, SOURCE)
        self._done = bus.subscriber(INTERVENTION_ANSWER)
        self.in_force = InForce()

    @property
    def there(self) -> bool:
        """The flight still runs."""
        return run_file(self.run.run_id).exists()

    def look(self) -> Snapshot:
        """Return the newest of everything, and take note of what was done."""
        for answer in self._done.drain():
            happening = unpacked(answer.happening)
            if answer.ok and happening is not None:
                self.in_force.take(happening, answer.t)
        return self._console.snapshot()

    def heard(self, seconds: float, look: Callable[[], T | None]) -> T | None:
        """Look again and again until there is something, and return it; None where the flight or the time ends."""
        until = time.monotonic() + seconds
        while (found := look()) is None and self.there and time.monotonic() < until:
            time.sleep(_TURN_S)
        return found

    def ask(self, happening: Happening) -> None:
        """Ask for something to happen."""
        self._asker.ask(happening)

    def answers(self) -> list[InterventionAnswer]:
        """Return what became of what was asked for."""
        return self._asker.answers()

    def say(self, text: str) -> None:
        """Tell the trainee something, and the recording."""
        self._bus.event(Severity.INFO, text)

    def command(self, kind: CommandKind) -> int:
        """Have the vehicle hold or land, told to the trainee as well; return the command's number."""
        self._bus.event(Severity.WARNING, f"The instructor commands {kind.name.capitalize()}.")
        return self._console.command(kind)

    def answer_to(self, number: int) -> CommandAnswer | None:
        """Return the answer to a command, if it has just come."""
        return next((answer for answer in self.look().answers if answer.number == number), None)


@contextmanager
def seat(run: Run) -> Generator[Seat]:
    """Take a seat in a flight, and leave it with nothing left behind, should it end meanwhile."""
    stay = Stay(run.run_id)
    bus = Bus(run.run_id, SOURCE)
    try:
        yield Seat(run, bus)
    finally:
        bus.close()
        if stay.end():
            sweep(run.run_id)
