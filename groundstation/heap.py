"""The C library's memory: what threads took and gave back goes back to the system.

glibc keeps an arena of memory for each thread. What one thread takes from its own and another gives back is not found
again: in the link, with MAVSDK's threads, 2 MB a minute. From one arena for all, freed pages are given back by
themselves only from its end.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
from collections.abc import Callable

# How often what is free is worth giving back, s.
GIVE_BACK_S = 20.0
_M_ARENA_MAX = -8


def take_one_arena() -> None:
    """Have all threads take their memory from one place, where the C library lets them (mallopt(3))."""
    with contextlib.suppress(AttributeError, OSError):
        ctypes.CDLL(None).mallopt(_M_ARENA_MAX, 1)


def give_back() -> None:
    """Give free pages back to the system, where the C library can: some tenths of a millisecond (malloc_trim(3))."""
    if trim := _trim():
        trim(0)


@functools.cache
def _trim() -> Callable[[int], object] | None:
    with contextlib.suppress(AttributeError, OSError):
        return ctypes.CDLL(None).malloc_trim
    return None
