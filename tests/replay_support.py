"""A servo in virtual time on a bus in memory, recorded as the recorder does: what replays are tried on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, HapticDevice, Vector3
from groundstation.config import Settings
from groundstation.devices.keeper import DeviceKeeper
from groundstation.messages import (
    COMMAND,
    EVENT,
    OBSTACLES,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Command,
    CommandKind,
    Event,
    FlightMode,
    Ranges,
    Record,
    Setpoint,
    Severity,
    Stream,
    Topic,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.lateness import Lateness
from groundstation.pilot.servo import Servo
from groundstation.recording.batch import Taps
from groundstation.recording.session import Session
from groundstation.run import Run
from groundstation.training.mission import find_mission, load_mission

TICK_NS = 1_000_000
# A machine that has been up for a month, at a time that is no round number.
BEGAN_NS = 2_712_345_678_901_234
INF = float("inf")


class MemoryBus:
    """As much of `groundstation.bus.Bus` as a servo, a vehicle and a recorder need, in one process."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._queues: dict[str, list[deque[Record]]] = {}

    def publisher(self, topic: Topic[Any]) -> MemoryPublisher:
        return MemoryPublisher(self._queues.setdefault(topic.name, []))

    def subscriber(self, topic: Topic[Any], depth: int | None = None) -> MemorySubscriber:
        queue: deque[Record] = deque(maxlen=depth or topic.depth)
        self._queues.setdefault(topic.name, []).append(queue)
        return MemorySubscriber(queue)

    def event(self, severity: Severity, text: str) -> None:
        record = Event(t=self._clock(), severity=severity, source=b"pilot", text=text.encode()[:200])
        self.publisher(EVENT).send(record)


class MemoryPublisher:
    def __init__(self, queues: list[deque[Record]]) -> None:
        self._queues = queues

    def send(self, record: Record) -> None:
        for queue in self._queues:
            queue.append(type(record).from_buffer_copy(record))


class MemorySubscriber:
    def __init__(self, queue: deque[Record]) -> None:
        self._queue, self._newest = queue, None

    def newest(self) -> Any:
        while self._queue:
            self._newest = self._queue.popleft()
        return self._newest

    def drain(self) -> Iterator[Any]:
        while self._queue:
            yield self._queue.popleft()


class Fickle:
    """A device with a hand on it, that does what a test says: silent, deaf, or another one when opened again."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._info = DeviceInfo("Fickle", "1", 4, 0.05, 8.0, 1000.0, 1000.0, "force")
        self.position, self.velocity, self.yaw, self.buttons, self.homed = ZERO3, ZERO3, 0.0, 0, True
        self.silent = self.deaf = self.another = False
        self.age = 3e-5

    @property
    def info(self) -> DeviceInfo:
        return self._info

    def open(self) -> None:
        if self.another:
            self._info = replace(self._info, workspace=self._info.workspace + 0.01)

    def read(self) -> HandleState:
        if self.silent:
            raise DeviceError("Fickle: is silent; wake it.")
        t = self._clock() - self.age
        return HandleState(self.position, self.velocity, self.yaw, self.buttons, self.homed, t)

    def write_force(self, force: Vector3) -> None:
        if self.deaf:
            raise DeviceError("Fickle: takes no force; shout.")

    def close(self) -> None:
        pass


class Flown:
    """A servo, a vehicle that follows it, and a recorder.

    Args:
        log: Of the recording, without suffix.
        device: Makes the device, given the clock.
        opening: Ticks that opening it takes.
        recorded_from: Tick at which the recorder begins to listen.
    """

    def __init__(
        self,
        log: Path,
        device: Callable[[Callable[[], float]], HapticDevice] = Fickle,
        *,
        opening: int = 3,
        recorded_from: int = 0,
        settings: Settings | None = None,
        controller: str = "paper",
    ) -> None:
        self.ns, self.tick_number, self._number = BEGAN_NS, 0, 0
        self.run_ = Run(
            "1-memory", "udpin://127.0.0.1:1", True, "made", load_mission(find_mission("paper")), "",
            settings or Settings(), str(log), "", "2026-11-26T10:00:00.000+00:00", controller=controller, seed=5,
        )  # fmt: skip
        self.bus = MemoryBus(lambda: self.now)
        self.device = device(lambda: self.now)
        self._opening, self._work = opening, deque[tuple[int, Callable[[], None]]]()
        self._taps: Taps | None = None
        self._recorded_from = recorded_from
        self._listen()
        self._states, self._statuses = self.bus.publisher(VEHICLE_STATE), self.bus.publisher(VEHICLE_STATUS)
        self._ranges, self._commands = self.bus.publisher(OBSTACLES), self.bus.publisher(COMMAND)
        self._setpoints = self.bus.subscriber(SETPOINT, depth=1)
        self.state = VehicleState(valid=1, boot_t=30.0, roll=0.01, pitch=-0.02)
        self.state.position[:] = (0.3, -0.2, 2.0, 0.1)
        self.status = VehicleStatus(
            connected=1, armed=1, in_air=1, mode=FlightMode.HOLD, rtt=0.061, loss=0.01
        )
        self.session = Session(self.run_, self.now - 0.4, lambda _severity, text: self._told.append(text))
        self._told: list[str] = []
        keeper = DeviceKeeper(self.device, self.bus.event, lambda: self.now, self._start)
        self.servo = Servo(self.run_, self.bus, keeper, lambda: self.now)
        self._late = Lateness(2000)

    @property
    def now(self) -> float:
        return self.ns / 1e9

    def run(self, seconds: float, *, dt: int = 1) -> None:
        """Run so long, with ticks of `dt` ms."""
        for _ in range(round(seconds * 1000 / dt)):
            self.tick(dt)

    def tick(self, dt: int = 1, each: Callable[[], None] = lambda: None) -> None:
        self.tick_number += 1
        # No real loop is punctual to the nanosecond.
        self.ns += dt * TICK_NS + (self.tick_number * 7_919) % 13 - 6
        while self._work and self._work[0][0] <= self.tick_number:
            self._work.popleft()[1]()
        each()
        if self.tick_number % 20 == 0:
            self._tell()
        self.servo.tick(self.now, dt * 1e-3)
        self.servo.report(self.now, self._late, 0, realtime=False)
        self._listen()
        if self._taps and self.tick_number % 50 == 0:
            # As often as the recorder does: a device that takes no force tells of it every tick.
            self._taps.drain()
            if self.tick_number % 500 == 0:
                self.take()

    def take(self) -> None:
        """Record what was said."""
        self._taps.drain()
        self.session.take(self._taps.take())

    def lose(self) -> None:
        """Record nothing of what was said, as a recorder that was held up."""
        self._taps.drain()
        self._taps.take()

    def command(self, kind: CommandKind, value: int = 0) -> None:
        self._number += 1
        self.ns += 17
        self._commands.send(Command(t=self.now, number=self._number, kind=kind, value=value, source=b"test"))

    def engage(self) -> None:
        self.status.mode, self.status.streaming = FlightMode.HOLD, Stream.IDLE
        self.run(0.1)
        self.command(CommandKind.ENGAGE)
        self.run(0.1)
        self.status.streaming = Stream.STARTING
        self.run(0.1)
        self.status.mode, self.status.streaming = FlightMode.OFFBOARD, Stream.FLYING
        self.run(0.1)

    def close(self) -> Path:
        """End the recording and return its file."""
        assert self._taps
        self.take()
        self.session.close()
        assert self._told == []
        return self.run_.recording

    def _start(self, work: Callable[[], None]) -> None:
        """Open the device some ticks later, as a thread of its own would; at once where it takes none."""
        if self._opening:
            self._work.append((self.tick_number + self._opening, work))
        else:
            work()

    def _listen(self) -> None:
        if self._taps is None and self.tick_number >= self._recorded_from:
            self._taps = Taps(self.bus)

    def _tell(self) -> None:
        """Let the vehicle fly what it was told, and tell of it."""
        setpoint: Setpoint | None = self._setpoints.newest()
        wanted = tuple(setpoint.velocity) if setpoint and setpoint.active else (0.0,) * 4
        state = self.state
        for axis in range(4):
            state.velocity[axis] += 0.08 * (wanted[axis] - state.velocity[axis])
            state.position[axis] += 0.02 * state.velocity[axis]
        state.t = self.status.t = self.now
        state.boot_t += 0.02
        self._states.send(state)
        if self.tick_number % 100 == 0:
            self._statuses.send(self.status)
            seen = Ranges(t=self.now, below=state.position[2], above=INF, limit=12.0)
            seen.ring[:] = [max(0.0, 4.0 - state.position[0]) if sector < 9 else INF for sector in range(72)]
            self._ranges.send(seen)
