"""A serial port, or the telemetry radio on it. Never waits, and comes back when it is plugged in again."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from math import inf
from time import monotonic

import serial

from sim.process.transport import RECONNECT_S, TransportError, Url

_BYTES = 4096
# What a port does not take at once waits, up to this; then whole datagrams are lost, as in a radio that is full.
_WAITING = 8192


class SerialPort:
    """Bytes over a serial port.

    pyserial sets the port up. Reading and writing go past it, for its `write` without a timeout never returns from a
    port that is full.

    Args:
        url: The device and its baud rate.
        clock: Monotonic seconds.

    Raises:
        TransportError: The port cannot be opened.
    """

    whole = False

    def __init__(self, url: Url, clock: Callable[[], float] = monotonic) -> None:
        self.url = url
        self._clock = clock
        self._waiting = bytearray()
        self._tried_t = -inf
        self._port: serial.Serial | None = None
        try:
            self._open()
        except (serial.SerialException, ValueError) as error:
            raise TransportError(
                f"{url}: cannot be opened ({error}); check the cable, the name, and that you are in the group "
                "that owns it (dialout)."
            ) from error

    @property
    def heard(self) -> bool:
        """The port is there; whether anybody reads at the other end it cannot know."""
        return self._port is not None

    def receive(self) -> Iterator[bytes]:
        """Yield what has arrived."""
        if self._port is None and self._clock() - self._tried_t >= RECONNECT_S:
            try:
                self._open()
            except (serial.SerialException, ValueError):
                return
        if self._port is None:
            return
        try:
            data = os.read(self._port.fileno(), _BYTES)
        except BlockingIOError:
            return
        except OSError:
            self.close()
            return
        if data:
            yield data

    def send(self, data: bytes) -> None:
        """Send what fits, keep the rest for the next time; lose all of it when too much waits."""
        if self._port is None:
            return
        if len(self._waiting) + len(data) <= _WAITING:
            self._waiting += data
        try:
            sent = os.write(self._port.fileno(), self._waiting)
        except BlockingIOError:
            return
        except OSError:
            self.close()
            return
        del self._waiting[:sent]

    def close(self) -> None:
        """Let the port go; receiving opens it again."""
        port, self._port = self._port, None
        self._waiting.clear()
        if port is not None:
            port.close()

    def _open(self) -> None:
        self._tried_t = self._clock()
        self._port = serial.Serial(self.url.place, self.url.number, timeout=0, write_timeout=0)
