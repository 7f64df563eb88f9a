"""The human side of an emulated device: an arm on its handle that wants something and yields to the force."""

from __future__ import annotations

from collections.abc import Callable

from drivers.arm import Arm, ArmState, stop
from drivers.device import HandleState, Vector3
from drivers.motion import Intention, Motion, circle, motion_named, rest
from drivers.stick import SILENCE_S, StickReceiver
from drivers.vectors import within

__all__ = ["EmulatedHand", "Intention", "Motion", "circle", "rest"]


class EmulatedHand:
    """A hand on an emulated handle; `drivers.arm` says how it moves.

    Args:
        workspace: Radius of the sphere the handle can move in, m.
        clock: Monotonic seconds.
        address: What it does, as a motion's name (`drivers.motion`), or the socket where its intention comes from
            as datagrams (`drivers.stick`). A sender that is silent for 0.2 s has let go: the hand goes back to
            the centre.
        motion: What it does where there is no address.
        arm: Whose arm it is.

    Raises:
        DeviceError: The socket cannot be bound, or the recording is not one.
    """

    def __init__(
        self,
        workspace: float,
        clock: Callable[[], float],
        address: str | None = None,
        motion: Motion = rest,
        arm: Arm | None = None,
    ) -> None:
        self.workspace = workspace
        named = motion_named(address) if address is not None else motion
        self._motion = named or rest
        self._arm = arm or Arm()
        self._state = ArmState()
        self._began = self._moved_t = clock()
        self._stick = StickReceiver(address, clock) if address is not None and named is None else None
        if self._stick is not None:
            self._stick.open()

    def step(self, now: float, force: Vector3) -> HandleState:
        """Move the hand on to `now`, monotonic s, with the device's `force`, N, handle frame, held since."""
        wanted = self._wanted(now)
        dt = max(now - self._moved_t, 0.0)
        self._moved_t = now
        intention = within(wanted.position, self.workspace)
        moved = self._arm.step(self._state, dt, intention, wanted.yaw, force)
        self._state = stop(moved, self.workspace)
        position, velocity, yaw, _ = self._state
        return HandleState(position, velocity, yaw, wanted.buttons, homed=True, device_time=now)

    def close(self) -> None:
        """Let the socket go."""
        if self._stick is not None:
            self._stick.close()

    def _wanted(self, now: float) -> Intention:
        if self._stick is None:
            return self._motion(now - self._began)
        self._stick.receive()
        newest = self._stick.newest
        if newest is None or now - newest.t > SILENCE_S:
            return Intention()
        return Intention(newest.position, newest.yaw, newest.buttons)
