"""Where a serial port is now: Linux numbers USB ports anew as they come back, the device behind stays what it is."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from serial.tools.list_ports_common import ListPortInfo


class Identity(NamedTuple):
    """What a USB device says it is: vendor and product, and its serial number where it has one."""

    vendor: int
    product: int
    serial: str | None


def present() -> list[ListPortInfo]:
    """Return the serial ports that are there."""
    from serial.tools import list_ports

    return list(list_ports.comports())


def identity(place: str, ports: Iterable[ListPortInfo]) -> Identity | None:
    """Return what is behind a port, or None where that is no USB device."""
    path = os.path.realpath(place)
    return next((who for port in ports if port.device == path and (who := _of(port)) is not None), None)


def find(place: str, who: Identity | None, ports: Iterable[ListPortInfo]) -> str:
    """Return the port that a device is at now, or "".

    Another device at its old place is not it, and between several that call themselves alike nothing is guessed.

    Args:
        place: Where it was.
        who: What it is, or None: then only the place counts.
        ports: Those that are there.
    """
    if who is None:
        return place
    found = [port.device for port in ports if _of(port) == who]
    if os.path.realpath(place) in found:
        return place
    return found[0] if len(found) == 1 else ""


def _of(port: ListPortInfo) -> Identity | None:
    if port.vid is None or port.pid is None:
        return None
    return Identity(port.vid, port.pid, port.serial_number)
