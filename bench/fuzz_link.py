"""A million hostile frames from the vehicle at the link: it lives on, and nothing leaves it that must not.

The real link process with MAVSDK in it, on a real bus. At the other end of its TCP connection flies a simulated
vehicle, and between what that says come frames in its name that no vehicle should send: every message there is, with
NaN, infinities and extremes in every field, texts that are none, and frames that are broken. Meanwhile an operator
commands at random. What leaves the link is read by pymavlink.
"""

from __future__ import annotations

import contextlib
import math
import random
import select
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pymavlink.dialects.v20 import common as m

from bench.fuzz import DT, ROOT, Hostile, Range
from bench.fuzz_station import BrokenError, sound
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import (
    COMMAND,
    EVENT,
    OBSTACLES,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Command,
    CommandKind,
    Setpoint,
)
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep

_STATION, _VEHICLE = 255, (1, 1)
_BURST = 12
_STALE_S, _KILL_S = 0.15, 3.0
_PATIENCE_S = 30.0
# The operator sets the first two; with the third the height of take-off is set.
_SET = frozenset({"MPC_XY_VEL_MAX", "COM_OF_LOSS_T", "MIS_TAKEOFF_ALT"})
_TEXTS = (b"\x1b[2J\x1b]0;gone\x07", b"[bold]\xff\xfe", b"\xc3", b"<script>alert(1)</script>", b"A" * 50, b"")
# What a station reads; the rest of the dialect comes as well, less often.
_TOLD = (
    m.MAVLINK_MSG_ID_HEARTBEAT, m.MAVLINK_MSG_ID_SYS_STATUS, m.MAVLINK_MSG_ID_PARAM_VALUE, m.MAVLINK_MSG_ID_ATTITUDE,
    m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, m.MAVLINK_MSG_ID_LOCAL_POSITION_NED, m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
    m.MAVLINK_MSG_ID_COMMAND_ACK, m.MAVLINK_MSG_ID_TIMESYNC, m.MAVLINK_MSG_ID_PING, m.MAVLINK_MSG_ID_DISTANCE_SENSOR,
    m.MAVLINK_MSG_ID_OBSTACLE_DISTANCE, m.MAVLINK_MSG_ID_BATTERY_STATUS, m.MAVLINK_MSG_ID_EXTENDED_SYS_STATE,
    m.MAVLINK_MSG_ID_AUTOPILOT_VERSION, m.MAVLINK_MSG_ID_HOME_POSITION, m.MAVLINK_MSG_ID_RADIO_STATUS,
    m.MAVLINK_MSG_ID_GPS_RAW_INT, m.MAVLINK_MSG_ID_SYSTEM_TIME, m.MAVLINK_MSG_ID_ALTITUDE,
)  # fmt: skip


class HostileVehicle(Hostile):
    """Draws what a vehicle must not say.

    Args:
        rng: Where chance comes from.
    """

    def __init__(self, rng: random.Random) -> None:
        super().__init__(rng, keys=True, system_id=_STATION, source=_VEHICLE)
        self._draws = (*[self._told] * 10, *[self._text] * 2, *self._draws)

    def _told(self) -> bytes:
        """A message that the station reads, all fields odd."""
        return self._packed(self._filled(m.mavlink_map[self._rng.choice(_TOLD)]))

    def _text(self) -> bytes:
        """Words that are none, or that a terminal or a page would obey."""
        rng = self._rng
        text = rng.choice(_TEXTS) if rng.random() < 0.7 else rng.randbytes(50)
        if rng.random() < 0.5:
            return self._packed(m.MAVLink_statustext_message(rng.randrange(256), text, rng.choice((0, 7)), 0))
        value = m.MAVLink_param_value_message(
            text[:16], self._number(), rng.randrange(12), 900, rng.randrange(900)
        )
        return self._packed(value)


@dataclass
class Heard:
    """What became of the link under fire.

    Attributes:
        frames: Hostile datagrams that it was sent.
        commands: That it was given meanwhile.
        states: Of the vehicle that it passed on.
        left: Frames that left it.
        kills: Of these.
        seconds: Wall-clock time.
    """

    frames: int = 0
    commands: int = 0
    states: int = 0
    left: int = 0
    kills: int = 0
    seconds: float = 0.0


class Siege:
    """The link process, its bus, the vehicle at the other end, and the fire between.

    Args:
        folder: Where its log goes.
        seed: Of everything.
    """

    def __init__(self, folder: Path, seed: int) -> None:
        self._rng = random.Random(seed)
        self._vehicle = Range(seed)
        self._hostile = HostileVehicle(self._rng).datagrams(sys.maxsize)
        self._listener = socket.create_server(("127.0.0.1", 0))
        run = Run(
            run_id=new_run_id(), url=f"tcpout://127.0.0.1:{self._listener.getsockname()[1]}", simulated=False,
            device="", mission=None, mission_path="", settings=Settings(), log=str(folder / "flight"), viewer_url="",
            started="",
        )  # fmt: skip
        self._run_id, self._complaints = run.run_id, folder / "link.log"
        path = write_run(run)
        self._bus = bus = Bus(run.run_id, "bench")
        self._commands, self._setpoints = bus.publisher(COMMAND), bus.publisher(SETPOINT)
        self._states, self._statuses = bus.subscriber(VEHICLE_STATE), bus.subscriber(VEHICLE_STATUS)
        self._ranges, self._events = bus.subscriber(OBSTACLES), bus.subscriber(EVENT)
        with self._complaints.open("wb") as log:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "groundstation.vehicle.link", path], cwd=ROOT, stdout=log, stderr=log
            )
        self._listener.settimeout(_PATIENCE_S)
        self._socket = self._listener.accept()[0]
        self._socket.settimeout(_PATIENCE_S)
        self._parser = m.MAVLink(None)
        self._parser.robust_parsing = True
        self._killed_t, self._number, self._connected = -math.inf, 0, False
        self.heard = Heard()

    def rage(self, frames: int) -> None:
        """Fire so many, beside what the vehicle says itself.

        Raises:
            BrokenError: The link ended, or something left it or came on its bus that must not.
        """
        end = self.heard.frames + frames
        while self.heard.frames < end:
            for _ in range(_BURST):
                self._send(next(self._hostile))
            self.heard.frames += _BURST
            self._operate()
            self._turn()

    def recovers(self) -> None:
        """Be silent but for what the vehicle says; it must be heard again.

        Raises:
            BrokenError: It is not.
        """
        began, states = time.monotonic(), self.heard.states
        while time.monotonic() < began + _PATIENCE_S:
            self._turn()
            time.sleep(DT)
            if self._connected and self.heard.states > states + 50:
                return
        raise BrokenError("the vehicle is not heard again")

    def close(self) -> str:
        """End all; return what the process wrote where nobody reads."""
        self._process.terminate()
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._socket.close()
        self._listener.close()
        self._bus.close()
        sweep(self._run_id)
        return self._complaints.read_text(errors="replace")

    def _operate(self) -> None:
        """Command at random, and fly."""
        rng, now = self._rng, time.monotonic()
        self._number += 1
        velocity = tuple(rng.uniform(-3.0, 3.0) for _ in range(4))
        self._setpoints.send(
            Setpoint(t=now, velocity=velocity, number=self._number, active=rng.random() < 0.9)
        )
        if rng.random() < 0.2:
            kind = rng.choice(list(CommandKind))
            if kind is CommandKind.KILL:
                self._killed_t = now
            command = Command(t=now, number=self._number, kind=kind, amount=rng.choice((math.nan, 1e9, 2.0)))
            command.name = rng.choice((b"MPC_XY_VEL_MAX", b"COM_OF_LOSS_T", *_TEXTS))[:15]
            self._commands.send(command)
            self.heard.commands += 1

    def _turn(self) -> None:
        """Let the vehicle say and hear its own, and look at all that came."""
        vehicle = self._vehicle
        for data in vehicle.spoken():
            self._send(data)
        while select.select([self._socket], [], [], 0.0)[0]:
            data = self._socket.recv(65536)
            if not data:
                raise self._ended()
            vehicle.endpoint.receive(data, whole=False)
            self._look_at(data)
        self._look_at_the_bus()

    def _send(self, data: bytes) -> None:
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise self._ended() from error

    def _ended(self) -> BrokenError:
        """Say how the link ended, or that it hung up."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(3.0)
        said = self._complaints.read_text(errors="replace")[-3000:]
        return BrokenError(
            f"the link is gone ({self._process.poll()}) after {self.heard.frames} frames: {said}"
        )

    def _look_at(self, data: bytes) -> None:
        # A command is sent again for a while; what was confirmed may leave a little later on a loaded machine.
        killing = time.monotonic() - self._killed_t <= _KILL_S + 1.0
        for message in self._parser.parse_buffer(data) or ():
            self.heard.left += 1
            self.heard.kills += sound(message, killing=killing, setting=_SET)

    def _look_at_the_bus(self) -> None:
        for state in self._states.drain():
            self.heard.states += 1
            if state.valid and not all(map(math.isfinite, (*state.position, *state.velocity))):
                raise BrokenError(
                    f"a state that is called valid: {tuple(state.position)}, {tuple(state.velocity)}"
                )
        for status in self._statuses.drain():
            self._connected = bool(status.connected)
            if not all(speed >= 0.0 and math.isfinite(speed) for speed in status.speed_limits):
                raise BrokenError(f"speed limits {tuple(status.speed_limits)}")
        for ranges in self._ranges.drain():
            if any(distance < 0.0 for distance in (*ranges.ring, ranges.below, ranges.above)):
                raise BrokenError(f"a distance below 0: {tuple(ranges.ring)}")
        for event in self._events.drain():
            event.text.decode()


def besieged(frames: int, seed: int = 0) -> Heard:
    """Fire so many hostile frames at a link.

    Raises:
        BrokenError: It did not stand it.
    """
    with tempfile.TemporaryDirectory() as folder:
        siege = Siege(Path(folder), seed)
        began = time.perf_counter()
        try:
            siege.recovers()
            siege.rage(frames)
            siege.recovers()
        finally:
            complaints = siege.close()
        if complaints:
            raise BrokenError(f"it complains: {complaints[-600:]}")
        siege.heard.seconds = time.perf_counter() - began
    return siege.heard


def main(*, short: bool) -> Iterator[str]:
    """Run, and yield lines for the table."""
    heard = besieged(10_000 if short else 1_000_000)
    yield (
        f"link: {heard.frames} hostile datagrams and {heard.commands} commands in {heard.seconds:.0f} s: it lives; "
        f"{heard.states} states passed on, {heard.left} frames left, {heard.kills} kills, all of them confirmed"
    )
