"""Loaded by every process of a flight under test: at SIGUSR1 it holds the interpreter's lock, as hung code does."""

import signal

HELD_S = 8


def _hold(_number, _frame):
    import ctypes

    # PyDLL, unlike CDLL, keeps the lock during the call.
    ctypes.PyDLL(None).sleep(HELD_S)


signal.signal(signal.SIGUSR1, _hold)
