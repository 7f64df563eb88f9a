"""Frames in and out: finding messages in bytes that may be garbage, and packing messages into datagrams."""

from __future__ import annotations

import struct
from collections.abc import Iterator

from pymavlink.dialects.v20 import common as dialect

from sim.mavlink.signing import Signing

# A datagram stays below the usual MTU.
DATAGRAM_BYTES = 1200
AUTOPILOT_COMPONENT = 1
_V1, _V2 = 0xFE, 0xFD
_SIGNED = 0x01
_SIGNATURE_BYTES = 13
_STATUSTEXT_BYTES = 50


class Inbox:
    """Takes bytes apart into messages; what is not a whole, right frame is passed over, and what is not trusted too.

    Args:
        signing: Whom to trust; everybody unless given.
    """

    def __init__(self, signing: Signing | None = None) -> None:
        self._decoder = dialect.MAVLink(None)
        self._signing = signing
        self._buffer = bytearray()

    def messages(self, data: bytes, *, whole: bool) -> Iterator[dialect.MAVLink_message]:
        """Yield the messages in `data`.

        Args:
            data: Bytes as they came.
            whole: Frames do not go on in the next data (a datagram): then a cut frame is forgotten.
        """
        buffer = self._buffer
        buffer += data
        start = 0
        while (length := _frame_length(buffer, start)) is not None:
            frame = buffer[start : start + length]
            if len(frame) < length:
                if not whole:
                    break
                start += 1
                continue
            message = self._decoded(frame)
            start += length if message else 1
            if message and (self._signing is None or self._signing.trusts(frame, message)):
                yield message
        del buffer[: len(buffer) if whole else start]

    def _decoded(self, frame: bytearray) -> dialect.MAVLink_message | None:
        if len(frame) <= 1:
            return None
        try:
            message = self._decoder.decode(frame)
        except (dialect.MAVError, struct.error):
            return None
        # An unknown message's checksum cannot be verified; it may be garbage with frames in it.
        return None if isinstance(message, dialect.MAVLink_unknown) else message


def _frame_length(buffer: bytearray, start: int) -> int | None:
    """Return the length a frame at `start` would have, 1 where none can begin, or None at the buffer's end."""
    if start >= len(buffer):
        return None
    magic, rest = buffer[start], len(buffer) - start
    if magic == _V1:
        return 8 + (buffer[start + 1] if rest > 1 else 0)
    if magic != _V2:
        return 1
    flags = buffer[start + 2] if rest > 2 else 0
    if flags & ~_SIGNED:
        return 1
    return 12 + (buffer[start + 1] if rest > 1 else 0) + (_SIGNATURE_BYTES if flags else 0)


class Outbox:
    """Packs messages in order, signs them where there is a key, and joins them into datagrams.

    Args:
        system_id: Of the vehicle.
        signing: Its key; nothing is signed unless given.
        link_id: Told in signatures.
    """

    def __init__(self, system_id: int, signing: Signing | None = None, link_id: int = 0) -> None:
        self._packer = dialect.MAVLink(None, srcSystem=system_id, srcComponent=AUTOPILOT_COMPONENT)
        self._packer.signing.link_id = link_id
        self._signing = signing
        self._frames: list[bytes] = []
        self._text_id = 0

    def send(self, message: dialect.MAVLink_message) -> None:
        """Queue a message."""
        if self._signing is not None:
            self._prepare_signature(self._signing)
        self._frames.append(message.pack(self._packer))
        self._packer.seq = (self._packer.seq + 1) % 256

    def _prepare_signature(self, signing: Signing) -> None:
        state = self._packer.signing
        state.secret_key, state.sign_outgoing = signing.key, signing.key is not None
        if state.sign_outgoing:
            state.timestamp = signing.timestamp()

    def say(self, severity: int, text: str) -> None:
        """Queue a STATUSTEXT, in chunks where it is too long for one; the last, never full, ends the text."""
        data = text.encode("ascii", errors="replace")
        if len(data) <= _STATUSTEXT_BYTES:
            self.send(dialect.MAVLink_statustext_message(severity, data))
            return
        self._text_id = self._text_id % 0xFFFF + 1
        for chunk, begin in enumerate(range(0, len(data) + 1, _STATUSTEXT_BYTES)):
            part = data[begin : begin + _STATUSTEXT_BYTES]
            self.send(dialect.MAVLink_statustext_message(severity, part, self._text_id, chunk))

    def take(self) -> list[bytes]:
        """Return what is queued as datagrams, and forget it."""
        datagrams: list[bytes] = []
        joined = bytearray()
        for frame in self._frames:
            if joined and len(joined) + len(frame) > DATAGRAM_BYTES:
                datagrams.append(bytes(joined))
                joined.clear()
            joined += frame
        if joined:
            datagrams.append(bytes(joined))
        self._frames.clear()
        return datagrams
