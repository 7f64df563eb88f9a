"""Putting the Falcon's program into it, which it needs once after each power-up.

The sequence is libnifalcon's (`FalconCommFTD2XX`, `FalconFirmware`). The program is Novint's and may not be given
away with this one; the user says where it is.
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from drivers.device import DeviceError
from drivers.serial_ports import lost, set_low_latency

if TYPE_CHECKING:
    import serial

NAME = "Novint Falcon"
GREETING, GREETED = b"\x0a\x43\x0d", b"\x0a\x44\x2c\x0d"
READY = b"\x41"
GREETING_BAUD = 9600
# 140 000 is what the vendor asks for; of the divisors of 3 MHz, FTDI's chip then took 21, and Linux takes another.
LOADING_BAUD = 142_857
RUNNING_BAUD = 1_500_000
CHUNK = 62
LARGEST_FIRMWARE = 1 << 20
_CORRECT = "correct firmware under [devices.falcon] in groundstation.toml"
_GREETINGS = 100
_PATIENCE_S = 0.05
_ECHO_S = 1.0


def firmware_fault(path: str) -> tuple[str, str] | None:
    """Return why there is no firmware at a path of the user's and what to do, or None."""
    if not path:
        return (
            "it needs its firmware after power-up, and no path to it is set",
            'set firmware = "/path/to/nvent_firmware.bin" under [devices.falcon] in groundstation.toml',
        )
    try:
        size = Path(path).expanduser().stat().st_size
    except (OSError, ValueError, RuntimeError) as error:
        return f"its firmware {path} cannot be read ({error})", _CORRECT
    if not 0 < size <= LARGEST_FIRMWARE:
        return f"{path} is {size} bytes long, which no firmware is", _CORRECT
    return None


def read_firmware(path: str) -> bytes:
    """Return the firmware at a path of the user's.

    Raises:
        DeviceError: No path is set, or it leads to no firmware.
    """
    if fault := firmware_fault(path):
        raise DeviceError(f"{NAME}: {fault[0]}; {fault[1]}.")
    try:
        return Path(path).expanduser().read_bytes()
    except OSError as error:
        raise DeviceError(f"{NAME}: its firmware {path} cannot be read ({error}); {_CORRECT}.") from error


def load(port: serial.Serial, firmware: bytes) -> None:
    """Put the firmware into a Falcon and leave the line at the speed it then speaks. Takes seconds.

    Raises:
        DeviceError: It does not answer, or gives back other bytes than it was sent.
    """
    try:
        _greet(port)
        _send(port, firmware)
        port.baudrate = RUNNING_BAUD
        port.timeout = 0.0
        port.reset_input_buffer()
    except OSError as error:
        raise lost(port, NAME, error) from error
    set_low_latency(port, low=True)


def _greet(port: serial.Serial) -> None:
    # With bytes handed on at once instead of after 16 ms the greeting is known to fail.
    set_low_latency(port, low=False)
    port.timeout = _PATIENCE_S
    port.write_timeout = _ECHO_S
    port.baudrate = GREETING_BAUD
    port.reset_input_buffer()
    port.reset_output_buffer()
    _modem_lines(port, rts=False, dtr=False)
    _modem_lines(port, rts=False, dtr=True)
    for _ in range(_GREETINGS):
        port.write(GREETING)
        if port.read_until(GREETED, 16).endswith(GREETED):
            break
    else:
        raise DeviceError(f"{port.port}: the {NAME} does not answer; check its power supply.")
    _modem_lines(port, rts=False, dtr=False)
    port.baudrate = LOADING_BAUD
    port.reset_input_buffer()
    port.timeout = _ECHO_S
    port.write(READY)
    if not port.read_until(READY, 4).endswith(READY):
        raise DeviceError(f"{port.port}: the {NAME} is not ready for its firmware; switch it off and on.")


def _send(port: serial.Serial, firmware: bytes) -> None:
    for begin in range(0, len(firmware), CHUNK):
        chunk = firmware[begin : begin + CHUNK]
        port.write(chunk)
        if port.read(len(chunk)) != chunk:
            raise DeviceError(
                f"{port.port}: the {NAME} gave back other firmware than it was sent, at byte {begin}; "
                "switch it off and on, and check the cable."
            )


def _modem_lines(port: serial.Serial, *, rts: bool, dtr: bool) -> None:
    # A pseudo-terminal has none.
    with contextlib.suppress(OSError):
        port.rts = rts
        port.dtr = dtr
