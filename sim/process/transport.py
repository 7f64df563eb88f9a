"""How bytes reach the vehicle: UDP, TCP and serial ports, opened from a URL. Nothing here ever waits.

Names are seen from the vehicle: `udpout://HOST:PORT` and `tcpout://HOST:PORT` speak first, to a ground station that
listens there; `udpin://[HOST:]PORT` and `tcpin://[HOST:]PORT` wait for one, and without HOST on this machine only.
"""

from __future__ import annotations

import contextlib
import errno
import re
import socket
from collections.abc import Callable, Iterator
from math import inf
from time import monotonic
from typing import Literal, NamedTuple, Protocol

LOOPBACK = "127.0.0.1"
Scheme = Literal["udpout", "udpin", "tcpout", "tcpin", "serial"]
Clock = Callable[[], float]

_NETWORK = re.compile(r"^(udpout|udpin|tcpout|tcpin)://(?:([^:/\s]*):)?([^:/\s]*)$")
_SERIAL = re.compile(r"^serial://(/[^:\s]+|[A-Za-z]+\d+):(\d{3,8})$")
_FORMS = (
    "udpout://HOST:PORT, udpin://[HOST:]PORT, tcpout://HOST:PORT, tcpin://[HOST:]PORT or serial://DEVICE:BAUD"
)
_LAST_PORT = 65535
_BYTES = 65536
_BURST = 256
# A peer is answered for so long after it last spoke; ground stations send a heartbeat each second.
PEER_S = 10.0
_PEERS = 8
# A port that refused is taken for closed for so long: longer than from one heartbeat to the next.
REFUSED_S = 1.5
RECONNECT_S = 1.0


class TransportError(Exception):
    """A connection cannot be made; the message is one sentence with what, where and what to do."""


class Url(NamedTuple):
    """A parsed URL: `place` is a host or a serial port, `number` a port or a baud rate."""

    scheme: Scheme
    place: str
    number: int

    def __str__(self) -> str:
        return f"{self.scheme}://{self.place}:{self.number}"

    def shifted(self, by: int) -> Url:
        """Return the URL of the vehicle that comes `by` after the first: its port counts up, a free one (0) stays.

        Raises:
            TransportError: There is no such port, or only one serial port.
        """
        if by == 0 or (self.number == 0 and self.scheme != "serial"):
            return self
        if self.scheme == "serial":
            raise TransportError(f"{self}: a serial port carries one vehicle; leave --instances out.")
        if self.number + by > _LAST_PORT:
            raise TransportError(f"{self}: vehicle {by + 1} would need port {self.number + by}; start lower.")
        return self._replace(number=self.number + by)


class Transport(Protocol):
    """A connection to ground stations.

    Attributes:
        url: Where it leads, with the port that was really taken.
        whole: What arrives are datagrams, not pieces of a stream.
    """

    url: Url
    whole: bool

    @property
    def heard(self) -> bool:
        """Somebody may be listening; False is certain."""
        ...

    def receive(self) -> Iterator[bytes]:
        """Yield what has arrived."""
        ...

    def send(self, data: bytes) -> None:
        """Send, or lose it: nobody may be listening, which is no error for a vehicle."""
        ...

    def close(self) -> None:
        """Let the connection go."""
        ...


class UdpOut:
    """UDP to one ground station.

    Args:
        url: Where it listens.
        clock: Monotonic seconds.
    """

    whole = True

    def __init__(self, url: Url, clock: Clock = monotonic) -> None:
        self.url = url
        self._clock = clock
        self._refused_t = -inf
        self._socket = _udp_socket(socket.socket.connect, url)

    @property
    def heard(self) -> bool:
        """The port has not said lately that it is closed (on this machine, that is; others may keep silent)."""
        return self._clock() - self._refused_t > REFUSED_S

    def receive(self) -> Iterator[bytes]:
        """Yield datagrams of the ground station, and of nobody else."""
        for _ in range(_BURST):
            try:
                data = self._socket.recv(_BYTES)
            except ConnectionRefusedError:
                # An echo of a datagram that found nobody; the next may.
                self._refused_t = self._clock()
                continue
            except OSError:
                return
            self._refused_t = -inf
            yield data

    def send(self, data: bytes) -> None:
        """Send a datagram."""
        try:
            self._socket.send(data)
        except ConnectionRefusedError:
            self._refused_t = self._clock()
        except OSError:
            return

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class UdpIn:
    """UDP from all who have spoken within the last ten seconds, at most eight: each hears everything.

    Args:
        url: Address to listen on; port 0 takes a free one.
        clock: Monotonic seconds.
    """

    whole = True

    def __init__(self, url: Url, clock: Clock = monotonic) -> None:
        self._clock = clock
        self._peers: dict[tuple[str, int], float] = {}
        self._socket = _udp_socket(socket.socket.bind, url)
        self.url = url._replace(number=int(self._socket.getsockname()[1]))

    @property
    def heard(self) -> bool:
        """Somebody has spoken lately."""
        return bool(self._peers)

    def receive(self) -> Iterator[bytes]:
        """Yield datagrams, and keep in mind who sent them."""
        now = self._clock()
        for peer, spoke_t in list(self._peers.items()):
            if now - spoke_t > PEER_S:
                del self._peers[peer]
        for _ in range(_BURST):
            try:
                data, peer = self._socket.recvfrom(_BYTES)
            except ConnectionRefusedError:
                continue
            except OSError:
                return
            if peer not in self._peers and len(self._peers) >= _PEERS:
                del self._peers[min(self._peers, key=self._peers.__getitem__)]
            self._peers[peer] = now
            yield data

    def send(self, data: bytes) -> None:
        """Send a datagram to every peer."""
        for peer in self._peers:
            with contextlib.suppress(OSError):
                self._socket.sendto(data, peer)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class TcpIn:
    """TCP from one ground station at a time; a new one takes the place of the last.

    Args:
        url: Address to listen on; port 0 takes a free one.
    """

    whole = False

    def __init__(self, url: Url) -> None:
        self._listener = socket.create_server((url.place, url.number))
        self._listener.setblocking(False)  # noqa: FBT003
        self.url = url._replace(number=int(self._listener.getsockname()[1]))
        self._client: socket.socket | None = None

    @property
    def heard(self) -> bool:
        """Somebody is connected."""
        return self._client is not None

    def receive(self) -> Iterator[bytes]:
        """Yield what the client sent."""
        with contextlib.suppress(OSError):
            client, _ = self._listener.accept()
            self._drop()
            _prepare(client)
            self._client = client
        while self._client is not None and (data := _read(self._client)) is not None:
            if not data:
                self._drop()
                return
            yield data

    def send(self, data: bytes) -> None:
        """Send to the client; one that does not read is let go, for a cut frame would spoil its stream."""
        if self._client is not None and not _write(self._client, data):
            self._drop()

    def close(self) -> None:
        """Close both sockets."""
        self._drop()
        self._listener.close()

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None


class TcpOut:
    """TCP to a ground station that listens; tried again every second until it does, and after it has gone.

    Args:
        url: Where it listens.
        clock: Monotonic seconds.
    """

    whole = False

    def __init__(self, url: Url, clock: Clock = monotonic) -> None:
        self.url = url
        self._clock = clock
        self._address = socket.getaddrinfo(url.place, url.number, socket.AF_INET, socket.SOCK_STREAM)[0][4]
        self._socket: socket.socket | None = None
        self._connected = False
        self._tried_t = -inf

    @property
    def heard(self) -> bool:
        """The connection stands."""
        return self._connected

    def receive(self) -> Iterator[bytes]:
        """Yield what the ground station sent."""
        if not self._connected:
            self._connect()
        while self._connected and self._socket is not None and (data := _read(self._socket)) is not None:
            if not data:
                self.close()
                return
            yield data

    def send(self, data: bytes) -> None:
        """Send; a ground station that does not read is let go, for a cut frame would spoil its stream."""
        if self._connected and self._socket is not None and not _write(self._socket, data):
            self.close()

    def close(self) -> None:
        """Close the connection; receiving opens it again."""
        self._connected = False
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _connect(self) -> None:
        """Begin to connect, or look whether it is done; a second call on one socket tells."""
        now = self._clock()
        if self._socket is None:
            if now - self._tried_t < RECONNECT_S:
                return
            self._tried_t = now
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
            _prepare(self._socket)
        try:
            self._socket.connect(self._address)
        except BlockingIOError:
            return
        except OSError as error:
            if error.errno == errno.EALREADY:
                return
            if error.errno != errno.EISCONN:
                self.close()
                return
        self._connected = True


def parse_url(text: str) -> Url:
    """Parse a connection's URL.

    Raises:
        TransportError: It is none of ours; the message says how they look.
    """
    if found := _SERIAL.match(text):
        return Url("serial", found[1], int(found[2]))
    found = _NETWORK.match(text)
    if found is None:
        raise TransportError(f"{text}: is not a connection; give {_FORMS}.")
    host, port = found[2] or "", found[3]
    if not port.isascii() or not port.isdigit() or int(port) > _LAST_PORT:
        raise TransportError(f"{text}: {port!r} is not a port from 0 to {_LAST_PORT}; give {_FORMS}.")
    scheme: Scheme = found[1]  # pyright: ignore[reportAssignmentType]  # the pattern has no others
    if scheme in ("udpout", "tcpout") and (not host or int(port) == 0):
        raise TransportError(f"{text}: names nobody to speak to; give {scheme}://HOST:PORT.")
    return Url(scheme, host or LOOPBACK, int(port))


def open_transport(url: Url) -> Transport:
    """Open the connection a URL names.

    Raises:
        TransportError: Its address cannot be used.
    """
    try:
        if url.scheme == "serial":
            from sim.process.serial_port import SerialPort

            return SerialPort(url)
        return {"udpout": UdpOut, "udpin": UdpIn, "tcpout": TcpOut, "tcpin": TcpIn}[url.scheme](url)
    except OSError as error:
        raise TransportError(
            f"{url}: cannot be opened ({error.strerror or error}); check the address, or take another port."
        ) from error


def _udp_socket(begin: Callable[[socket.socket, tuple[str, int]], None], url: Url) -> socket.socket:
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.setblocking(False)  # noqa: FBT003
    try:
        begin(udp, (url.place, url.number))
    except OSError:
        udp.close()
        raise
    return udp


def _prepare(stream: socket.socket) -> None:
    stream.setblocking(False)  # noqa: FBT003
    stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def _read(stream: socket.socket) -> bytes | None:
    """Return what has come, b"" when the other side has gone, or None when there is nothing now."""
    try:
        return stream.recv(_BYTES)
    except BlockingIOError:
        return None
    except OSError:
        return b""


def _write(stream: socket.socket, data: bytes) -> bool:
    """Send all of it, or say that it could not be."""
    try:
        return stream.send(data) == len(data)
    except OSError:
        return False
