"""A simulated arm on a simulated handle: datagrams tell its intention; it moves, and yields to force."""

from __future__ import annotations

import time
from collections.abc import Callable

from drivers.arm import Arm, ArmState, stop
from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
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
    """A hand that follows an intention: `drivers.stick` says how it is told, `drivers.arm` how it moves.

    Args:
        address: Path of its socket.
        clock: Monotonic seconds.
        arm: Whose arm it is.
    """

    def __init__(
        self, address: str, clock: Callable[[], float] = time.monotonic, arm: Arm | None = None
    ) -> None:
        self._clock = clock
        self._arm = arm or Arm()
        self._stick = StickReceiver(address, clock)
        self._state = ArmState()
        self._force = ZERO3
        self._moved_t: float | None = None

    @property
    def info(self) -> DeviceInfo:
        """What the hand holds."""
        return INFO

    def open(self) -> None:
        """Listen for intentions; the handle rests at its centre."""
        self._stick.open()
        self._state = ArmState()
        self._let_go()

    def read(self) -> HandleState:
        """Move the arm up to now and return where the handle is.

        Raises:
            DeviceError: The intention is older than 0.2 s, never came, or the hand is not open. The handle
                then stays where it is, without force.
        """
        now = self._clock()
        self._stick.receive()
        try:
            newest = self._stick.fresh(now)
        except DeviceError:
            self._let_go()
            raise
        dt = 0.0 if self._moved_t is None else max(now - self._moved_t, 0.0)
        self._moved_t = now
        intention = within(newest.position, WORKSPACE)
        moved = self._arm.step(self._state, dt, intention, newest.yaw, self._force)
        self._state = stop(moved, WORKSPACE)
        position, velocity, yaw, _ = self._state
        return HandleState(position, velocity, yaw, newest.buttons, homed=True, device_time=now)

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
        self._stick.close()

    def _let_go(self) -> None:
        self._force = ZERO3
        self._moved_t = None
        self._state = ArmState(self._state.position, ZERO3, self._state.yaw, 0.0)
