"""Today's servo once more through the ticks of a recording: the same inputs, tick by tick."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, cast

from drivers.device import DeviceInfo, HandleState, Vector3
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.devices.keeper import ABSENT
from groundstation.errors import InputError
from groundstation.messages import (
    COMMAND,
    EVENT,
    EVENT_TEXT,
    OBSTACLES,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Command,
    Event,
    Record,
    Severity,
    Topic,
    fit,
)
from groundstation.pilot.lateness import Lateness
from groundstation.pilot.servo import Servo
from groundstation.recording.batch import Batch
from groundstation.replay.known import device_at, known_in
from groundstation.replay.records import Collector
from groundstation.replay.ticks import ticks_of
from groundstation.review.flight import Flight
from groundstation.run import Run
from sim.scenario import ScenarioError

_BATCH_TICKS = 1000


class RecordedBus(Collector):
    """A bus on which a servo hears what it heard then; what it says is gathered.

    Attributes:
        now: Monotonic s, of events.
        newest: The record of each topic that is the newest now.
        commands: Not yet taken.
    """

    def __init__(self) -> None:
        super().__init__()
        self.now = 0.0
        self.newest: dict[str, Record] = {}
        self.commands: list[Command] = []

    def subscriber(self, topic: Topic[Any], depth: int | None = None) -> _Subscriber:  # noqa: ARG002
        """Return a receiver for a topic."""
        return _Subscriber(self, topic)

    def event(self, severity: Severity, text: str) -> None:
        """Keep what the servo tells."""
        self.batch.add(EVENT, [Event(t=self.now, severity=severity, text=fit(text, EVENT_TEXT))])


class _Subscriber:
    def __init__(self, bus: RecordedBus, topic: Topic[Any]) -> None:
        self._bus, self._topic = bus, topic

    def newest(self) -> Any:  # noqa: ANN401 - of the topic's type
        """Return the newest record, or None before the first."""
        return self._bus.newest.get(self._topic.name)

    def drain(self) -> Iterator[Any]:
        """Yield the commands of this tick."""
        assert self._topic is COMMAND, "a servo drains commands only"
        commands, self._bus.commands = self._bus.commands, []
        yield from commands


class RecordedKeeper:
    """A keeper whose device is, tick by tick, what it was then.

    Attributes:
        info, present, read_s, write_s: As of `groundstation.devices.keeper.DeviceKeeper`.
        state: What is read, or None.
    """

    def __init__(self) -> None:
        self.info: DeviceInfo = ABSENT
        self.present = False
        self.read_s = self.write_s = 0.0
        self.state: HandleState | None = None

    def read(self, now: float) -> HandleState | None:  # noqa: ARG002 - what it is now was set
        """Return the handle's state, or None where there was none."""
        return self.state

    def write(self, force: Vector3) -> None:
        """Render nothing: nobody holds it."""

    def close(self) -> None:
        """There is nothing to let go."""


def run_of(flight: Flight, settings: Settings, controller: str) -> Run:
    """Return the run of a recording as its pilot had it, with these settings and this controller."""
    facts = flight.properties()
    return Run(
        run_id="",
        url=str(facts.get("vehicle", "")),
        simulated=bool(facts.get("simulated", False)),
        device=str(facts.get("device", "")),
        mission=flight.mission,
        mission_path="",
        settings=settings,
        log="",
        viewer_url="",
        started="",
        controller=controller,
        guidance=float(facts.get("guidance", 0.0)),
    )


class Again:
    """A servo on the inputs of a recording.

    Args:
        flight: The recording.
        run: As `run_of` has it.

    Attributes:
        ticks: What it is made from.

    Raises:
        InputError: The recording does not hold it, or controller or airframe cannot be used here.
    """

    def __init__(self, flight: Flight, run: Run) -> None:
        self.ticks = ticks_of(flight)
        self._flight, self._records = flight, known_in(flight)
        self._bus, self._keeper = RecordedBus(), RecordedKeeper()
        self._bus.now = float(self.ticks.t[0])
        try:
            self._servo = Servo(run, cast(Bus, self._bus), self._keeper, lambda: self._bus.now)
        except ScenarioError as error:
            raise InputError(str(error)) from error

    def batches(self) -> Iterator[tuple[float, Batch]]:
        """Run all ticks; yield what the servo said, stretch by stretch, with the time of its last tick, monotonic s.

        Raises:
            InputError: A record that a tick knew is not in the recording.
        """
        ticks, bus, keeper, late = self.ticks, self._bus, self._keeper, Lateness(1)
        known, fitted = [0.0] * ticks.known.shape[1], 1.0
        rows = zip(*(column.tolist() for column in ticks[:5]), strict=True)
        for number, (t, hand, buttons, made, now_known) in enumerate(rows, start=1):
            _, dt, fits, read, homed, present = made
            bus.now = t
            if now_known != known:
                self._hear(t, known, now_known)
                known = now_known
            if fits != fitted:
                if (info := device_at(self._flight, t)) is None:
                    raise self._lost(t, "device")
                keeper.info, fitted = info, fits
            keeper.state, keeper.present = _hand(hand, buttons, homed) if read else None, bool(present)
            self._servo.tick(t, dt)
            self._servo.report(t, late, 0, realtime=False)
            if number % _BATCH_TICKS == 0:
                yield t, bus.taken()
        yield bus.now, bus.taken()

    def _hear(self, t: float, known: list[float], now_known: list[float]) -> None:
        """Put on the bus what a tick knew and the one before did not."""
        states, statuses, ranges, commands = self._records
        heard = ((VEHICLE_STATE, states), (VEHICLE_STATUS, statuses), (OBSTACLES, ranges))
        for place, (topic, records) in enumerate(heard):
            if now_known[place] != known[place]:
                record = records.get(now_known[place])
                if record is None:
                    raise self._lost(t, topic.name)
                self._bus.newest[topic.name] = record
        if taken := int(now_known[4] - known[4]):
            end = next((n for n, each in enumerate(commands, start=1) if each.t == now_known[3]), 0)
            if end < taken:
                raise self._lost(t, COMMAND.name)
            self._bus.commands = commands[end - taken : end]

    def _lost(self, t: float, name: str) -> InputError:
        return InputError(
            f"{self._flight.path}: the {name.replace('_', ' ')} that the servo knew at "
            f"{t - self._flight.start:.3f} s is not in the recording; leave out --check."
        )


def _hand(numbers: list[float], buttons: float, homed: float) -> HandleState:
    x, y, z, u, v, w, yaw, sampled = numbers
    return HandleState((x, y, z), (u, v, w), yaw, int(buttons), bool(homed), sampled)
