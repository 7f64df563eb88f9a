"""Where MAVLink frames begin and end in bytes, without knowing what they say.

Frame lengths: https://mavlink.io/en/guide/serialization.html (versions 1 and 2, signature included).
"""

from __future__ import annotations

from collections.abc import Iterator

_V1, _V2 = 0xFE, 0xFD
_V1_AROUND, _V2_AROUND, _SIGNATURE = 8, 12, 13
_SIGNED = 0x01


class Splitter:
    """Cuts bytes into frames. What lies between them is kept too: the pieces joined are the input.

    Args:
        whole: What is given are datagrams: a frame cut off at the end does not go on in the next.
    """

    def __init__(self, *, whole: bool) -> None:
        self._whole = whole
        self._rest = b""

    def split(self, data: bytes) -> Iterator[bytes]:
        """Yield frames and what lies between them."""
        data = self._rest + data
        self._rest = b""
        begin = 0
        while begin < len(data):
            end = _end(data, begin)
            if end > len(data) and not self._whole:
                self._rest = data[begin:]
                return
            yield data[begin:end]
            begin = end

    def flush(self) -> Iterator[bytes]:
        """Yield what was kept of a frame cut off, and forget it."""
        if self._rest:
            yield self._rest
            self._rest = b""


def _end(data: bytes, begin: int) -> int:
    """Return where the frame at `begin`, or what is none, ends; beyond the data where it is cut off."""
    magic, left = data[begin], len(data) - begin
    if magic == _V1:
        return begin + _V1_AROUND + data[begin + 1] if left > 1 else begin + _V1_AROUND
    if magic == _V2:
        if left < 3:
            return begin + _V2_AROUND
        return begin + _V2_AROUND + data[begin + 1] + (_SIGNATURE if data[begin + 2] & _SIGNED else 0)
    found = [place for place in (data.find(_V1, begin), data.find(_V2, begin)) if place >= 0]
    return min(found, default=len(data))
