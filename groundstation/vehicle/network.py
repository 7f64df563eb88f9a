"""Ways to a vehicle over a network: UDP, TCP."""

from __future__ import annotations

import contextlib
import socket
import time

from groundstation.messages import Severity
from groundstation.vehicle.transport import Tell, TransportError, Url

_DATAGRAM = 65_536
_PEER_SILENT_S = 5.0
_RECONNECT_S = 1.0
# A vehicle that is silent for so long is on its own in any case (`safety.link_lost_s`), ms.
_STALLED_MS = 1_500


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


def _udp_socket() -> socket.socket:
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.settimeout(0.1)
    return udp
