"""Foxglove's own messages for what it can show by itself: transforms, poses, the log and the scene.

Foxglove knows a message by its schema's name (docs.foxglove.dev, "Message schemas"); the fields are those it
documents, encoded as JSON. A field that is not used is not in the schema. World ENU is the frame "world", the
vehicle's axes with roll and pitch are "vehicle".
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from groundstation.frames import Vector3, Vector4
from groundstation.recording import palette
from groundstation.training.mission import Mission
from sim.environment.shapes import primitives
from sim.scenario import Box, Cylinder, Primitive

WORLD, VEHICLE = "world", "vehicle"
Json = dict[str, Any]

_OBSTACLE: palette.Colour = (158, 134, 118)
_DISC_M = 0.02
_ROUTE_PX = 2.0
# Of Rerun's levels, those of Foxglove's.
_LEVELS = {"TRACE": 1, "DEBUG": 1, "INFO": 2, "WARN": 3, "ERROR": 4, "CRITICAL": 5}
_LINE_STRIP = 0


def _object(title: str = "", **properties: Json) -> Json:
    named = {"title": title} if title else {}
    return {**named, "type": "object", "properties": properties}


def _list(items: Json) -> Json:
    return {"type": "array", "items": items}


_TEXT: Json = {"type": "string"}
_NUMBER: Json = {"type": "number"}
_BOOLEAN: Json = {"type": "boolean"}
_COUNT: Json = {"type": "integer"}
_STAMP = _object("time", sec=_COUNT, nsec=_COUNT)
_DURATION = _object("duration", sec=_COUNT, nsec=_COUNT)
_VECTOR = _object("foxglove.Vector3", x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION = _object("foxglove.Quaternion", x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_POSE = _object("foxglove.Pose", position=_VECTOR, orientation=_QUATERNION)
_COLOUR = _object("foxglove.Color", r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_SOLID = _object(pose=_POSE, size=_VECTOR, color=_COLOUR)
_CYLINDER = _object(pose=_POSE, size=_VECTOR, bottom_scale=_NUMBER, top_scale=_NUMBER, color=_COLOUR)
_LINE = _object(
    type=_COUNT,
    pose=_POSE,
    thickness=_NUMBER,
    scale_invariant=_BOOLEAN,
    points=_list(_VECTOR),
    color=_COLOUR,
    colors=_list(_COLOUR),
    indices=_list(_COUNT),
)
_ENTITY = _object(
    "foxglove.SceneEntity",
    timestamp=_STAMP,
    frame_id=_TEXT,
    id=_TEXT,
    lifetime=_DURATION,
    frame_locked=_BOOLEAN,
    cubes=_list(_SOLID),
    spheres=_list(_SOLID),
    cylinders=_list(_CYLINDER),
    lines=_list(_LINE),
)

SCHEMAS: dict[str, Json] = {
    "foxglove.FrameTransform": _object(
        "foxglove.FrameTransform",
        timestamp=_STAMP,
        parent_frame_id=_TEXT,
        child_frame_id=_TEXT,
        translation=_VECTOR,
        rotation=_QUATERNION,
    ),
    "foxglove.PoseInFrame": _object("foxglove.PoseInFrame", timestamp=_STAMP, frame_id=_TEXT, pose=_POSE),
    "foxglove.Log": _object("foxglove.Log", timestamp=_STAMP, level=_COUNT, message=_TEXT, name=_TEXT),
    "foxglove.SceneUpdate": _object("foxglove.SceneUpdate", entities=_list(_ENTITY)),
}


def transform(ns: int, position: Vector3, rotation: Vector4) -> Json:
    """Return where the vehicle's frame is in the world, `rotation` a quaternion [x, y, z, w]."""
    return {
        "timestamp": _stamp(ns),
        "parent_frame_id": WORLD,
        "child_frame_id": VEHICLE,
        "translation": _vector(position),
        "rotation": _quaternion(rotation),
    }


def pose(ns: int, position: Vector3, yaw: float) -> Json:
    """Return a pose in the world, turned by a yaw, rad."""
    return {"timestamp": _stamp(ns), "frame_id": WORLD, "pose": _pose(position, yaw)}


def log(ns: int, level: str, source: str, text: str) -> Json:
    """Return a line of the log."""
    return {"timestamp": _stamp(ns), "level": _LEVELS.get(level, 0), "message": text, "name": source}


def scene(ns: int, mission: Mission | None) -> Json:
    """Return what stands still: obstacles, pads, route and target."""
    shapes = list(_shapes(mission)) if mission else []
    return {"entities": [_entity(ns, name, kind, [shape]) for name, kind, shape in shapes]}


def _shapes(mission: Mission) -> Iterator[tuple[str, str, Json]]:
    """Yield name, kind and shape of each."""
    for obstacle in mission.obstacle:
        for number, part in enumerate(primitives(obstacle)):
            kind, shape = _solid(part)
            yield f"{obstacle.name}/{number}", kind, shape
    disc = (1.0, 1.0, _DISC_M)
    yield "pad", "cylinders", _cylinder(_shape((0.0, 0.0, 0.0), disc, palette.BLUE))
    for pad in mission.pad:
        size = (2.0 * pad.radius, 2.0 * pad.radius, _DISC_M)
        yield f"pad/{pad.name}", "cylinders", _cylinder(_shape(pad.position, size, palette.BLUE))
    target = mission.target
    if target:
        across = 2.0 * target.radius
        yield "target", "spheres", _shape(target.position, (across, across, across), palette.GREEN, alpha=0.4)
    if mission.way:
        yield "route", "lines", _line(mission.path)


def _solid(part: Primitive) -> tuple[str, Json]:
    if isinstance(part, Box):
        return "cubes", _shape(part.center, part.size, _OBSTACLE, yaw=math.radians(part.yaw_deg))
    across = 2.0 * part.radius
    if isinstance(part, Cylinder):
        return "cylinders", _cylinder(_shape(part.center, (across, across, part.height), _OBSTACLE))
    return "spheres", _shape(part.center, (across, across, across), _OBSTACLE)


def _shape(
    center: Vector3, size: Vector3, colour: palette.Colour, *, yaw: float = 0.0, alpha: float = 1.0
) -> Json:
    return {"pose": _pose(center, yaw), "size": _vector(size), "color": _colour(colour, alpha)}


def _cylinder(shape: Json) -> Json:
    return {**shape, "bottom_scale": 1.0, "top_scale": 1.0}


def _line(points: Sequence[Vector3]) -> Json:
    return {
        "type": _LINE_STRIP,
        "pose": _pose((0.0, 0.0, 0.0), 0.0),
        "thickness": _ROUTE_PX,
        "scale_invariant": True,
        "points": [_vector(point) for point in points],
        "color": _colour(palette.GREEN, 1.0),
        "colors": [],
        "indices": [],
    }


def _entity(ns: int, name: str, kind: str, shapes: list[Json]) -> Json:
    nothing: dict[str, list[Json]] = {"cubes": [], "spheres": [], "cylinders": [], "lines": []}
    return {
        "timestamp": _stamp(ns),
        "frame_id": WORLD,
        "id": name,
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": False,
        **nothing,
        kind: shapes,
    }


def _stamp(ns: int) -> Json:
    seconds, rest = divmod(ns, 1_000_000_000)
    return {"sec": seconds, "nsec": rest}


def _pose(position: Vector3, yaw: float) -> Json:
    half = 0.5 * yaw
    return {
        "position": _vector(position),
        "orientation": _quaternion((0.0, 0.0, math.sin(half), math.cos(half))),
    }


def _vector(v: Sequence[float]) -> Json:
    return dict(zip("xyz", v, strict=True))


def _quaternion(q: Sequence[float]) -> Json:
    return dict(zip("xyzw", q, strict=True))


def _colour(colour: palette.Colour, alpha: float) -> Json:
    r, g, b = (part / 255.0 for part in colour)
    return {"r": r, "g": g, "b": b, "a": alpha}
