"""What is logged when it happens or changes: states of lanes, events, commands and their answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import IntEnum
from operator import attrgetter

import numpy as np
import rerun as rr

from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    EVENT,
    MISSION_PROGRESS,
    PARAMETER,
    PILOT_STATE,
    VEHICLE_STATUS,
    Command,
    CommandKind,
    DeviceReport,
    FlightMode,
    MappingMode,
    Parameter,
    Phase,
    PilotState,
    Preset,
    Severity,
    Stream,
    VehicleStatus,
)
from groundstation.recording import entities, lanes
from groundstation.recording.batch import Batch, text
from groundstation.recording.item import Chunk, time_column

# Rerun's names of levels, which its viewer colours.
_INFO, _WARNING = "INFO", "WARN"
_LEVELS: dict[int, str] = {Severity.INFO: _INFO, Severity.WARNING: _WARNING, Severity.ALARM: "ERROR"}

# All that becomes words here: a state whose fields are as before needs no look, and a thousand come a second.
_PILOT_WORDS = (
    "phase", "on_leash", "reason", "mapping", "fine", "clutched", "waiting", "preset", "guarding", "guarded_by",
    "compensated",
)  # fmt: skip

# What stands where the vehicle's own failsafes forbid nothing.
SAFE = "nothing"

Timed = tuple[float, str]


class Changes:
    """Turns records into rows where a state differs from the one before.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, start: float) -> None:
        self._start = start
        self._last: dict[str, str] = {}

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's changes of state, an entity each."""
        pilot = _differing(batch.of(PILOT_STATE), _PILOT_WORDS)
        status = batch.of(VEHICLE_STATUS)
        states: tuple[tuple[lanes.Lane, Iterable[Timed]], ...] = (
            (lanes.PHASE, ((state.t, _phase(state)) for state in pilot)),
            (lanes.MODE, ((state.t, _word(FlightMode, state.mode)) for state in status)),
            (lanes.STREAM, ((state.t, _word(Stream, state.streaming)) for state in status)),
            (lanes.VEHICLE, ((state.t, _vehicle(state)) for state in status)),
            (lanes.DEVICE_STATE, ((report.t, _device(report)) for report in batch.of(DEVICE_REPORT))),
            (lanes.STAGE, ((state.t, text(state.stage)) for state in batch.of(MISSION_PROGRESS))),
            (lanes.MAPPING, ((state.t, _mapping(state)) for state in pilot)),
            (lanes.PRESET, ((state.t, _word(Preset, state.preset)) for state in pilot)),
            (lanes.GUARD, ((state.t, "guards" if state.guarding else "lets pass") for state in pilot)),
            (lanes.COMPENSATION, ((state.t, "on" if state.compensated else "off") for state in pilot)),
        )
        for lane, timed in states:
            if changed := self._changed(lane.path, timed):
                words = [word for _, word in changed]
                yield Chunk(lane.path, self._times(changed), rr.StateChange.columns(state=words))
        for path, said in (
            (entities.REASON, ((state.t, text(state.reason)) for state in pilot)),
            (entities.GUARDED, ((state.t, _guarded(state)) for state in pilot)),
            (entities.FIRMWARE, ((state.t, text(state.firmware)) for state in status)),
            (entities.UNSAFE, ((state.t, text(state.unsafe) or SAFE) for state in status)),
        ):
            if lines := [(t, words, _INFO) for t, words in self._changed(path, said) if words]:
                yield self._texts(path, lines)

    def texts(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's events, an entity a source, and its commands with their answers."""
        events: dict[str, list[tuple[float, str, str]]] = {}
        for event in batch.of(EVENT):
            level = _LEVELS.get(event.severity, _WARNING)
            path = f"{entities.EVENTS}/{text(event.source)}"
            events.setdefault(path, []).append((event.t, text(event.text), level))
        for command in batch.of(COMMAND):
            name = _word(CommandKind, command.kind).capitalize()
            line = f"{name}{_parameter_asked(command)} asked for ({text(command.source)})"
            events.setdefault(entities.COMMANDS, []).append((command.t, line, _INFO))
        for answer in batch.of(COMMAND_ANSWER):
            name = _word(CommandKind, answer.kind).capitalize()
            words = text(answer.text)
            line = f"{name} {'done' if answer.ok else 'refused'}{': ' if words else ''}{words}"
            level = _INFO if answer.ok else _WARNING
            events.setdefault(entities.COMMANDS, []).append((answer.t, line, level))
        for parameter in batch.of(PARAMETER):
            path, words = f"{entities.PARAMETERS}/{text(parameter.name)}", _parameter(parameter)
            # Those that are judged are told again and again, for who comes late.
            if self._changed(path, [(parameter.t, words)]):
                events.setdefault(entities.PARAMETERS, []).append((parameter.t, words, _INFO))
        for path, lines in events.items():
            yield self._texts(path, sorted(lines))

    def _changed(self, path: str, timed: Iterable[Timed]) -> list[Timed]:
        changed: list[Timed] = []
        for t, word in timed:
            if self._last.get(path) != word:
                self._last[path] = word
                changed.append((t, word))
        return changed

    def _times(self, timed: Iterable[tuple[float, object]]) -> rr.TimeColumn:
        return time_column(np.array([t for t, _ in timed]), self._start)

    def _texts(self, path: str, lines: list[tuple[float, str, str]]) -> Chunk:
        times, texts, levels = zip(*lines, strict=True)
        columns = rr.TextLog.columns(text=list(texts), level=list(levels))
        # Whole milliseconds read well in a table.
        return Chunk(path, time_column(np.round(np.array(times) - self._start, 3)), columns)


def _parameter_asked(command: Command) -> str:
    """Return which parameter is to be set to what, where a command says so."""
    named = command.name or command.amount
    return f" {text(command.name)} = {command.amount:g}" if named else ""


def _parameter(parameter: Parameter) -> str:
    value = f"{parameter.value:.0f}" if parameter.whole else f"{parameter.value:#g}"
    count = f" (of {parameter.count})" if parameter.count else ""
    return f"{text(parameter.name)} = {value}{count}"


def _differing(states: Sequence[PilotState], fields: Sequence[str]) -> list[PilotState]:
    """Return the states some of whose fields differ from the state's before, and the first."""
    read = attrgetter(*fields)
    found: list[PilotState] = []
    before: object = None
    for state in states:
        now = read(state)
        if now != before:
            found.append(state)
            before = now
    return found


def _word(kind: type[IntEnum], number: int) -> str:
    """Return the word of a number; one that means nothing here stays a number and ends no recording."""
    try:
        return kind(number).name.lower()
    except ValueError:
        return str(number)


def _phase(state: PilotState) -> str:
    if state.phase == Phase.ENGAGED and state.on_leash:
        return "on leash"
    return _word(Phase, state.phase)


def _mapping(state: PilotState) -> str:
    if state.clutched:
        return "clutched"
    if state.waiting:
        return "waiting for the centre"
    return f"{_word(MappingMode, state.mapping)}{', fine' if state.fine else ''}"


def _guarded(state: PilotState) -> str:
    return f"keeps away from {text(state.guarded_by)}" if state.guarding else ""


def _vehicle(status: VehicleStatus) -> str:
    if not status.connected:
        return "no link"
    if not status.armed:
        return "disarmed"
    return "in air" if status.in_air else "armed"


def _device(report: DeviceReport) -> str:
    if not report.present:
        return "absent"
    return "ready" if report.homed else "not homed"
