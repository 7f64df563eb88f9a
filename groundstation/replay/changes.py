"""What is changed against the recording: settings one by one, preset, vehicle, world."""

from __future__ import annotations

import argparse
import tomllib
from collections.abc import Sequence
from typing import Any

import msgspec

from groundstation.config import Settings, load_settings
from groundstation.errors import InputError
from groundstation.pilot.guest import load_controller
from groundstation.review.flight import Flight
from groundstation.training.mission import Mission, find_mission, load_mission
from sim.conditions import BothWays, ConditionsError, parse_conditions
from sim.scenario import Wind


def settings_for(asked: argparse.Namespace, flight: Flight) -> Settings:
    """Return the settings to replay with.

    Raises:
        InputError: A file, a key or a value is wrong.
    """
    settings = load_settings(asked.config) if asked.config else flight.settings
    changes = [*asked.set, *([f'control.preset="{asked.preset}"'] if asked.preset else [])]
    settings = changed(settings, changes)
    if asked.controller:
        load_controller(asked.controller, settings)
    return settings


def changed(settings: Settings, changes: Sequence[str]) -> Settings:
    """Return settings with some of them changed.

    Args:
        settings: To begin with.
        changes: Each as `table.key=value`, the value as in a TOML file.

    Raises:
        InputError: There is no such setting, or it cannot have such a value.
    """
    tables: dict[str, dict[str, Any]] = msgspec.to_builtins(settings)
    for change in changes:
        name, equals, words = change.partition("=")
        table, _, key = name.strip().partition(".")
        if not equals or key not in tables.get(table, {}):
            raise InputError(
                f"--set {change}: is no setting; write TABLE.KEY=VALUE, docs/control.md lists them."
            )
        try:
            tables[table][key] = tomllib.loads(f"value = {words}")["value"]
        except tomllib.TOMLDecodeError:
            tables[table][key] = words
    try:
        return msgspec.convert(tables, Settings)
    except msgspec.ValidationError as error:
        raise InputError(f"--set: {error}") from error


def mission_for(asked: argparse.Namespace, flight: Flight) -> Mission:
    """Return the mission whose world is flown in.

    Raises:
        InputError: There is none, or one asked for cannot be read.
    """
    mission = load_mission(find_mission(asked.mission)) if asked.mission else flight.mission
    if mission is None:
        raise InputError(
            f"{flight.path}: was flown without a mission; name a world to replay it in with --mission."
        )
    choice = mission.vehicle
    choice = msgspec.structs.replace(
        choice, airframe=asked.airframe or choice.airframe, model=asked.model or choice.model
    )
    wind = Wind() if asked.wind == "calm" else mission.wind
    return msgspec.structs.replace(mission, vehicle=choice, wind=wind)


def channel_for(asked: argparse.Namespace) -> BothWays:
    """Return what the channel does each way.

    Raises:
        InputError: It cannot.
    """
    try:
        return parse_conditions(asked.channel)
    except ConditionsError as error:
        raise InputError(f"--channel: {error}") from error
