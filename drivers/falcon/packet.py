"""The Falcon's packets: 16 bytes each way, strictly request and reply.

| byte | request | reply |
|---|---|---|
| 0 | `<` | `<` |
| 1-12 | three motors' counts, int16 | three encoders' counts, int16 |
| 13 | homing 1, green 2, blue 4, red 8 | low nibble: grip buttons; bits 4-6: homed, one a leg |
| 14 | 0 | 0 |
| 15 | `>` | `>` |

An int16 is four nibbles, the lowest first. Bytes 1 to 14 are sent plus 0x41, so that no packet holds a `<` or a
`>` but at its ends, which is what finds the next packet after lost bytes. Source: libnifalcon's
`FalconFirmwareNovintSDK`.
"""

from __future__ import annotations

import re
from typing import NamedTuple

Counts = tuple[int, int, int]
NO_FORCE: Counts = (0, 0, 0)

SIZE = 16
OFFSET = 0x41
HOMING, GREEN, BLUE, RED = 1, 2, 4, 8
ALL_LEGS = 0b111
LARGEST_FORCE = 4095
"""Counts at which the vendor's driver saturates."""

_REQUEST = re.compile(rb"<([A-P]{12})([A-P])A>")
_REPLY = re.compile(rb"<([A-P]{12})([A-\xc0])A>")
_PAIRS = [bytes((OFFSET + (byte & 15), OFFSET + (byte >> 4))) for byte in range(256)]
_BYTES = {pair: byte for byte, pair in enumerate(_PAIRS)}


class Request(NamedTuple):
    """What the host tells the device.

    Attributes:
        forces: Counts of the motors, within ±4095.
        lights: `GREEN`, `BLUE`, `RED`, or a sum of them.
        homing: The device shall find its reference marks; without it the handle is not homed.
    """

    forces: Counts
    lights: int = 0
    homing: bool = True


class Reply(NamedTuple):
    """What the device tells the host.

    Attributes:
        encoders: Counts of the encoders; they mean an angle once the legs are homed.
        buttons: 1 plus, 2 forward, 4 centre, 8 minus.
        legs: One bit for each homed leg.
    """

    encoders: Counts
    buttons: int
    legs: int


def encode_request(request: Request) -> bytes:
    """Return the 16 bytes of a request.

    Raises:
        ValueError: A force does not fit: as an int16 that wraps it would throw the handle the other way.
    """
    if max(map(abs, request.forces)) > LARGEST_FORCE:
        raise ValueError(f"{request.forces} counts of force; the motors take {LARGEST_FORCE}.")
    return _packet(request.forces, request.lights & 0b1110 | request.homing)


def encode_reply(reply: Reply) -> bytes:
    """Return the 16 bytes of a reply; what does not fit 16, 4 and 3 bits is cut off."""
    return _packet(reply.encoders, reply.buttons & 15 | (reply.legs & ALL_LEGS) << 4)


class Reader:
    """Finds packets in a stream of bytes, whatever was lost in it. `requests` at the device, `replies` here.

    Attributes:
        passed_over: Bytes that belonged to no packet.
    """

    def __init__(self) -> None:
        self._rest = b""
        self.passed_over = 0

    def requests(self, data: bytes) -> list[Request]:
        """Return the requests that `data` completes."""
        return [
            Request(_counts(body), flags[0] - OFFSET & 0b1110, bool(flags[0] - OFFSET & HOMING))
            for body, flags in self._split(_REQUEST, data)
        ]

    def replies(self, data: bytes) -> list[Reply]:
        """Return the replies that `data` completes."""
        return [
            Reply(_counts(body), flags[0] - OFFSET & 15, flags[0] - OFFSET >> 4)
            for body, flags in self._split(_REPLY, data)
        ]

    def reset(self) -> None:
        """Forget the beginning of a packet."""
        self._rest = b""

    def _split(self, pattern: re.Pattern[bytes], data: bytes) -> list[tuple[bytes, bytes]]:
        data = self._rest + data
        found = pattern.findall(data)
        begin = data.rfind(b"<")
        self._rest = b"" if begin < 0 or len(data) - begin >= SIZE else data[begin:]
        self.passed_over += len(data) - len(self._rest) - SIZE * len(found)
        return found


def _packet(counts: Counts, flags: int) -> bytes:
    a, b, c = counts
    pairs = _PAIRS
    return b"<%b%b%b%b%b%b%cA>" % (
        pairs[a & 255], pairs[a >> 8 & 255],
        pairs[b & 255], pairs[b >> 8 & 255],
        pairs[c & 255], pairs[c >> 8 & 255],
        flags + OFFSET,
    )  # fmt: skip


def _counts(body: bytes) -> Counts:
    byte = _BYTES
    a = byte[body[0:2]] | byte[body[2:4]] << 8
    b = byte[body[4:6]] | byte[body[6:8]] << 8
    c = byte[body[8:10]] | byte[body[10:12]] << 8
    # The two's complement of 16 bits.
    return (a ^ 0x8000) - 0x8000, (b ^ 0x8000) - 0x8000, (c ^ 0x8000) - 0x8000
