"""The bytes' way to the vehicle: UDP, TCP and serial ports, opened from a URL, all ours to close.

MAVSDK never sees a socket: see `gate.py` for why.
"""

from __future__ import annotations

import contextlib
import re
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from groundstation.errors import InputError
from groundstation.messages import Severity
from groundstation.vehicle import usb_port

if TYPE_CHECKING:
    import serial
    from serial.tools.list_ports_common import ListPortInfo

Scheme = Literal["udpin", "udpout", "tcpout", "serial"]
Tell = Callable[[Severity, str], None]

_NETWORK = re.compile(r"^(udpin|udpout|tcpout)://([^:/\s]+):(\d{1,5})$")
_SERIAL = re.compile(r"^serial://(/[^:\s]+|[A-Za-z]+\d+):(\d{3,8})$")
_DATAGRAM = 65_536
_PEER_SILENT_S = 5.0
_RECONNECT_S = 1.0
_WRITE_S = 0.05
# A vehicle that is silent for so long is on its own in any case (`safety.link_lost_s`), ms.
_STALLED_MS = 1_500
# What would stand in the port's queue for longer than a setpoint may be old (`safety.setpoint_stale_s`), s, is lost
# instead. A byte is ten bits on the line.
_QUEUE_S, _BITS = 0.15, 10
# The longest frame of MAVLink 2, signed, bytes.
_LEAST_QUEUE = 293


class UrlError(InputError):
    """A vehicle's URL is wrong; the message says how it should look."""


class TransportError(Exception):
    """The way to the vehicle cannot be opened; the message says why and what to do."""


@dataclass(frozen=True)
class Url:
    """A parsed vehicle URL: `place` is a host or a serial port, `number` a port or a baud rate."""

    scheme: Scheme
    place: str
    number: int


class Transport(Protocol):
    """Moves bytes. Neither call raises for what a link may do at any time: silence, loss, a lost peer."""

    def receive(self) -> bytes:
        """Return what came, or nothing after at most 0.1 s."""
        ...

    def send(self, data: bytes) -> None:
        """Send, or lose, some bytes at once."""
        ...

    def close(self) -> None:
        """Let go of the port."""
        ...


def parse_url(text: str) -> Url:
    """Parse `udpin://HOST:PORT`, `udpout://HOST:PORT`, `tcpout://HOST:PORT` or `serial:///dev/PORT:BAUD`.

    Raises:
        UrlError: It is none of these.
    """
    found = _NETWORK.match(text) or _SERIAL.match(text)
    if found is None:
        raise UrlError(
            f"{text!r} is not a vehicle's URL; use udpin://0.0.0.0:14540, udpout://HOST:PORT, "
            "tcpout://HOST:PORT or serial:///dev/ttyUSB0:57600."
        )
    if found.re is _SERIAL:
        return Url("serial", found[1], int(found[2]))
    number = int(found[3])
    if not 0 < number < 65_536:
        raise UrlError(f"{text!r}: port {number} does not exist; use 1 to 65535.")
    scheme: Scheme = "udpin" if found[1] == "udpin" else "udpout" if found[1] == "udpout" else "tcpout"
    return Url(scheme, found[2], number)


def open_transport(url: Url, tell: Tell = lambda _severity, _words: None) -> Transport:
    """Open the way to the vehicle.

    Args:
        url: Where it is.
        tell: Is told of a way that is lost and of one that is found again.

    Raises:
        TransportError: With where, why and what to do.
    """
    if url.scheme == "udpin":
        return UdpIn(url)
    if url.scheme == "udpout":
        return UdpOut(url)
    if url.scheme == "tcpout":
        return TcpOut(url, tell)
    return SerialPort(url, tell)


class UdpIn:
    """Listens on a port and answers whoever spoke first, until that one is silent for long."""

    def __init__(self, url: Url) -> None:
        self._socket = _udp_socket()
        self._peer: tuple[str, int] | None = None
        self._heard = 0.0
        try:
            self._socket.bind((url.place, url.number))
        except OSError as error:
            self._socket.close()
            raise TransportError(
                f"udpin://{url.place}:{url.number}: cannot listen ({error.strerror}); "
                "end the other program on this port or choose another."
            ) from error

    def receive(self) -> bytes:
        """See `Transport`."""
        try:
            data, peer = self._socket.recvfrom(_DATAGRAM)
        except OSError:
            return b""
        now = time.monotonic()
        if peer != self._peer and now - self._heard > _PEER_SILENT_S:
            self._peer = peer
        if peer != self._peer:
            return b""
        self._heard = now
        return data

    def send(self, data: bytes) -> None:
        """See `Transport`."""
        if self._peer is not None:
            with contextlib.suppress(OSError):
                self._socket.sendto(data, self._peer)

    def close(self) -> None:
        """See `Transport`."""
        self._socket.close()


class UdpOut:
    """Speaks to a fixed address and listens to its answers."""

    def __init__(self, url: Url) -> None:
        self._socket = _udp_socket()
        try:
            self._socket.connect((url.place, url.number))
        except OSError as error:
            self._socket.close()
            raise TransportError(
                f"udpout://{url.place}:{url.number}: no way there ({error.strerror}); check the address."
            ) from error

    def receive(self) -> bytes:
        """See `Transport`."""
        try:
            return self._socket.recv(_DATAGRAM)
        except TimeoutError:
            return b""
        except OSError:
            # The peer's port is closed (ICMP); do not spin on it.
            time.sleep(0.05)
            return b""

    def send(self, data: bytes) -> None:
        """See `Transport`."""
        with contextlib.suppress(OSError):
            self._socket.send(data)

    def close(self) -> None:
        """See `Transport`."""
        self._socket.close()


class TcpOut:
    """Connects to a server, and again whenever the connection breaks."""

    def __init__(self, url: Url, tell: Tell) -> None:
        self._address = (url.place, url.number)
        self._tell = tell
        self._way = f"tcpout://{url.place}:{url.number}"
        self._socket: socket.socket | None = None
        self._retry_t = 0.0
        try:
            self._connect()
        except OSError as error:
            raise TransportError(
                f"tcpout://{url.place}:{url.number}: no answer ({error.strerror or error}); "
                "check that the vehicle listens there."
            ) from error

    def receive(self) -> bytes:
        """See `Transport`."""
        connection = self._socket or self._reconnect()
        if connection is None:
            return b""
        try:
            data = connection.recv(_DATAGRAM)
        except TimeoutError:
            return b""
        except OSError:
            data = b""
        if not data:
            self._lose()
        return data

    def send(self, data: bytes) -> None:
        """See `Transport`."""
        connection = self._socket
        if connection is not None:
            try:
                connection.sendall(data)
            except OSError:
                self._lose()

    def close(self) -> None:
        """See `Transport`."""
        connection, self._socket = self._socket, None
        if connection is not None:
            connection.close()

    def _lose(self) -> None:
        # Both threads may find out; it is told once.
        if self._socket is not None:
            self.close()
            self._tell(Severity.ALARM, f"{self._way} has hung up; it is called again every second.")

    def _connect(self) -> socket.socket:
        connection = socket.create_connection(self._address, timeout=2.0)
        connection.settimeout(0.1)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        # What nobody has confirmed by then would come late, and TCP tries ever less often: better call anew (tcp(7)).
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _STALLED_MS)
        self._socket = connection
        return connection

    def _reconnect(self) -> socket.socket | None:
        time.sleep(0.1)
        now = time.monotonic()
        if now < self._retry_t:
            return None
        self._retry_t = now + _RECONNECT_S
        with contextlib.suppress(OSError):
            connection = self._connect()
            self._tell(Severity.INFO, f"{self._way} answers again.")
            return connection
        return None


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


def _udp_socket() -> socket.socket:
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.settimeout(0.1)
    return udp
