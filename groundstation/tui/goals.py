"""What a mission leads to, as pure drawing on the flat maps: route, gates, target, and the goal that is next."""

from __future__ import annotations

import math

import numpy as np

from groundstation.training.director import Goal
from groundstation.training.guide import Guide
from groundstation.training.mission import Mission
from groundstation.tui.canvas import Canvas
from groundstation.tui.scene import cross, gates, ring
from groundstation.tui.theme import Tone
from groundstation.tui.view import TOP, View
from sim.scenario import Gate

# A ring is never smaller than this, nor is what is asked for as a heading shorter, dots.
_SEEN, _TICK = 4.0, 7.0
_ARROWS = "→↗↑↖←↙↓↘"
# An arrow at the edge is so far from it, dots.
_EDGE = 4.0


def draw_ways(canvas: Canvas, view: View, mission: Mission | None, guide: Guide) -> None:
    """Draw the way the mission asks for: what is behind the vehicle dim, the gate that is next bright.

    Args:
        canvas: Drawn on.
        view: What it shows.
        mission: What is flown, or None.
        guide: How far it is.
    """
    if mission is None:
        return
    _route(canvas, view, mission, guide.reached)
    for gate in gates(mission):
        passed = gate.name in guide.passed
        tone = Tone.FAINT if passed else Tone.TARGET if gate.name == guide.gate else Tone.ROUTE
        _way_through(canvas, view, gate, _backward(mission, gate), tone)
    if mission.target is not None:
        at = view.plane.flat(mission.target.position)
        tone = Tone.FAINT if guide.points and guide.reached >= guide.points else Tone.TARGET
        ring(canvas, view, (*at, max(mission.target.radius, _SEEN * view.scale)), tone)
        cross(canvas, float(view.x(at[0])), float(view.y(at[1])), 1, tone)


def draw_goal(canvas: Canvas, view: View, guide: Guide, distance: float) -> None:
    """Draw the goal as a ring with its number, the heading that is asked for and how long was stayed there.

    Args:
        canvas: Drawn on.
        view: What it shows; where the goal is outside of it, an arrow at the edge says where.
        guide: How far the mission is.
        distance: Of the goal from the vehicle, m.
    """
    goal = guide.goal
    if goal is None:
        return
    across, upward = view.plane.flat(goal.at)
    x, y = float(view.x(across)), float(view.y(upward))
    if not (0 <= x < canvas.width and 0 <= y < canvas.height):
        middle_x, middle_y = canvas.width / 2, canvas.height / 2
        draw_off(canvas, (x - middle_x, y - middle_y), f"{guide.number} {distance:.0f} m")
        return
    radius = max(goal.radius, _SEEN * view.scale)
    ring(canvas, view, (across, upward, radius), Tone.TARGET)
    cross(canvas, x, y, 1, Tone.TARGET)
    if view.plane is TOP:
        _heading(canvas, (x, y), radius / view.scale, goal)
    _stayed(canvas, (x, y), radius / view.scale, guide)
    number = guide.number.partition("/")[0]
    column = int((x + radius / view.scale) / 2) + 1
    canvas.letters(min(column, canvas.columns - len(number)), max(int(y / 4) - 1, 0), number, Tone.TARGET)


def draw_off(canvas: Canvas, way: tuple[float, float], words: str) -> None:
    """Draw an arrow at the edge of a picture to what lies beyond it.

    Args:
        canvas: Drawn on.
        way: Where it lies from the picture's middle, dots to the right and down; not both zero.
        words: Stand beside the arrow.
    """
    half_x, half_y = canvas.width / 2 - _EDGE, canvas.height / 2 - _EDGE
    share = min(half_x / max(abs(way[0]), 1e-9), half_y / max(abs(way[1]), 1e-9))
    x, y = canvas.width / 2 + share * way[0], canvas.height / 2 + share * way[1]
    arrow = _ARROWS[round(math.atan2(-way[1], way[0]) / (math.tau / 8)) % 8]
    column, row = int(x / 2), int(y / 4)
    text = f"{words} {arrow}" if way[0] > 0 else f"{arrow} {words}"
    start = column - len(text) + 1 if way[0] > 0 else column
    canvas.letters(max(min(start, canvas.columns - len(text)), 0), row, text, Tone.TARGET)


def _backward(mission: Mission, gate: Gate) -> bool:
    """Say whether the route leads through a gate against its own direction: counted it is from either side."""
    path = np.array(mission.path)
    near = int(np.argmin(np.linalg.norm(path - np.array(gate.center), axis=1)))
    before, after = path[max(near - 1, 0)], path[min(near + 1, len(path) - 1)]
    yaw = math.radians(gate.yaw_deg)
    return bool((after - before)[:2] @ (math.cos(yaw), math.sin(yaw)) < 0.0)


def _route(canvas: Canvas, view: View, mission: Mission, reached: int) -> None:
    """Draw the way the mission asks for, dotted, with a head on each leg that says which way it goes."""
    if not mission.way:
        return
    x, y = view.dots(np.array(mission.path))
    for index in range(len(x) - 1):
        tone = Tone.FAINT if index < reached else Tone.ROUTE
        canvas.line(x[index : index + 2], y[index : index + 2], tone, gap=4)
        _head(canvas, ((x[index], y[index]), (x[index + 1], y[index + 1])), 0.5, tone)
    for index in range(len(mission.waypoints)):
        cross(canvas, x[index + 1], y[index + 1], 1, Tone.FAINT if index < reached else Tone.ROUTE)


def _head(
    canvas: Canvas, line: tuple[tuple[float, float], tuple[float, float]], share: float, tone: Tone
) -> None:
    """Draw an arrow's head on a line, dots; none where the line is too short to have a direction."""
    size, (start, end) = 3.0, line
    length = math.dist(start, end)
    if not size * 2 < length < math.inf:
        return
    x, y = start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    for side in (2.5, -2.5):
        canvas.line([x, x + size * math.cos(angle + side)], [y, y + size * math.sin(angle + side)], tone)


def _way_through(canvas: Canvas, view: View, gate: Gate, backward: bool, tone: Tone) -> None:
    """Draw an arrow through a gate, the way the route goes."""
    yaw = math.radians(gate.yaw_deg) + (math.pi if backward else 0.0)
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    x, y = view.dots(np.array(gate.center) + np.outer([-0.6, 0.6], ahead))
    canvas.line(x, y, tone)
    _head(canvas, ((x[0], y[0]), (x[1], y[1])), 1.0, tone)


def _heading(canvas: Canvas, middle: tuple[float, float], radius: float, goal: Goal) -> None:
    """Draw where the nose must point, outward from the ring; a map from above has north up."""
    if math.isnan(goal.yaw):
        return
    c, s = math.cos(goal.yaw), -math.sin(goal.yaw)
    x, y = middle[0] + radius * c, middle[1] + radius * s
    end = (x + _TICK * c, y + _TICK * s)
    canvas.line([x, end[0]], [y, end[1]], Tone.TARGET)
    _head(canvas, ((x, y), end), 1.0, Tone.TARGET)


def _stayed(canvas: Canvas, middle: tuple[float, float], radius: float, guide: Guide) -> None:
    """Draw how much of the stay is done as an arc around the ring, clockwise from the top."""
    if not guide.hold_s or guide.held_s <= 0.0:
        return
    share = min(guide.held_s / guide.hold_s, 1.0)
    angles = np.linspace(0.0, share * math.tau, max(int(share * math.tau * radius * 1.5), 2))
    for wider in (1.0, 2.0):
        x = middle[0] + (radius + wider) * np.sin(angles)
        canvas.plot(x, middle[1] - (radius + wider) * np.cos(angles), Tone.STRONG)
