"""A device outside a flight: read at its rate in a thread, pressed on gently, to look at it and calibrate it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from drivers.device import ZERO3, HandleState, HapticDevice, Vector3
from drivers.vectors import finite, slewed, within
from groundstation.clock import Clock, Pacer
from groundstation.devices.keeper import DeviceKeeper, Start, in_thread
from groundstation.messages import Severity

# Enough to feel, too little to surprise a hand, N; and how fast it comes and goes, N/s.
GENTLE_N = 2.0
_SLEW = 10.0

Push = Callable[[float], Vector3]
"""From monotonic s to the force to render, N, handle frame."""


def no_push(_t: float) -> Vector3:
    """Render nothing."""
    return ZERO3


class DeviceLoop:
    """Keeps a device going until `stop`.

    Args:
        device: Not yet open.
        clock: Monotonic seconds.
        start: Starts the device's opening.

    Attributes:
        state: The handle as last read, or None while there is none.
        words: What was last said of the device.
        push: The force to render; no stronger than 2 N, nor faster than 10 N/s.
        force: As it is rendered now, N.
        ticks: Times the handle was read.
    """

    def __init__(self, device: HapticDevice, clock: Clock = time.monotonic, start: Start = in_thread) -> None:
        self._clock = clock
        self.keeper = DeviceKeeper(device, self._hear, clock, start)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="device", daemon=True)
        self._samples: list[Vector3] | None = None
        self._last_t = clock()
        self.state: HandleState | None = None
        self.words = ""
        self.push: Push = no_push
        self.force = ZERO3
        self.ticks = 0

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """Render nothing, let the device go, and wait for that."""
        self._over.set()
        if self._thread.is_alive():
            self._thread.join()

    def collect(self) -> None:
        """Begin to collect positions."""
        self._samples = []

    def collected(self) -> list[Vector3]:
        """Return the positions read since `collect`, m, and end collecting."""
        samples, self._samples = self._samples or [], None
        return samples

    def turn(self, now: float) -> None:
        """Run one tick at monotonic time `now`, s."""
        dt, self._last_t = now - self._last_t, now
        state = self.state = self.keeper.read(now)
        if state is None or not state.homed:
            self.force = ZERO3
        else:
            self.ticks += 1
            if self._samples is not None:
                self._samples.append(state.position)
            wanted = self.push(now)
            limit = min(GENTLE_N, self.keeper.info.force_limit)
            self.force = slewed(self.force, within(wanted, limit) if finite(wanted) else ZERO3, _SLEW * dt)
        self.keeper.write(self.force)

    def _run(self) -> None:
        rate = self.keeper.info.rate
        pacer = Pacer(1.0 / rate, self._clock)
        try:
            while not self._over.is_set():
                pacer.wait()
                self.turn(self._clock())
                if self.keeper.info.rate != rate:
                    rate = self.keeper.info.rate
                    pacer.restart(1.0 / rate)
        finally:
            self.keeper.close()

    def _hear(self, _severity: Severity, words: str) -> None:
        self.words = words
