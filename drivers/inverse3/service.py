"""Finding Haply's Inverse Service: its address, its version, and the snapshot it greets with."""

from __future__ import annotations

import time
from http.client import HTTPConnection, HTTPException
from typing import NamedTuple

from drivers.device import DeviceError
from drivers.inverse3 import messages
from drivers.inverse3.messages import Dialect, Message
from drivers.inverse3.websocket import WebSocket

HOST = "localhost"
PORTS = (10001, 10000)
"""Where the service listens by default: since 3.1, and before."""

PATIENCE_S = 0.5
"""Longest wait for each of: the version, the connection, the snapshot."""


class Address(NamedTuple):
    """What the user means: services to try, and a device's id or ""."""

    services: tuple[tuple[str, int], ...]
    device_id: str


def parse(address: str) -> Address:
    """Return what an address means.

    Raises:
        DeviceError: The port is none.
    """
    if ":" not in address:
        return Address(tuple((HOST, port) for port in PORTS), address)
    service, _, device_id = address.partition("/")
    host, _, port = service.rpartition(":")
    if not port.isdecimal() or not 0 < int(port) < 1 << 16:
        raise DeviceError(
            f"{address}: {port!r} is no port; write inverse3:HOST:PORT, as inverse3:localhost:10001."
        )
    return Address(((host.strip("[]") or HOST, int(port)),), device_id)


def version(host: str, port: int) -> Dialect | None:
    """Return the dialect of a service by the version it tells, or None where it tells none in time."""
    for path in ("/version", "/3.0/version"):
        http = HTTPConnection(host, port, timeout=PATIENCE_S / 2)
        try:
            http.request("GET", path)
            answer = http.getresponse().read()
        except (OSError, HTTPException):
            return None
        finally:
            http.close()
        if dialect := messages.dialect_of(answer):
            return dialect
    return None


def connect(address: Address, patience: float = PATIENCE_S) -> tuple[tuple[str, int], WebSocket, Message]:
    """Return the first service that there is, the connection to it, and its snapshot.

    Raises:
        DeviceError: None listens there, it says no snapshot, or `wsproto` is missing.
    """
    for where in address.services:
        try:
            connection = WebSocket(*where, patience)
        except DeviceError:
            if where == address.services[-1]:
                raise
            continue
        try:
            return where, connection, _snapshot(connection, patience)
        except BaseException:
            connection.close()
            raise
    raise AssertionError("an address names at least one service")


def _snapshot(connection: WebSocket, patience: float) -> Message:
    until = time.monotonic() + patience
    while (left := until - time.monotonic()) > 0.0:
        for text in connection.receive():
            if (message := messages.decode(text)) is not None:
                return message
            raise DeviceError("The Inverse Service sends what is no snapshot; update it or this program.")
        connection.wait(left)
    raise DeviceError("The Inverse Service sends no snapshot of its devices; restart it.")
