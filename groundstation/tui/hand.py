"""The on-screen stick's deflection: pure, moved by mouse and keys, read by the keepalive timer."""

from __future__ import annotations

import math
from typing import Protocol

from groundstation.frames import Vector3

Share4 = tuple[float, float, float, float]

STEP = 0.2
CENTRED: Share4 = (0.0, 0.0, 0.0, 0.0)


class StickSender(Protocol):
    """Takes the on-screen stick's deflection to the process that has the device."""

    def send(self, position: Vector3, yaw: float, buttons: int, t: float) -> bool:
        """Send a deflection: m and rad in the handle frame, at monotonic time `t`. Say whether it went."""
        ...


class Hand:
    """Where the operator wants the on-screen handle, as shares of its travel from −1 to 1.

    Axes are the handle's: forward, left, up, and yaw counter-clockwise.
    """

    def __init__(self) -> None:
        self._share = list(CENTRED)

    @property
    def share(self) -> Share4:
        """Forward, left, up, yaw, each from −1 to 1."""
        forward, left, up, yaw = self._share
        return forward, left, up, yaw

    def step(self, axis: int, direction: int) -> None:
        """Move one axis by a step, and let it stay there."""
        self.place(axis, self._share[axis] + direction * STEP)

    def place(self, axis: int, share: float) -> None:
        """Move one axis to a share of its travel; what is not a number centres it."""
        bounded = max(-1.0, min(1.0, share)) if math.isfinite(share) else 0.0
        self._share[axis] = 0.0 if abs(bounded) < 1e-9 else bounded

    def centre(self) -> None:
        """Let go: all axes to the middle at once."""
        self._share = list(CENTRED)

    def deflection(self, workspace: float, yaw_range: float) -> tuple[Vector3, float]:
        """Return the handle's position, m, within a ball of radius `workspace`, and its yaw, rad."""
        forward, left, up, yaw = self._share
        norm = math.hypot(forward, left, up)
        scale = workspace / max(norm, 1.0)
        return (forward * scale, left * scale, up * scale), yaw * yaw_range
