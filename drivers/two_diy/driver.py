"""Haply 2DIY: a planar handle with force, on a serial port; bytes in `wire`, geometry in `kinematics`.

The device lies flat before the operator, its motors on the far side: the handle frame's x is the mechanism's −y,
its y the mechanism's x, and nothing moves along z.

Each `write_force` asks once, and the `read` of the next tick takes the answer, so neither waits; what `read` returns
was measured when the last tick's force arrived, one tick ago, and says so in its time. A question unanswered for
5 ms is given up. What garbles an answer is told by its length, by ranges, and by how far a hand can go between
two samples.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.discovery import Found
from drivers.serial_ports import UsbId, find_port, open_port, port_fault, read_now, usb_ports, write_now
from drivers.two_diy import wire
from drivers.two_diy.kinematics import Pair, forward, torques
from drivers.vectors import finite, within
from drivers.velocity import Windowed

if TYPE_CHECKING:
    import serial

NAME = "Haply 2DIY"
BOARDS = (UsbId(0x2341, 0x003E), UsbId(0x2341, 0x804D), UsbId(0x2341, 0x804E))
"""Arduino boards that Haply's firmware is for: Due, and the M0 family. The 2DIY has no USB identity of its own."""

WORKSPACE = 0.05
CENTRE: Pair = (0.019, 0.095)
"""Middle of the widest disc in which the linkage is well conditioned (condition number ≤ 3.4), mechanism frame."""

FORCE_LIMIT = 3.0
STIFFNESS_LIMIT = 400.0
"""Not published by the maker: what Haply's own examples use, N and N/m."""

RATE = 1000.0
BAUD_RATE = 115200
"""Any does: the board's port is USB throughout, and 1200 would erase its firmware."""

SILENCE_S = 0.05
REPLY_S = 0.005
SETTLE_S = 0.05
FASTEST = 2.0
HARDEST = 30.0
"""No hand is faster, m/s, or pulls harder, m/s²; a stop that it hits does."""

REACH = 0.065
"""The farthest that the linkage goes from the centre: its rest, m."""

AGREEING = 3
"""As many neighbouring answers are believed wherever they are. The same byte lost from two that are nearly alike
leaves two that are nearly alike."""

WINDOW = 20
"""Most ticks of which the velocity is the mean."""
COUNT = 2 * math.tau / wire.COUNTS_PER_TURN * 0.094
"""Most that the handle moves while each encoder counts one, m; 0.094 m/rad is the Jacobian's largest gain."""


class Sample(NamedTuple):
    """An answer that can be believed as far as it goes: s, rad, m."""

    t: float
    thetas: Pair
    place: Pair


class TwoDiy:
    """A 2DIY.

    Args:
        address: "" for the first board found, a serial port's path, or a USB serial number.
        clock: Monotonic seconds.
        pause: Waits for some seconds; only used while opening.

    Attributes:
        refused: Answers that were not believed since it was opened.
    """

    def __init__(
        self,
        address: str,
        clock: Callable[[], float] = time.monotonic,
        pause: Callable[[float], None] = time.sleep,
    ) -> None:
        self._address = address
        self._clock = clock
        self._pause = pause
        self._port: serial.Serial | None = None
        self._info = _info("")
        self._velocities = (Windowed(COUNT, WINDOW), Windowed(COUNT, WINDOW))
        self._rest()

    @property
    def info(self) -> DeviceInfo:
        """What the device is."""
        return self._info

    def open(self) -> None:
        """Reset the board and tell it what is connected to it.

        Its encoders count from here, and for this the handle must be at rest: pulled toward the motors with
        the cranks spread.

        Raises:
            DeviceError: There is no such port, or it cannot be opened.
        """
        self.close()
        found = find_port(self._address, NAME, *BOARDS)
        port = open_port(found.path, NAME, BAUD_RATE)
        self._port = port
        self._info = _info(found.serial)
        self._rest()
        try:
            for packet in (wire.RESET, wire.setup()):
                write_now(port, NAME, packet)
                self._pause(SETTLE_S)
            self._ask(ZERO3)
        except DeviceError:
            self.close()
            raise
        self._opened_t = self._clock()

    def read(self) -> HandleState:
        """Return where the handle is.

        Raises:
            DeviceError: It is silent or says nothing that can be believed for 50 ms, is gone, or not open.
        """
        now = self._clock()
        self._listen(now)
        newest = self._newest
        if newest is None or now - newest.t > SILENCE_S:
            self._force = ZERO3
            if now - self._opened_t <= SILENCE_S:
                raise DeviceError(f"{NAME}: no answer yet; it was only just opened.")
            raise DeviceError(f"{NAME}: it does not answer; check its cable and power supply.")
        x, y = newest.place
        position = within((CENTRE[1] - y, x - CENTRE[0], 0.0), WORKSPACE)
        return HandleState(position, self._velocity, 0.0, 0, homed=True, device_time=newest.t)

    def write_force(self, force: Vector3) -> None:
        """Render a force, N, in the plane; what is across it cannot be.

        Raises:
            DeviceError: It is not finite (then it is zero), or the device is gone.
        """
        if not finite(force):
            self._force = ZERO3
            raise DeviceError(f"{NAME}: the force is not a number; it is set to zero.")
        self._force = within((force[0], force[1], 0.0), FORCE_LIMIT)
        if self._asked_t is None:
            self._ask(self._force)

    def close(self) -> None:
        """Set the torques to zero and let the port go."""
        port, self._port = self._port, None
        if port is None:
            return
        try:
            write_now(port, NAME, wire.drive(0.0, 0.0))
        except DeviceError:
            pass  # it is gone, and its torques with it
        finally:
            port.close()

    def _rest(self) -> None:
        self._opened_t = self._clock()
        self._asked_t: float | None = None
        self._reply = b""
        self._newest: Sample | None = None
        self._candidate: Sample | None = None
        self._agreed = 0
        self._velocity = self._force = ZERO3
        self.refused = 0
        for velocity in self._velocities:
            velocity.reset()

    def _listen(self, now: float) -> None:
        """Take what came; ask again where nothing is under way, so that a device nobody writes to answers."""
        if self._asked_t is None:
            self._ask(ZERO3)
            return
        asked_t = self._asked_t
        self._reply += read_now(self._opened(), NAME)
        if len(self._reply) >= wire.REPLY.size:
            self._asked_t = None
            self._take(asked_t, self._reply)
        elif now - asked_t > REPLY_S:
            self.refused += bool(self._reply)
            self._ask(self._force)

    def _ask(self, force: Vector3) -> None:
        """Send the torques for a force. What is still in the line belongs to an older question."""
        port = self._opened()
        newest = self._newest
        torque = (0.0, 0.0)
        if newest is not None:
            torque = torques(*newest.thetas, (force[1], -force[0]))
        read_now(port, NAME)
        self._reply = b""
        write_now(port, NAME, wire.drive(*torque))
        self._asked_t = self._clock()

    def _take(self, t: float, reply: bytes) -> None:
        """Believe an answer, to what was asked at `t`, that is where a hand can be; or near one that was not."""
        thetas = wire.angles(reply)
        place = None if thetas is None else forward(*thetas)
        if thetas is None or place is None or math.dist(place, CENTRE) > REACH:
            self.refused += 1
            return
        sample = Sample(t, thetas, place)
        self._agreed = self._agreed + 1 if _near(self._candidate, sample) else 1
        self._candidate = sample
        if self._expected(sample) or self._agreed >= AGREEING:
            self._move(sample)
        else:
            self.refused += self._newest is not None

    def _expected(self, sample: Sample) -> bool:
        """Say whether a hand that goes on as it was moving, or pulls or stops, can be there."""
        newest = self._newest
        if newest is None:
            return False
        elapsed = sample.t - newest.t
        if elapsed > SILENCE_S:
            return False
        along, across, _ = self._velocity
        x, y = newest.place[0] + across * elapsed, newest.place[1] - along * elapsed
        # The velocity is that of half a window ago.
        most = COUNT + HARDEST * elapsed * (elapsed + WINDOW / RATE)
        return math.dist((x, y), sample.place) <= most

    def _move(self, sample: Sample) -> None:
        newest = self._newest
        if newest is not None and sample.t <= newest.t:
            return
        if newest is None or sample.t - newest.t > SILENCE_S:
            for velocity in self._velocities:
                velocity.reset()
        across, along = self._velocities
        x, y = sample.place
        self._velocity = (-along.add(sample.t, y), across.add(sample.t, x), 0.0)
        self._newest = sample

    def _opened(self) -> serial.Serial:
        if self._port is None:
            raise DeviceError(f"{NAME}: it is not open; open it first.")
        return self._port


def discover() -> list[Found]:
    """Return the boards that a 2DIY may be behind; which one it is, only the operator knows."""
    return [_found(port.path, port.serial) for port in usb_ports(*BOARDS)]


def _found(path: str, serial_number: str) -> Found:
    fault = port_fault(path, *BOARDS)
    why, remedy = fault or ("", "")
    return Found(
        driver="two-diy",
        uri=f"two-diy:{serial_number or path}",
        name=f"{NAME}, if it is behind this Arduino board",
        serial=serial_number,
        port=path,
        renders="force",
        rate=RATE,
        usable=fault is None,
        why=why,
        remedy=remedy,
    )


def _near(earlier: Sample | None, sample: Sample) -> bool:
    """Say whether any hand can have come from the one place to the other, and they are neighbours."""
    if earlier is None:
        return False
    elapsed = sample.t - earlier.t
    return elapsed <= 2.0 * REPLY_S and math.dist(earlier.place, sample.place) <= COUNT + FASTEST * elapsed


def _info(serial_number: str) -> DeviceInfo:
    return DeviceInfo(
        name=NAME,
        serial=serial_number,
        axes=2,
        workspace=WORKSPACE,
        force_limit=FORCE_LIMIT,
        stiffness_limit=STIFFNESS_LIMIT,
        rate=RATE,
        renders="force",
    )
