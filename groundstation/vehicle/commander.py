"""The operator's commands to the vehicle through MAVSDK, each with one answer, none of them ever waiting."""

from __future__ import annotations

import queue
from collections.abc import Callable
from typing import NamedTuple

from mavsdk import System
from mavsdk.plugins.action import Action, ActionResult
from mavsdk.plugins.offboard import Offboard, OffboardResult, VelocityBodyYawspeed

from groundstation.frames import Vector4, frd_from_flu
from groundstation.messages import CommandKind
from groundstation.vehicle.gate import Gate
from groundstation.vehicle.takeoff_altitude import TakeoffAltitude

RADIANS_TO_DEGREES = 57.29577951308232

# Commands that change who steers: the offboard stream makes room for them.
STEERING = frozenset(
    {
        CommandKind.LAND,
        CommandKind.RETURN,
        CommandKind.HOLD,
        CommandKind.TAKEOFF,
        CommandKind.KILL,
        CommandKind.DISARM,
    }
)

_WORDS = {
    ActionResult.NO_SYSTEM: "no vehicle is connected",
    ActionResult.CONNECTION_ERROR: "the link failed",
    ActionResult.BUSY: "the vehicle is busy with another command; try again",
    ActionResult.COMMAND_DENIED: "the vehicle denied it",
    ActionResult.COMMAND_DENIED_LANDED_STATE_UNKNOWN: "the vehicle does not know whether it is landed",
    ActionResult.COMMAND_DENIED_NOT_LANDED: "the vehicle is not landed",
    ActionResult.TIMEOUT: "the vehicle did not answer; check the link",
    ActionResult.PARAMETER_ERROR: "the vehicle does not take the altitude of take-off",
    ActionResult.UNSUPPORTED: "the vehicle cannot do that",
}


class Answer(NamedTuple):
    """What became of a command. `number` 0 means the program's own act."""

    number: int
    kind: CommandKind
    ok: bool
    why: str


class OffboardAnswer(NamedTuple):
    """What became of asking for offboard: acknowledged, or answered otherwise, or not at all; and why."""

    ok: bool
    heard: bool
    why: str


class Commander:
    """Sends commands and collects their answers; callbacks come on MAVSDK's thread.

    Args:
        system: The vehicle.
        gate: Lets pass what is rarely meant only when it is.
        takeoff_m: Where take-off ends, m above the ground.
        altitude: Tells the vehicle so, where it is a parameter; None where it goes with the command.

    Attributes:
        answers, offboard_answers: What has been answered since they were last emptied.
    """

    def __init__(
        self, system: System, gate: Gate, takeoff_m: float, altitude: TakeoffAltitude | None
    ) -> None:
        self._gate = gate
        self._action = Action(system)
        self._offboard = Offboard(system)
        self._takeoff_m, self._altitude = takeoff_m, altitude
        self._acts: dict[CommandKind, Callable[[Callable[[ActionResult, object], None]], None]] = {
            CommandKind.ARM: self._action.arm_async,
            CommandKind.DISARM: self._action.disarm_async,
            CommandKind.TAKEOFF: self._takeoff,
            CommandKind.LAND: self._action.land_async,
            CommandKind.RETURN: self._action.return_to_launch_async,
            CommandKind.HOLD: self._action.hold_async,
            CommandKind.KILL: self._kill,
        }
        self.answers: queue.SimpleQueue[Answer] = queue.SimpleQueue()
        self.offboard_answers: queue.SimpleQueue[OffboardAnswer] = queue.SimpleQueue()

    def do(self, kind: CommandKind, number: int = 0) -> None:
        """Send a command. Number 0 is the program's own act, others are the operator's."""
        if self._altitude and kind in STEERING:
            self._altitude.forget()
        self._acts[kind](lambda result, _: self._answer(number, kind, result))

    def turn(self) -> None:
        """Go on with what takes more than one message; never waits."""
        if self._altitude:
            self._altitude.turn()

    def arm_from_hold(self, number: int) -> None:
        """Arm by way of Hold: in a mode that a landing leaves behind, a vehicle may not be armed.

        PX4 1.14 goes to Hold by itself when it has landed, later versions may stay:
        https://github.com/mavlink/MAVSDK/pull/3099.
        """

        def held(result: ActionResult, _: object) -> None:
            if result is ActionResult.SUCCESS:
                self.do(CommandKind.ARM, number)
            else:
                self._answer(number, CommandKind.ARM, result)

        self._action.hold_async(held)

    def _answer(self, number: int, kind: CommandKind, result: ActionResult) -> None:
        ok = result is ActionResult.SUCCESS
        why = "" if ok else _WORDS.get(result, result.name.replace("_", " ").lower())
        self.answers.put(Answer(number, kind, ok, why))

    def start_offboard(self) -> None:
        """Ask for offboard. A setpoint must have been given just before."""
        self._offboard.start_async(self._on_started)

    def fly(self, velocity: Vector4) -> None:
        """Give MAVSDK a setpoint (FLU, m/s and rad/s), which it sends at once and repeats at 20 Hz."""
        forward, right, down, yaw_rate = frd_from_flu(velocity)
        self._offboard.set_velocity_body(
            VelocityBodyYawspeed(forward, right, down, yaw_rate * RADIANS_TO_DEGREES)
        )

    def _kill(self, answered: Callable[[ActionResult, object], None]) -> None:
        self._gate.allow_kill()
        self._action.kill_async(answered)

    def _takeoff(self, answered: Callable[[ActionResult, object], None]) -> None:
        def altitude_set(result: ActionResult, _: object = None) -> None:
            if result is ActionResult.SUCCESS:
                self._action.takeoff_async(answered)
            else:
                answered(result, None)

        if self._altitude:
            self._altitude.set(altitude_set)
        else:
            self._action.set_takeoff_altitude_async(self._takeoff_m, altitude_set)

    def _on_started(self, result: OffboardResult, _: object) -> None:
        ok, heard = result is OffboardResult.SUCCESS, result is not OffboardResult.TIMEOUT
        self.offboard_answers.put(OffboardAnswer(ok, heard, result.name.replace("_", " ").lower()))
