"""A 2DIY on a pty: takes the bytes of its driver, moves a hand by its torques, answers with its encoders."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from drivers.device import ZERO3, Vector3
from drivers.emulators.faults import Faults
from drivers.emulators.hand import EmulatedHand
from drivers.emulators.pty import Pty
from drivers.two_diy import wire
from drivers.two_diy.driver import CENTRE, WORKSPACE
from drivers.two_diy.kinematics import Pair, inverse, jacobian

# Length of each packet from the host by its first byte.
_LENGTHS = {0: len(wire.RESET), 1: wire.SETUP.size, 2: wire.TORQUES.size}


class TwoDiyEmulator:
    """A 2DIY with a hand on it.

    Args:
        hand: Whose hand; what it does along z is not seen.
        clock: Monotonic seconds.

    Attributes:
        faults: What the line does to its answers.
        silent: It does not answer.
        force: What its motors press with now, N, handle frame.
    """

    WORKSPACE = WORKSPACE

    def __init__(self, hand: EmulatedHand, clock: Callable[[], float]) -> None:
        self._hand = hand
        self._clock = clock
        self._inbox = b""
        self._set_up = False
        self._pty = Pty()
        self.faults = Faults()
        self.silent = False
        self.force: Vector3 = ZERO3

    @property
    def uri(self) -> str:
        """What to give to `--device`."""
        return f"two-diy:{self._pty.path}"

    def descriptors(self) -> Sequence[int]:
        """Return the line's."""
        return self._pty.descriptors()

    def turn(self) -> None:
        """Take what came, move the hand, answer."""
        state = self._hand.step(self._clock(), self.force)
        x, y, _ = state.position
        thetas = inverse(CENTRE[0] + y, CENTRE[1] - x)
        if thetas is None:
            return
        self._inbox += self._pty.read()
        while packet := self._packet():
            self._obey(packet, thetas)

    def unplug(self) -> None:
        """Pull its cable out."""
        self._pty.unplug()

    def plug(self) -> None:
        """Put its cable in again, on the same path."""
        self._pty.plug()

    def close(self) -> None:
        """Unplug it for good and let the hand go."""
        self._pty.close()
        self._hand.close()

    def _packet(self) -> bytes:
        """Take the next whole packet off the inbox, b"" where there is none."""
        if not self._inbox:
            return b""
        length = _LENGTHS.get(self._inbox[0])
        if length is None:
            self._inbox = self._inbox[1:]
            return self._packet()
        if len(self._inbox) < length:
            return b""
        packet, self._inbox = self._inbox[:length], self._inbox[length:]
        return packet

    def _obey(self, packet: bytes, thetas: Pair) -> None:
        if packet == wire.RESET:
            self._set_up, self.force = False, ZERO3
        elif len(packet) == wire.SETUP.size:
            self._set_up = packet == wire.setup()
        elif self._set_up:
            _, _, torque2, torque1 = wire.TORQUES.unpack(packet)
            self.force = _pressed(thetas, torque1, torque2)
            degrees = (_counted(thetas[1], wire.HOME[1]), _counted(thetas[0], wire.HOME[0]))
            answer = wire.REPLY.pack(wire.DEVICE, *degrees)
            if not self.silent:
                self._pty.write(self.faults.spoil(answer))


def _counted(theta: float, home: float) -> float:
    """Return an angle, rad, as its encoder sees it, degrees: whole counts from home."""
    turn = 360.0 / wire.COUNTS_PER_TURN
    return math.degrees(home) + turn * round(math.degrees(theta - home) / turn)


def _pressed(thetas: Pair, torque1: float, torque2: float) -> Vector3:
    """Return the force on the hand, N, handle frame: F = J⁻ᵀ τ."""
    matrix = jacobian(*thetas)
    if matrix is None:
        return ZERO3
    (xx, xy), (yx, yy) = matrix
    determinant = xx * yy - xy * yx
    fx = (yy * torque1 - yx * torque2) / determinant
    fy = (xx * torque2 - xy * torque1) / determinant
    return -fy, fx, 0.0
