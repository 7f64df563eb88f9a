"""Where vehicles are: heard on the usual UDP ports, and on serial ports by the USB identity behind them.

Nothing is said to anybody: a port is listened to for a moment, a serial port is not even opened.
"""

from __future__ import annotations

import contextlib
import select
import socket
import time
from typing import NamedTuple

from groundstation.vehicle.gate import message_number, origin

# PX4's simulators and companions send to the first, ground stations usually listen on the second.
UDP_PORTS = (14540, 14550)
HEARD_S = 1.2
BAUD_RADIO, BAUD_USB = 57_600, 115_200
_AUTOPILOTS = {3: "ArduPilot", 12: "PX4"}
# Vendors whose ports are flight controllers by USB: Auterion and Holybro's 3DR, Hex, CUAV and others of PX4.
_CONTROLLERS = frozenset({0x26AC, 0x2DAE, 0x3162, 0x3185, 0x1209})


class Place(NamedTuple):
    """Where a vehicle is, or may be.

    Attributes:
        url: As for `--connect`.
        words: What is known of it, for people.
        heard: A vehicle speaks there now.
    """

    url: str
    words: str
    heard: bool = False


def listen(ports: tuple[int, ...] = UDP_PORTS, seconds: float = HEARD_S) -> list[Place]:
    """Listen on UDP ports for vehicles; return a place for every port that is free to listen on."""
    places: list[Place] = []
    with contextlib.ExitStack() as stack:
        open_: dict[socket.socket, int] = {}
        for port in ports:
            udp = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            try:
                udp.bind(("0.0.0.0", port))  # noqa: S104 - vehicles are on other machines, too
            except OSError as error:
                places.append(Place(f"udpin://0.0.0.0:{port}", f"taken: {error.strerror}"))
            else:
                open_[udp] = port
        heard = _hear(open_, seconds)
    for port in open_.values():
        words = heard.get(port, "nobody heard yet")
        places.append(Place(f"udpin://0.0.0.0:{port}", words, port in heard))
    return sorted(places, key=lambda place: (not place.heard, place.url))


def _hear(sockets: dict[socket.socket, int], seconds: float) -> dict[int, str]:
    """Return who speaks on which port, within the usual second between heartbeats."""
    heard: dict[int, str] = {}
    end = time.monotonic() + seconds
    while len(heard) < len(sockets) and (left := end - time.monotonic()) > 0:
        for ready in select.select(list(sockets), [], [], left)[0]:
            with contextlib.suppress(OSError):
                if words := heartbeat_words(ready.recv(65_536)):
                    heard[sockets[ready]] = words
    return heard


def heartbeat_words(data: bytes) -> str:
    """Say who sent a datagram that begins with an autopilot's heartbeat, or ""."""
    if message_number(data) != 0:
        return ""
    header = 10 if data[0] == 0xFD else 6
    payload = data[header : header + data[1]].ljust(9, b"\0")
    if payload[5] == 8:
        return ""  # MAV_AUTOPILOT_INVALID: another ground station, or a part of a vehicle
    return f"system {origin(data)[1]}, {_AUTOPILOTS.get(payload[5], 'an autopilot')} heard"


def serial_places() -> list[Place]:
    """Return the serial ports of USB devices, flight controllers first."""
    from serial.tools import list_ports

    ports = [port for port in list_ports.comports() if port.vid is not None]
    ports.sort(key=lambda port: (port.vid not in _CONTROLLERS, port.device))
    return [
        Place(
            f"serial://{port.device}:{BAUD_USB if port.vid in _CONTROLLERS else BAUD_RADIO}",
            usb_words(port.product, port.vid, port.pid, port.serial_number),
        )
        for port in ports
    ]


def usb_words(product: str | None, vendor: int, number: int, serial: str | None) -> str:
    """Say what a USB device calls itself, with its identity."""
    return f"{product or 'USB serial port'} ({vendor:04x}:{number:04x}{f', {serial}' if serial else ''})"
