"""A simulated arm on a simulated handle: told what it wants, it moves there, and yields to force."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from drivers.arm import MASS, STIFFNESS, Arm, ArmState, stop
from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.motion import Intention, motion_named
from drivers.stick import StickReceiver
from drivers.vectors import finite, within

WORKSPACE = 0.1
INFO = DeviceInfo(
    name="Scripted hand",
    serial="",
    axes=4,
    workspace=WORKSPACE,
    force_limit=10.0,
    stiffness_limit=1000.0,
    rate=1000.0,
    renders="force",
)


class ScriptedHand:
    """A hand that follows an intention: `drivers.arm` says how it moves.

    Args:
        address: What it wants: a motion's name or a recording (`drivers.motion`), or the path of the socket where
            it is told (`drivers.stick`).
        clock: Monotonic seconds.
        mass: Of hand and handle, kg.
        stiffness: Of the arm, N/m.

    Raises:
        DeviceError: There is no address, the recording is not one, or mass or stiffness is not positive.
    """

    def __init__(
        self,
        address: str,
        clock: Callable[[], float] = time.monotonic,
        *,
        mass: float = MASS,
        stiffness: float = STIFFNESS,
    ) -> None:
        self._clock = clock
        self._arm = Arm(_positive("mass", mass), _positive("stiffness", stiffness))
        self._motion = motion_named(address)
        self._stick = StickReceiver(address, clock) if self._motion is None else None
        self._began: float | None = None
        self._state = ArmState()
        self._force = ZERO3
        self._moved_t: float | None = None

    @property
    def info(self) -> DeviceInfo:
        """What the hand holds."""
        return INFO

    def open(self) -> None:
        """Begin the motion, or listen for intentions; the handle rests at its centre."""
        if self._stick is not None:
            self._stick.open()
        self._began = self._clock()
        self._state = ArmState()
        self._let_go()

    def read(self) -> HandleState:
        """Move the arm up to now and return where the handle is.

        Raises:
            DeviceError: The intention is older than 0.2 s, never came, or the hand is not open. The handle
                then stays where it is, without force.
        """
        now = self._clock()
        try:
            wanted = self._wanted(now)
        except DeviceError:
            self._let_go()
            raise
        dt = 0.0 if self._moved_t is None else max(now - self._moved_t, 0.0)
        self._moved_t = now
        intention = within(wanted.position, WORKSPACE)
        moved = self._arm.step(self._state, dt, intention, wanted.yaw, self._force)
        self._state = stop(moved, WORKSPACE)
        position, velocity, yaw, _ = self._state
        return HandleState(position, velocity, yaw, wanted.buttons, homed=True, device_time=now)

    def write_force(self, force: Vector3) -> None:
        """Press on the hand, N, until the next call.

        Raises:
            DeviceError: The force is not finite; then it is zero.
        """
        if not finite(force):
            self._force = ZERO3
            raise DeviceError("Scripted hand: the force is not a number; it is set to zero.")
        self._force = within(force, INFO.force_limit)

    def close(self) -> None:
        """Stop listening and let the handle go."""
        self._let_go()
        self._began = None
        if self._stick is not None:
            self._stick.close()

    def _wanted(self, now: float) -> Intention:
        if self._stick is not None:
            self._stick.receive()
            newest = self._stick.fresh(now)
            return Intention(newest.position, newest.yaw, newest.buttons)
        if self._began is None or self._motion is None:
            raise DeviceError("Scripted hand: it is not open; open it first.")
        return self._motion(now - self._began)

    def _let_go(self) -> None:
        self._force = ZERO3
        self._moved_t = None
        self._state = ArmState(self._state.position, ZERO3, self._state.yaw, 0.0)


def _positive(name: str, value: float) -> float:
    if type(value) not in {int, float} or not 0.0 < value < math.inf:
        raise DeviceError(f"devices.scripted.{name}: {value!r} is not a positive number; correct it.")
    return value
