"""What a mission leads to, as the views from within see it: route, gates' arrows, and the goal that is next."""

from __future__ import annotations

import math

import numpy as np

from groundstation.training.director import Goal
from groundstation.training.guide import Guide, Way
from groundstation.training.mission import Mission
from groundstation.tui import wireframe
from groundstation.tui.camera import Camera
from groundstation.tui.canvas import Canvas
from groundstation.tui.goals import draw_off
from groundstation.tui.perspective import Lines
from groundstation.tui.theme import Tone
from groundstation.tui.wireframe import Floats

_SMALLEST_M, _MARK_M, _TICK_M = 0.2, 0.15, 0.6
# So much above the goal stands how far it is, m.
_ABOVE_M = 0.4


def ways(mission: Mission, guide: Guide) -> list[Lines]:
    """Return the route, what is behind dim, and the goal; where nobody follows the mission, its target."""
    path, reached = np.array(mission.path), guide.reached
    scene = [Lines(wireframe.path(path[: reached + 1]), Tone.FAINT, 6)] if reached else []
    if len(path) > reached + 1:
        scene.append(Lines(wireframe.path(path[reached:]), Tone.ROUTE, 5))
    if (goal := aim(mission, guide)) is not None:
        scene += _goal(goal)
    return scene


def aim(mission: Mission, guide: Guide) -> Goal | None:
    """Return what is next, or where nobody follows the mission its target."""
    if guide.points:
        return guide.goal
    target = mission.target
    return Goal(target.position, target.radius) if target is not None else None


def tone_of(name: str, guide: Guide) -> Tone:
    """Return how an obstacle looks: the gate that is next bright, those behind dim."""
    if name == guide.gate:
        return Tone.TARGET
    return Tone.OBSTACLE if name in guide.passed else Tone.BESIDE


def draw_goal(canvas: Canvas, eye: Camera, goal: Goal, guide: Guide, way: Way) -> None:
    """Write over the goal which it is and how far, or where it is not seen draw an arrow to it at the edge."""
    x, y, z = goal.at
    words = f"{guide.number if guide.points else 'target'} {way.distance:.1f} m"
    across, down = (float(dot) for dot in eye.dots(np.array(goal.at)))
    if 0 <= across < canvas.width and 0 <= down < canvas.height:
        _, above = (float(dot) for dot in eye.dots(np.array((x, y, z + _ABOVE_M))))
        # At the edge words move inward, for half a figure would be another; in the first row is the heading.
        start = max(min(int(across / 2) - len(words) // 2, canvas.columns - len(words)), 0)
        canvas.letters(start, max(int(above / 4), 1), words, Tone.TARGET)
        return
    right, down, ahead = eye.seen(np.array(goal.at)).tolist()
    if ahead < 0.0:
        # Behind: whichever side is nearer is where to turn to.
        right, down = math.copysign(max(abs(right), -ahead), right), 0.0
    draw_off(canvas, (right, down) if right or down else (1.0, 0.0), words)


def _goal(goal: Goal) -> list[Lines]:
    """Return a mark that shines through everything, the ring that counts as there, and the heading asked for."""
    middle, radius = np.array(goal.at), max(goal.radius, _SMALLEST_M)
    lines: list[Floats] = [wireframe.level_circle(middle, radius), wireframe.diamond(middle, _MARK_M)]
    if math.isfinite(goal.yaw):
        ahead = np.array((math.cos(goal.yaw), math.sin(goal.yaw), 0.0))
        lines.append(wireframe.path(np.array([middle + radius * ahead, middle + (radius + _TICK_M) * ahead])))
    foot = np.array([middle, middle * (1.0, 1.0, 0.0)])
    return [
        Lines(np.concatenate(lines), Tone.TARGET, through=True),
        Lines(wireframe.path(foot), Tone.ROUTE, 4),
    ]
