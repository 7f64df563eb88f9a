"""The world from within, as a wireframe: from behind the vehicle, or as the vehicle itself sees it."""

from __future__ import annotations

import math

import numpy as np

from groundstation.messages import Phase, PilotState
from groundstation.training.guide import Guide, way_to
from groundstation.training.mission import Fence, Mission
from groundstation.tui import goals_inside, wireframe
from groundstation.tui.camera import Camera, Solids
from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.ghosts import ghost_lines
from groundstation.tui.moving import FADED_S, FRESH_S, echoes
from groundstation.tui.perspective import Lines, draw, visible
from groundstation.tui.rows import columns_of
from groundstation.tui.scene import gates
from groundstation.tui.tape import heading_tape
from groundstation.tui.theme import Tone
from groundstation.tui.wireframe import Floats
from sim.environment.shapes import extent

# How far behind the vehicle and above it the chasing camera is at zoom 1, m, and how far down it looks, rad.
_BEHIND_M, _ABOVE_M, _DOWN = 3.0, 1.5, -0.34
# What is seen across the picture at zoom 1, rad.
_ANGLE = math.radians(80.0)
_GROUND_M, _DIM_M, _GRID_DIM_M, _HORIZON_M = 10.0, 12.0, 5.0, 2000.0
_SKY = np.linspace(0.0, math.tau, 73)
_SKYLINE = wireframe.path(np.stack([np.cos(_SKY), np.sin(_SKY), np.zeros(len(_SKY))], axis=1) * _HORIZON_M)
_FENCE_POSTS = 16
# This far around a vehicle nothing behind it is drawn, m.
_FREE_M = 0.55
_SLOW = 0.3
_TAPE_FROM = 30


def camera(frame: Frame, columns: int, rows: int, zoom: float, *, chase: bool) -> Camera | None:
    """Return the camera of a frame, or None where it is not known where the vehicle is.

    Args:
        frame: Of which the picture is.
        columns: Of the picture, cells.
        rows: Likewise.
        zoom: Nearer where above 1.
        chase: From behind the vehicle, not from it.
    """
    vehicle = frame.snapshot.vehicle
    if vehicle is None or not all(map(math.isfinite, vehicle.position)):
        return None
    east, north, up, yaw = vehicle.position
    width, height = 2 * columns, 4 * rows
    focal = max(0.5 * width / math.tan(_ANGLE / 2), 0.5 * height)
    if not chase:
        pitch, roll = (angle if math.isfinite(angle) else 0.0 for angle in (vehicle.pitch, vehicle.roll))
        return Camera((east, north, up), yaw, -pitch, roll, focal * zoom, width, height)
    back = _BEHIND_M / zoom
    place = (east - back * math.cos(yaw), north - back * math.sin(yaw), max(up + _ABOVE_M / zoom, 0.2))
    return Camera(place, yaw, _DOWN, 0.0, focal, width, height)


def draw_inside(
    canvas: Canvas, frame: Frame, eye: Camera, solids: Solids, fence: Fence, *, chase: bool
) -> None:
    """Draw the world as a camera sees it, with the vehicle in it where the camera is not the vehicle.

    Args:
        canvas: Drawn on.
        frame: What there is.
        eye: Sees it.
        solids: The mission's obstacles.
        fence: Where the hand may take the vehicle.
        chase: The vehicle is seen.
    """
    mission, pilot = frame.run.mission, frame.pilot
    if pilot is not None and pilot.phase != Phase.ENGAGED:
        pilot = None
    scene = [*_standing(frame, eye, mission, fence), *_flown(frame, chase=chase), *ghost_lines(frame)]
    if pilot is not None:
        scene += _led(frame, pilot, chase=chase)
    draw(canvas, eye, solids, scene)
    if chase:
        _draw_vehicle(canvas, frame, eye, solids)
    _labels(canvas, frame, eye, solids)
    if not chase:
        _sights(canvas, frame, eye)
    if canvas.columns >= _TAPE_FROM:
        for column, (text, tone) in columns_of(heading_tape(eye.yaw, canvas.columns)):
            canvas.letters(column, 0, text, tone)


def _standing(frame: Frame, eye: Camera, mission: Mission | None, fence: Fence) -> list[Lines]:
    """Return ground, horizon, route and goal, fence, obstacles and gates."""
    place = eye.place
    scene = [
        Lines(wireframe.ground(place, _GROUND_M), Tone.GRID, 3, far=_GRID_DIM_M),
        Lines(_SKYLINE + np.array(place), Tone.MUTED),
    ]
    if fence.radius > 0.0:
        scene.append(Lines(_fence(fence, max(place[2], 2.0)), Tone.OBSTACLE, 2))
    if mission is None:
        return scene
    guide = frame.guide or Guide()
    for obstacle in mission.obstacle:
        guarded = bool(frame.guarded_by) and obstacle.name == frame.guarded_by
        tone = Tone.WARN if guarded else goals_inside.tone_of(obstacle.name, guide)
        scene.append(Lines(wireframe.contours(obstacle, place), tone, far=_DIM_M))
    return [*scene[:2], *goals_inside.ways(mission, guide), *scene[2:]]


def _fence(fence: Fence, seen_up: float) -> Floats:
    """Return rings at the fence's floor and ceiling, and posts between them."""
    top = fence.ceiling or 2.0 * seen_up
    rings = [wireframe.level_circle(np.array([0.0, 0.0, level]), fence.radius) for level in (0.0, top)]
    feet = rings[0][:_FENCE_POSTS, 0]
    return np.concatenate([*rings, np.stack([feet, feet + np.array([0.0, 0.0, top])], axis=1)])


def _flown(frame: Frame, *, chase: bool) -> list[Lines]:
    """Return the way flown, the older the dimmer; as the vehicle sees it, all of it lies behind."""
    points = frame.track.points()
    if not chase or len(points) < 2:
        return []
    segments, age = wireframe.path(points[:, :3]), frame.now - points[1:, 3]
    bounds = (
        (0.0, FRESH_S, Tone.VEHICLE, 1),
        (FRESH_S, FADED_S, Tone.TRAIL, 2),
        (FADED_S, np.inf, Tone.FADED, 3),
    )
    return [
        Lines(segments[(age >= young) & (age < old)], tone, gap) for young, old, tone, gap in reversed(bounds)
    ]


def _led(frame: Frame, pilot: PilotState, *, chase: bool) -> list[Lines]:
    """Return p_h with the line to it, the leash, and where the vehicle can stop."""
    assert frame.snapshot.vehicle is not None
    place, wanted, stop = (
        np.array(tuple(point)[:3]) for point in (frame.snapshot.vehicle.position, pilot.p_h, pilot.stop)
    )
    if not np.isfinite([place, wanted, stop]).all():
        return []
    tone = Tone.WARN if pilot.on_leash else Tone.HAND
    scene = [Lines(wireframe.diamond(wanted, 0.12), tone, through=True)]
    if chase:
        leash = wireframe.level_circle(place, frame.run.settings.mapping.leash)
        scene += [Lines(wireframe.path(np.array([place, wanted])), tone, 2), Lines(leash, Tone.FAINT, 3)]
        cross = np.array([[[0.15, 0.15, 0], [-0.15, -0.15, 0]], [[0.15, -0.15, 0], [-0.15, 0.15, 0]]])
        scene += [
            Lines(cross + stop, Tone.VEHICLE),
            Lines(wireframe.path(np.array([place, stop])), Tone.TRAIL, 2),
        ]
    return scene


def _draw_vehicle(canvas: Canvas, frame: Frame, eye: Camera, solids: Solids) -> None:
    """Draw the vehicle so that it stands free of what is behind it."""
    state = frame.snapshot.vehicle
    assert state is not None
    x, y = eye.dots(np.array(tuple(state.position)[:3]))
    distance = math.dist(eye.place, tuple(state.position)[:3])
    reach = _FREE_M * eye.focal / max(distance, 0.1)
    across, down = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-0.4 * reach, 0.4 * reach + 1))
    disc = (across / reach) ** 2 + (down / (0.4 * reach)) ** 2 <= 1.0
    canvas.clear(x + across[disc], y + down[disc])
    draw(canvas, eye, solids, _vehicle(frame))


def _vehicle(frame: Frame) -> list[Lines]:
    """Return the vehicle, its shadow, and what its own sensors see."""
    state = frame.snapshot.vehicle
    assert state is not None
    east, north, up, yaw = state.position
    place = np.array([east, north, up])
    pitch, roll = (angle if math.isfinite(angle) else 0.0 for angle in (state.pitch, state.roll))
    shadow = wireframe.level_circle(np.array([east, north, 0.0]), 0.35)
    drop = wireframe.path(np.array([place, place * (1.0, 1.0, 0.0)]))
    scene = [
        Lines(np.concatenate([shadow, drop]), Tone.FAINT, 3),
        Lines(wireframe.vehicle(place, yaw, pitch, roll), Tone.VEHICLE),
    ]
    ranges = frame.snapshot.ranges
    if ranges is not None and frame.age(ranges) <= 0.5:
        marks = echoes((east, north, up, yaw), tuple(ranges.ring))
        marks = marks[np.isfinite(marks).all(axis=1)]
        scene.append(Lines(np.stack([marks, marks + np.array([0.0, 0.0, 0.15])], axis=1), Tone.TEXT))
    return scene


def _labels(canvas: Canvas, frame: Frame, eye: Camera, solids: Solids) -> None:
    """Write names over what is seen, gates with their numbers; the goal, through everything, with how far it is."""
    mission, vehicle = frame.run.mission, frame.snapshot.vehicle
    if mission is None or vehicle is None:
        return
    here = (vehicle.position[0], vehicle.position[1], vehicle.position[2])
    numbers = {gate.name: f"gate {number}" for number, gate in enumerate(gates(mission), 1)}
    for obstacle in mission.obstacle:
        lower, upper = extent(obstacle)
        x, y = 0.5 * (lower[0] + upper[0]), 0.5 * (lower[1] + upper[1])
        if math.dist(here[:2], (x, y)) < _DIM_M:
            tone = Tone.WARN if obstacle.name == frame.guarded_by else Tone.MUTED
            name = numbers.get(obstacle.name, obstacle.name)
            _label(canvas, visible(eye, solids, np.array((x, y, upper[2] + 0.15))), name, tone)
    guide = frame.guide or Guide()
    if (goal := goals_inside.aim(mission, guide)) is not None:
        goals_inside.draw_goal(canvas, eye, goal, guide, way_to(goal, (*here, vehicle.position[3])))


def _label(canvas: Canvas, dot: tuple[float, float] | None, words: str, tone: Tone) -> None:
    if dot is not None:
        # At the edge a name moves inward, for half a figure would be another.
        column = max(min(int(dot[0] / 2) - len(words) // 2, canvas.columns - len(words)), 0)
        canvas.letters(column, int(dot[1] / 4), words, tone)


def _sights(canvas: Canvas, frame: Frame, eye: Camera) -> None:
    """Mark straight ahead, and where it flies to."""
    x, y = (canvas.width - 1) / 2, (canvas.height - 1) / 2
    for side in (1, -1):
        canvas.line([x + 4 * side, x + 12 * side], [y, y], Tone.VEHICLE)
    canvas.line([x, x], [y + 4, y + 8], Tone.VEHICLE)
    assert frame.snapshot.vehicle is not None
    velocity = np.array(tuple(frame.snapshot.vehicle.velocity)[:3])
    if not np.linalg.norm(velocity) > _SLOW:
        return
    ahead_x, ahead_y = eye.dots(np.array(eye.place) + 10.0 * velocity / np.linalg.norm(velocity))
    angles = np.linspace(0.0, math.tau, 20)
    canvas.plot(ahead_x + 4 * np.cos(angles), ahead_y + 4 * np.sin(angles), Tone.OK)
