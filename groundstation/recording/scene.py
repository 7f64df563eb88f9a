"""What stands still in the scene: ground, pads, obstacles, route and target; and how what moves looks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import rerun as rr

from groundstation.recording import entities, palette
from groundstation.recording.airframe import quadrotor
from groundstation.recording.item import Numbers, Still
from groundstation.training.mission import Mission
from sim.environment.shapes import extent as reached
from sim.environment.shapes import primitives
from sim.scenario import Box, Cylinder, Pad, Primitive

_MARGIN_M = 4.0
# The Chase view fits this around the vehicle.
_CHASE_M = 0.6
_GROUND: palette.Colour = (43, 48, 56)
_OBSTACLE: palette.Colour = (158, 134, 118)
_SOLID = rr.components.FillMode.Solid


def static_scene(mission: Mission | None) -> Iterator[Still]:
    """Yield what is logged once, entity by entity.

    Args:
        mission: Whose obstacles, route and target are shown; None shows the ground alone.
    """
    yield Still(entities.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    yield Still(entities.GROUND, _ground(mission))
    yield Still(
        entities.PAD, rr.Cylinders3D(lengths=[0.02], radii=[0.5], colors=[palette.BLUE], fill_mode=_SOLID)
    )
    for obstacle in mission.obstacle if mission else ():
        parts = primitives(obstacle)
        for number, part in enumerate(parts):
            path = f"{entities.OBSTACLES}/{_entity(obstacle.name)}"
            yield Still(path if len(parts) == 1 else f"{path}/{number}", _solid(part))
    for pad in mission.pad if mission else ():
        yield Still(f"{entities.PAD}/{_entity(pad.name)}", _pad(pad))
    if mission and mission.route:
        yield Still(entities.ROUTE, _route(mission))
    if mission and mission.target:
        position, radius = mission.target.position, mission.target.radius
        yield Still(
            entities.TARGET,
            rr.Ellipsoids3D(
                centers=[position],
                radii=[radius],
                colors=[palette.GREEN],
                line_radii=[-1.0],
                fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
                labels=["target"],
            ),
        )
    yield Still(entities.AIRFRAME, quadrotor())
    yield Still(
        entities.CHASED,
        rr.Points3D([(-_CHASE_M, -_CHASE_M, -_CHASE_M), (_CHASE_M, _CHASE_M, _CHASE_M)], radii=[0.0]),
    )
    yield from _looks()


def _looks() -> Iterator[Still]:
    """Yield colour and thickness of what moves; negative radii are in the screen's points, not metres."""
    yield Still(entities.VEHICLE_TRAIL, rr.LineStrips3D.from_fields(colors=[palette.VEHICLE], radii=[-1.5]))
    yield Still(entities.HAND_TRAIL, rr.LineStrips3D.from_fields(colors=[palette.HAND], radii=[-0.75]))
    yield Still(entities.PLUMB, rr.LineStrips3D.from_fields(colors=[palette.LIGHT], radii=[-0.5]))
    yield Still(entities.HAND, rr.Points3D.from_fields(colors=[palette.HAND], radii=[0.07]))
    yield Still(entities.LEASH, rr.LineStrips3D.from_fields(colors=[palette.HAND], radii=[-1.0]))
    yield Still(entities.PREDICTED, rr.Points3D.from_fields(colors=[palette.VEHICLE], radii=[0.06]))
    yield Still(entities.STOP, rr.Points3D.from_fields(colors=[palette.VERMILION], radii=[0.05]))
    yield Still(entities.PROSPECT, rr.LineStrips3D.from_fields(colors=[palette.VEHICLE], radii=[-0.75]))
    yield Still(entities.ECHOES, rr.Points3D.from_fields(colors=[palette.PURPLE], radii=[-2.0]))
    yield Still(entities.GHOST, rr.Points3D.from_fields(colors=[palette.LIGHT], radii=[0.15]))
    yield Still(entities.GHOST_TRAIL, rr.LineStrips3D.from_fields(colors=[palette.GREY], radii=[-0.75]))
    yield Still(
        entities.INCIDENTS,
        rr.Points3D.from_fields(colors=[palette.VERMILION], radii=[0.1], show_labels=True),
    )
    yield Still(
        entities.LOSSES, rr.Points3D.from_fields(colors=[palette.ORANGE], radii=[0.08], show_labels=False)
    )
    yield Still(entities.FORCE_ARROW, rr.Arrows3D.from_fields(colors=[palette.FORCE], radii=[0.04]))


def extent(mission: Mission | None) -> tuple[Numbers, Numbers]:
    """Return the lower and upper corner of what a mission is about, world, m."""
    points: list[Sequence[float]] = [(0.0, 0.0, 0.0)]
    if mission:
        points += [corner for obstacle in mission.obstacle for corner in reached(obstacle)]
        points += [pad.position for pad in mission.pad]
        points += mission.way
    return np.min(points, axis=0), np.max(points, axis=0)


def _ground(mission: Mission | None) -> rr.Mesh3D:
    low, high = extent(mission)
    (x0, y0), (x1, y1) = low[:2] - _MARGIN_M, high[:2] + _MARGIN_M
    corners = [(x0, y0, -0.01), (x1, y0, -0.01), (x1, y1, -0.01), (x0, y1, -0.01)]
    return rr.Mesh3D(
        vertex_positions=corners,
        triangle_indices=[(0, 1, 2), (0, 2, 3)],
        vertex_normals=[(0, 0, 1)] * 4,
        vertex_colors=[_GROUND] * 4,
    )


def _route(mission: Mission) -> rr.LineStrips3D:
    return rr.LineStrips3D([mission.path], colors=[palette.GREEN], radii=[-0.75])


def _entity(name: str) -> str:
    return name.replace(" ", "_")


def _pad(pad: Pad) -> rr.Cylinders3D:
    return rr.Cylinders3D(
        centers=[pad.position],
        lengths=[0.02],
        radii=[pad.radius],
        colors=[palette.BLUE],
        fill_mode=_SOLID,
        labels=[pad.name],
        show_labels=False,
    )


def _solid(part: Primitive) -> rr.AsComponents:
    if isinstance(part, Box):
        return rr.Boxes3D(
            centers=[part.center],
            sizes=[part.size],
            rotation_axis_angles=[rr.RotationAxisAngle((0, 0, 1), radians=math.radians(part.yaw_deg))],
            colors=[_OBSTACLE],
            fill_mode=_SOLID,
            labels=[part.name],
            show_labels=False,
        )
    if isinstance(part, Cylinder):
        return rr.Cylinders3D(
            centers=[part.center],
            lengths=[part.height],
            radii=[part.radius],
            colors=[_OBSTACLE],
            fill_mode=_SOLID,
            labels=[part.name],
            show_labels=False,
        )
    return rr.Ellipsoids3D(
        centers=[part.center],
        radii=[part.radius],
        colors=[_OBSTACLE],
        fill_mode=_SOLID,
        labels=[part.name],
        show_labels=False,
    )
