"""A mission as the text of its file: what is as it would be anyway is left out."""

from __future__ import annotations

import re

import msgspec
import tomli_w
from msgspec import Struct
from msgspec.structs import fields

from groundstation.training.mission import Mission

_WIDEST = 100
# An array as tomli_w writes it, an item a line; a line break within a string it escapes.
_ARRAY = re.compile(r"\[\n((?:    .*,\n)+)\]")


def toml_of(mission: Mission) -> str:
    """Return the text of a mission file; loaded, it is the same mission."""
    return _ARRAY.sub(_in_a_line, tomli_w.dumps(_table(mission)))


def _in_a_line(array: re.Match[str]) -> str:
    items = ", ".join(line.strip().removesuffix(",") for line in array[1].rstrip("\n").split("\n"))
    return f"[{items}]" if len(items) <= _WIDEST else array[0]


def _table(struct: Struct) -> dict[str, object]:
    """Return a struct's keys that differ from their defaults, and what tells its kind."""
    config = struct.__struct_config__
    table: dict[str, object] = {config.tag_field: config.tag} if config.tag_field else {}
    for field in fields(struct):
        value = getattr(struct, field.name)
        if value != field.default:
            table[field.encode_name] = _plain(value)
    return table


def _plain(value: object) -> object:
    if isinstance(value, Struct):
        return _table(value)
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return msgspec.to_builtins(value)
