"""Which haptic devices are connected, and for those that cannot be used, why and what to do about it."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Literal

from drivers.registry import BUILT_IN, driver_module, driver_names


@dataclass(frozen=True, slots=True)
class Found:
    """A device that is connected, or one whose driver cannot look for it.

    Attributes:
        driver: Name of its driver.
        uri: What to give to `--device` for this very device.
        name: Vendor and model, for people.
        serial: Stable identity of this very device, or "".
        port: Where it is connected, or "".
        renders: How it answers: with force, with rumble, or not at all.
        rate: Servo rate it is made for, Hz.
        usable: It can be opened now, as far as can be told without opening it.
        why: Where it is not usable, the reason.
        remedy: Where it is not usable, the command or act that changes it.
    """

    driver: str
    uri: str
    name: str
    serial: str
    port: str
    renders: Literal["force", "rumble", "nothing"]
    rate: float
    usable: bool = True
    why: str = ""
    remedy: str = ""


Discover = Callable[..., list[Found]]
"""What a driver's module may offer as `discover`: it returns within 0.5 s and takes no device from anybody. Of
the user's settings it gets, as keywords, those that it names among its parameters."""


def discover_all(settings: Mapping[str, Mapping[str, object]] | None = None) -> list[Found]:
    """Return what all drivers find, ours and those of other packages, by the drivers' names.

    A driver finds devices by a function `discover` in its module; one without finds none.

    Args:
        settings: The user's, by driver, the table `[devices]` of `groundstation.toml`.
    """
    tables = settings or {}
    # Drivers that share a module share what it finds.
    names = {driver_module(name): name for name in reversed(driver_names())}
    return [found for name in sorted(names.values()) for found in _discover(name, tables.get(name, {}))]


def _discover(name: str, settings: Mapping[str, object]) -> list[Found]:
    if name in BUILT_IN:
        return _look(name, settings)
    try:
        return _look(name, settings)
    except Exception as error:  # noqa: BLE001 - another package's code may fail in any way; ours are still listed
        return [
            unusable(
                name, name, f"its driver fails ({type(error).__name__}: {error})", "reinstall its package"
            )
        ]


def _look(name: str, settings: Mapping[str, object]) -> list[Found]:
    discover: Discover | None = getattr(import_module(driver_module(name)), "discover", None)
    if discover is None:
        return []
    wanted = inspect.signature(discover).parameters
    return discover(**{key: value for key, value in settings.items() if key in wanted})


def unusable(driver: str, name: str, why: str, remedy: str) -> Found:
    """Return a device that could not even be looked for, as where a library is missing."""
    return Found(driver, driver, name, "", "", "nothing", 0.0, usable=False, why=why, remedy=remedy)
