"""The way to a vehicle over a serial port."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from groundstation.messages import Severity
from groundstation.vehicle import usb_port
from groundstation.vehicle.transport import Tell, TransportError, Url

if TYPE_CHECKING:
    import serial
    from serial.tools.list_ports_common import ListPortInfo

_RECONNECT_S = 1.0
_WRITE_S = 0.05
# What would stand in the port's queue for longer than a setpoint may be old (`safety.setpoint_stale_s`), s, is lost
# instead. A byte is ten bits on the line.
_QUEUE_S, _BITS = 0.15, 10
# The longest frame of MAVLink 2, signed, bytes.
_LEAST_QUEUE = 293


class SerialPort:
    """A telemetry radio or a flight controller on a serial port, opened again when it comes back, wherever that is.

    Args:
        url: Its port and baud rate.
        tell: Is told when it goes and comes.
        ports: Lists the serial ports that are there.
    """

    def __init__(
        self, url: Url, tell: Tell, ports: Callable[[], list[ListPortInfo]] = usb_port.present
    ) -> None:
        import serial

        self._url, self._tell, self._ports = url, tell, ports
        self._error = serial.SerialException
        self._full = serial.SerialTimeoutException
        self._open = serial.Serial
        self._port: serial.Serial | None = None
        self._most = max(int(_QUEUE_S * url.number / _BITS), _LEAST_QUEUE)
        self._slow = False
        self._retry_t = 0.0
        try:
            self._port = self._open(url.place, url.number, timeout=0.1, write_timeout=_WRITE_S)
        except (serial.SerialException, ValueError) as error:
            raise TransportError(
                f"serial://{url.place}:{url.number}: cannot be opened ({error}); check the cable, the name "
                "and that you are in the group that owns it (dialout)."
            ) from error
        self._who = usb_port.identity(url.place, ports())

    def receive(self) -> bytes:
        """See `Transport`."""
        port = self._port or self._reopen()
        if port is None:
            return b""
        try:
            return port.read(max(1, port.in_waiting))
        except (self._error, OSError, TypeError):
            self._lose()
            return b""

    def send(self, data: bytes) -> None:
        """See `Transport`."""
        port = self._port
        if port is not None:
            try:
                if port.out_waiting + len(data) <= self._most:
                    port.write(data)
                    return
            except self._full:
                pass
            except (self._error, OSError, TypeError):
                self._lose()
                return
            self._tell_slow()

    def _tell_slow(self) -> None:
        """The line is slower than its traffic: the frame is lost, not the port. Told once."""
        if not self._slow:
            self._slow = True
            words = f"Serial port {self._url.place} is too slow at {self._url.number} baud, messages are lost"
            self._tell(
                Severity.WARNING, f"{words}; see `rates` in groundstation.toml, or set both ends faster."
            )

    def close(self) -> None:
        """See `Transport`."""
        port, self._port = self._port, None
        if port is not None:
            with contextlib.suppress(self._error, OSError):
                port.close()

    def _lose(self) -> None:
        # Both threads may find out; it is told once.
        if self._port is not None:
            self.close()
            self._tell(Severity.ALARM, f"Serial port {self._url.place} is gone; plug it in again.")

    def _reopen(self) -> serial.Serial | None:
        time.sleep(0.1)
        now = time.monotonic()
        if now < self._retry_t:
            return None
        self._retry_t = now + _RECONNECT_S
        place = usb_port.find(self._url.place, self._who, self._ports())
        with contextlib.suppress(self._error, OSError):
            if place:
                self._port = self._open(place, self._url.number, timeout=0.1, write_timeout=_WRITE_S)
                moved = "" if place == self._url.place else f", as {place}"
                self._tell(Severity.INFO, f"Serial port {self._url.place} is back{moved}.")
        return self._port
