"""The contract between a haptic device and the servo: half a page that every driver fulfils.

Handle frame: x toward the drone's front as the operator sees it, y left, z up; metres, radians, newtons.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

Vector3 = tuple[float, float, float]
ZERO3: Vector3 = (0.0, 0.0, 0.0)


class DeviceError(Exception):
    """The device cannot be used now; the message says why and what to do, in one sentence."""


class HandleState(NamedTuple):
    """What the device says of the hand at one moment, in the handle frame.

    Attributes:
        position: Displacement from the centre, m.
        velocity: Its rate, m/s.
        yaw: Rotation about z, rad, counter-clockwise from above; 0 where the device has no such axis.
        buttons: One bit a button.
        homed: The device knows where it is. While it does not, its force is 0 and nothing engages.
        device_time: When the sample was taken, s on the monotonic clock.
    """

    position: Vector3
    velocity: Vector3
    yaw: float
    buttons: int
    homed: bool
    device_time: float


@dataclass(frozen=True, slots=True)
class DeviceInfo:
    """What a device is and can do.

    Attributes:
        name: Vendor and model, for people.
        serial: Stable identity of this very device, or "" where it has none.
        axes: Number of axes the operator can move (3, or 4 with yaw).
        workspace: Radius the handle can be moved in, m.
        force_limit: Largest norm of force it can render, N; the servo clips to it.
        stiffness_limit: Largest stiffness it renders passively, N/m.
        rate: Servo rate it is made for, Hz.
        renders: How it answers: with force, with rumble, or not at all.
    """

    name: str
    serial: str
    axes: int
    workspace: float
    force_limit: float
    stiffness_limit: float
    rate: float
    renders: Literal["force", "rumble", "nothing"]


class HapticDevice(Protocol):
    """A haptic device. `read` and `write_force` return well within a tick; `close` alone raises nothing."""

    @property
    def info(self) -> DeviceInfo:
        """What the device is; valid once it is open."""
        ...

    def open(self) -> None:
        """Take the device. It renders no force until it is homed and told one."""
        ...

    def read(self) -> HandleState:
        """Return the newest state of the handle. Never an old one: a silent device is a `DeviceError`."""
        ...

    def write_force(self, force: Vector3) -> None:
        """Render a force on the hand, N, in the handle frame."""
        ...

    def close(self) -> None:
        """Render nothing and let the device go. May be called at any time, and twice."""
        ...
