"""A stick on a screen: the handle is where its datagrams say. It cannot press back, only show the force."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.stick import SILENCE_S, StickReceiver, StickSample
from drivers.vectors import finite, within

WORKSPACE = 0.1
FILTER_S = 0.05
INFO = DeviceInfo(
    name="On-screen stick",
    serial="",
    axes=4,
    workspace=WORKSPACE,
    force_limit=10.0,
    stiffness_limit=1000.0,
    rate=1000.0,
    renders="nothing",
)


class VirtualHandle:
    """The on-screen stick; see `drivers.stick` for what moves it.

    Args:
        address: Path of its socket.
        clock: Monotonic seconds.

    Attributes:
        force: The force a hand would feel now, N, for whoever draws it.
    """

    def __init__(self, address: str, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._stick = StickReceiver(address, clock)
        self._last: StickSample | None = None
        self._velocity = ZERO3
        self.force = ZERO3

    @property
    def info(self) -> DeviceInfo:
        """What the stick is."""
        return INFO

    def open(self) -> None:
        """Listen for the stick."""
        self._stick.open()
        self._last = None
        self._velocity = self.force = ZERO3

    def read(self) -> HandleState:
        """Return where the stick is.

        Raises:
            DeviceError: It is silent for longer than 0.2 s, was never heard, or is not open.
        """
        for sample in self._stick.receive():
            self._take(sample)
        try:
            newest = self._stick.fresh(self._clock())
        except DeviceError:
            self.force = ZERO3
            raise
        position = within(newest.position, WORKSPACE)
        return HandleState(
            position, self._velocity, newest.yaw, newest.buttons, homed=True, device_time=newest.t
        )

    def write_force(self, force: Vector3) -> None:
        """Remember the force, N, that a hand would feel.

        Raises:
            DeviceError: It is not finite; then it is zero.
        """
        if not finite(force):
            self.force = ZERO3
            raise DeviceError("On-screen stick: the force is not a number; it is set to zero.")
        self.force = within(force, INFO.force_limit)

    def close(self) -> None:
        """Stop listening."""
        self.force = ZERO3
        self._stick.close()

    def _take(self, sample: StickSample) -> None:
        """Low-pass the difference of positions; after a silence the stick starts from rest."""
        last, self._last = self._last, sample
        elapsed = math.inf if last is None else sample.t - last.t
        if last is None or elapsed > SILENCE_S:
            self._velocity = ZERO3
            return
        share = -math.expm1(-elapsed / FILTER_S)
        x, y, z = within(sample.position, WORKSPACE)
        a, b, c = within(last.position, WORKSPACE)
        u, v, w = self._velocity
        gain = share / elapsed
        self._velocity = (
            u + gain * (x - a) - share * u,
            v + gain * (y - b) - share * v,
            w + gain * (z - c) - share * w,
        )
