"""From what the user writes to a device, with the user's settings and the device's calibration."""

from __future__ import annotations

from pathlib import Path

from drivers.device import DeviceError, HapticDevice
from drivers.registry import make_device
from groundstation.config import Settings, load_settings
from groundstation.devices.calibration import Calibrated, calibrations_folder
from groundstation.errors import InputError


def raw_device(uri: str, config: Path | None) -> HapticDevice:
    """Return a device as its driver has it, not yet open.

    Raises:
        InputError: There is no such device, or its settings are wrong.
    """
    try:
        return _made(uri, load_settings(config))
    except DeviceError as error:
        raise InputError(str(error) if uri in str(error) else f"{uri}: {error}") from error


def flight_device(uri: str, settings: Settings) -> HapticDevice:
    """Return a device for a flight, not yet open: with settings and calibration.

    Raises:
        DeviceError: There is no such device, or its settings are wrong.
    """
    return calibrated(_made(uri, settings), uri)


def calibrated(device: HapticDevice, uri: str) -> Calibrated:
    """Return a device with its calibration, where it has one."""
    return Calibrated(device, _driver(uri), calibrations_folder())


def _made(uri: str, settings: Settings) -> HapticDevice:
    return make_device(uri, settings.devices.get(_driver(uri)))


def _driver(uri: str) -> str:
    return uri.partition(":")[0]
