"""The bytes' way to the vehicle: its URL, and what can be done with it; `open_transport.py` opens it.

MAVSDK never sees a socket: see `gate.py` for why.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

from groundstation.errors import InputError
from groundstation.messages import Severity

Scheme = Literal["udpin", "udpout", "tcpout", "serial"]
Tell = Callable[[Severity, str], None]

_NETWORK = re.compile(r"^(udpin|udpout|tcpout)://([^:/\s]+):(\d{1,5})$")
_SERIAL = re.compile(r"^serial://(/[^:\s]+|[A-Za-z]+\d+):(\d{3,8})$")


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
