"""The gate: no setpoint leaves that was not given within the last 150 ms, and nothing else that is not meant.

MAVSDK re-sends its last offboard setpoint at 20 Hz from a thread of its own, whatever happened to the
program that gave it. A hung pilot would fly on, with every failsafe of the vehicle satisfied. So MAVSDK's
bytes pass here before they reach a socket, and a frame that steers passes only when it carries a setpoint
that was authorised a moment ago. Every other frame must be on the list in `groundstation.vehicle.allowed`.
"""

from __future__ import annotations

import math
import struct
from collections import deque
from collections.abc import Callable

from groundstation.frames import Vector4, frd_from_flu
from groundstation.vehicle.allowed import COMMAND_LONG, Addressee, refusal

SET_POSITION_TARGET_LOCAL_NED = 84
# MAVSDK sends a command four times, half a second apart; setting a parameter takes a little longer.
KILL_S, PARAMETER_S = 3.0, 5.0

_PAYLOAD = struct.Struct("<I11fHBBB")
_FRAME_BODY_NED = 8
_VELOCITY_AND_YAW_RATE = 1479
_V2, _V1 = 0xFD, 0xFE
_TOLERANCE = 1e-5


class Gate:
    """Decides for every outgoing frame whether it may leave. Called from MAVSDK's thread and from ours.

    Args:
        stale_s: Age from which an authorised setpoint no longer opens the gate, s.
        clock: Monotonic seconds.
        tell: Takes a sentence about what is kept back and is no setpoint, once for each kind.

    Attributes:
        sent: Setpoint frames that passed.
        dropped: Frames that were kept back.
    """

    def __init__(
        self, stale_s: float, clock: Callable[[], float], tell: Callable[[str], None] = lambda _: None
    ) -> None:
        self._stale_s = stale_s
        self._clock = clock
        self._tell = tell
        self._told: set[tuple[int, int]] = set()
        self._authorised: deque[tuple[float, Vector4]] = deque(maxlen=8)
        self._system = 0
        self._modes: frozenset[tuple[float, float]] = frozenset()
        self._kill_until = -math.inf
        self._parameters: dict[str, tuple[float, float]] = {}
        self.sent = 0
        self.dropped = 0

    def address(self, system: int, modes: frozenset[tuple[float, float]]) -> None:
        """Let pass what is for a vehicle, by its system id, and asks it for one of these modes, main and sub."""
        self._system, self._modes = system, modes

    def allow_kill(self) -> None:
        """Let a kill pass for a moment: the operator has confirmed it."""
        self._kill_until = self._clock() + KILL_S

    def allow_parameter(self, name: str, value: float) -> None:
        """Let a parameter be set to a value for a moment."""
        # A new dictionary: another thread may be reading the old one.
        self._parameters = self._parameters | {name: (value, self._clock() + PARAMETER_S)}

    def authorise(self, velocity: Vector4, made_t: float) -> bool:
        """Let frames pass that carry this velocity (FLU, m/s and rad/s), while it is young.

        Returns:
            False when it is stale or not finite: then it must not be given to MAVSDK at all.
        """
        if self._clock() - made_t > self._stale_s or not all(map(math.isfinite, velocity)):
            return False
        self._authorised.append((made_t, frd_from_flu(velocity)))
        return True

    def close(self) -> None:
        """Let no setpoint pass until another is authorised."""
        self._authorised.clear()

    def passes(self, frame: bytes) -> bool:
        """Say whether a MAVLink frame may leave; with something behind it, it is none."""
        number = message_number(frame) if len(frame) == _length(frame, 0) else -1
        if number == SET_POSITION_TARGET_LOCAL_NED:
            passes = self._is_fresh(frame)
            self.sent += passes
        else:
            passes = self._is_allowed(number, frame)
        self.dropped += not passes
        return passes

    def _is_allowed(self, number: int, frame: bytes) -> bool:
        now = self._clock()
        parameters = {name: value for name, (value, until) in self._parameters.items() if now <= until}
        addressee = Addressee(self._system, self._modes, now <= self._kill_until, parameters)
        payload = payload_of(frame)
        why = refusal(number, payload, addressee)
        if not why:
            return True
        command = int.from_bytes(payload[28:30], "little") if number == COMMAND_LONG else 0
        if (number, command) not in self._told:
            self._told.add((number, command))
            self._tell(f"MAVLink message {number} was kept back: {why}.")
        return False

    def _is_fresh(self, frame: bytes) -> bool:
        """Say whether a setpoint frame carries a velocity authorised a moment ago, and nothing else."""
        # MAVLink 2 cuts trailing zero bytes off the payload; put them back before reading it.
        values = _PAYLOAD.unpack(payload_of(frame)[: _PAYLOAD.size].ljust(_PAYLOAD.size, b"\0"))
        velocity = (*values[4:7], values[11])
        if (
            values[12] != _VELOCITY_AND_YAW_RATE
            or values[15] != _FRAME_BODY_NED
            or values[13] != self._system
        ):
            return False
        oldest = self._clock() - self._stale_s
        return any(
            made_t >= oldest
            and all(abs(a - b) <= _TOLERANCE * max(1.0, abs(b)) for a, b in zip(velocity, given, strict=True))
            for made_t, given in tuple(self._authorised)
        )


def message_number(frame: bytes) -> int:
    """Return the message id of the frame that data begins with, or -1 where it is not MAVLink."""
    if len(frame) >= 12 and frame[0] == _V2:
        return frame[7] | frame[8] << 8 | frame[9] << 16
    if len(frame) >= 8 and frame[0] == _V1:
        return frame[5]
    return -1


def payload_of(frame: bytes) -> bytes:
    """Return a frame's payload as it is on the wire."""
    header = 10 if frame[:1] == bytes((_V2,)) else 6
    return frame[header : header + frame[1]] if len(frame) > header else b""


def origin(frame: bytes) -> tuple[int, int, int]:
    """Return a frame's sequence number, system and component; -1 each where it is not MAVLink."""
    if message_number(frame) < 0:
        return -1, -1, -1
    start = 4 if frame[0] == _V2 else 2
    return frame[start], frame[start + 1], frame[start + 2]


def split_frames(data: bytes) -> list[bytes]:
    """Cut bytes as MAVSDK hands them out into MAVLink frames; what is none stays in one piece."""
    frames: list[bytes] = []
    start = 0
    while start + 8 <= len(data):
        length = _length(data, start) or len(data) - start
        frames.append(data[start : start + length])
        start += length
    return frames


def _length(data: bytes, start: int) -> int:
    """Return how long the frame is that begins there, checksum and signature included; 0 where none begins."""
    if len(data) < start + 8 or data[start] not in {_V1, _V2}:
        return 0
    if data[start] == _V1:
        return data[start + 1] + 8
    return data[start + 1] + 12 + 13 * (data[start + 2] & 1)
