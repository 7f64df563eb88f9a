"""`groundstation devices`: does what was asked with haptic devices."""

from __future__ import annotations

import argparse
import sys

from groundstation.errors import InputError


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code.

    Raises:
        InputError: There is no such device, or no terminal where one is needed.
    """
    if asked.act == "emulate":
        from groundstation.devices import emulating

        if asked.name is None:
            return emulating.listing()
        return emulating.emulate(asked.name, asked.hand, asked.link)
    if asked.act in (None, "list"):
        from groundstation.devices import listing

        return listing.show(as_json=asked.json, config=asked.config)
    return _with_device(asked)


def _with_device(asked: argparse.Namespace) -> int:
    """Calibrate a device or try it out."""
    from groundstation.devices import calibrating, making

    if asked.act == "calibrate" and asked.forget is not None:
        return calibrating.forget(asked.device.partition(":")[0], asked.forget)
    device = making.raw_device(asked.device, asked.config)
    if asked.act == "calibrate":
        return calibrating.calibrate(asked.device.partition(":")[0], device)
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise InputError("devices test draws on a terminal; run it in one.")
    from groundstation.tui import device_test

    return device_test.try_out(making.calibrated(device, asked.device))
