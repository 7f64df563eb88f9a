"""The Novint Falcon's driver.

One request a tick: `write_force` sends it, and the next `read` finds the reply, so neither ever waits. What `read`
returns was measured when the last tick's force arrived, one tick ago, and says so in its time.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.discovery import Found
from drivers.falcon import firmware as loader
from drivers.falcon.guard import Guard
from drivers.falcon.kinematics import CENTRE, Pose, combine, locate
from drivers.falcon.packet import (
    BLUE,
    GREEN,
    NO_FORCE,
    RED,
    Counts,
    Reader,
    Reply,
    Request,
    encode_request,
)
from drivers.falcon.units import COUNT, force_counts, from_handle, leg_angle, to_handle
from drivers.serial_ports import (
    UsbId,
    find_port,
    lost,
    open_port,
    port_fault,
    read_now,
    set_low_latency,
    usb_ports,
    without_port,
    write_now,
)
from drivers.vectors import finite
from drivers.velocity import Windowed

if TYPE_CHECKING:
    import serial

NAME = loader.NAME
USB = UsbId(0x0403, 0xCB48)
WORKSPACE = 0.04
FORCE_LIMIT = 8.0
STIFFNESS_LIMIT = 3000.0
RATE = 1000.0

REPLY_S = 0.004
"""A request not answered by then was lost, and another is sent."""

SILENCE_S = 0.05
_FEEL_S = 1.0
_ANSWER_S = 0.03
_ANSWER_TRIES = 5
_LOADS = 3


class Falcon:
    """A Falcon on a serial port.

    Args:
        address: "" for the first one, its port, or its USB serial number.
        clock: Monotonic seconds.
        firmware: Path of its firmware, needed after power-up.

    Attributes:
        refused: Samples of this connection that were not believed.

    Raises:
        DeviceError: The firmware's path is not text.
    """

    def __init__(
        self, address: str, clock: Callable[[], float] = time.monotonic, *, firmware: str = ""
    ) -> None:
        if not isinstance(firmware, str):  # pyright: ignore[reportUnnecessaryIsInstance] - from a user's file
            raise DeviceError(f"devices.falcon.firmware: {firmware!r} is not a path; write it in quotes.")
        self._address = address
        self._firmware = firmware
        self._clock = clock
        self._port: serial.Serial | None = None
        self._serial = ""
        self._forget()

    @property
    def info(self) -> DeviceInfo:
        """What a Falcon is and can do."""
        return DeviceInfo(
            NAME, self._serial, 3, WORKSPACE, FORCE_LIMIT, STIFFNESS_LIMIT, RATE, renders="force"
        )

    def open(self) -> None:
        """Take the Falcon; where it has no firmware yet, load it, which takes seconds.

        Raises:
            DeviceError: It is not there, may not be used, has no firmware, or does not answer.
        """
        self.close()
        found = find_port(self._address, NAME, USB)
        self._serial = found.serial
        port = open_port(found.path, NAME, loader.RUNNING_BAUD, lines=False)
        self._port = port
        try:
            set_low_latency(port, low=True)
            if not self._answers(port):
                self._load(port)
        except DeviceError:
            self.close()
            raise
        self._heard_t = self._clock()

    def read(self) -> HandleState:
        """Return the handle as of the newest reply; while the legs are not homed it rests in its centre.

        Raises:
            DeviceError: It was unplugged, has said nothing for 50 ms, or is not open.
        """
        port = self._opened()
        now = self._clock()
        self._take(now, self._reader.replies(read_now(port, NAME)))
        if not self._written:
            self._ask(port, NO_FORCE)
        self._written = False
        state = self._state()
        if now - state.device_time > SILENCE_S:
            raise DeviceError(f"{port.port}: the {NAME} is silent; check its power supply and cable.")
        return state

    def write_force(self, force: Vector3) -> None:
        """Render a force on the hand, N, handle frame; none while the legs are not homed.

        Raises:
            DeviceError: It is not finite, and then zero; or the Falcon was unplugged or is not open.
        """
        port = self._opened()
        if not finite(force):
            self._ask(port, NO_FORCE)
            raise DeviceError(f"{NAME}: the force is not a number; it is set to zero.")
        counts = NO_FORCE
        if self._pose is not None:
            counts = force_counts(self._pose, from_handle(force))
        self._written = True
        self._ask(port, counts)

    def close(self) -> None:
        """Render nothing and let the Falcon go."""
        port, self._port = self._port, None
        if port is not None:
            try:
                write_now(port, NAME, encode_request(Request(NO_FORCE, RED)))
            except DeviceError:
                pass  # it is gone already
            finally:
                port.close()
        self._forget()

    @property
    def refused(self) -> int:
        """Samples of this connection that were not believed."""
        return self._guard.refused + self._unreachable

    def _forget(self) -> None:
        self._reader = Reader()
        self._guard = Guard()
        self._legs = (Windowed(1.0), Windowed(1.0), Windowed(1.0))
        self._pose: Pose | None = None
        self._velocity = ZERO3
        self._unreachable = 0
        self._moved_t = self._asked_t = self._heard_t = self._felt_t = -math.inf
        self._waiting = self._written = False

    def _opened(self) -> serial.Serial:
        if self._port is None:
            raise DeviceError(f"The {NAME} is not open; open it first.")
        return self._port

    def _answers(self, port: serial.Serial) -> bool:
        """Say whether the Falcon runs its firmware: it answers a request."""
        port.timeout = _ANSWER_S
        try:
            for _ in range(_ANSWER_TRIES):
                port.write(encode_request(Request(NO_FORCE, RED)))
                if self._reader.replies(port.read_until(b">", 64)):
                    return True
        except OSError as error:
            raise lost(port, NAME, error) from error
        finally:
            port.timeout = 0.0
        return False

    def _load(self, port: serial.Serial) -> None:
        firmware = loader.read_firmware(self._firmware)
        why = DeviceError(
            f"{port.port}: the {NAME} has taken its firmware and does not answer; "
            "check that devices.falcon.firmware is a Falcon's, and switch it off and on."
        )
        for _ in range(_LOADS):
            try:
                loader.load(port, firmware)
            except DeviceError as error:
                why = error
                continue
            if self._answers(port):
                return
        raise why

    def _take(self, now: float, replies: list[Reply]) -> None:
        believed: Counts | None = None
        for reply in replies:
            self._heard_t, self._waiting = now, False
            if self._guard.take(self._asked_t, reply):
                believed = reply.encoders
        if believed is not None and self._asked_t > self._moved_t:
            self._move(self._asked_t, believed)

    def _move(self, t: float, encoders: Counts) -> None:
        """Take a believed sample of a moment, s."""
        if not self._guard.homed:
            self._rest()
            return
        a, b, c = encoders
        start = CENTRE if self._pose is None else self._pose.position
        pose = locate((leg_angle(a), leg_angle(b), leg_angle(c)), start)
        if pose is None:
            self._unreachable += 1
            return
        if t - self._moved_t > SILENCE_S:
            self._rest()
        one, two, three = self._legs
        rates = (one.add(t, a) * COUNT, two.add(t, b) * COUNT, three.add(t, c) * COUNT)
        self._pose, self._velocity, self._moved_t = pose, combine(pose.columns, rates), t

    def _rest(self) -> None:
        self._pose, self._velocity = None, ZERO3
        for leg in self._legs:
            leg.reset()

    def _state(self) -> HandleState:
        buttons = self._guard.buttons
        if self._pose is None:
            return HandleState(ZERO3, ZERO3, 0.0, buttons, homed=False, device_time=self._heard_t)
        x, y, z = self._pose.position
        position = to_handle((x - CENTRE[0], y - CENTRE[1], z - CENTRE[2]))
        velocity = to_handle(self._velocity)
        return HandleState(position, velocity, 0.0, buttons, homed=True, device_time=self._moved_t)

    def _ask(self, port: serial.Serial, forces: Counts) -> None:
        """Send a request, unless the last one is still to be answered."""
        now = self._clock()
        if self._waiting and now - self._asked_t < REPLY_S:
            return
        if forces != NO_FORCE:
            self._felt_t = now
        ready = GREEN if now - self._felt_t < _FEEL_S else BLUE
        lights = RED if self._pose is None else ready
        self._asked_t, self._waiting = now, True
        write_now(port, NAME, encode_request(Request(forces, lights)))


def discover(*, firmware: str = "") -> list[Found]:
    """Return the Falcons that are connected; `firmware` is the path from the user's settings."""
    found: list[Found] = []
    for port in usb_ports(USB):
        fault = port_fault(port.path, USB) or loader.firmware_fault(firmware)
        found.append(_found(port.path, port.serial, fault))
    return found + [_found("", number, _NO_PORT) for number in without_port(USB)]


_NO_PORT = (
    "Linux does not know that it is an FTDI serial device, and gave it no port",
    "sudo modprobe ftdi_sio && echo 0403 cb48 | sudo tee /sys/bus/usb-serial/drivers/ftdi_sio/new_id",
)


def _found(path: str, number: str, fault: tuple[str, str] | None) -> Found:
    why, remedy = fault or ("", "")
    uri = f"falcon:{number or path}".rstrip(":")
    return Found(
        "falcon", uri, NAME, number, path, "force", RATE, usable=fault is None, why=why, remedy=remedy
    )
