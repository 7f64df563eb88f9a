"""A Novint Falcon on a pseudo-terminal, from power-up on: it takes firmware, homes its legs, and has a hand on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum, auto

from drivers.device import ZERO3, Vector3
from drivers.emulators.faults import Faults
from drivers.emulators.hand import EmulatedHand
from drivers.emulators.pty import Pty
from drivers.falcon import driver, firmware, units
from drivers.falcon.kinematics import CENTRE, angles, combine, slopes
from drivers.falcon.packet import ALL_LEGS, NO_FORCE, Counts, Reader, Reply, Request, encode_reply

HOMING_S = 0.6
"""How long the legs take to find their reference marks: a third of it each."""


class Stage(Enum):
    """How far the device has come since power-up."""

    GREETING = auto()
    LOADING = auto()
    RUNNING = auto()


class FalconEmulator:
    """The device's side of the line.

    Args:
        hand: Whose hand is on the grip.
        clock: Monotonic seconds.
        loaded: It has its firmware already, as one that was used since it was switched on.

    Attributes:
        faults: Of the line, both ways, while the firmware runs; none to begin with.
        silent: It takes everything and answers nothing.
        stage: How far it has come.
        firmware: What it was sent of it.
        request: The newest request.
        force: On the hand now, N, handle frame.
    """

    WORKSPACE = driver.WORKSPACE

    def __init__(self, hand: EmulatedHand, clock: Callable[[], float], *, loaded: bool = True) -> None:
        self._hand = hand
        self._clock = clock
        self._pty = Pty()
        self._reader = Reader()
        self._heard = b""
        self._greeted = False
        self._buttons = 0
        self.faults = Faults()
        self.silent = False
        self.stage = Stage.RUNNING if loaded else Stage.GREETING
        self.firmware = b""
        self._power_up()

    @property
    def uri(self) -> str:
        """What to give to `--device`."""
        return f"falcon:{self._pty.path}"

    def descriptors(self) -> Sequence[int]:
        """Return what becomes readable when a request has come."""
        return self._pty.descriptors()

    def turn(self) -> None:
        """Take what came, move the hand, answer."""
        now = self._clock()
        data = self._pty.read()
        if data and self._pty.baudrate() == firmware.GREETING_BAUD:
            # The real one is reset by DTR, which a pseudo-terminal has not.
            self.stage = Stage.GREETING
        if self.stage is Stage.RUNNING:
            self._run(now, data)
        elif data:
            self._load(data)

    def unplug(self) -> None:
        """Pull its cable out; it loses neither power nor firmware."""
        self._pty.unplug()
        self._reader.reset()

    def plug(self) -> None:
        """Put its cable in again, on the same path."""
        self._pty.plug()

    def close(self) -> None:
        """Unplug it for good and let the hand go."""
        self._pty.close()
        self._hand.close()

    def _power_up(self) -> None:
        self.request = Request(NO_FORCE, homing=False)
        self.force: Vector3 = ZERO3
        self._homing_t: float | None = None
        self._place = CENTRE
        self._zero = self._absolute()

    def _load(self, data: bytes) -> None:
        """Answer as the boot loader does; at another speed it hears noise."""
        speed = self._pty.baudrate()
        if self.stage is Stage.LOADING and speed == firmware.RUNNING_BAUD and self.firmware:
            self.stage = Stage.RUNNING
            self._power_up()
            self._run(self._clock(), data)
        elif speed == firmware.GREETING_BAUD:
            self._heard = (self._heard + data)[-len(firmware.GREETING) :]
            if self._heard == firmware.GREETING:
                self._heard = b""
                self.stage, self.firmware = Stage.LOADING, b""
                self._greeted = False
                self._pty.write(b"\x00" + firmware.GREETED)
        elif self.stage is Stage.LOADING and speed == firmware.LOADING_BAUD:
            self._pty.write(data)
            if not self._greeted:
                self._greeted, data = True, data[len(firmware.READY) :]
            self.firmware += data

    def _run(self, now: float, data: bytes) -> None:
        self._move(now)
        for request in self._reader.requests(self.faults.spoil(data)) if data else ():
            self.request = request
            if not self.silent:
                self._pty.write(self.faults.spoil(encode_reply(self._reply(now))))
        self._press()

    def _move(self, now: float) -> None:
        """Move the hand on to now, with the force that has been on it since the last turn."""
        handle = self._hand.step(now, self.force)
        self._buttons = handle.buttons
        x, y, z = units.from_handle(handle.position)
        self._place = (x + CENTRE[0], y + CENTRE[1], z + CENTRE[2])

    def _press(self) -> None:
        """Let the motors press on the hand: f = −10⁻⁴ ∂θ/∂positionᵀ counts."""
        if self.request.forces == NO_FORCE:
            self.force = ZERO3
            return
        a, b, c = self.request.forces
        share = -1.0 / units.COUNTS_PER_NM
        force = combine(slopes(self._place), (a * share, b * share, c * share))
        self.force = units.to_handle(force)

    def _reply(self, now: float) -> Reply:
        if self._homing_t is None and self.request.homing:
            self._homing_t = now
        share = 0.0 if self._homing_t is None else (now - self._homing_t) / HOMING_S
        legs = (1 << min(int(share * 3.0), 3)) - 1
        here, zero = self._absolute(), NO_FORCE if legs == ALL_LEGS else self._zero
        encoders = (here[0] - zero[0], here[1] - zero[1], here[2] - zero[2])
        return Reply(encoders, self._buttons, legs)

    def _absolute(self) -> Counts:
        """Return the encoders' counts from the reference marks."""
        a, b, c = angles(self._place)
        return _count(a), _count(b), _count(c)


def _count(angle: float) -> int:
    return round((angle - units.ANGLE_AT_ZERO) / units.COUNT)
