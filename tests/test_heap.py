"""What the C library is told about memory, seen in the marks that glibc keeps before each of its blocks."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="glibc's heap")

# Before a block stands its size, whose lowest bits say where it lies: malloc/malloc.c of glibc, "IS_MMAPPED".
_ASKS = """
import ctypes, sys, threading
from groundstation import heap
libc = ctypes.CDLL(None)
libc.malloc.restype = ctypes.c_void_p
libc.free.argtypes = (ctypes.c_void_p,)
BY_ITSELF, OF_A_THREAD = 2, 4

def marked(size, mark):
    block = libc.malloc(size)
    found = bool(ctypes.c_size_t.from_address(block - 8).value & mark)
    libc.free(block)
    return found

if "arranged" in sys.argv:
    heap.arrange()
libc.free(libc.malloc(4 << 20))
# Larger than any hole that is there already: those are filled first.
large = marked(2 << 20, BY_ITSELF)
small = marked(1 << 10, BY_ITSELF)
threads = []
thread = threading.Thread(target=lambda: threads.append(marked(3 << 10, OF_A_THREAD)))
thread.start()
thread.join()
print(large, small, threads[0])
"""


def _asked(*words: str) -> list[bool]:
    told = subprocess.run(
        [sys.executable, "-c", _ASKS, *words], capture_output=True, text=True, check=True, timeout=60
    )
    return [word == "True" for word in told.stdout.split()]


def test_what_is_large_lies_by_itself_and_threads_take_from_the_one_arena():
    assert _asked("arranged") == [True, False, False]


def test_by_itself_the_library_lets_a_freed_block_raise_its_limit_and_gives_each_thread_an_arena():
    assert _asked() == [False, False, True]
