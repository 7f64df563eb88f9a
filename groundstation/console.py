"""The operator's side of the bus: the newest of every topic as one snapshot, and the acts of the operator.

The screen and the headless flight are both built on it; neither knows more of the other processes than this.
"""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from groundstation.bus import Bus
from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    EVENT,
    HANDLE,
    MISSION_PROGRESS,
    OBSTACLES,
    PARAMETER,
    PARAMETER_TEXT,
    PILOT_STATE,
    SERVO_REPORT,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Command,
    CommandAnswer,
    CommandKind,
    DeviceReport,
    Event,
    Handle,
    MissionProgress,
    Parameter,
    PilotState,
    Ranges,
    ServoReport,
    Setpoint,
    VehicleState,
    VehicleStatus,
    fit,
)

_EVENTS_KEPT = 500


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Everything known at one moment; a field is None until its first record came.

    Attributes:
        t: When the snapshot was taken, monotonic s.
        ranges: What the vehicle's own distance sensors see.
        events: The latest events, oldest first.
        answers: Answers to commands since the last snapshot.
        parameters: The vehicle's own, as last read, by name.
    """

    t: float
    handle: Handle | None
    setpoint: Setpoint | None
    pilot: PilotState | None
    vehicle: VehicleState | None
    ranges: Ranges | None
    status: VehicleStatus | None
    servo: ServoReport | None
    device: DeviceReport | None
    progress: MissionProgress | None
    events: tuple[Event, ...]
    answers: tuple[CommandAnswer, ...]
    parameters: Mapping[str, Parameter] = field(default_factory=dict[str, Parameter])


class Console:
    """Reads the bus for people and sends their commands.

    Args:
        bus: This process's place on the bus.
        source: Who gives the commands, as in "screen" or "headless".
        clock: Monotonic seconds.
        first: Number of the first command; a second console of a run begins elsewhere.
    """

    def __init__(
        self, bus: Bus, source: str, clock: Callable[[], float] = time.monotonic, first: int = 1
    ) -> None:
        self._clock = clock
        self._source = source.encode()
        self._numbers = itertools.count(first)
        self._commands = bus.publisher(COMMAND)
        self._handle = bus.subscriber(HANDLE, depth=1)
        self._setpoint = bus.subscriber(SETPOINT, depth=1)
        self._pilot = bus.subscriber(PILOT_STATE, depth=1)
        self._vehicle = bus.subscriber(VEHICLE_STATE, depth=1)
        self._ranges = bus.subscriber(OBSTACLES, depth=1)
        self._status = bus.subscriber(VEHICLE_STATUS, depth=1)
        self._servo = bus.subscriber(SERVO_REPORT, depth=1)
        self._device = bus.subscriber(DEVICE_REPORT, depth=1)
        self._progress = bus.subscriber(MISSION_PROGRESS, depth=1)
        self._answers = bus.subscriber(COMMAND_ANSWER)
        self._event_stream = bus.subscriber(EVENT)
        self._parameter_stream = bus.subscriber(PARAMETER)
        self._parameters: dict[str, Parameter] = {}
        self._events: deque[Event] = deque(maxlen=_EVENTS_KEPT)

    def snapshot(self) -> Snapshot:
        """Return the newest of everything."""
        self._events.extend(self._event_stream.drain())
        if read := list(self._parameter_stream.drain()):
            # A new dictionary, so that earlier snapshots stay as they were; it is seldom.
            self._parameters = self._parameters | {each.name.decode(): each for each in read}
        return Snapshot(
            t=self._clock(),
            handle=self._handle.newest(),
            setpoint=self._setpoint.newest(),
            pilot=self._pilot.newest(),
            vehicle=self._vehicle.newest(),
            ranges=self._ranges.newest(),
            status=self._status.newest(),
            servo=self._servo.newest(),
            device=self._device.newest(),
            progress=self._progress.newest(),
            events=tuple(self._events),
            answers=tuple(self._answers.drain()),
            parameters=self._parameters,
        )

    def command(self, kind: CommandKind, value: int = 0, name: str = "", amount: float = 0.0) -> int:
        """Send a command and return its number, which its answer will carry.

        Args:
            kind: What is asked for.
            value: What a choice chooses, see `groundstation.messages.Command`.
            name: Of the vehicle's parameter that is to be set.
            amount: What it is to be set to.
        """
        number = next(self._numbers)
        command = Command(t=self._clock(), number=number, kind=kind, value=value, source=self._source)
        command.name, command.amount = fit(name, PARAMETER_TEXT), amount
        self._commands.send(command)
        return number
