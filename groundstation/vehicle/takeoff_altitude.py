"""The altitude of take-off where it is one of the vehicle's parameters: set before each take-off, without waiting.

MAVSDK's own call waits for the vehicle's answer, and behind whatever else is read of its parameters: over a radio a
minute, in which a link that called it would neither steer nor hear.
"""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable

from mavsdk import System
from mavsdk.plugins.action import ActionResult
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkDirectError, MavlinkMessage

from groundstation.vehicle.gate import Gate
from groundstation.vehicle.overheard import Overheard

_TIMES, _AGAIN_S = 4, 0.5
_AUTOPILOT, _REAL32 = 1, 9
# The value travels as a 32 bit float.
_CLOSE = 1e-5


class TakeoffAltitude:
    """Sets the parameter, and says when the vehicle has told that it has it.

    Args:
        system: The vehicle.
        gate: Lets the parameter be set.
        name: Of the parameter.
        metres: What it is set to.
        clock: Monotonic seconds.
    """

    def __init__(
        self, system: System, gate: Gate, name: str, metres: float, clock: Callable[[], float]
    ) -> None:
        self._gate, self._name, self._metres, self._clock = gate, name, metres, clock
        self._system_id = system.get_system_id()
        self._direct = MavlinkDirect(system)
        self._overheard = Overheard(system, bytewise=True)
        self._done: Callable[[ActionResult], None] | None = None
        self._left, self._next, self._told = 0, 0.0, math.nan

    def set(self, done: Callable[[ActionResult], None]) -> None:
        """Begin; `done` is called from `turn` with what became of it."""
        self.forget()
        self._done, self._left, self._next, self._told = done, _TIMES, 0.0, math.nan

    def forget(self) -> None:
        """Something else was commanded: a take-off that waits is not wanted any more."""
        self._end(ActionResult.BUSY)

    def turn(self) -> None:
        """Take what the vehicle told, and ask again when it is time; never waits."""
        for name, value in self._overheard.take():
            if name == self._name:
                self._told = value
        if self._done is None:
            return
        if abs(self._told - self._metres) <= _CLOSE * max(1.0, self._metres):
            self._end(ActionResult.SUCCESS)
        elif (now := self._clock()) >= self._next:
            if not self._left:
                silent = math.isnan(self._told)
                self._end(ActionResult.TIMEOUT if silent else ActionResult.PARAMETER_ERROR)
                return
            self._left, self._next = self._left - 1, now + _AGAIN_S
            self._ask()

    def _end(self, result: ActionResult) -> None:
        done, self._done = self._done, None
        if done is not None:
            done(result)

    def _ask(self) -> None:
        self._gate.allow_parameter(self._name, self._metres)
        fields = {
            "target_system": self._system_id,
            "target_component": _AUTOPILOT,
            "param_id": self._name,
            "param_value": self._metres,
            "param_type": _REAL32,
        }
        # What cannot be sent is lost like anything else on its way.
        with contextlib.suppress(MavlinkDirectError):
            self._direct.send_message(
                MavlinkMessage("PARAM_SET", 0, 0, self._system_id, _AUTOPILOT, json.dumps(fields))
            )
