"""`groundstation devices calibrate`: centre and travel of a handle, step by step, in words. No force meanwhile."""

from __future__ import annotations

import datetime
import time
from collections.abc import Callable

from drivers.device import HapticDevice, Vector3
from groundstation.devices.calibration import (
    calibration_path,
    calibrations_folder,
    load_calibration,
    measured,
    save_calibration,
)
from groundstation.devices.loop import DeviceLoop
from groundstation.errors import InputError

_APPEAR_S = 10.0
_REST_S = 1.0
_LOOK_S = 0.05


def calibrate(driver: str, device: HapticDevice, *, ask: Callable[[str], str] = input) -> int:
    """Measure a device's centre, and travel where it renders no force; keep it under its serial number.

    Args:
        driver: Name of its driver.
        device: Not yet open.
        ask: Prints a sentence and waits for Enter.

    Returns:
        The exit code.

    Raises:
        InputError: There is no device, the handle was not kept still, or the file cannot be written.
    """
    loop = DeviceLoop(device)
    loop.start()
    try:
        _wait(loop, lambda: loop.state is not None, "is not there")
        if loop.state is not None and not loop.state.homed:
            print(
                f"{loop.keeper.info.name}: move the handle slowly through its whole travel until it is homed."
            )
            _wait(loop, lambda: loop.state is not None and loop.state.homed, "was not homed")
        info = loop.keeper.info
        ask(f"{info.name}: let the handle go, or hold it still in its middle, then press Enter.")
        resting = _collect(loop, lambda: time.sleep(_REST_S))
        swept: list[Vector3] = []
        if info.renders != "force":
            ask("Press Enter, then move the handle all the way round, on every axis.")
            swept = _collect(loop, lambda: ask("Press Enter when done."))
        made = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        calibration = measured(info, made, resting, swept)
        path = calibration_path(calibrations_folder(), driver, info.serial)
        save_calibration(path, calibration)
    finally:
        loop.stop()
    center = ", ".join(f"{1e3 * value:.2f}" for value in calibration.center)
    scale = ", ".join(f"{value:.3g}" for value in calibration.scale)
    print(f"Centre [{center}] mm, travel scaled by [{scale}]; kept in {path}.")
    return 0


def forget(driver: str, serial: str) -> int:
    """Remove a device's calibration; return the exit code.

    Raises:
        InputError: It has none.
    """
    path = calibration_path(calibrations_folder(), driver, serial)
    if load_calibration(path) is None:
        raise InputError(f"{path}: there is no such calibration; nothing to forget.")
    path.unlink()
    print(f"{path} is removed; the device is as its driver has it.")
    return 0


def _wait(loop: DeviceLoop, done: Callable[[], bool], failure: str) -> None:
    ends = time.monotonic() + _APPEAR_S
    while not done():
        if time.monotonic() > ends:
            name = loop.keeper.info.name
            raise InputError(
                loop.words or f"{name}: the handle {failure} within {_APPEAR_S:.0f} s; try again."
            )
        time.sleep(_LOOK_S)


def _collect(loop: DeviceLoop, meanwhile: Callable[[], object]) -> list[Vector3]:
    loop.collect()
    meanwhile()
    samples = loop.collected()
    if loop.state is None or not samples:
        raise InputError(
            f"the device was lost while it was calibrated ({loop.words}); plug it in and try again."
        )
    return samples
