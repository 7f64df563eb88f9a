"""Makes text of what a vehicle says where it is none: MAVSDK drops words that are not UTF-8, and an alarm with them.

A cut in the middle of a letter is enough. Control characters go as well: what is said is shown on terminals. Layouts
and CRC_EXTRA are those of MAVLink's common.xml (https://mavlink.io/en/messages/common.html).
"""

from __future__ import annotations

from typing import NamedTuple

from pymavlink.dialects.v20.minimal import x25crc

from groundstation.vehicle.gate import message_number

_V2 = 0xFD


class _Text(NamedTuple):
    """Where a message's text is in its payload, and what its CRC ends with."""

    start: int
    end: int
    crc_extra: int


# STATUSTEXT and PARAM_VALUE.
_TEXTS = {253: _Text(1, 51, 83), 22: _Text(8, 24, 220)}


def legible(frame: bytes) -> bytes:
    """Return a frame as it is, or, where its text cannot be shown, with question marks and spaces in that."""
    text = _TEXTS.get(message_number(frame))
    if text is None:
        return frame
    header = 10 if frame[0] == _V2 else 6
    start, end = header + text.start, min(header + text.end, header + frame[1])
    said = frame[start:end]
    shown = _shown(said)
    # A frame that was broken on its way stays broken.
    if shown == said or _crc(frame, text) != frame[header + frame[1] : header + frame[1] + 2]:
        return frame
    mended = frame[:start] + shown + frame[end:]
    crc = _crc(mended, text)
    return mended[: header + frame[1]] + crc + frame[header + frame[1] + 2 :]


def _shown(said: bytes) -> bytes:
    """Return text of the same length in bytes; what is behind its end (a zero byte) stays."""
    words, end, rest = said.partition(b"\0")
    letters = words.decode(errors="surrogateescape")
    return "".join(each if each.isprintable() else _instead(each) for each in letters).encode() + end + rest


def _instead(letter: str) -> str:
    # PX4 ends what it says with a tab where it says it in other words as well.
    return (" " if letter.isspace() else "?") * len(letter.encode(errors="surrogateescape"))


def _crc(frame: bytes, text: _Text) -> bytes:
    header = 10 if frame[0] == _V2 else 6
    covered = frame[1 : header + frame[1]] + bytes((text.crc_extra,))
    return x25crc(covered).crc.to_bytes(2, "little")
