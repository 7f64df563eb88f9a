"""`groundstation devices`: what is connected, what it can render, and what keeps the rest from being used."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from drivers.discovery import Found, discover_all
from drivers.registry import driver_names
from groundstation.config import load_settings

_ANSWERS = {"force": "force", "rumble": "rumble", "nothing": "no force"}


def show(*, as_json: bool, config: Path | None) -> int:
    """Print the devices; return the exit code: 0, also where there is none, for that is an answer.

    Raises:
        InputError: The settings are wrong.
    """
    found = discover_all(load_settings(config).devices)
    if as_json:
        print(json.dumps([asdict(device) for device in found], indent=2, ensure_ascii=False))
        return 0
    usable = [device for device in found if device.usable]
    print(*(line for device in usable for line in _usable(device)), sep="\n") if usable else _none()
    for device in found:
        if not device.usable:
            print(*_unusable(device), sep="\n")
    return 0


def _none() -> None:
    drivers = ", ".join(driver_names())
    print("No haptic device is connected. The on-screen stick needs none: leave --device away.")
    print(f"Drivers: {drivers}. Emulators: groundstation devices emulate --help")


def _usable(device: Found) -> list[str]:
    where = f" at {device.port}" if device.port else ""
    serial = f", serial number {device.serial}" if device.serial else ""
    rate = f", {device.rate:.0f} Hz" if device.rate else ""
    return [f"{device.name}{where}{serial}: {_ANSWERS[device.renders]}{rate}", f"  --device {device.uri}"]


def _unusable(device: Found) -> list[str]:
    where = f" at {device.port}" if device.port else ""
    return [f"{device.name}{where}: cannot be used, {device.why}", f"  do: {device.remedy}"]
