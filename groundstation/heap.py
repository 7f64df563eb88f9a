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
# Of NumPy: how many blocks of a size it keeps, and below which, bytes. Masks have any size, numbers eight bytes each.
_KEPT, _SMALL = 7, 1024
_SMALLEST, _NUMBER = 256, 8


def take_one_arena() -> None:
    """Have all threads take their memory from one place, where the C library lets them (mallopt(3))."""
    with contextlib.suppress(AttributeError, OSError):
        ctypes.CDLL(None).mallopt(_M_ARENA_MAX, 1)


def take_small_blocks() -> None:
    """Have NumPy take at once the small blocks that it keeps: some 0.9 MB, in 3 ms.

    NumPy 2 keeps up to seven freed blocks of each size under 1,024 bytes. Taken whenever a size is first met, over an
    hour, they lie between larger ones, whose pages then cannot be given back.
    """
    import numpy as np

    sizes = {*range(1, _SMALLEST), *range(_SMALLEST, _SMALL, _NUMBER)}
    kept = [np.empty(size, np.uint8) for size in sizes for _ in range(_KEPT)]
    kept.clear()


def give_back() -> None:
    """Give free pages back to the system, where the C library can: some tenths of a millisecond (malloc_trim(3))."""
    if trim := _trim():
        trim(0)


@functools.cache
def _trim() -> Callable[[int], object] | None:
    with contextlib.suppress(AttributeError, OSError):
        return ctypes.CDLL(None).malloc_trim
    return None
