"""A selection as an MCAP file: a channel an entity, JSON messages, and what Foxglove shows by itself beside them.

Messages lie in the order of their times, a window after the other, so that a reader that plays them reads the file
once. A part that is not known (NaN) is left out of its message; an infinite one is 1e999, which readers of JSON take
for infinity. Every other number comes back to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from math import isnan
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import tomli_w
from mcap.writer import CompressionType, Writer

from groundstation import __version__
from groundstation.export import foxglove
from groundstation.export.selection import Selection, Table, nanoseconds, unit_of
from groundstation.recording import schema
from groundstation.recording.motion import quaternions
from groundstation.review.flight import Numbers

Tell = Callable[[str], None]
# When, ns; and the message.
Message = tuple[int, bytes]

_WINDOW_S = 1.0
# What is compressed at a time, bytes.
_CHUNK_BYTES = 4 << 20
_INFINITY = {np.inf: msgspec.Raw(b"1e999"), -np.inf: msgspec.Raw(b"-1e999")}
_encode = msgspec.json.Encoder().encode


class Channel(NamedTuple):
    """One channel.

    Attributes:
        topic: Its name.
        kind: Of its messages, the schema's name.
        schema: Of its messages.
        t: (n,), when they are, s, ascending.
        messages: Makes those of rows from one to another.
    """

    topic: str
    kind: str
    schema: Mapping[str, Any]
    t: Numbers
    messages: Callable[[int, int], Iterator[Message]]


def write_mcap(selection: Selection, path: Path, tell: Tell) -> None:
    """Write a selection."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        writer.start(library=f"groundstation {__version__}")
        channels = list(_channels(selection))
        numbers = [_registered(writer, channel) for channel in channels]
        _attach(writer, selection)
        first, last = selection.span
        edges = [first, *np.arange(first + _WINDOW_S, last, _WINDOW_S).tolist(), np.inf]
        for begin, end in pairwise(edges):
            tell(f"{begin - first:.0f} of {last - first:.0f} s")
            for ns, number, message in _merged(channels, numbers, begin, end):
                writer.add_message(number, ns, message, ns)
        writer.finish()


def _registered(writer: Writer, channel: Channel) -> int:
    schema_id = writer.register_schema(channel.kind, "jsonschema", _encode(channel.schema))
    return writer.register_channel(channel.topic, "json", schema_id)


def _merged(
    channels: list[Channel], numbers: list[int], begin: float, end: float
) -> list[tuple[int, int, bytes]]:
    """Return the messages of a window, each with its time, ns, and its channel's number, in order."""
    found: list[tuple[int, int, bytes]] = []
    for channel, number in zip(channels, numbers, strict=True):
        first, last = np.searchsorted(channel.t, (begin, end))
        found += [(ns, number, message) for ns, message in channel.messages(int(first), int(last))]
    return sorted(found, key=itemgetter(0))


def _channels(selection: Selection) -> Iterator[Channel]:
    for table in selection.tables:
        yield _numbers(selection, table)
    for path, meaning, changes in selection.states:
        told = {"type": "object", "description": meaning, "properties": {"state": {"type": "string"}}}
        rows = [{"state": word} for _, word in changes]
        yield _made(selection, path, told, np.array([t for t, _ in changes]), lambda _, i, rows=rows: rows[i])
    yield from _shown(selection)


def _numbers(selection: Selection, table: Table) -> Channel:
    """Return the channel of a quantity."""
    quantity, values = table.quantity, table.values
    stamps = nanoseconds(table.t) + selection.started_ns
    finite = bool(np.isfinite(values).all())

    def messages(first: int, last: int) -> Iterator[Message]:
        rows = zip(stamps[first:last].tolist(), values[first:last].tolist(), strict=True)
        for ns, row in rows:
            known = dict(zip(quantity.parts, row, strict=True))
            yield ns, _encode(known if finite else _sayable(known))

    properties = {
        part: {"type": "number", "description": f"{unit_of(quantity, place)}; left out: not known"}
        for place, part in enumerate(quantity.parts)
    }
    told = {
        "type": "object",
        "description": f"{quantity.meaning} ({quantity.rate})",
        "properties": properties,
    }
    return Channel(quantity.path, quantity.path, told, table.t, messages)


def _sayable(row: dict[str, float]) -> dict[str, Any]:
    return {part: _INFINITY.get(value, value) for part, value in row.items() if not isnan(value)}


def _shown(selection: Selection) -> Iterator[Channel]:
    """Yield what Foxglove shows by itself, of what is selected."""
    tables = {table.quantity.path: table for table in selection.tables}
    place = tables.get(schema.POSITION.path)
    lean = tables.get(schema.ATTITUDE.path)
    if place and lean and len(place.t) == len(lean.t):
        p, (roll, pitch) = place.values, lean.values.T
        turned = quaternions(roll, pitch, p[:, 3])
        yield _made(
            selection, "/tf", "foxglove.FrameTransform", place.t,
            lambda ns, i: foxglove.transform(ns, p[i, :3].tolist(), turned[i].tolist()),
        )  # fmt: skip
    for topic, path in (("/vehicle/pose", schema.POSITION.path), ("/pilot/p_h_pose", schema.P_H.path)):
        if path in tables:
            yield _poses(selection, topic, tables[path])
    if selection.events:
        lines = selection.events
        yield _made(
            selection, "/log", "foxglove.Log", np.array([line.t for line in lines]),
            lambda ns, i: foxglove.log(ns, lines[i].level, lines[i].source, lines[i].text),
        )  # fmt: skip
    mission = selection.flight.mission
    yield _made(
        selection, "/scene", "foxglove.SceneUpdate", np.array([selection.span[0]]),
        lambda ns, _: foxglove.scene(ns, mission),
    )  # fmt: skip


def _poses(selection: Selection, topic: str, table: Table) -> Channel:
    known = np.isfinite(table.values).all(axis=1)
    t, rows = table.t[known], table.values[known]

    def of(ns: int, i: int) -> foxglove.Json:
        x, y, z, yaw = rows[i].tolist()
        return foxglove.pose(ns, (x, y, z), yaw)

    return _made(selection, topic, "foxglove.PoseInFrame", t, of)


def _made(
    selection: Selection,
    topic: str,
    kind: str | Mapping[str, Any],
    t: Numbers,
    of: Callable[[int, int], foxglove.Json],
) -> Channel:
    """Return a channel whose messages are made one by one, from their time, ns, and their place.

    Args:
        selection: Where its times count from.
        topic: Its name.
        kind: One of Foxglove's schemas by name, or a schema of the topic's own.
        t: (n,), s.
        of: Makes one.
    """
    stamps = (nanoseconds(t) + selection.started_ns).tolist()

    def messages(first: int, last: int) -> Iterator[Message]:
        return ((stamps[i], _encode(of(stamps[i], i))) for i in range(first, last))

    if isinstance(kind, str):
        return Channel(topic, kind, foxglove.SCHEMAS[kind], t, messages)
    return Channel(topic, topic, kind, t, messages)


def _attach(writer: Writer, selection: Selection) -> None:
    """Put properties, mission, settings and the MAVLink log into the file."""
    for name, facts in (("flight", selection.properties), ("device", selection.device)):
        if facts:
            writer.add_metadata(name, {key: str(value) for key, value in facts.items()})
    described = selection.described()
    for name in ("mission", "settings"):
        if described[name] is not None:
            content = tomli_w.dumps(_without_none(described[name])).encode()
            _attached(writer, selection, f"{name}.toml", "application/toml", content)
    tlog = selection.flight.path.with_suffix(".tlog")
    if tlog.is_file():
        _attached(writer, selection, tlog.name, "application/octet-stream", tlog.read_bytes())


def _attached(writer: Writer, selection: Selection, name: str, media: str, content: bytes) -> None:
    at = selection.started_ns
    writer.add_attachment(create_time=at, log_time=at, name=name, media_type=media, data=content)


def _without_none(table: dict[str, Any]) -> dict[str, Any]:
    """TOML has no null: what is None is what is left out."""
    return {
        key: _without_none(value) if isinstance(value, dict) else value
        for key, value in table.items()
        if value is not None
    }
