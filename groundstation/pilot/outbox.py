"""What the pilot puts on the bus. Records are made once and filled anew, so that a tick allocates little."""

from __future__ import annotations

from math import nan
from typing import NamedTuple

from drivers.device import ZERO3, DeviceInfo, HandleState, Vector3
from groundstation.bus import Bus
from groundstation.frames import Vector4
from groundstation.messages import (
    ANSWER_TEXT,
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    HANDLE,
    NAME_TEXT,
    PILOT_STATE,
    REASON_TEXT,
    SERVO_REPORT,
    SETPOINT,
    TICK_INPUTS,
    Command,
    CommandAnswer,
    CommandKind,
    DeviceReport,
    Handle,
    Phase,
    PilotState,
    ServoReport,
    Setpoint,
    TickInputs,
    fit,
)
from groundstation.pilot.choices import Choices
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.lateness import Figures
from groundstation.pilot.pilot import Outputs
from groundstation.pilot.setpoint import Commanded

_NAME, _RENDERS = 64, 16
# Far from the numbers that any console counts up to.
_NUMBERS = 1 << 32
_UNKNOWN4 = (nan, nan, nan, nan)


class Tick(NamedTuple):
    """What a tick was made from, what it said, and where the vehicle would come to rest, world, m."""

    inputs: Inputs
    outputs: Outputs
    stop: Vector3


class MadeFrom(NamedTuple):
    """What ticks are made from besides the hand; see `TickInputs`."""

    dt: float
    state_t: float
    status_t: float
    ranges_t: float
    command_t: float
    commands: int
    fitted: int
    read: bool
    homed: bool
    present: bool


class Outbox:
    """The pilot's records and their senders.

    Args:
        bus: Where they go.
    """

    def __init__(self, bus: Bus) -> None:
        self._handles = bus.publisher(HANDLE)
        self._inputs = bus.publisher(TICK_INPUTS)
        self._setpoints = bus.publisher(SETPOINT)
        self._states = bus.publisher(PILOT_STATE)
        self._answers = bus.publisher(COMMAND_ANSWER)
        self._commands = bus.publisher(COMMAND)
        self._number = _NUMBERS
        self._servo_reports = bus.publisher(SERVO_REPORT)
        self._device_reports = bus.publisher(DEVICE_REPORT)
        self._handle = Handle()
        self._made_from: MadeFrom | None = None
        self._setpoint = Setpoint()
        self._state = PilotState()
        self._servo_report = ServoReport()
        self._device_report = DeviceReport()
        # Views into the records: looking an array up in a structure makes a new object every time.
        handle = self._handle
        self._position, self._velocity, self._force = handle.position, handle.velocity, handle.force

    def handle(self, t: float, hand: HandleState, force: Vector3, *, present: bool) -> None:
        """Send the hand and the force on it."""
        record = self._handle
        record.t = t
        self._position[:] = hand.position
        self._velocity[:] = hand.velocity
        self._force[:] = force if present else ZERO3
        record.yaw = hand.yaw
        record.device_t = hand.device_time
        record.buttons = hand.buttons
        record.homed = hand.homed
        record.present = present
        record.tick += 1
        self._handles.send(record)

    def made_from(self, t: float, inputs: MadeFrom) -> None:
        """Say what the tick whose handle was sent last was made from, where that is another than before."""
        if inputs != self._made_from:
            self._made_from = inputs
            self._inputs.send(TickInputs(t, self._handle.tick, *inputs))

    def setpoint(self, t: float, velocity: Vector4, handle_t: float, *, active: bool) -> None:
        """Send what the vehicle shall do."""
        record = self._setpoint
        record.t = t
        record.velocity[:] = velocity
        record.handle_t = handle_t
        record.number += 1
        record.active = active
        self._setpoints.send(record)

    def pilot_state(self, t: float, tick: Tick, phase: Phase, reason: str, *, centred: bool) -> None:
        """Send the inside of the controller.

        Args:
            t: Now, monotonic s.
            tick: What the tick was made from, and what it said.
            phase: How far the hand is coupled.
            reason: Why the hand was last uncoupled, or "".
            centred: The handle is where engaging is possible.
        """
        record, (inputs, outputs, stop) = self._state, tick
        record.t = t
        record.p_h[:] = outputs.p_h
        record.p_h_rate[:] = outputs.p_h_rate
        record.error[:] = outputs.error
        record.v_ref[:] = outputs.v_ref
        record.force[:] = outputs.position_force
        record.state_age = inputs.state_age
        record.port_energy = outputs.port.energy
        record.dissipated = outputs.port.dissipated
        record.phase = phase
        record.on_leash = outputs.on_leash
        record.centred = centred
        record.reason = fit(reason, REASON_TEXT)
        _fill_choices(record, inputs.choices, waiting=outputs.reference.waiting)
        _fill_command(record, outputs.commanded)
        record.stop[:] = stop
        _fill_forecast(record, outputs)
        _fill_cues(record, outputs)
        self._states.send(record)

    def command(self, t: float, kind: CommandKind) -> None:
        """Send what a button of the handle commands; this process obeys it like any other."""
        self._number += 1
        self._commands.send(Command(t=t, number=self._number, kind=int(kind), source=b"handle"))

    def answer(self, t: float, command: Command, refusal: str) -> None:
        """Answer a command: done, or refused with the reason."""
        record = CommandAnswer(t=t, number=command.number, kind=command.kind, ok=not refusal)
        record.text = fit(refusal, ANSWER_TEXT)
        self._answers.send(record)

    def device_report(self, t: float, info: DeviceInfo, *, present: bool, homed: bool) -> None:
        """Send which device there is."""
        record = self._device_report
        record.t = t
        record.name, record.serial = fit(info.name, _NAME), fit(info.serial, _NAME)
        record.renders = fit(info.renders, _RENDERS)
        record.axes, record.workspace, record.rate = info.axes, info.workspace, info.rate
        record.force_limit, record.stiffness_limit = info.force_limit, info.stiffness_limit
        record.present, record.homed = present, homed
        self._device_reports.send(record)

    def servo_report(
        self, t: float, rate: float, late: Figures, longest: Vector3, missed: int, *, realtime: bool
    ) -> None:
        """Send how well the servo keeps its time; `longest` read, write and step, s."""
        record = self._servo_report
        record.t, record.rate = t, rate
        record.late_p50, record.late_p99, record.late_max, record.run_p50, record.run_p99 = late
        record.read, record.write, record.step = longest
        record.ticks, record.missed = self._handle.tick, missed
        record.realtime = realtime
        self._servo_reports.send(record)


def _fill_choices(record: PilotState, choices: Choices, *, waiting: bool) -> None:
    record.mapping, record.preset, record.cues = choices.mapping, choices.preset, choices.cues
    record.fine, record.clutched, record.waiting = choices.fine, choices.clutched, waiting


def _fill_command(record: PilotState, commanded: Commanded) -> None:
    record.v_safe[:] = commanded.safe
    record.v_c[:] = commanded.meant
    record.guarding = bool(commanded.by)
    record.guarded_by = fit(commanded.by, NAME_TEXT)
    record.compensated = commanded.compensated


def _fill_forecast(record: PilotState, outputs: Outputs) -> None:
    """Where nothing is flown, nothing is known of gains and delay either."""
    forecast, terms = outputs.forecast, outputs.terms
    record.predicted[:] = forecast.p
    record.predicted_velocity[:] = forecast.velocity
    record.push[:] = forecast.push
    record.k1[:] = terms.loop.k1 if terms else _UNKNOWN4
    record.phase_margin = terms.loop.margin if terms else nan
    record.delay = terms.delay if terms else nan
    record.gain_share, record.speed_share = terms.link if terms else (1.0, 1.0)


def _fill_cues(record: PilotState, outputs: Outputs) -> None:
    cues = outputs.cues
    record.environment[:] = cues.environment
    record.mismatch[:] = cues.mismatch
    record.guard[:] = cues.guard
    record.damping[:] = cues.damping
    record.guidance[:] = cues.guidance
