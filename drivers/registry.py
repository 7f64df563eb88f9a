"""From what the user writes, `driver` or `driver:address`, to a device. Drivers are imported on demand."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.metadata import entry_points
from typing import cast

from drivers.device import DeviceError, HapticDevice

GROUP = "groundstation.drivers"
"""Entry point group of drivers in other packages: callables from the address to a `HapticDevice`."""

Factory = Callable[..., HapticDevice]
"""Takes the address, and the user's settings as keywords: its keyword-only parameters are the known keys."""

BUILT_IN = {
    "emulated": ("drivers.emulated", "Emulated"),
    "falcon": ("drivers.falcon.driver", "Falcon"),
    "force-dimension": ("drivers.force_dimension", "ForceDimension"),
    "inverse3": ("drivers.inverse3.driver", "Inverse3"),
    "joystick": ("drivers.joystick.driver", "Joystick"),
    "scripted": ("drivers.scripted", "ScriptedHand"),
    "spacemouse": ("drivers.spacemouse", "SpaceMouse"),
    "two-diy": ("drivers.two_diy.driver", "TwoDiy"),
    "virtual": ("drivers.virtual", "VirtualHandle"),
    "virtual-joystick": ("drivers.emulators.joystick", "VirtualJoystick"),
}


def make_device(uri: str, settings: Mapping[str, object] | None = None) -> HapticDevice:
    """Return the device that `uri` names, not yet open.

    Args:
        uri: `driver` or `driver:address`, as `virtual:/run/user/1000/stick`.
        settings: The user's for this driver, the table `[devices.NAME]` of `groundstation.toml`.

    Raises:
        DeviceError: There is no such driver (the message lists those there are), it cannot be loaded, it does
            not know a setting (the message lists those it knows), or it does not accept address or settings.
    """
    name, _, address = uri.partition(":")
    factory = _factory(name)
    settings = settings or {}
    _check_keys(name, factory, settings)
    return factory(address, **settings)


def driver_names() -> list[str]:
    """Return the names of all drivers, ours and those of other packages, sorted."""
    return sorted({*BUILT_IN, *entry_points(group=GROUP).names})


def driver_module(name: str) -> str:
    """Return the name of the module that a driver of `driver_names` is in."""
    if name in BUILT_IN:
        return BUILT_IN[name][0]
    return next(iter(entry_points(group=GROUP, name=name))).module


def _factory(name: str) -> Factory:
    if name in BUILT_IN:
        module, attribute = BUILT_IN[name]
        return getattr(import_module(module), attribute)
    found = tuple(entry_points(group=GROUP, name=name))
    if not found:
        known = ", ".join(driver_names())
        raise DeviceError(f"{name!r}: no such haptic device; use one of: {known}.")
    try:
        return cast("Factory", found[0].load())
    except (ImportError, AttributeError) as error:
        raise DeviceError(
            f"{name}: its driver {found[0].value} cannot be loaded ({error}); reinstall its package."
        ) from error


def _check_keys(name: str, factory: Factory, settings: Mapping[str, object]) -> None:
    parameters = inspect.signature(factory).parameters.values()
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return
    known = [parameter.name for parameter in parameters if parameter.kind is parameter.KEYWORD_ONLY]
    for key in settings:
        if key not in known:
            there_are = f"it has: {', '.join(known)}" if known else "it has none"
            raise DeviceError(f"devices.{name}.{key}: the driver has no such setting; {there_are}.")
