"""The C library's memory: what threads took and gave back goes back to the system.

glibc keeps an arena of memory for each thread. What one thread takes from its own and another gives back is not found
again: in the link, with MAVSDK's threads, 2 MB a minute. From one arena for all, freed pages are given back by
themselves only from its end. What is large is best not among the small: beside the arena it goes back at once, within
it leaves a hole that is filled with what stays.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
from collections.abc import Callable

# How often what is free is worth giving back, s.
GIVE_BACK_S = 20.0
_M_MMAP_THRESHOLD, _M_ARENA_MAX = -3, -8
# From so many bytes on a block lies by itself. Left alone, glibc raises its limit with each larger one that is freed,
# up to 32 MiB: lists, buffers and dictionaries of a moment then lie between what stays.
_LARGE = 64 * 1024
# Of NumPy: how many blocks of a size it keeps, and below which, bytes. Masks have any size, numbers eight bytes each.
_KEPT, _SMALL = 7, 1024
_SMALLEST, _NUMBER = 256, 8


def arrange() -> None:
    """Have all threads take their memory from one place, and what is large from none of it (mallopt(3)).

    Where the C library is another, nothing is done.
    """
    with contextlib.suppress(AttributeError, OSError):
        mallopt = ctypes.CDLL(None).mallopt
        mallopt(_M_ARENA_MAX, 1)
        mallopt(_M_MMAP_THRESHOLD, _LARGE)


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
