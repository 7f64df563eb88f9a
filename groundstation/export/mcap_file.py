"""MCAP: a channel a quantity as JSON with its schema, and what Foxglove shows without further ado.

Format: https://mcap.dev/spec; Foxglove's schemas: https://docs.foxglove.dev/docs/visualization/message-schemas.
"""

from __future__ import annotations

import heapq
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, Writer

from groundstation import __version__
from groundstation.export.columns import Columns, Span, columns_of
from groundstation.export.tables import properties_of, started_of, wall_ns
from groundstation.recording import schema
from groundstation.recording.motion import quaternions
from groundstation.review.flight import Flight
from sim.environment.shapes import primitives
from sim.scenario import Box, Cylinder

# Foxglove's level numbers by ours.
_LEVELS = {"INFO": 2, "WARN": 3, "ERROR": 4}
_SOLID = {"r": 0.62, "g": 0.53, "b": 0.46, "a": 0.8}
_WORLD, _VEHICLE = "world", "vehicle"
_TELL_EVERY = 20_000
# Time, order among equals, channel, content.
Message = tuple[int, int, int, bytes]


def write_mcap(flight: Flight, span: Span, out: Path) -> Iterator[str]:
    """Write a flight as an MCAP file, in the order of time, yielding how far it is.

    Args:
        flight: The flight.
        span: What of it.
        out: The file.
    """
    with out.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="", library=f"groundstation {__version__}")
        _Attached(writer, flight).write()
        streams = [*_numbers(writer, flight, span), *_shown(writer, flight, span)]
        for number, (at, _, channel, content) in enumerate(heapq.merge(*streams)):
            writer.add_message(channel, at, content, at, number)
            if number % _TELL_EVERY == 0:
                yield f"{number} messages"
        writer.finish()


class _Attached:
    """What goes into the file beside the messages: properties, mission, settings, the MAVLink log."""

    def __init__(self, writer: Writer, flight: Flight) -> None:
        self._writer, self._flight = writer, flight
        self._at = int(wall_ns(np.zeros(1), started_of(flight))[0])

    def write(self) -> None:
        """Write them."""
        known = properties_of(self._flight)
        for name, facts in known.items():
            self._writer.add_metadata(name, {key: str(value) for key, value in facts.items()})
        for name in ("mission", "settings"):
            if words := known["flight"].get(f"{name}_json"):
                self._attach(f"{name}.json", "application/json", str(words).encode())
        tlog = self._flight.path.with_suffix(".tlog")
        if tlog.is_file():
            self._attach(tlog.name, "application/vnd.mavlink.tlog", tlog.read_bytes())

    def _attach(self, name: str, kind: str, content: bytes) -> None:
        self._writer.add_attachment(self._at, self._at, name, kind, content)


def _channel(writer: Writer, topic: str, name: str, described: dict[str, Any]) -> int:
    known = writer.register_schema(name, "jsonschema", json.dumps(described).encode())
    return writer.register_channel(topic, "json", known)


def _numbers(writer: Writer, flight: Flight, span: Span) -> Iterator[Iterator[Message]]:
    """Yield a stream of messages a quantity."""
    started = started_of(flight)
    for columns in columns_of(flight, span):
        parts = {
            name: {"type": ["number", "null"], "description": unit}
            for name, unit in zip(columns.names, columns.units, strict=True)
        }
        described = {"type": "object", "description": columns.meaning, "properties": parts}
        channel = _channel(writer, columns.path, f"groundstation{columns.path.replace('/', '.')}", described)
        yield _rows(columns, channel, wall_ns(columns.t, started))


def _rows(columns: Columns, channel: int, at: np.ndarray) -> Iterator[Message]:
    names = list(columns.names)
    for number, (when, row) in enumerate(zip(at.tolist(), columns.values.tolist(), strict=True)):
        # JSON knows no NaN.
        known = {
            name: value if math.isfinite(value) else None for name, value in zip(names, row, strict=True)
        }
        yield when, number, channel, json.dumps(known).encode()


def _shown(writer: Writer, flight: Flight, span: Span) -> Iterator[Iterator[Message]]:
    """Yield what Foxglove shows by itself: the vehicle in the world, obstacles, events."""
    anything: dict[str, Any] = {"type": "object"}
    yield _poses(flight, span, _channel(writer, "/tf", "foxglove.FrameTransform", anything))
    yield _logged(flight, span, _channel(writer, "/log", "foxglove.Log", anything))
    yield _scene(flight, _channel(writer, "/scene", "foxglove.SceneUpdate", anything))


def _poses(flight: Flight, span: Span, channel: int) -> Iterator[Message]:
    t, values = flight.series(schema.POSITION)
    attitude_t, attitude = flight.series(schema.ATTITUDE)
    chosen = np.isfinite(values.sum(axis=1)) & (t >= span.start) & (t <= span.end)
    t, values = t[chosen], values[chosen]
    if not len(t) or not len(attitude_t):
        return
    places = np.maximum(np.searchsorted(attitude_t, t, side="right") - 1, 0)
    turns = quaternions(attitude[places, 0], attitude[places, 1], values[:, 3])
    at = wall_ns(t, started_of(flight)).tolist()
    for number, (when, place, turn) in enumerate(zip(at, values.tolist(), turns.tolist(), strict=True)):
        content = {
            "timestamp": _stamp(when),
            "parent_frame_id": _WORLD,
            "child_frame_id": _VEHICLE,
            "translation": dict(zip("xyz", place[:3], strict=True)),
            "rotation": dict(zip("xyzw", turn, strict=True)),
        }
        yield when, number, channel, json.dumps(content).encode()


def _logged(flight: Flight, span: Span, channel: int) -> Iterator[Message]:
    lines = [line for line in flight.events() if span.start <= line.t <= span.end]
    at = wall_ns(np.array([line.t for line in lines]), started_of(flight)).tolist()
    for number, (when, line) in enumerate(zip(at, lines, strict=True)):
        content = {
            "timestamp": _stamp(when),
            "level": _LEVELS.get(line.level, 1),
            "message": line.text,
            "name": line.source,
        }
        yield when, number, channel, json.dumps(content).encode()


def _scene(flight: Flight, channel: int) -> Iterator[Message]:
    """Yield the mission's obstacles, once, as what they are made of."""
    mission = flight.mission
    if mission is None or not mission.obstacle:
        return
    when = int(wall_ns(np.zeros(1), started_of(flight))[0])
    cubes: list[dict[str, Any]] = []
    cylinders: list[dict[str, Any]] = []
    spheres: list[dict[str, Any]] = []
    for obstacle in mission.obstacle:
        for part in primitives(obstacle):
            pose = {"position": dict(zip("xyz", part.center, strict=True)), "orientation": _upright(part)}
            if isinstance(part, Box):
                cubes.append(
                    {"pose": pose, "size": dict(zip("xyz", part.size, strict=True)), "color": _SOLID}
                )
            elif isinstance(part, Cylinder):
                size = {"x": 2.0 * part.radius, "y": 2.0 * part.radius, "z": part.height}
                cylinders.append(
                    {"pose": pose, "size": size, "bottom_scale": 1.0, "top_scale": 1.0, "color": _SOLID}
                )
            else:
                size = dict.fromkeys("xyz", 2.0 * part.radius)
                spheres.append({"pose": pose, "size": size, "color": _SOLID})
    entity = {
        "timestamp": _stamp(when),
        "frame_id": _WORLD,
        "id": "obstacles",
        "lifetime": {"sec": 0, "nsec": 0},
        "frame_locked": False,
        "metadata": [],
        **{name: [] for name in ("arrows", "lines", "triangles", "texts", "models")},
        "cubes": cubes,
        "cylinders": cylinders,
        "spheres": spheres,
    }
    yield when, 0, channel, json.dumps({"deletions": [], "entities": [entity]}).encode()


def _upright(part: object) -> dict[str, float]:
    """Return the quaternion of a part that stands upright, turned by its yaw."""
    half = math.radians(getattr(part, "yaw_deg", 0.0)) / 2.0
    return {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}


def _stamp(at: int) -> dict[str, int]:
    return {"sec": at // 1_000_000_000, "nsec": at % 1_000_000_000}
