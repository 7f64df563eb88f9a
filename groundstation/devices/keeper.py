"""Keeps the haptic device open: reads it, writes to it, and brings it back after it was lost."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Protocol

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, HapticDevice, Vector3
from groundstation.clock import Clock
from groundstation.devices.sanity import impossible, unusable
from groundstation.messages import Severity

RETRY_S = 0.5
ABSENT = DeviceInfo(
    name="none",
    serial="",
    axes=0,
    workspace=1.0,
    force_limit=0.0,
    stiffness_limit=0.0,
    rate=100.0,
    renders="nothing",
)
"""What there is before a device was first opened."""


Start = Callable[[Callable[[], None]], object]
"""Starts work that may be slow, and returns."""

# Opening that has not ended by then when the keeper is closed is left to the end of the process, s.
_PATIENCE_S = 2.0


def in_thread(work: Callable[[], None]) -> None:
    """Start work in a thread of its own."""
    threading.Thread(target=work, name="open device", daemon=True).start()


class Keeper(Protocol):
    """What a servo needs of who keeps its device; see `DeviceKeeper`."""

    info: DeviceInfo
    present: bool
    read_s: float
    write_s: float

    def read(self, now: float) -> HandleState | None:
        """Return the handle's state, or None where there is none now; `now` in monotonic s."""
        ...

    def write(self, force: Vector3) -> None:
        """Render a force, N, handle frame, where there is a device."""
        ...

    def close(self) -> None:
        """Render nothing and let the device go."""
        ...


class DeviceKeeper:
    """A device that may come and go.

    A silent device is still read every tick, for it may only have paused, and is opened anew at 2 Hz for as
    long as it stays silent. Opening may take seconds, as where firmware is loaded: it is done aside, and until it is
    done there is no device.

    Args:
        device: Not yet open.
        tell: Takes a sentence when the device is lost or there again; once for each.
        clock: Monotonic seconds.
        start: Starts the opening.

    Attributes:
        info: What the device is, `ABSENT` before it was first opened.
        present: It was read in the last tick.
        read_s, write_s: Longest time a read or a write took since they were last set to zero.
    """

    def __init__(
        self,
        device: HapticDevice,
        tell: Callable[[Severity, str], None],
        clock: Clock,
        start: Start = in_thread,
    ) -> None:
        self._device = device
        self._tell = tell
        self._clock = clock
        self._start = start
        self._open = self._opening = False
        self._opened = threading.Event()
        self._fault = ""
        self._next_try = -float("inf")
        self._why = self._told = ""
        self.info = ABSENT
        self.present = False
        self.read_s = 0.0
        self.write_s = 0.0

    def read(self, now: float) -> HandleState | None:
        """Return the handle's state, or None where there is none now; `now` in monotonic s."""
        if self._opening:
            if not self._opened.is_set():
                return None
            self._take_opened()
        if self._open and (state := self._sample(now)) is not None:
            return state
        if now >= self._next_try:
            self._next_try = now + RETRY_S
            self._reopen()
        return None

    def write(self, force: Vector3) -> None:
        """Render a force, N, handle frame, where there is a device."""
        if not self.present:
            return
        began = self._clock()
        try:
            self._device.write_force(force)
        except DeviceError as error:
            self._lose(began, error)
            # It still reads, and would be there again in the next tick: it is opened anew instead.
            self._open = False
        self.write_s = max(self.write_s, self._clock() - began)

    def close(self) -> None:
        """Render nothing and let the device go."""
        if self._opening:
            self._opened.wait(_PATIENCE_S)
        self.write(ZERO3)
        self._device.close()
        self._open = self.present = False

    def _sample(self, now: float) -> HandleState | None:
        began = self._clock()
        try:
            state = self._device.read()
        except DeviceError as error:
            self._lose(now, error)
            return None
        self.read_s = max(self.read_s, self._clock() - began)
        if words := impossible(state, self.info, began):
            self._lose(now, DeviceError(f"{self.info.name}: {words}; unplug it, plug it in again."))
            return None
        if not self.present:
            self.present, self._told = True, ""
            self._tell(Severity.INFO, f"{self.info.name} is there.")
        return state

    def _reopen(self) -> None:
        if self._open:
            self._complain()
        self._open, self._opening = False, True
        self._opened.clear()
        self._start(self._open_device)
        if self._opened.is_set():
            self._take_opened()

    def _open_device(self) -> None:
        """Open the device, aside. Until `_opened` is set, nothing else touches it."""
        self._fault = "The device's driver failed while opening it; see the traceback in this program's log."
        try:
            self._device.close()
            self._device.open()
            self._fault = ""
        except DeviceError as error:
            self._fault = str(error)
        finally:
            self._opened.set()

    def _take_opened(self) -> None:
        self._opening = False
        if self._fault:
            self._why = self._fault
            self._complain()
            return
        if words := unusable(self._device.info):
            self._why = f"{self._device.info.name}: {words}; its driver is wrong."
            self._complain()
            return
        self._open = True
        self.info = self._device.info

    def _lose(self, now: float, error: DeviceError) -> None:
        """Take note of a failure. One just opened may need a moment; one that was there is missed at once."""
        self._why = str(error)
        if self.present:
            self.present = False
            self._next_try = now + RETRY_S
            self._complain()

    def _complain(self) -> None:
        """Say what is wrong, once for as long as it is the same."""
        if self._why != self._told:
            self._told = self._why
            self._tell(Severity.WARNING, self._why)
