"""From what the user writes, `driver` or `driver:address`, to a device. Drivers are imported on demand."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.metadata import entry_points
from typing import cast

from drivers.device import DeviceError, HapticDevice

GROUP = "groundstation.drivers"
"""Entry point group of drivers in other packages: callables from the address to a `HapticDevice`."""

BUILT_IN = {
    "scripted": ("drivers.scripted", "ScriptedHand"),
    "virtual": ("drivers.virtual", "VirtualHandle"),
}


def make_device(uri: str) -> HapticDevice:
    """Return the device that `uri` names, not yet open.

    Args:
        uri: `driver` or `driver:address`, as `virtual:/run/user/1000/stick`.

    Raises:
        DeviceError: There is no such driver (the message lists those there are), it cannot be loaded, or it
            does not accept the address.
    """
    name, _, address = uri.partition(":")
    return _factory(name)(address)


def driver_names() -> list[str]:
    """Return the names of all drivers, ours and those of other packages, sorted."""
    return sorted({*BUILT_IN, *entry_points(group=GROUP).names})


def _factory(name: str) -> Callable[[str], HapticDevice]:
    if name in BUILT_IN:
        module, attribute = BUILT_IN[name]
        return getattr(import_module(module), attribute)
    found = tuple(entry_points(group=GROUP, name=name))
    if not found:
        known = ", ".join(driver_names())
        raise DeviceError(f"{name!r}: no such haptic device; use one of: {known}.")
    try:
        return cast("Callable[[str], HapticDevice]", found[0].load())
    except (ImportError, AttributeError) as error:
        raise DeviceError(
            f"{name}: its driver {found[0].value} cannot be loaded ({error}); reinstall its package."
        ) from error
