"""What a trainee is shown of what comes next: the goal, how far the mission is, and the way there. Pure."""

from __future__ import annotations

import math
from typing import NamedTuple

from groundstation.frames import Vector4, body_from_world
from groundstation.training.director import YAW_WITHIN, Director, Goal, Stage
from sim.scenario import Gate

# A heading is near enough to the one asked for within half of what is forgiven, rad.
_TURN_FROM = 0.5 * YAW_WITHIN


class Guide(NamedTuple):
    """A mission as far as it has come.

    Attributes:
        goal: What is to be reached next; None where nothing is.
        reached: Points behind the vehicle; the goal is the next one.
        points: All there are, the pad to land on among them.
        hold_s: How long the goal is to be stayed at, s.
        held_s: How long it has been so far, s.
        gate: Name of the gate that is next, or "".
        passed: Names of those flown through.
        elapsed: Since take-off, s; 0 before it.
        landing: The goal is the pad to land on.
    """

    goal: Goal | None = None
    reached: int = 0
    points: int = 0
    hold_s: float = 0.0
    held_s: float = 0.0
    gate: str = ""
    passed: frozenset[str] = frozenset()
    elapsed: float = 0.0
    landing: bool = False

    @property
    def number(self) -> str:
        """Which point is next, of how many: 2/5."""
        return f"{min(self.reached + 1, self.points)}/{self.points}"


class Way(NamedTuple):
    """The way from the vehicle to its goal.

    Attributes:
        distance: m.
        ahead, left, up: On the vehicle's axes, m.
        bearing: Of the goal from the nose, counter-clockwise, rad; NaN where it is straight above or below.
        turn: What the nose must turn to point where it is to point, counter-clockwise, rad; 0 where it does.
    """

    distance: float
    ahead: float
    left: float
    up: float
    bearing: float
    turn: float


def guide_of(director: Director, t: float) -> Guide:
    """Return how far a mission is at `t`, s."""
    hold_s, held_s = director.stay
    left, mission = [gate.name for gate in director.missed], director.mission
    gates = {each.name for each in mission.obstacle if isinstance(each, Gate)}
    return Guide(
        goal=None if director.stage is Stage.DONE else director.goal,
        reached=director.leg,
        points=director.legs + (mission.landing is not None),
        hold_s=hold_s,
        held_s=held_s,
        gate=left[0] if left else "",
        passed=frozenset(gates.difference(left)),
        elapsed=director.elapsed(t),
        landing=mission.landing is not None and director.leg >= director.legs,
    )


def way_to(goal: Goal, position: Vector4) -> Way:
    """Return the way to a goal.

    Args:
        goal: What is to be reached.
        position: Of the vehicle: x, y, z, yaw; world, m and rad.
    """
    x, y, z, yaw = position
    to = (goal.at[0] - x, goal.at[1] - y, goal.at[2] - z)
    ahead, left, up = body_from_world(to, yaw)
    flat = math.hypot(ahead, left)
    off = 0.0 if math.isnan(goal.yaw) else math.remainder(goal.yaw - yaw, math.tau)
    return Way(
        distance=math.hypot(flat, up),
        ahead=ahead,
        left=left,
        up=up,
        bearing=math.atan2(left, ahead) if flat > 0.3 * goal.radius else math.nan,
        turn=off if abs(off) > _TURN_FROM else 0.0,
    )
