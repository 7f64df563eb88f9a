"""Serial ports of USB devices: found by identity, opened, and explained where they cannot be."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from drivers.device import DeviceError

if TYPE_CHECKING:
    import serial


USB_DEVICES = Path("/sys/bus/usb/devices")


class UsbId(NamedTuple):
    """Vendor and product of a USB device."""

    vendor: int
    product: int

    def __str__(self) -> str:
        return f"{self.vendor:04x}:{self.product:04x}"


class Port(NamedTuple):
    """A serial port: its path, and the serial number of the USB device behind it, or ""."""

    path: str
    serial: str


def usb_ports(*ids: UsbId) -> list[Port]:
    """Return the serial ports of connected USB devices with one of these identities, sorted by path."""
    from serial.tools import list_ports

    found = (port for port in list_ports.comports() if (port.vid, port.pid) in ids)
    return sorted(Port(port.device, port.serial_number or "") for port in found)


def find_port(address: str, name: str, *ids: UsbId) -> Port:
    """Return the port that the user means.

    Args:
        address: "" for the first one found, a port's path, or a USB serial number.
        name: Of the device, for people.
        ids: Its USB identities.

    Raises:
        DeviceError: It is not there.
    """
    found = usb_ports(*ids)
    for port in found:
        if address in {"", port.path, port.serial}:
            return port
    if "/" in address:
        if Path(address).exists():
            return Port(address, "")
        raise DeviceError(f"{address}: there is no such serial port; plug the {name} in or correct the path.")
    if address and found:
        others = ", ".join(port.serial or port.path for port in found)
        raise DeviceError(f"{address}: no {name} with this serial number; connected: {others}.")
    wanted = " or ".join(map(str, ids))
    raise DeviceError(
        f"No {name} is connected (USB {wanted}); plug it in, see `groundstation devices`, "
        "or give its serial port after a colon."
    )


def open_port(path: str, name: str, baudrate: int, *, lines: bool = True) -> serial.Serial:
    """Open a serial port for this program alone, not waiting on reads.

    Args:
        path: Of the port.
        name: Of the device, for people.
        baudrate: Baud.
        lines: Whether DTR and RTS are raised; some devices take that for a reset.

    Raises:
        DeviceError: It cannot be opened, with the reason and what to do.
    """
    import serial

    if fault := port_fault(path):
        raise DeviceError(f"{path}: {fault[0]}; {fault[1]}.")
    try:
        port = serial.Serial(None, baudrate, timeout=0, write_timeout=0, exclusive=True)
        port.port, port.dtr, port.rts = path, lines, lines
        port.open()
    except (OSError, ValueError) as error:
        raise DeviceError(
            f"{path}: the {name} cannot be opened ({error}); unplug it, plug it in again."
        ) from error
    return port


def read_now(port: serial.Serial, name: str) -> bytes:
    """Return what has come, without waiting.

    Raises:
        DeviceError: The port is gone.
    """
    try:
        return os.read(port.fileno(), 4096)
    except BlockingIOError:
        return b""
    except OSError as error:
        raise lost(port, name, error) from error


def write_now(port: serial.Serial, name: str, data: bytes) -> None:
    """Send, without waiting; what does not fit the port's buffer is lost, as bytes on a line may be.

    pyserial's own write spins while the buffer of a device that takes nothing is full.

    Raises:
        DeviceError: The port is gone.
    """
    try:
        os.write(port.fileno(), data)
    except BlockingIOError:
        return
    except OSError as error:
        raise lost(port, name, error) from error


def lost(port: serial.Serial, name: str, error: OSError) -> DeviceError:
    """Return the error of a port that has failed while it was open."""
    reason = error.strerror or error
    return DeviceError(f"{port.port}: the {name} is gone ({reason}); plug it in again.")


def set_low_latency(port: serial.Serial, *, low: bool) -> None:
    """Let the kernel hand bytes on at once, or gather them for 16 ms; not every port knows this."""
    with contextlib.suppress(ValueError, OSError):
        port.set_low_latency_mode(low)


def port_fault(path: str, *ids: UsbId) -> tuple[str, str] | None:
    """Return why a port cannot be used and what to do, or None; nothing is opened to find out."""
    if not os.access(path, os.R_OK | os.W_OK):
        remedy = udev_rule(*ids) if ids else "run `groundstation devices` for the command that allows it"
        return "you may not read and write this port", remedy
    if holder := _holder(path):
        return f"it is in use by {holder}", "end that program"
    return None


def without_port(*ids: UsbId) -> list[str]:
    """Return the serial numbers, or "", of connected USB devices with these identities that Linux gave no port."""
    found: list[str] = []
    for folder in sorted(USB_DEVICES.glob("*")):
        usb = UsbId(_hex(folder / "idVendor"), _hex(folder / "idProduct"))
        if usb in ids and not any(folder.glob("*/tty*")):
            serial_file = folder / "serial"
            found.append(serial_file.read_text().strip() if serial_file.is_file() else "")
    return found


def udev_rule(*ids: UsbId) -> str:
    """Return the command that lets the person at the screen use these devices."""
    rules = "\\n".join(
        f'SUBSYSTEM=="tty", ATTRS{{idVendor}}=="{usb.vendor:04x}", '
        f'ATTRS{{idProduct}}=="{usb.product:04x}", TAG+="uaccess"'
        for usb in ids
    )
    file = "/etc/udev/rules.d/60-groundstation.rules"
    return (
        f"printf '{rules}\\n' | sudo tee -a {file} && sudo udevadm control --reload && sudo udevadm trigger"
    )


def _holder(path: str) -> str:
    """Return the name and id of another process of ours that has the port open, or ""."""
    target = os.path.realpath(path)
    for folder in Path("/proc").glob("[0-9]*"):
        if int(folder.name) == os.getpid():
            continue
        try:
            if any(str(link.readlink()) == target for link in (folder / "fd").iterdir()):
                return f"{(folder / 'comm').read_text().strip()} (process {folder.name})"
        except OSError:
            continue  # it is another user's, or it has ended
    return ""


def _hex(path: Path) -> int:
    try:
        return int(path.read_text(), 16)
    except (OSError, ValueError):
        return -1
