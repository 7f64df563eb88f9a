"""A device that can be made to seem unplugged for a while, to practise what is to be done then."""

from __future__ import annotations

import contextlib

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, HapticDevice, Vector3
from groundstation.clock import Clock


class Unpluggable:
    """Passes everything on until it is unplugged; then it fails as a device does that is gone, and comes back.

    Args:
        device: The device itself.
        clock: Monotonic seconds.
    """

    def __init__(self, device: HapticDevice, clock: Clock) -> None:
        self._device, self._clock = device, clock
        self._back_t = -float("inf")
        self._held = False

    @property
    def info(self) -> DeviceInfo:
        """What the device is."""
        return self._device.info

    def unplug(self, seconds: float) -> None:
        """Be gone for so long from now on; 0 is back again."""
        self._back_t, self._held = self._clock() + seconds, seconds > 0.0

    def open(self) -> None:
        """Take the device.

        Raises:
            DeviceError: It is unplugged, or cannot be opened.
        """
        self._check()
        self._device.open()

    def read(self) -> HandleState:
        """Return the handle's state.

        Raises:
            DeviceError: It is unplugged, or silent.
        """
        if self._held:
            # It is there in truth: the last force would stay on the hand.
            self._held = False
            with contextlib.suppress(DeviceError):
                self._device.write_force(ZERO3)
        self._check()
        return self._device.read()

    def write_force(self, force: Vector3) -> None:
        """Render a force on the hand.

        Raises:
            DeviceError: It is unplugged, or takes no force.
        """
        self._check()
        self._device.write_force(force)

    def close(self) -> None:
        """Let the device go."""
        self._device.close()

    def _check(self) -> None:
        if self._clock() < self._back_t:
            raise DeviceError("The haptic device is gone; plug it in again.")
