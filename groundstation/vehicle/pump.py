"""The pump: moves bytes between transport and MAVSDK, through gate and log, and watches the link's health.

MAVSDK has a `raw://` connection only, so no byte reaches the vehicle but through here.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

# The smallest dialect: headers, checksums of heartbeats and whole frames are all that is needed here, it loads
# seven times faster than `common` and parses a frame in 4 µs.
from pymavlink.dialects.v20 import minimal as mavlink

from groundstation.vehicle.gate import Gate, message_number, origin, split_frames
from groundstation.vehicle.legible import legible
from groundstation.vehicle.signing import NEVER_SIGNED, Signing, is_signed, without_signature
from groundstation.vehicle.tlog import TlogWriter
from groundstation.vehicle.transport import Transport

if TYPE_CHECKING:
    from mavsdk import Mavsdk

_SETUP_SIGNING = 256
# PARAM_REQUEST_READ and _LIST, PARAM_SET, and the same of PARAM_EXT: whoever asks a station for its parameters. It
# has none, and MAVSDK's answer to a name that is no text goes to the terminal.
_NOT_FOR_STATIONS = frozenset({20, 21, 23, 320, 321, 323})
# What parts of a vehicle say, other stations, and what has not started yet.
_NO_AUTOPILOTS = frozenset({mavlink.MAV_AUTOPILOT_GENERIC, mavlink.MAV_AUTOPILOT_INVALID})
_WINDOW_S = 5.0
_HALF = 128


class Losses:
    """Counts the vehicle's lost frames by the gaps in its sequence numbers over the last seconds.

    What is overtaken on its way is lost only until it comes; what comes twice counts once.
    """

    def __init__(self) -> None:
        self._next: dict[tuple[int, int], int] = {}
        self._missing: dict[tuple[int, int], set[int]] = {}
        self._marks: deque[tuple[float, int]] = deque()
        self._lost = 0

    def count(self, now: float, system: int, component: int, sequence: int) -> None:
        """Take note of a frame (sequence numbers run modulo 256)."""
        source = (system, component)
        next_ = self._next.setdefault(source, sequence)
        missing = self._missing.setdefault(source, set())
        lost = (sequence - next_) % 256
        if lost <= _HALF:
            # Half a round on, a number is the next round's.
            missing.difference_update((sequence + _HALF + each) % 256 for each in range(lost + 1))
            missing.update((next_ + each) % 256 for each in range(lost))
            self._next[source] = (sequence + 1) % 256
        elif sequence in missing:
            missing.remove(sequence)
            lost = -1
        else:
            return
        self._marks.append((now, lost))
        self._lost += lost

    def share(self, now: float) -> float:
        """Return lost / (lost + received) over the window, 0 to 1."""
        while self._marks and self._marks[0][0] < now - _WINDOW_S:
            self._lost -= self._marks.popleft()[1]
        # One that came late may have been lost before the window.
        received, lost = len(self._marks), max(0, self._lost)
        return lost / (received + lost) if received else 0.0


class Pump:
    """Runs the bytes both ways from `start` to `stop`.

    Args:
        transport: The way to the vehicle.
        gate: Passes or keeps outgoing frames.
        tlog: Where frames are logged, or None.
        clock: Monotonic seconds.
        signing: Signs what leaves and judges what comes; None where nothing is signed and everything heard.

    Attributes:
        heard_t: When the last frame came of the vehicle, or before that is known of any system that has introduced
            itself by a heartbeat; 0 before.
        refused: How many frames were not heard, for their signature.
        signed: The vehicle signs what it says, and there is no key.
        contradicted: A heartbeat has come that says another autopilot than those before it. Such are not heard: what
            is asked of a vehicle, and how, hangs on its autopilot.
        others: Systems that say they are vehicles and are not the one that is watched.
    """

    def __init__(
        self,
        transport: Transport,
        gate: Gate,
        tlog: TlogWriter | None,
        clock: Callable[[], float],
        signing: Signing | None = None,
    ) -> None:
        self._transport = transport
        self._gate = gate
        self._tlog = tlog
        self._clock = clock
        self._signing = signing
        self._parser = mavlink.MAVLink(None)
        self._parser.robust_parsing = True
        self._losses = Losses()
        self._known: set[int] = set()
        self._autopilots: dict[tuple[int, ...], int] = {}
        self._vehicle = 0
        self._lock = threading.Lock()
        self._running = True
        self._thread: threading.Thread | None = None
        self.heard_t = 0.0
        self.refused = 0
        self.signed = self.contradicted = False
        self.others: frozenset[int] = frozenset()

    def start(self, mavsdk: Mavsdk) -> None:
        """Connect MAVSDK and begin."""
        # In this order no heartbeat is sent into nothing.
        mavsdk.subscribe_raw_bytes_to_be_sent(self._send)
        mavsdk.add_any_connection("raw://")
        self._thread = threading.Thread(target=self._receive_all, args=(mavsdk,), name="pump", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End both ways. Before MAVSDK is destroyed: bytes passed to it afterwards crash the process."""
        self._running = False
        if self._thread is not None:
            self._thread.join()
        self._transport.close()

    def watch(self, system: int) -> None:
        """Watch this system only: another station that is heard on the same link is not the vehicle."""
        self._vehicle = system

    def loss(self) -> float:
        """Return the share of frames lost in the last seconds, 0 to 1."""
        with self._lock:
            return self._losses.share(self._clock())

    def _send(self, data: bytes) -> None:
        if not self._running:
            return
        for frame in split_frames(data):
            sent = frame if self._gate.passes(frame) else b""
            if sent and self._signing:
                sent = self._signing.sign(sent)
            if sent:
                self._transport.send(sent)
                self._log(sent)

    def _receive_all(self, mavsdk: Mavsdk) -> None:
        while self._running:
            data = self._transport.receive()
            if not data or not self._running:
                continue
            for message in self._parser.parse_buffer(data) or ():
                if message.get_type() == "BAD_DATA":
                    continue
                frame = bytes(message.get_msgbuf())
                if self._signing and not self._signing.trusts(frame):
                    self.refused += message_number(frame) not in NEVER_SIGNED
                    continue
                heartbeat = message if isinstance(message, mavlink.MAVLink_heartbeat_message) else None
                if heartbeat is not None and self._contradicts(frame, heartbeat):
                    self.contradicted = True
                    continue
                if message_number(frame) not in _NOT_FOR_STATIONS:
                    mavsdk.pass_received_raw_bytes(legible(frame))
                self._watch(frame, heartbeat)

    def _contradicts(self, frame: bytes, heartbeat: mavlink.MAVLink_heartbeat_message) -> bool:
        source, autopilot = origin(frame)[1:], heartbeat.autopilot
        if source not in self._autopilots:
            if autopilot not in _NO_AUTOPILOTS:
                self._autopilots[source] = autopilot
            return False
        return autopilot != self._autopilots[source]

    def _watch(self, frame: bytes, heartbeat: mavlink.MAVLink_heartbeat_message | None) -> None:
        now = self._clock()
        sequence, system, component = origin(frame)
        if heartbeat is not None:
            self._known.add(system)
            # A part of a vehicle, and another station, have no autopilot.
            if self._vehicle not in {0, system} and heartbeat.autopilot != mavlink.MAV_AUTOPILOT_INVALID:
                self.others |= {system}
        # Noise on a serial line can look like a frame, but hardly like one of a system that is known.
        if system not in self._known:
            return
        self._log(frame)
        if system != (self._vehicle or system):
            return
        self.heard_t = now
        self.signed = self._signing is None and is_signed(frame)
        with self._lock:
            self._losses.count(now, system, component, sequence)

    def _log(self, frame: bytes) -> None:
        """Log a frame; nothing that tells the key or helps to guess it is in a log."""
        if self._tlog and message_number(frame) != _SETUP_SIGNING:
            self._tlog.write(without_signature(frame))
