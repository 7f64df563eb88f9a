"""Asks the system to run this thread before all ordinary ones, and says how to allow it where it does not."""

from __future__ import annotations

import os
import sys
from pathlib import Path

PRIORITY = 50


def request_realtime() -> str:
    """Ask for SCHED_FIFO for this thread.

    Returns:
        "" where it is granted, else a sentence for the user on what is missing and how to grant it.
    """
    if sys.platform != "linux":
        return "The servo has no real-time priority, which it can ask for on Linux only; ticks may be late."
    try:
        # A thread or process that this one starts, as to open a device, is an ordinary one.
        policy = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK
        os.sched_setscheduler(0, policy, os.sched_param(PRIORITY))
    except PermissionError:
        return (
            "The servo runs without real-time priority and may be late on a busy machine; to grant it: "
            f"sudo setcap cap_sys_nice+ep {Path(sys.executable).resolve()}"
            f", or rtprio {PRIORITY} in /etc/security/limits.conf."
        )
    return ""
