"""Recordings of earlier schemas in today's terms."""

from __future__ import annotations

from typing import Any

import msgspec

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.recording import schema


def settings_from(properties: dict[str, Any]) -> Settings:
    """Return the settings that a flight was flown with.

    Args:
        properties: The recorder's of the flight.

    Raises:
        InputError: It was recorded by a later version of this program.
    """
    version = int(properties["schema"])
    if version > schema.VERSION:
        raise InputError(
            f"the recording has schema {version}, this program knows up to {schema.VERSION}; "
            "read it with the version that made it, or a later one."
        )
    tables = msgspec.json.decode(properties["settings_json"])
    if version == 1:
        _from_1(tables)
    return msgspec.convert(tables, Settings)


def _from_1(tables: dict[str, dict[str, Any]]) -> None:
    """Equations (4) and (5) were all there was, with the observer or without."""
    control = tables["control"]
    control["passivity"] = "observer" if control["passivity"] else "off"
    control["preset"] = "paper"
    tables["shield"] = {"guard": "off"}
