"""Asks the system to run this thread before all ordinary ones, and says how to allow it where it does not."""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from pathlib import Path

PRIORITY = 50
# The shortest time slice Linux gives, ns (kernel/sched/syscalls.c: 0.1 to 100 ms).
_SLICE_NS = 100_000
# From Linux's syscall tables and prctl.h.
_SCHED_SETATTR = {"x86_64": 314, "aarch64": 274}
_PR_SET_TIMERSLACK = 29


def request_realtime() -> str:
    """Ask for SCHED_FIFO for this thread.

    Returns:
        "" where it is granted, else a sentence for the user on what is missing and how to grant it.
    """
    if sys.platform != "linux":
        return "The servo has no real-time priority, which it can ask for on Linux only; ticks may be late."
    # Ordinary threads may be woken 50 µs late, to save power; this one not (prctl(2), PR_SET_TIMERSLACK, ns).
    ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, ctypes.c_ulong(1), 0, 0, 0)
    try:
        # A thread or process that this one starts, as to open a device, is an ordinary one.
        policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
        os.sched_setscheduler(0, policy, os.sched_param(PRIORITY))
    except PermissionError:
        _request_short_slice()
        return (
            "The servo runs without real-time priority and may be late on a busy machine; to grant it: "
            f"sudo setcap cap_sys_nice+ep {Path(sys.executable).resolve()}"
            f", or rtprio {PRIORITY} in /etc/security/limits.conf."
        )
    return ""


class _SchedAttr(ctypes.Structure):
    """`struct sched_attr` in its first version, sched_setattr(2)."""

    _fields_ = (
        ("size", ctypes.c_uint32),
        ("policy", ctypes.c_uint32),
        ("flags", ctypes.c_uint64),
        ("nice", ctypes.c_int32),
        ("priority", ctypes.c_uint32),
        ("runtime", ctypes.c_uint64),
        ("deadline", ctypes.c_uint64),
        ("period", ctypes.c_uint64),
    )


def _request_short_slice() -> None:
    """Ask to run for short slices but soon: who asks for less at a time is let in earlier (EEVDF, Linux 6.12 on).

    Anybody may; an older kernel takes no notice.
    """
    number = _SCHED_SETATTR.get(platform.machine())
    if number is None:
        return
    attributes = _SchedAttr(size=ctypes.sizeof(_SchedAttr), policy=os.SCHED_OTHER, runtime=_SLICE_NS)
    ctypes.CDLL(None).syscall(number, 0, ctypes.byref(attributes), 0)
