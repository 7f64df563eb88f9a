"""Trying a device out: which way each axis reads, and whether its forces can be felt and point the right way.

Pure: the screen shows `instruction`, hands in what it sees and what the person answers, and renders `push`.
"""

from __future__ import annotations

from enum import Enum
from math import hypot, sin, tau
from typing import NamedTuple

from drivers.device import ZERO3, DeviceInfo, HandleState, Vector3

# Share of its travel that an axis must be moved by, and by how much more than the others, to be meant.
_MEANT = 0.4
_CLEARLY = 2.0
# Share of the travel within which the handle is back in its middle.
_BACK = 0.2
_PUSH_N = 1.5
_BUZZ_HZ = 2.0
_TURN_RANGE = 0.5


class Outcome(Enum):
    """How a step went."""

    PASSED = "as it should be"
    FAILED = "wrong"
    SKIPPED = "skipped"


class Step(NamedTuple):
    """One thing to try.

    Attributes:
        name: In the summary.
        instruction: What the person shall do, or say.
        axis: 0 to 2 for x, y, z, 3 for yaw.
        sign: The reading that is right.
        felt: It is a force, which the person confirms; else a motion, which is read.
    """

    name: str
    instruction: str
    axis: int
    sign: float = 1.0
    felt: bool = False


_MOVES = (
    Step("forward", "Push the handle away from you, and let it come back.", 0),
    Step("left", "Move the handle to the left, and let it come back.", 1),
    Step("up", "Lift the handle, and let it come back.", 2),
    Step("turn left", "Turn the handle counter-clockwise seen from above, and back.", 3),
)
_FORCES = (
    Step("force forward", "Does it push your hand away from you? y or n", 0, felt=True),
    Step("force left", "Does it push your hand to the left? y or n", 1, felt=True),
    Step("force up", "Does it push your hand up? y or n", 2, felt=True),
)
_RUMBLE = (Step("rumble", "Does it shake in your hand? y or n", 0, felt=True),)


def steps_for(info: DeviceInfo) -> tuple[Step, ...]:
    """Return what there is to try on a device; one of two axes has no up."""
    axes = min(info.axes, 4)
    moves = _MOVES[:axes]
    if info.renders == "force":
        return moves + _FORCES[: min(axes, 3)]
    return moves + (_RUMBLE if info.renders == "rumble" else ())


class Trial:
    """Goes through the steps.

    Args:
        info: Of the device.

    Attributes:
        results: How each step done so far went, with words.
    """

    def __init__(self, info: DeviceInfo) -> None:
        self._info = info
        self._steps = steps_for(info)
        self._moved: str | None = None
        self._ok = False
        self.results: list[tuple[Step, Outcome, str]] = []

    @property
    def step(self) -> Step | None:
        """What is tried now, or None at the end."""
        return self._steps[len(self.results)] if len(self.results) < len(self._steps) else None

    @property
    def passed(self) -> bool:
        """Nothing was wrong, and nothing is left."""
        return self.step is None and all(outcome is not Outcome.FAILED for _, outcome, _ in self.results)

    @property
    def instruction(self) -> str:
        """What to do now."""
        return self.step.instruction if self.step else "That was all. q to leave."

    def look(self, state: HandleState) -> None:
        """Take in where the handle is: a step of motion ends when it was moved and has come back."""
        step = self.step
        if step is None or step.felt:
            return
        shares = [value / self._info.workspace for value in state.position]
        shares.append(state.yaw / _TURN_RANGE)
        axis = max(range(4), key=lambda index: abs(shares[index]))
        others = max(abs(shares[index]) for index in range(4) if index != axis)
        if abs(shares[axis]) >= _MEANT and abs(shares[axis]) >= _CLEARLY * others:
            self._ok = axis == step.axis and shares[axis] * step.sign > 0.0
            self._moved = f"reads as {'+' if shares[axis] > 0 else '-'}{('x', 'y', 'z', 'yaw')[axis]}"
        elif self._moved and hypot(*shares) < _BACK:
            self._end(Outcome.PASSED if self._ok else Outcome.FAILED, self._moved)

    def answer(self, *, yes: bool) -> None:
        """Take the person's answer to a step that is felt."""
        if self.step is not None and self.step.felt:
            self._end(Outcome.PASSED if yes else Outcome.FAILED, "felt" if yes else "not felt so")

    def skip(self) -> None:
        """Leave the step out."""
        if self.step is not None:
            self._end(Outcome.SKIPPED, "")

    def push(self, t: float) -> Vector3:
        """Return the force to render at monotonic time `t`, s: pulses along the axis, in the handle frame, N."""
        step = self.step
        if step is None or not step.felt:
            return ZERO3
        size = _PUSH_N * max(0.0, sin(tau * _BUZZ_HZ / 4.0 * t))
        return (
            (size, 0.0, 0.0) if step.axis == 0 else (0.0, size, 0.0) if step.axis == 1 else (0.0, 0.0, size)
        )

    def _end(self, outcome: Outcome, words: str) -> None:
        if self.step is not None:
            self.results.append((self.step, outcome, words))
        self._moved, self._ok = None, False
