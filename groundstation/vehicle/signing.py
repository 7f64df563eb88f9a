"""MAVLink 2 signing, on whole frames: ours are signed; of others those are heard that are well signed and new.

Source: MAVLink guide, "Message Signing (Authentication)", https://mavlink.io/en/guide/message_signing.html.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from hashlib import sha256
from hmac import compare_digest
from pathlib import Path

from msgspec import Struct

from groundstation.clock import Every
from groundstation.errors import InputError
from groundstation.vehicle.gate import origin
from sim.process.signing_key import KeyFileError
from sim.process.signing_key import read_key as read_key_file

_V2, _SIGNED = 0xFD, 0x01
_HEADER, _CRC = 10, 2
# Link id, 48 bits of timestamp, 48 bits of the hash.
_BLOCK, _HASH = 13, 6
_LINK_ID = 0
# Timestamps count 10 µs since 2015-01-01 UTC.
_EPOCH_UNIX_S = 1_420_070_400
_TICKS_PER_S = 100_000
# A stream that was not heard before may be this far behind; later it only goes on.
_LATE_TICKS = 60 * _TICKS_PER_S
# What lies in the upper half leaves no room to go on counting: nobody honest is there before 2059.
_LATEST = 1 << 47
_STREAMS = 16
_TELL_S = 10.0
# RADIO_STATUS, which a telemetry radio tells of itself: it has no key. Not heard, for whoever sends one in the
# vehicle's name would make a silent vehicle seem alive; but no reason for a warning.
NEVER_SIGNED = frozenset({109})


def read_key(path: Path) -> bytes:
    """Return the key in a file, 32 bytes.

    Raises:
        InputError: It cannot be read, others may read it, or there is too little in it.
    """
    try:
        return read_key_file(path)
    except KeyFileError as error:
        raise InputError(f"--signing-key: {error}") from error


class Times(Struct, frozen=True):
    """The timestamps that were used under a key: what is not later than they are has been said before.

    Attributes:
        newest: Of all that was sent and heard.
        streams: The newest that was heard of each: link id, system, component, timestamp.
    """

    newest: int = 0
    streams: tuple[tuple[int, int, int, int], ...] = ()


NO_TIMES = Times()


class Signing:
    """Signs and checks under one key. Called from MAVSDK's thread and from the pump's.

    Args:
        key: 32 bytes.
        unix_time: Wall-clock time, s since 1970. However it jumps, timestamps only rise.
        times: Those that were used before.
    """

    def __init__(self, key: bytes, unix_time: Callable[[], float], times: Times = NO_TIMES) -> None:
        self._key = key
        self._unix_time = unix_time
        self._newest = times.newest
        # Of older ones nothing is heard in any case.
        self._streams = {
            (link, system, component): t
            for link, system, component, t in times.streams
            if t > times.newest - _LATE_TICKS
        }
        self._lock = threading.Lock()

    def times(self) -> Times:
        """Return the timestamps used until now."""
        with self._lock:
            return Times(self._newest, tuple((*stream, t) for stream, t in self._streams.items()))

    def sign(self, frame: bytes) -> bytes:
        """Return an unsigned frame signed, or nothing where it cannot be, which is MAVLink 1."""
        if not frame or frame[0] != _V2:
            return b""
        with self._lock:
            self._newest = max(self._newest + 1, self._now())
            timestamp = self._newest
        end = _HEADER + frame[1]
        signed = _turned(frame[: end + _CRC]) + bytes((_LINK_ID,)) + timestamp.to_bytes(6, "little")
        return signed + self._hash(signed)

    def trusts(self, frame: bytes) -> bool:
        """Say whether a frame is to be heard: well signed and new."""
        if not is_signed(frame) or len(frame) != _HEADER + frame[1] + _CRC + _BLOCK:
            return False
        timestamp = int.from_bytes(frame[-_BLOCK + 1 : -_HASH], "little")
        stream = (frame[-_BLOCK], *origin(frame)[1:])
        with self._lock:
            if not self._is_new(stream, timestamp):
                return False
            if not compare_digest(self._hash(frame[:-_HASH]), frame[-_HASH:]):
                return False
            self._streams[stream] = timestamp
            self._newest = max(self._newest, timestamp)
        return True

    def _is_new(self, stream: tuple[int, int, int], timestamp: int) -> bool:
        if timestamp >= _LATEST:
            return False
        before = self._streams.get(stream)
        if before is not None:
            return timestamp > before
        return len(self._streams) < _STREAMS and timestamp >= max(self._newest, self._now()) - _LATE_TICKS

    def _now(self) -> int:
        return int((self._unix_time() - _EPOCH_UNIX_S) * _TICKS_PER_S)

    def _hash(self, data: bytes) -> bytes:
        return sha256(self._key + data).digest()[:_HASH]


class Refusals:
    """Tells how many frames were refused: the first at once, then what has come since, every ten seconds."""

    def __init__(self) -> None:
        self._told = 0
        self._every = Every(_TELL_S)

    def news(self, now: float, refused: int, *, heard: bool) -> str:
        """Return what is to be told, or "".

        Args:
            now: Monotonic s.
            refused: Frames refused so far.
            heard: Some frame was not.
        """
        more = refused - self._told
        if not more or not self._every.due(now):
            return ""
        self._told = refused
        words = (
            f"{more} frame{'s' * (more > 1)} not signed with this key {'were' if more > 1 else 'was'} refused"
        )
        return (
            f"{words}."
            if heard
            else f"{words}, and no other has come; see that the vehicle has the same key."
        )


def is_signed(frame: bytes) -> bool:
    """Say whether a frame says that it is signed, with whatever key."""
    return frame[0] == _V2 and bool(frame[2] & _SIGNED)


def without_signature(frame: bytes) -> bytes:
    """Return a frame as it was before it was signed, for logs: many signatures help to guess the key."""
    return _turned(frame[:-_BLOCK]) if is_signed(frame) else frame


def _turned(frame: bytes) -> bytes:
    """Return a frame without its signature, with the signed flag turned over and the CRC of that."""
    crc = int.from_bytes(frame[-_CRC:], "little") ^ _crc_of_flag(frame[1])
    return frame[:2] + bytes((frame[2] ^ _SIGNED,)) + frame[3:-_CRC] + crc.to_bytes(_CRC, "little")


@functools.cache
def _crc_of_flag(length: int) -> int:
    """Return what the signed flag changes in the CRC of a frame with a payload of so many bytes.

    CRC-16/MCRF4XX is linear: crc(a ⊕ b) = crc(a) ⊕ crc₀(b), with crc₀ begun at zero. So neither the message nor
    its CRC_EXTRA must be known.
    """
    crc = 0
    for byte in (0, _SIGNED, *bytes(_HEADER - 3 + length + 1)):
        low = byte ^ (crc & 0xFF)
        low = (low ^ (low << 4)) & 0xFF
        crc = (crc >> 8) ^ (low << 8) ^ (low << 3) ^ (low >> 4)
    return crc
