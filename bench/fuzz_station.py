"""A million hostile inputs at the operator's side: no NaN, no speed over a limit, no kill that was not confirmed.

A servo with a real bus, in virtual time, is given handles, vehicle states and commands that cannot be, with settings
drawn from all that the settings file allows; and the gate is given frames that nobody should send. What it lets out
is read by pymavlink, which knows nothing of it. All is drawn from one seed, so what breaks it breaks it again.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import msgspec
from msgspec import inspect
from pymavlink.dialects.v20 import common as m

from bench.fuzz import Hostile
from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.devices.keeper import DeviceKeeper
from groundstation.messages import (
    COMMAND,
    HANDLE,
    OBSTACLES,
    PILOT_STATE,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Autopilot,
    Command,
    CommandKind,
    FlightMode,
    Phase,
    Ranges,
    Stream,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.limits import bounded
from groundstation.pilot.servo import Servo
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep
from groundstation.vehicle.gate import Gate, split_frames
from groundstation.vehicle.profiles import PROFILES

DT = 0.001
# Ticks that one draw of settings is flown for, and in which the vehicle tells where it is.
_FLOWN, _STATE = 4_000, 20
# A lost device is looked for every 500 ticks; then the hand is coupled, and then the storm begins.
_CYCLE, _CALM, _ENGAGE = 2_000, 900, 650
_FUZZED = ("mapping", "buttons", "control", "cues", "shield", "limits", "link", "safety")
_EXTREMES = (math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, 1e7, -1e7, 0.0, -0.0)
_SLACK = 1.0 + 1e-9
_INFO = DeviceInfo("hostile", "", 4, 0.1, 8.0, 500.0, 1000.0, "force")
_KINDS = [kind for kind in CommandKind if kind is not CommandKind.SETTINGS]
_FORCE = 21196.0


class BrokenError(Exception):
    """Something left that must not; the message says what."""


@dataclass
class Flown:
    """What became of the servo under fire.

    Attributes:
        inputs: Handle samples, vehicle records and commands that it was given.
        settings: Draws of settings.
        engaged: Ticks in which the hand was coupled.
        setpoints: Looked at.
        seconds: Wall-clock time.
    """

    inputs: int = 0
    settings: int = 0
    engaged: int = 0
    setpoints: int = 0
    seconds: float = 0.0


def random_settings(rng: random.Random) -> Settings:
    """Return settings that the settings file may have: usual, anywhere within their bounds, or at one of them."""
    tables: dict[str, dict[str, Any]] = {}
    for section in inspect.type_info(Settings).fields:
        if section.encode_name in _FUZZED:
            drawn = {
                field.encode_name: _drawn(rng, field.type)
                for field in section.type.fields
                if field.encode_name != "airframe" and rng.random() < 0.2
            }
            try:
                msgspec.convert({section.encode_name: drawn}, Settings)
            except msgspec.ValidationError:
                # Each may be so, but not together; the section is left as usual.
                continue
            tables[section.encode_name] = drawn
    return msgspec.convert(tables, Settings)


def _drawn(rng: random.Random, kind: Any) -> Any:
    if isinstance(kind, inspect.BoolType):
        return rng.random() < 0.5
    if isinstance(kind, inspect.LiteralType):
        return rng.choice(kind.values)
    if isinstance(kind, inspect.TupleType):
        return [_drawn(rng, each) for each in kind.item_types]
    low = kind.ge if kind.ge is not None else kind.gt if kind.gt is not None else 0.0
    high = kind.le if kind.le is not None else kind.lt if kind.lt is not None else low + 1.0
    if isinstance(kind, inspect.IntType):
        return rng.randint(int(low), int(high))
    if rng.random() < 0.2:
        return rng.choice(
            (kind.ge if kind.ge is not None else low + 1e-9, kind.le if kind.le is not None else high - 1e-9)
        )
    # By magnitude: a limit of 1000 and one of 0.01 are as likely.
    return min(high, max(low + 1e-9, low + (high - low) * 10.0 ** rng.uniform(-5.0, 0.0)))


class HostileDevice:
    """A driver that mostly says what a hand does, and now and then what none can.

    Args:
        rng: Where chance comes from.
        clock: Monotonic seconds.
        enable: Bits of the enable control.

    Attributes:
        calm: The hand rests in its centre, the enable control held, so that it can be coupled.
        info: Of the device.
    """

    info = _INFO

    def __init__(self, rng: random.Random, clock: Callable[[], float], enable: int) -> None:
        self._rng, self._clock, self._enable = rng, clock, enable
        self._phase = [rng.uniform(0.0, math.tau) for _ in range(4)]
        self.calm = True
        self.hit = 0.02

    def open(self) -> None:
        """Nothing needs to be opened."""

    def close(self) -> None:
        """Nothing needs to be closed."""

    def read(self) -> HandleState:
        """Return a handle's state, or raise."""
        rng, now = self._rng, self._clock()
        if self.calm:
            return HandleState(ZERO3, ZERO3, 0.0, self._enable, homed=True, device_time=now)
        x, y, z, yaw = (0.12 * math.sin(3.0 * now + phase) for phase in self._phase)
        buttons = self._enable | (rng.getrandbits(6) if rng.random() < 0.01 else 0)
        state = HandleState((x, y, z), (0.3, -0.3, 0.2), 10.0 * yaw, buttons, homed=True, device_time=now)
        if rng.random() > self.hit:
            return state
        return self._spoilt(state, now)

    def write_force(self, force: Vector3) -> None:
        """Look at what a hand would feel.

        Raises:
            BrokenError: It is not finite, or more than the device renders.
        """
        if not math.hypot(*force) <= self.info.force_limit * _SLACK:
            raise BrokenError(f"force {force}")
        if not self.calm and self._rng.random() < 0.05 * self.hit:
            raise DeviceError("it takes no force.")

    def _spoilt(self, state: HandleState, now: float) -> HandleState:
        rng, odd = self._rng, self._rng.choice(_EXTREMES)
        place = rng.randrange(3)
        if (chance := rng.randrange(8)) == 0:
            raise DeviceError("unplugged.")
        spoilt = (
            state._replace(position=tuple(odd if i == place else p for i, p in enumerate(state.position))),
            state._replace(velocity=tuple(odd if i == place else p for i, p in enumerate(state.velocity))),
            state._replace(yaw=odd),
            state._replace(device_time=rng.choice((odd, now - 5.0, now + 5.0))),
            state._replace(homed=False),
            state._replace(buttons=rng.getrandbits(40) - 5),
            state._replace(position=(0.25, -0.25, 0.2), velocity=(40.0, -20.0, 3.0)),
        )
        return spoilt[chance - 1]


class Storm:
    """One servo, its bus, and the world that goes wrong around it.

    Args:
        rng: Where chance comes from.
        settings: Of the servo.
    """

    def __init__(self, rng: random.Random, settings: Settings) -> None:
        self._rng, self._settings = rng, settings
        self.now = 1000.0 + rng.uniform(0.0, 1e5)
        self._run_id = new_run_id()
        run = Run(
            self._run_id, "udpin://127.0.0.1:0", simulated=True, device="", mission=None, mission_path="",
            settings=settings, log="", viewer_url="", started="",
        )  # fmt: skip
        write_run(run)
        self._world, self._bus = Bus(self._run_id, "world"), Bus(self._run_id, "pilot")
        out = self._world
        self._states, self._statuses = out.publisher(VEHICLE_STATE), out.publisher(VEHICLE_STATUS)
        self._ranges, self._commands = out.publisher(OBSTACLES), out.publisher(COMMAND)
        self._setpoints, self._handles = out.subscriber(SETPOINT), out.subscriber(HANDLE)
        self._pilots = out.subscriber(PILOT_STATE)
        enable = settings.buttons.enable
        self._device = HostileDevice(rng, lambda: self.now, 1 << enable if enable >= 0 else 0)
        keeper = DeviceKeeper(self._device, self._bus.event, lambda: self.now, lambda work: work())
        self._servo = Servo(run, self._bus, keeper, lambda: self.now)
        self._state, self._boot_t = VehicleState(valid=1), 30.0
        self._status = VehicleStatus(connected=1, armed=1, in_air=1, mode=FlightMode.HOLD, rtt=0.03)
        self._told: list[Vector3] = [(0.0, 0.0, 0.0)]
        self._number, self._severity, self._well = 0, 1.0, True
        self.found = Flown(settings=1)

    def rage(self, ticks: int) -> Flown:
        """Run so many ticks; every two thousand the world is well for a while and the operator engages.

        Raises:
            BrokenError: Something left that must not.
        """
        for tick in range(ticks):
            turn = tick % _CYCLE
            if turn == 0:
                # From one oddity in seconds to one in every few ticks.
                self._severity = 10.0 ** self._rng.uniform(-3.0, 0.0)
                self._device.hit = 0.02 * self._severity
            self._well, self._device.calm = turn < _CALM, turn < _CALM - 100
            if turn == _ENGAGE - 50:
                self._status.mode, self._status.streaming = FlightMode.HOLD, Stream.IDLE
            elif turn == _ENGAGE:
                self._say(CommandKind.ENGAGE)
            elif turn == _ENGAGE + 30:
                self._status.mode, self._status.streaming = FlightMode.OFFBOARD, Stream.FLYING
            self._tick(tick)
        return self.found

    def close(self) -> None:
        """End it."""
        self._servo.close()
        self._bus.close()
        self._world.close()
        sweep(self._run_id)

    def _tick(self, tick: int) -> None:
        rng = self._rng
        self.now += DT if self._well or not self._odd(0.001) else rng.choice((0.2, 0.0, 2.0))
        if tick % _STATE == 0:
            self._tell()
        if not self._well and self._odd(0.004):
            self._say(rng.choice(_KINDS))
        self._servo.tick(self.now, rng.choice((0.2, 0.002)) if self._odd(0.01) else DT)
        self.found.inputs += 1
        if tick % 50 == 0:
            self._look()

    def _say(self, kind: CommandKind) -> None:
        self._number += 1
        self._commands.send(
            Command(
                t=self.now, number=self._number, kind=kind, value=self._rng.randrange(256), source=b"fuzz"
            )
        )
        self.found.inputs += 1

    def _odd(self, chance: float) -> bool:
        """Say whether something odd happens, whose chance is this in the worst storm."""
        return self._rng.random() < chance * self._severity

    def _tell(self) -> None:
        """Tell where the vehicle is, how it is, and what it sees; now and then what cannot be."""
        rng, state, status = self._rng, self._state, self._status
        wild = not self._well and self._odd(0.15)
        state.t = status.t = self.now
        self._boot_t += DT * _STATE
        state.boot_t = self._boot_t
        state.position[:] = [rng.uniform(-3.0, 3.0) if not self._well else 1.0 for _ in range(4)]
        state.velocity[:] = [rng.uniform(-0.5, 0.5) if not self._well else 0.0 for _ in range(4)]
        state.valid, status.connected, status.armed, status.in_air = 1, 1, 1, 1
        status.loss, status.rtt = 0.0, 0.03
        if self._well:
            status.speed_limits[:] = [
                rng.choice((0.0, 0.3, 2.0, 12.0)) if rng.random() < 0.01 else x for x in status.speed_limits
            ]
        if wild:
            self._spoil()
        self._states.send(state)
        self._statuses.send(status)
        around, up, down = status.speed_limits
        self._told.append((around, up, down))
        ring = [
            rng.choice((*_EXTREMES, 0.3, 1.0, 5.0)) if wild else rng.uniform(0.5, 12.0) for _ in range(72)
        ]
        self._ranges.send(
            Ranges(t=self.now, ring=tuple(ring), below=rng.choice(_EXTREMES), above=3.0, limit=12.0)
        )
        self.found.inputs += 3

    def _spoil(self) -> None:
        rng, state, status = self._rng, self._state, self._status
        odd = rng.choice(_EXTREMES)
        chance = rng.randrange(9)
        if chance == 0:
            state.position[rng.randrange(4)] = odd
        elif chance == 1:
            state.velocity[rng.randrange(4)] = odd
        elif chance == 2:
            state.t = rng.choice((odd, self.now - 3.0, self.now + 3.0))
        elif chance == 3:
            state.boot_t = rng.choice((odd, 0.1, 30.0))
        elif chance == 4:
            status.rtt, status.loss = odd, rng.choice(_EXTREMES)
        elif chance == 5:
            status.speed_limits[rng.randrange(3)] = odd
        elif chance == 6:
            status.mode, status.streaming = rng.choice(list(FlightMode)), rng.choice(list(Stream))
        elif chance == 7:
            state.valid = status.armed = status.in_air = rng.randrange(2)
        else:
            state.velocity[:] = [rng.uniform(-90.0, 90.0) for _ in range(4)]

    def _look(self) -> None:
        """Look at all that left since the last look."""
        # What was asked for before the vehicle told others was right by those that it had told until then.
        limits = [bounded(self._settings.limits, told) for told in self._told]
        self._told = self._told[-1:]
        for setpoint in self._setpoints.drain():
            self.found.setpoints += 1
            forward, left, up, yaw = setpoint.velocity
            slow = (
                math.hypot(forward, left) <= max(each.horizontal_speed for each in limits) * _SLACK
                and abs(up) <= max(each.vertical_speed for each in limits) * _SLACK
                and abs(yaw) <= self._settings.limits.yaw_rate * _SLACK
            )
            if not slow or (not setpoint.active and any(setpoint.velocity)):
                raise BrokenError(f"setpoint {tuple(setpoint.velocity)}, active {setpoint.active}, {limits}")
        for handle in self._handles.drain():
            if not math.hypot(*handle.force) <= _INFO.force_limit * _SLACK:
                raise BrokenError(f"force {tuple(handle.force)}")
        for pilot in self._pilots.drain():
            self.found.engaged += 20 * (pilot.phase == Phase.ENGAGED)
            for numbers in (pilot.p_h, pilot.v_c, pilot.v_safe, pilot.v_ref, pilot.error):
                if not all(map(math.isfinite, numbers)):
                    raise BrokenError(f"the controller says {tuple(numbers)}")


def station(number: int, seed: int = 0) -> Flown:
    """Give a servo so many ticks of hostile inputs, with other settings every few thousand.

    Raises:
        BrokenError: Something left that must not; the message has seed and draw.
    """
    total, began = Flown(), time.perf_counter()
    while total.inputs < number:
        rng = random.Random(f"{seed}-{total.settings}")
        storm = Storm(rng, random_settings(rng))
        try:
            found = storm.rage(min(_FLOWN, number - total.inputs))
        except BrokenError as error:
            raise BrokenError(f"{error} (seed {seed}, draw {total.settings})") from error
        finally:
            storm.close()
        total.inputs += found.inputs
        total.settings += 1
        total.engaged += found.engaged
        total.setpoints += found.setpoints
    total.seconds = time.perf_counter() - began
    return total


@dataclass
class Passed:
    """What became of the frames: how many came, left, and were kills, and how long it took, s."""

    frames: int = 0
    left: int = 0
    kills: int = 0
    seconds: float = 0.0


def gate(number: int, seed: int = 0) -> Passed:
    """Give the gate so many frames that nobody should send, and read what it lets out.

    Raises:
        BrokenError: It let out what it must not.
    """
    rng = random.Random(seed)
    now = [100.0]
    guard = Gate(0.15, lambda: now[0])
    guard.address(1, PROFILES[Autopilot.PX4].modes)
    total, began, confirmed = Passed(), time.perf_counter(), -math.inf
    for frame in (frame for data in _frames(number, rng) for frame in split_frames(data)):
        now[0] += 0.001
        if rng.random() < 0.0005:
            guard.allow_kill()
            confirmed = now[0]
        if rng.random() < 0.01:
            guard.authorise(tuple(rng.uniform(-3.0, 3.0) for _ in range(4)), now[0])
        total.frames += 1
        if guard.passes(frame):
            total.left += 1
            total.kills += _sound(frame, killing=now[0] - confirmed <= 3.0)
    total.seconds = time.perf_counter() - began
    return total


def _frames(number: int, rng: random.Random) -> Iterator[bytes]:
    """Yield frames: hostile ones, and every tenth one that is nearly a kill or a steering one."""
    packer = m.MAVLink(None, srcSystem=255, srcComponent=190)
    hostile = Hostile(rng, keys=True).datagrams(number)
    for given, frame in enumerate(hostile):
        if given % 10:
            yield frame
            continue
        first, second = rng.choice((0.0, 1.0, math.nan)), rng.choice((_FORCE, 0.0, math.nan, 2989.0))
        system = rng.choice((1, 1, 1, 0, 7))
        arm = m.MAVLink_command_long_message(system, 1, 400, rng.randrange(4), first, second, *[0.0] * 5)
        yield arm.pack(packer, force_mavlink1=rng.random() < 0.1)


def _sound(frame: bytes, *, killing: bool) -> bool:
    """Look at a frame that left; see `sound`."""
    parser = m.MAVLink(None)
    parser.robust_parsing = True
    return any(sound(message, killing=killing) for message in parser.parse_buffer(frame) or ())


def sound(message: m.MAVLink_message, *, killing: bool, setting: frozenset[str] = frozenset()) -> bool:
    """Look at a message that left; return whether it kills.

    Args:
        message: As pymavlink reads it.
        killing: A kill has been confirmed a moment ago.
        setting: Parameters that may be set.

    Raises:
        BrokenError: It must not have left.
    """
    kind = message.get_type()
    if kind == "SET_POSITION_TARGET_LOCAL_NED":
        numbers = (message.vx, message.vy, message.vz, message.yaw_rate)
        if message.target_system != 1 or not all(abs(each) <= 3.0001 for each in numbers):
            raise BrokenError(f"{message}")
    elif kind == "COMMAND_LONG":
        if message.command not in {21, 22, 176, 400, 511, 512, 520}:
            raise BrokenError(f"{message}")
        forced = message.command == 400 and message.param2 == _FORCE
        if forced and not (killing and message.param1 == 0.0 and message.target_system == 1):
            raise BrokenError(f"a kill that was not meant: {message}")
        return forced
    elif kind == "PARAM_SET":
        if message.param_id not in setting:
            raise BrokenError(f"{message}")
    elif kind not in _LISTED:
        raise BrokenError(f"{message}")
    return False


_LISTED = {
    "HEARTBEAT", "PING", "TIMESYNC", "PARAM_REQUEST_READ", "PARAM_REQUEST_LIST", "COMMAND_ACK", "AUTOPILOT_VERSION",
    "BAD_DATA",
}  # fmt: skip


def main(*, short: bool) -> list[str]:
    """Run, and return lines for the table."""
    number = 30_000 if short else 1_000_000
    flown, passed = station(number), gate(number)
    return [
        f"pilot: {flown.inputs} inputs, {flown.settings} draws of settings, {flown.engaged / 1000:.0f} s coupled, "
        f"{flown.setpoints} setpoints in {flown.seconds:.0f} s: no NaN, no speed over a limit",
        f"gate: {passed.frames} frames in {passed.seconds:.0f} s, {passed.left} left, "
        f"{passed.kills} kills, all of them confirmed",
    ]
