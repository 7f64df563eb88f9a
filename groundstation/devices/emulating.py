"""`groundstation devices emulate`: a double of a device to fly with, byte for byte, in a process of its own."""

from __future__ import annotations

import gc
import signal
import sys
import time
from pathlib import Path

from drivers.device import DeviceError
from drivers.emulators.registry import emulator_names, make_emulator, serve
from groundstation.errors import InputError


def listing() -> int:
    """Print the emulators there are; return the exit code."""
    print(*emulator_names(), sep="\n")
    return 0


def emulate(name: str, hand: str, link: Path | None) -> int:
    """Run an emulator until it is told to end; return the exit code.

    Args:
        name: Of the device.
        hand: What its hand does, `rest`, `circle` or a .csv file, or the socket where datagrams of `drivers.stick`
            say so.
        link: A path that shall always lead to the emulator's port, or None.

    Raises:
        InputError: There is no such emulator, or a path cannot be used.
    """
    try:
        emulator = make_emulator(name, time.monotonic, hand)
    except DeviceError as error:
        raise InputError(str(error)) from error
    ended = False

    def end(*_: object) -> None:
        nonlocal ended
        ended = True

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, end)
    try:
        uri = _linked(emulator.uri, link) if link else emulator.uri
        print(f"An emulated {name} is there; fly with it: groundstation --sim --device {uri}", flush=True)
        print(f"Its hand: {hand}. Ctrl-C unplugs it.", file=sys.stderr, flush=True)
        gc.freeze()
        serve(emulator, lambda: not ended)
    finally:
        emulator.close()
        if link is not None and link.is_symlink():
            link.unlink()
    return 0


def _linked(uri: str, link: Path) -> str:
    """Make a path lead to the emulator's port and return the URI with that path."""
    driver, _, port = uri.partition(":")
    if not port.startswith("/"):
        raise InputError(f"--link: an emulated {driver} is at {port}, which is no file; leave --link away.")
    try:
        if link.is_symlink():
            link.unlink()
        link.symlink_to(port)
    except OSError as error:
        raise InputError(f"--link {link}: cannot be made ({error.strerror}); choose another path.") from error
    return f"{driver}:{link.absolute()}"
