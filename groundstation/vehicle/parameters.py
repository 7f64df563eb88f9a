"""The vehicle's parameters through MAVSDK: its calls wait for the vehicle, so a thread of their own makes them.

What the thread reads and sets comes out of queues; the link's loop never waits. Those that are judged are taken from
what the vehicle tells, see `groundstation.vehicle.overheard`: in its order, and when somebody else sets them, too.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from mavsdk import System
from mavsdk.plugins.param import Param, ParamError, ParamResult

from groundstation.messages import CommandKind
from groundstation.vehicle.commander import Answer
from groundstation.vehicle.failsafes import Judged
from groundstation.vehicle.gate import Gate

# One that is judged and that the vehicle did not tell is asked for again after this, s.
_AGAIN_S = 2.0
# The process is given 3 s to end in, and has its log to close after this, s.
_END_S = 1.5
# An integer travels in a float's 32 bits.
_WHOLE_MOST = 2**31

_WORDS = {
    ParamResult.TIMEOUT: "the vehicle did not answer; check the link",
    ParamResult.DOES_NOT_EXIST: "the vehicle has no such parameter",
    ParamResult.VALUE_OUT_OF_RANGE: "the vehicle does not allow that value",
    ParamResult.READ_ONLY: "the vehicle does not let it be set",
    ParamResult.WRONG_TYPE: "it is of another type",
}


class Read(NamedTuple):
    """A parameter's value; `total` is how many there are where all were read, else 0."""

    name: str
    value: float
    whole: bool
    total: int = 0


class Parameters:
    """Reads and sets parameters on a thread; those that are judged are asked for first, and until they are heard.

    Args:
        system: The vehicle.
        gate: Lets a parameter be set.
        wanted: Those that are judged.

    Attributes:
        read, answers: What came since they were last emptied.
        judged: Values of those that are judged, by name; only the link's loop changes it.
    """

    def __init__(self, system: System, gate: Gate, wanted: tuple[Judged, ...]) -> None:
        self._param = Param(system)
        self._gate = gate
        self._wanted = {each.name: each for each in wanted}
        self._due = frozenset(self._wanted)
        self._work: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._over = threading.Event()
        self.read: queue.SimpleQueue[Read] = queue.SimpleQueue()
        self.answers: queue.SimpleQueue[Answer] = queue.SimpleQueue()
        self.judged: dict[str, float] = {}
        self._thread = threading.Thread(target=self._run, name="parameters", daemon=True)
        self._thread.start()

    def fetch_all(self, number: int) -> None:
        """Read every parameter; the answer has the command's number."""
        self._work.put(lambda: self._fetch_all(number))

    def set(self, number: int, name: str, amount: float, *, whole: bool) -> None:
        """Set a parameter, and read it back."""
        self._work.put(lambda: self._set(number, name, amount, whole=whole))

    def hear(self, name: str, value: float) -> float | None:
        """Take what the vehicle told of a parameter that is judged; return what it was before, or None."""
        before = self.judged.get(name)
        self.judged = self.judged | {name: value}
        self._due -= {name}
        return before

    def forget(self) -> None:
        """The vehicle has started anew: what was read need not be true any more."""
        self.judged = {}
        self.ask_again()

    def ask_again(self) -> None:
        """Ask for all that are judged: a change may have been told while nobody could hear it."""
        self._due = frozenset(self._wanted)
        self._work.put(lambda: None)

    def close(self) -> bool:
        """End the thread; say whether it has ended, for MAVSDK must not be taken from under it."""
        self._over.set()
        self._work.put(None)
        self._thread.join(_END_S)
        return not self._thread.is_alive()

    def _run(self) -> None:
        next_look = 0.0
        while not self._over.is_set():
            if time.monotonic() >= next_look and self._due:
                self._read_judged()
                next_look = time.monotonic() + _AGAIN_S
            try:
                work = self._work.get(timeout=_AGAIN_S / 4 if self._due else None)
            except queue.Empty:
                continue
            if work is not None:
                work()

    def _read_judged(self) -> None:
        for name, each in self._wanted.items():
            if name in self._due and not self._over.is_set():
                try:
                    value = self._value(name, whole=each.whole)
                except ParamError as error:
                    # It is asked for again; until then the hand is not coupled, and the screen says why.
                    if error.result is ParamResult.TIMEOUT:
                        return
                else:
                    self.read.put(Read(name, value, each.whole))

    def _fetch_all(self, number: int) -> None:
        every = self._param.get_all_params()
        found = [Read(each.name, float(each.value), whole=True) for each in every.int_params]
        found += [Read(each.name, float(each.value), whole=False) for each in every.float_params]
        for each in found:
            self.read.put(each._replace(total=len(found)))
        why = "" if found else "the vehicle told no parameter; check the link"
        self.answers.put(Answer(number, CommandKind.PARAMETERS, bool(found), why))

    def _set(self, number: int, name: str, amount: float, *, whole: bool) -> None:
        kind = CommandKind.SET_PARAMETER
        self._gate.allow_parameter(name, amount)
        try:
            if whole:
                self._param.set_param_int(name, int(amount))
            else:
                self._param.set_param_float(name, amount)
            self.read.put(Read(name, self._value(name, whole=whole), whole))
        except ParamError as error:
            why = _WORDS.get(error.result, str(error.result.name).replace("_", " ").lower())
            self.answers.put(Answer(number, kind, ok=False, why=f"{name}: {why}"))
        else:
            self.answers.put(Answer(number, kind, ok=True, why=""))

    def _value(self, name: str, *, whole: bool) -> float:
        return float(self._param.get_param_int(name) if whole else self._param.get_param_float(name))


def cannot_be_set(amount: float, *, whole: bool, armed: bool) -> str:
    """Return why a parameter is not set to an amount, or ""; the vehicle itself knows its range."""
    if armed:
        return "the vehicle is armed; disarm it first"
    if not abs(amount) < _WHOLE_MOST:
        return "that is no number that a parameter can have"
    if whole and amount != int(amount):
        return "it takes whole numbers only"
    return ""
