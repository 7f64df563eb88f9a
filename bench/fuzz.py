"""A million hostile datagrams at the vehicle: it never breaks, never sticks, and its memory stays flat.

The bulk goes to the endpoint in virtual time, the rest to `python -m sim` over UDP. All of them are drawn from one
seed, so what breaks it breaks it again.
"""

from __future__ import annotations

import contextlib
import gc
import math
import os
import random
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pymavlink.dialects.v20 import common as m

from sim.airframe import MODELS
from sim.autopilot.parameters import NAMES, SPECS
from sim.mavlink.endpoint import Endpoint
from sim.mavlink.wire import Inbox
from sim.scenario import Box, EstimateChoice, Scenario, VehicleChoice
from sim.simulator import Simulator, build

ROOT = Path(__file__).resolve().parents[1]
DT = 0.004
A_STEP = 4
MEMORY_BAR_MB = 8.0
# Longer than the longest blackout a parameter may set, s.
_PATIENCE_S = 120.0
_FLOATS = (0.0, -0.0, 0.5, 1.0, -1.0, 2.0, 4.0, 6.0, 90.0, 32.0, 21196.0, 488.0, 1e5, -1e5)
_EXTREMES = (math.nan, math.inf, -math.inf, 3.4e38, -3.4e38, 1e-40, -1e-40, 1e9, 2147483648.0)
_COMMANDS = (
    16,
    17,
    20,
    21,
    22,
    176,
    178,
    179,
    185,
    192,
    193,
    209,
    224,
    241,
    245,
    246,
    262,
    300,
    400,
    401,
    410,
    420,
)
_COMMANDS += (510, 511, 512, 519, 520, 528, 2510, 5001, 5003, 5100)
_ITEMS = (16, 17, 19, 20, 21, 22, 31, 93, 177, 178, 201, 206, 5000, 5001, 5002, 5003, 5004, 5100, 9999)
_FRAMES = (0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 255)
_MODELS = tuple(MODELS)
_NOBODY = math.nan


class Hostile:
    """Draws datagrams that no ground station should send, and some that it would.

    Args:
        rng: Where chance comes from.
        keys: Also set keys to sign with; somebody has to take them back, or all the rest is not heard.
        system_id: Of whom they are for.
        source: System and component that they are from.
    """

    def __init__(
        self, rng: random.Random, *, keys: bool, system_id: int = 1, source: tuple[int, int] = (245, 190)
    ) -> None:
        self._rng = rng
        self._system_id = system_id
        self._source = source
        self._packer = m.MAVLink(None, srcSystem=source[0], srcComponent=source[1])
        left_out = () if keys else (m.MAVLINK_MSG_ID_SETUP_SIGNING,)
        self._kinds = [m.mavlink_map[key] for key in sorted(m.mavlink_map) if key not in left_out]
        self._likely = [kind for kind in self._kinds if "target_system" in kind.fieldnames]
        self._draws = (
            *[self._message] * 6,
            *[self._useful] * 6,
            self._mutated,
            self._mutated,
            self._cut,
            self._joined,
            self._garbage,
            self._stretched,
        )

    def datagrams(self, number: int) -> Iterator[bytes]:
        """Yield so many."""
        given = 0
        while given < number:
            chance = self._rng.random()
            if chance < 0.02:
                burst = self._rng.choice((self._plan, self._flight))()
            else:
                burst = [self._restart() if chance > 0.9995 else self._rng.choice(self._draws)()]
            for data in burst:
                given += 1
                yield data

    def _message(self) -> bytes:
        """A message of any kind, all fields odd."""
        kinds = self._likely if self._rng.random() < 0.8 else self._kinds
        return self._packed(self._filled(self._rng.choice(kinds)))

    def _useful(self) -> bytes:
        """A command or setpoint that may well be taken, with values that may well be odd."""
        if self._rng.random() < 0.5:
            command = self._rng.choice(_COMMANDS)
            return self._packed(m.MAVLink_command_long_message(1, 1, command, 0, *self._numbers(7)))
        mask, frame = self._rng.randrange(0x1000), self._rng.choice((1, 8))
        numbers = [
            self._rng.uniform(-20.0, 20.0) if self._rng.random() < 0.97 else x for x in self._numbers(11)
        ]
        return self._packed(m.MAVLink_set_position_target_local_ned_message(0, 1, 1, frame, mask, *numbers))

    def _flight(self) -> list[bytes]:
        """Arming and taking off, as a ground station would: hostile datagrams mostly meet a vehicle in flight."""
        commands = ((m.MAV_CMD_COMPONENT_ARM_DISARM, 1.0), (m.MAV_CMD_NAV_TAKEOFF, 0.0))
        return [
            self._packed(m.MAVLink_command_long_message(1, 1, command, 0, first, *[_NOBODY] * 6))
            for command, first in commands
        ]

    def _restart(self) -> bytes:
        """Motors off, and begin anew."""
        kill = m.MAVLink_command_long_message(1, 1, m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0, 21196, *[0] * 5)
        restart = m.MAVLink_command_long_message(1, 1, m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 0, 1, *[0] * 6)
        return self._packed(kill) + self._packed(restart)

    def _plan(self) -> list[bytes]:
        """A whole upload of a plan, then its start."""
        kind, count = self._rng.choice((0, 0, 1, 2)), self._rng.randint(0, 6)
        messages: list[m.MAVLink_message] = [m.MAVLink_mission_count_message(1, 1, count, kind)]
        for seq in range(count):
            place = (self._rng.randint(473_900_000, 474_000_000), self._rng.randint(85_000_000, 86_000_000))
            if self._rng.random() < 0.2:
                place = (self._whole("int32_t"), self._whole("int32_t"))
            head = (seq, self._rng.choice(_FRAMES), self._rng.choice(_ITEMS), 0, 1)
            height = self._rng.uniform(0.0, 40.0) if self._rng.random() < 0.9 else self._number()
            messages.append(
                m.MAVLink_mission_item_int_message(1, 1, *head, *self._numbers(4), *place, height, kind)
            )
        messages.append(m.MAVLink_command_long_message(1, 1, 176, 0, 29, 4, 3, *[0] * 4))
        messages.append(m.MAVLink_command_long_message(1, 1, 300, 0, 0, 0, *[0] * 5))
        return [self._packed(message) for message in messages]

    def _mutated(self) -> bytes:
        data = bytearray(self._useful() if self._rng.random() < 0.5 else self._message()) or bytearray(1)
        for _ in range(self._rng.randint(1, 6)):
            data[self._rng.randrange(len(data))] = self._rng.randrange(256)
        return bytes(data)

    def _cut(self) -> bytes:
        data = self._message() or b"\xfd"
        return (
            data[self._rng.randrange(len(data)) :]
            if self._rng.random() < 0.3
            else data[: self._rng.randrange(len(data))]
        )

    def _joined(self) -> bytes:
        parts = [self._garbage(), self._message(), self._useful(), self._cut(), self._message()]
        self._rng.shuffle(parts)
        return b"".join(parts)

    def _garbage(self) -> bytes:
        data = bytearray(self._rng.randbytes(self._rng.randrange(600)))
        for _ in range(self._rng.randrange(4)):
            if data:
                data[self._rng.randrange(len(data))] = self._rng.choice((0xFD, 0xFE))
        return bytes(data)

    def _stretched(self) -> bytes:
        """A frame whose checksum is right and whose length is not the message's; sometimes with a signature."""
        kind = self._rng.choice(self._kinds)
        payload = self._rng.randbytes(self._rng.randrange(256))
        flags = self._rng.choice((0, 0, 1))
        head = bytes(
            (0xFD, len(payload), flags, 0, self._rng.randrange(256), *self._source)
        ) + kind.id.to_bytes(3, "little")
        crc = m.x25crc(head[1:] + payload + bytes((kind.crc_extra,))).crc
        return head + payload + crc.to_bytes(2, "little") + (self._rng.randbytes(13) if flags else b"")

    def _packed(self, message: m.MAVLink_message) -> bytes:
        self._packer.seq = (self._packer.seq + 1) % 256
        old = self._rng.random() < 0.05 and message.get_msgId() < 256
        try:
            return message.pack(self._packer, force_mavlink1=old)
        except Exception:  # noqa: BLE001 (a number that the field cannot hold: another is drawn)
            return self._garbage()

    def _filled(self, kind: type[m.MAVLink_message]) -> m.MAVLink_message:
        lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
        fields = zip(kind.fieldnames, kind.fieldtypes, strict=True)
        return kind(*(self._field(name, type_, lengths[name]) for name, type_ in fields))

    def _field(self, name: str, type_: str, length: int) -> object:
        rng = self._rng
        if name in {"target_system", "target_component", "target"}:
            return rng.choices(
                (self._system_id if name != "target_component" else 1, 0, rng.randrange(256)), (8, 1, 1)
            )[0]
        if name == "command":
            return rng.choice(_COMMANDS + _ITEMS)
        if name in {"frame", "coordinate_frame"}:
            return rng.choice(_FRAMES)
        if name in {"mission_type", "count", "seq"} and rng.random() < 0.7:
            return rng.randrange(4)
        if type_ == "char":
            return rng.choice((rng.choice(NAMES).encode()[:length], b"", rng.randbytes(length)))
        draw = self._number if type_ in {"float", "double"} else lambda: self._whole(type_)
        return [draw() for _ in range(length)] if length else draw()

    def _number(self) -> float:
        if self._rng.random() < 0.3:
            return self._rng.choice(_EXTREMES)
        return self._rng.choice(_FLOATS) if self._rng.random() < 0.8 else self._rng.uniform(-1e3, 1e3)

    def _numbers(self, count: int) -> list[float]:
        return [self._number() for _ in range(count)]

    def _whole(self, type_: str) -> int:
        bits = int(
            type_.removesuffix("_t").removesuffix("_mavlink_version").removesuffix("_t").lstrip("uint")
        )
        lowest = 0 if type_.startswith("u") else -(1 << (bits - 1))
        highest = lowest + (1 << bits) - 1
        near = self._rng.randrange(-2 if lowest else 0, 12)
        return self._rng.choice((near, near, lowest, highest, self._rng.randint(lowest, highest)))


@dataclass
class Outcome:
    """What became of a vehicle under fire.

    Attributes:
        datagrams: How many it was sent.
        seconds: Wall-clock time it took.
        reboots: How often it was restarted.
        grown_mb: Memory that it uses more than after the first tenth.
        flown: Seconds it was in the air.
    """

    datagrams: int
    seconds: float
    reboots: int
    grown_mb: float
    flown: float


class BrokenError(Exception):
    """The vehicle did not stand it; the message says how."""


class Range:
    """A vehicle in virtual time that is fired at.

    Args:
        seed: Of everything.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self.reboots = 0
        self.flown = 0.0
        self._start()

    def fire(self, datagrams: Iterator[bytes]) -> int:
        """Fire all, a few between two steps; return how many it were."""
        number = 0
        for number, data in enumerate(datagrams, 1):
            self.endpoint.receive(data, number % 2, whole=number % 7 > 0)
            if number % A_STEP == 0:
                self.step()
        return number

    def step(self) -> list[m.MAVLink_message]:
        """Advance; return the messages of the vehicle on its first link."""
        return [message for data in self.spoken() for message in self._inbox.messages(data, whole=True)]

    def spoken(self) -> list[bytes]:
        """Advance; return what the vehicle says on its first link."""
        self.sim.step(DT)
        self.endpoint.step()
        said = self.endpoint.outgoing(0)
        self.endpoint.outgoing(1)
        self.check()
        self.endpoint._shared.signing.set_key(bytes(32), 0)
        self.flown += 0.0 if self.sim.autopilot.landed else DT
        # What was terminated flies no more: somebody goes there and switches it off and on.
        if self.endpoint.reboot_asked or self.sim.autopilot.terminated:
            self.reboots += 1
            self._start()
        return said

    def check(self) -> None:
        """Look whether the vehicle's state is sound.

        Raises:
            BrokenError: It is not.
        """
        sim, estimate = self.sim, self.sim.estimate
        numbers = (
            *sim.p,
            *sim.v,
            *estimate.p,
            *estimate.v,
            *sim.wind,
            *sim.autopilot.home,
            sim.battery.remaining,
        )
        if not all(map(math.isfinite, numbers)):
            raise BrokenError(f"not finite at {sim.t:.3f} s: {numbers}")

    def flies(self) -> None:
        """Restart the vehicle, arm it, take off and land.

        Raises:
            BrokenError: It does not.
        """
        for name in NAMES:
            if not SPECS[name].allows(self.sim.autopilot.parameters[name]):
                raise BrokenError(f"{name} is {self.sim.autopilot.parameters[name]}")
        self._start()
        for command, params, done in (
            (m.MAV_CMD_COMPONENT_ARM_DISARM, (1, 0), lambda: self.sim.autopilot.armed),
            (m.MAV_CMD_NAV_TAKEOFF, (_NOBODY,) * 7, lambda: self.sim.p[2] > 2.0),
            (m.MAV_CMD_NAV_LAND, (_NOBODY,) * 7, lambda: not self.sim.autopilot.armed),
        ):
            self._command(command, *params)
            self._until(done, m.enums["MAV_CMD"][command].name)

    def _command(self, command: int, *params: float) -> None:
        message = m.MAVLink_command_long_message(1, 1, command, 0, *params, *[0.0] * (7 - len(params)))
        self.endpoint.receive(message.pack(m.MAVLink(None, srcSystem=245, srcComponent=190)))
        acks = [said for said in self.step() if said.get_type() == "COMMAND_ACK"]
        if not acks or acks[0].result != m.MAV_RESULT_ACCEPTED:
            raise BrokenError(f"command {command} was answered with {acks}")

    def _until(self, done, what: str) -> None:
        for _ in range(round(60.0 / DT)):
            if done():
                return
            self.step()
        raise BrokenError(f"{what} was not done within a minute")

    def _start(self) -> None:
        obstacle = Box("crate", (6.0, 0.0, 1.0), (2.0, 2.0, 2.0))
        vehicle = VehicleChoice(airframe="x500", model=_MODELS[self.reboots % len(_MODELS)])
        scenario = Scenario(vehicle=vehicle, obstacle=(obstacle,), estimate=EstimateChoice("gps"))
        self.sim: Simulator = build(scenario, seed=self._seed)
        self.endpoint = Endpoint(self.sim, seed=self._seed, unix_time=1.7e9, links=2)
        self._inbox = Inbox()


def virtual(number: int, seed: int = 0) -> Outcome:
    """Fire at the endpoint in virtual time.

    Args:
        number: How many datagrams.
        seed: Which ones.

    Raises:
        BrokenError: The vehicle did not stand it.
    """
    range_ = Range(seed)
    hostile = Hostile(random.Random(seed), keys=True)
    began = time.perf_counter()
    sent = range_.fire(hostile.datagrams(number // 10))
    gc.collect()
    before = resident_mb(os.getpid())
    sent += range_.fire(hostile.datagrams(number - number // 10))
    gc.collect()
    grown = resident_mb(os.getpid()) - before
    seconds = time.perf_counter() - began
    range_.flies()
    return Outcome(sent, seconds, range_.reboots, grown, range_.flown)


def real(number: int, seed: int = 0) -> Outcome:
    """Fire at `python -m sim` over UDP, then look whether it still answers.

    Args:
        number: How many datagrams.
        seed: Which ones.

    Raises:
        BrokenError: The vehicle did not stand it.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("127.0.0.1", 0))
        station.settimeout(20.0)
        url = f"udpout://127.0.0.1:{station.getsockname()[1]}"
        command = [sys.executable, "-m", "sim", "--quiet", "--with-parent", "--connect", url]
        process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
        try:
            peer = station.recvfrom(65536)[1]
            station.settimeout(0.0)
            return _fire_at(process, station, peer, number, seed)
        finally:
            process.kill()
            process.communicate()


def _fire_at(process, station: socket.socket, peer, number: int, seed: int) -> Outcome:
    began, before, sent = time.perf_counter(), 0.0, 0
    for data in Hostile(random.Random(seed), keys=False).datagrams(number):
        with contextlib.suppress(BlockingIOError):
            station.sendto(data, peer)
        sent += 1
        if sent % 16 == 0:
            # As fast as the vehicle listens: what overflows its socket tests nothing.
            time.sleep(0.004)
            with contextlib.suppress(BlockingIOError):
                while station.recv(65536):
                    pass
        if sent == max(1, number // 10):
            before = resident_mb(process.pid)
        if process.poll() is not None:
            raise BrokenError(f"the process ended: {process.stderr.read()[-400:]}")
    seconds = time.perf_counter() - began
    _hear(station, peer, m.MAVLINK_MSG_ID_HEARTBEAT)
    return Outcome(sent, seconds, 0, resident_mb(process.pid) - before, 0.0)


def _hear(station: socket.socket, peer, message_id: int) -> None:
    """Wait for a message; meanwhile take back, as a ground station would, what hostile parameters did to the channel.

    A blackout by parameter ends by itself within a minute.
    """
    packer = m.MAVLink(None, srcSystem=255, srcComponent=190)
    ideal = [
        m.MAVLink_param_set_message(0, 0, name.encode(), 0.0, m.MAV_PARAM_TYPE_REAL32).pack(packer)
        for name in NAMES
        if name.startswith(("SIM_UP_", "SIM_DN_"))
    ]
    inbox, deadline = Inbox(), time.monotonic() + _PATIENCE_S
    station.settimeout(0.2)
    while time.monotonic() < deadline:
        for data in ideal:
            station.sendto(data, peer)
        try:
            data = station.recv(65536)
        except TimeoutError:
            continue
        if any(message.get_msgId() == message_id for message in inbox.messages(data, whole=True)):
            return
    raise BrokenError("the vehicle says nothing any more")


def resident_mb(pid: int) -> float:
    """Return a process's resident memory, MB."""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    lines = []
    for where, fire, number in (
        ("virtual time", virtual, 20_000 if short else 1_000_000),
        ("UDP", real, 2_000 if short else 100_000),
    ):
        found = fire(number)
        verdict = "flat" if found.grown_mb <= MEMORY_BAR_MB else "GROWS"
        lines.append(
            f"{where}: {found.datagrams} datagrams in {found.seconds:.0f} s, {found.reboots} restarts, "
            f"{found.flown:.0f} s in the air; memory {found.grown_mb:+.1f} MB ({verdict})"
        )
    return lines
