"""All that crosses the bus is recorded: no field of any record can change without the recording changing."""

from __future__ import annotations

import ctypes

import pytest
from recording_support import a_run, batch_of

from groundstation.messages import CommandKind, Phase, Record, Topic
from groundstation.recording.batch import TOPICS
from groundstation.recording.item import Chunk
from groundstation.recording.session import Translator

START = 50.0
# By which the words of a row are found, or that decide whether what is beside them is known.
_KNOWN = {
    "phase": Phase.ENGAGED, "valid": 1, "connected": 1, "present": 1, "homed": 1, "heard_t": START, "ok": 1,
    "armed": 1, "on_leash": 0, "guarding": 1, "active": 1,
}  # fmt: skip


# The rows of the handle are the ticks, counted on from the last of `/servo/tick`; the score so far is worked out anew
# from what is recorded.
_NOT_KEPT = {("handle", "tick"), ("mission_progress", "score")}


def fields() -> list[tuple[Topic, str]]:
    every = [(topic, name) for topic in TOPICS for name, *_ in topic.record._fields_ if name != "t"]
    return [(topic, name) for topic, name in every if (topic.name, name) not in _NOT_KEPT]


def a_record(kind: type[Record], t: float, /, **changed: object) -> Record:
    names = {name for name, *_ in kind._fields_}
    return kind(t=t, **{name: value for name, value in _KNOWN.items() if name in names} | changed)


def other(kind: type[Record], name: str) -> object:
    """Return a value that the field does not have in `a_record`."""
    field = dict(kind._fields_)[name]
    if issubclass(field, ctypes.Array) and field._type_ is ctypes.c_char:
        return b"other"
    if issubclass(field, ctypes.Array):
        return field(*[0.25] * field._length_)
    if name == "kind":
        return CommandKind.LAND
    return 0.25 if field in {ctypes.c_double, ctypes.c_float} else 0 if _KNOWN.get(name) else 1


def told(tmp_path, topic: Topic, name: str | None) -> list[tuple[str, str]]:
    translator = Translator(a_run(tmp_path / "flight"), START)
    list(translator.opening())
    for _ in range(2):
        list(translator.items(batch_of(topic, a_record(topic.record, START))))
    changed = {} if name is None else {name: other(topic.record, name)}
    found: list[tuple[str, str]] = []
    for item in translator.items(batch_of(topic, a_record(topic.record, START + 1.0, **changed))):
        words = (
            [str(column.as_arrow_array().to_pylist()) for column in item.columns]
            if isinstance(item, Chunk)
            else [repr(item.content)]
        )
        found += [(item.path, word) for word in words]
    return found


@pytest.mark.parametrize(
    ("topic", "name"), fields(), ids=lambda each: each if isinstance(each, str) else each.name
)
def test_a_field_that_changes_changes_the_recording(tmp_path, topic, name):
    assert told(tmp_path, topic, name) != told(tmp_path, topic, None)
