"""How bytes reach the vehicle: UDP to a ground station, UDP from one, or TCP from one. Nothing here ever waits.

Names are seen from the vehicle: `udpout://HOST:PORT` speaks first to a ground station that listens there,
`udpin://[HOST:]PORT` and `tcpin://[HOST:]PORT` wait for one. Without HOST only this machine is listened to.
"""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator
from typing import Protocol

LOOPBACK = "127.0.0.1"
_BYTES = 65536
_BURST = 256
_SCHEMES = "udpout://HOST:PORT, udpin://[HOST:]PORT or tcpin://[HOST:]PORT"


class TransportError(Exception):
    """A connection cannot be made; the message is one sentence with what, where and what to do."""


class Transport(Protocol):
    """A connection to ground stations.

    Attributes:
        whole: What arrives are datagrams, not pieces of a stream.
        port: The local port, or the remote one for `udpout`.
    """

    whole: bool
    port: int

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
        host: Where it listens.
        port: Likewise.
    """

    whole = True

    def __init__(self, host: str, port: int) -> None:
        self.port = port
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)  # noqa: FBT003
        self._socket.connect((host, port))

    def receive(self) -> Iterator[bytes]:
        """Yield datagrams of the ground station, and of nobody else."""
        for _ in range(_BURST):
            try:
                yield self._socket.recv(_BYTES)
            except ConnectionRefusedError:
                continue  # An echo of a datagram that found nobody; the next may.
            except OSError:
                return

    def send(self, data: bytes) -> None:
        """Send a datagram."""
        with contextlib.suppress(OSError):
            self._socket.send(data)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class UdpIn:
    """UDP from whoever speaks last.

    Args:
        host: Address to listen on.
        port: Likewise; 0 takes a free one.
    """

    whole = True

    def __init__(self, host: str, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)  # noqa: FBT003
        self._socket.bind((host, port))
        self.port = self._socket.getsockname()[1]
        self._peer: tuple[str, int] | None = None

    def receive(self) -> Iterator[bytes]:
        """Yield datagrams; answers go to the last sender."""
        for _ in range(_BURST):
            try:
                data, self._peer = self._socket.recvfrom(_BYTES)
            except OSError:
                return
            yield data

    def send(self, data: bytes) -> None:
        """Send a datagram, once there is somebody to send to."""
        if self._peer:
            with contextlib.suppress(OSError):
                self._socket.sendto(data, self._peer)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class TcpIn:
    """TCP from one ground station at a time; a new one takes the place of the last.

    Args:
        host: Address to listen on.
        port: Likewise; 0 takes a free one.
    """

    whole = False

    def __init__(self, host: str, port: int) -> None:
        self._listener = socket.create_server((host, port))
        self._listener.setblocking(False)  # noqa: FBT003
        self.port = self._listener.getsockname()[1]
        self._client: socket.socket | None = None

    def receive(self) -> Iterator[bytes]:
        """Yield what the client sent."""
        with contextlib.suppress(BlockingIOError):
            client, _ = self._listener.accept()
            self._drop()
            client.setblocking(False)  # noqa: FBT003
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._client = client
        for _ in range(_BURST):
            if self._client is None:
                return
            try:
                data = self._client.recv(_BYTES)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if not data:
                self._drop()
                return
            yield data

    def send(self, data: bytes) -> None:
        """Send to the client; one that does not read is let go, for a cut frame would spoil its stream."""
        if self._client is None:
            return
        try:
            sent = self._client.send(data)
        except OSError:
            sent = 0
        if sent < len(data):
            self._drop()

    def close(self) -> None:
        """Close both sockets."""
        self._drop()
        self._listener.close()

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None


def open_transport(url: str) -> Transport:
    """Open the connection a URL names.

    Raises:
        TransportError: The URL is not one of ours, or its address cannot be used.
    """
    scheme, separator, address = url.partition("://")
    host, _, port_text = address.rpartition(":")
    kinds = {"udpout": UdpOut, "udpin": UdpIn, "tcpin": TcpIn}
    kind = kinds.get(scheme)
    if kind is None or not separator:
        raise TransportError(f"{url}: is not a connection; give {_SCHEMES}.")
    if not port_text.isascii() or not port_text.isdigit() or int(port_text) > 65535:
        raise TransportError(f"{url}: {port_text!r} is not a port from 0 to 65535; give {_SCHEMES}.")
    port = int(port_text)
    if kind is UdpOut and (not host or port == 0):
        raise TransportError(f"{url}: names nobody to speak to; give udpout://HOST:PORT.")
    try:
        return kind(host or LOOPBACK, port)
    except OSError as error:
        raise TransportError(
            f"{url}: cannot be opened ({error.strerror or error}); check host and port."
        ) from error
