"""The vehicle's parameters through MAVSDK: its calls wait for the vehicle, so a thread of their own makes them.

What the thread reads and sets comes out of queues; the link's loop never waits. Those that are judged do not come
this way, see `groundstation.vehicle.judged_parameters`.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from typing import NamedTuple

from mavsdk import System
from mavsdk.plugins.param import Param, ParamError, ParamResult

from groundstation.messages import CommandKind
from groundstation.vehicle.commander import Answer
from groundstation.vehicle.gate import Gate

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
    """Reads and sets parameters on a thread.

    Args:
        system: The vehicle.
        gate: Lets a parameter be set.

    Attributes:
        read, answers: What came since they were last emptied.
        reading: All are being read. Where the vehicle goes silent meanwhile, MAVSDK goes on when it is back.
    """

    def __init__(self, system: System, gate: Gate) -> None:
        self._param = Param(system)
        self._gate = gate
        self._work: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._over = threading.Event()
        self.read: queue.SimpleQueue[Read] = queue.SimpleQueue()
        self.answers: queue.SimpleQueue[Answer] = queue.SimpleQueue()
        self.reading = False
        self._thread = threading.Thread(target=self._run, name="parameters", daemon=True)
        self._thread.start()

    def fetch_all(self, number: int) -> None:
        """Read every parameter; the answer has the command's number."""
        self.reading = True
        self._work.put(lambda: self._fetch_all(number))

    def set(self, number: int, name: str, amount: float, *, whole: bool) -> None:
        """Set a parameter, and read it back."""
        self._work.put(lambda: self._set(number, name, amount, whole=whole))

    def close(self) -> bool:
        """End the thread; say whether it has ended, for MAVSDK must not be taken from under it."""
        self._over.set()
        self._work.put(None)
        self._thread.join(_END_S)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while not self._over.is_set():
            work = self._work.get()
            if work is not None:
                work()

    def _fetch_all(self, number: int) -> None:
        every = self._param.get_all_params()
        self.reading = False
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
