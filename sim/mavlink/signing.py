"""MAVLink 2 signing: which frames are to be trusted, and the signatures of our own.

Source: MAVLink guide, "Message Signing (Authentication)". Who may change the key is PX4's rule (its guide, "MAVLink
Message Signing"): anybody while there is none, afterwards only who has it, and nobody while the vehicle is armed.
"""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from hmac import compare_digest

from pymavlink.dialects.v20 import common as m

KEY_BYTES = 32
_V2, _SIGNED = 0xFD, 0x01
_BLOCK, _HASH = 13, 6
# Timestamps count 10 µs since 2015-01-01 UTC.
_EPOCH_UNIX_S = 1_420_070_400
_TICKS_PER_S = 100_000
# A stream not heard before may be this far behind.
_LATE_TICKS = 60 * _TICKS_PER_S
_STREAMS = 16
# Of the 48 bits that a timestamp has, half: what is later (than 2059) leaves no room to go on counting.
_LATEST = 1 << 47
# Said by those who cannot sign and heard for safety's sake: PX4's list.
_UNSIGNED = frozenset(
    (
        m.MAVLINK_MSG_ID_HEARTBEAT,
        m.MAVLINK_MSG_ID_RADIO_STATUS,
        m.MAVLINK_MSG_ID_ADSB_VEHICLE,
        m.MAVLINK_MSG_ID_COLLISION,
    )
)


class Signing:
    """The key of a vehicle, and what was heard under it.

    Args:
        unix_time: Returns the wall-clock time, s since 1970.
        key: 32 bytes, or None: nothing is signed and everything is heard.

    Raises:
        ValueError: The key has another length.
    """

    def __init__(self, unix_time: Callable[[], float], key: bytes | None = None) -> None:
        if key is not None and len(key) != KEY_BYTES:
            raise ValueError(f"a signing key has {KEY_BYTES} bytes, this one {len(key)}.")
        self.key = key
        self._unix_time = unix_time
        self._newest = 0
        self._streams: dict[tuple[int, int, int], int] = {}

    def set_key(self, key: bytes, timestamp: int) -> None:
        """Take the key and timestamp of a SETUP_SIGNING; all zero ends signing, a time without room is not taken."""
        if timestamp >= _LATEST:
            return
        self.key = key if any(key) or timestamp else None
        self._newest = max(self._newest, timestamp) if self.key else 0
        self._streams.clear()

    def timestamp(self) -> int:
        """Return the next of ours, later than any before and than any that was heard."""
        self._newest = max(self._newest + 1, self._now())
        return self._newest

    def _now(self) -> int:
        return int((self._unix_time() - _EPOCH_UNIX_S) * _TICKS_PER_S)

    def trusts(self, frame: bytes | bytearray, message: m.MAVLink_message) -> bool:
        """Say whether a frame is to be heard: well signed and new, or of the few that need no signature."""
        if self.key is None or message.get_msgId() in _UNSIGNED:
            return True
        signed = frame[0] == _V2 and frame[2] & _SIGNED
        return bool(signed) and self._well_signed(self.key, bytes(frame), message)

    def _well_signed(self, key: bytes, frame: bytes, message: m.MAVLink_message) -> bool:
        block = frame[-_BLOCK:]
        timestamp = int.from_bytes(block[1:7], "little")
        stream = (block[0], message.get_srcSystem(), message.get_srcComponent())
        before = self._streams.get(stream)
        if before is None:
            newest = max(self._newest, self._now())
            if len(self._streams) >= _STREAMS or timestamp < newest - _LATE_TICKS:
                return False
        elif timestamp <= before:
            return False
        if timestamp >= _LATEST:
            return False
        if not compare_digest(sha256(key + frame[:-_HASH]).digest()[:_HASH], block[-_HASH:]):
            return False
        self._streams[stream] = timestamp
        self._newest = max(self._newest, timestamp)
        return True
