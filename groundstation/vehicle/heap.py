"""The link's memory: what MAVSDK's threads took and gave back goes back to the system.

glibc keeps an arena of memory for each thread. What MAVSDK's threads take from theirs and ours give back is not found
again, 2 MB a minute; and from one arena for all, freed pages are given back only from its end.
"""

from __future__ import annotations

import contextlib
import ctypes

_M_ARENA_MAX = -8
_EVERY_S = 20.0


def take_one_arena() -> None:
    """Have all threads take their memory from one place, where the C library lets them (mallopt(3))."""
    with contextlib.suppress(AttributeError, OSError):
        ctypes.CDLL(None).mallopt(_M_ARENA_MAX, 1)


class Trimmer:
    """Gives back what is free within the heap, now and then: 0.3 ms each time (malloc_trim(3))."""

    def __init__(self) -> None:
        self._next = 0.0
        self._library: ctypes.CDLL | None = None
        with contextlib.suppress(AttributeError, OSError):
            library = ctypes.CDLL(None)
            if hasattr(library, "malloc_trim"):
                self._library = library

    def look(self, now: float) -> None:
        """Give back if it is due, at monotonic s."""
        if self._library is not None and now >= self._next:
            self._next = now + _EVERY_S
            self._library.malloc_trim(0)
