"""Numbers of the records as Rerun columns: from records to one array a topic to one column a quantity."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from typing import Any, NamedTuple, cast

import numpy as np
import numpy.typing as npt
import rerun as rr

from groundstation.messages import (
    ATTITUDE,
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    HANDLE,
    HEARTBEAT,
    MISSION_PROGRESS,
    OBSTACLES,
    PILOT_STATE,
    POINTS_LOST,
    SERVO_REPORT,
    SETPOINT,
    TICK_INPUTS,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Heartbeat,
    Record,
    Topic,
)
from groundstation.recording import schema
from groundstation.recording.batch import Batch, text
from groundstation.recording.item import Chunk, Numbers, time_column
from groundstation.recording.schema import Quantity

Rows = npt.NDArray[np.void]


def rows_of(records: Sequence[Record]) -> Rows:
    """Return records of one kind as one structured array, a row each, in one copy."""
    return np.frombuffer(b"".join(records), dtype=_kind(type(records[0])))


def rows_in(batch: Batch, topic: Topic[Any]) -> Rows:
    """Return the records of a topic in a batch as `rows_of`; the batch is complete and has some."""
    if topic.name not in batch.arrays:
        batch.arrays[topic.name] = rows_of(batch.of(topic))
    return batch.arrays[topic.name]


@cache
def _kind(record: type[Record]) -> np.dtype[np.void]:
    return cast("np.dtype[np.void]", np.dtype(record))


def vehicle_rates(world: Numbers, yaw: Numbers) -> Numbers:
    """Turn world velocities onto the vehicle's axes, v = J⁻¹(θ) ṗ of equation (3), row by row.

    Args:
        world: (n, 4), [x, y, z, yaw] rates, m/s and rad/s.
        yaw: (n,), θ, rad.

    Returns:
        (n, 4), [forward, left, up, yaw rate].
    """
    cosine, sine = np.cos(yaw), np.sin(yaw)
    x, y = world[:, 0], world[:, 1]
    return np.column_stack((cosine * x + sine * y, cosine * y - sine * x, world[:, 2], world[:, 3]))


def _where(known: npt.NDArray[np.bool_], values: Numbers) -> Numbers:
    """Return values with NaN in the rows that are not known."""
    return np.where(known if values.ndim == 1 else known[:, None], values, np.nan)


def _with_yaw(field: str) -> Callable[[Rows], Numbers]:
    return lambda rows: np.column_stack((rows[field], rows["yaw"]))


def _fields(*names: str) -> Callable[[Rows], Numbers]:
    if len(names) == 1:
        return lambda rows: rows[names[0]].astype(np.float64)
    return lambda rows: np.column_stack([rows[name] for name in names]).astype(np.float64)


def _valid(field: str) -> Callable[[Rows], Numbers]:
    return lambda rows: _where(rows["valid"] != 0, rows[field])


def _reference(axis: int) -> Callable[[Rows], Numbers]:
    return lambda rows: _where(rows["active"] != 0, rows["velocity"][:, axis])


def _executed(axis: int) -> Callable[[Rows], Numbers]:
    return lambda rows: _where(
        rows["valid"] != 0, vehicle_rates(rows["velocity"], rows["position"][:, 3])[:, axis]
    )


def _sizes(*vectors: str) -> Callable[[Rows], Numbers]:
    return lambda rows: np.column_stack([np.linalg.norm(rows[vector], axis=1) for vector in vectors])


def _ranges(rows: Rows) -> Numbers:
    """Return the ring's least, NaN where nothing of it is known; below and above."""
    return np.column_stack((np.fmin.reduce(rows["ring"], axis=1), rows["below"], rows["above"]))


_NUMBERS: tuple[tuple[Topic[Any], tuple[tuple[Quantity, Callable[[Rows], Numbers]], ...]], ...] = (
    (
        HANDLE,
        (
            (schema.HANDLE_POSITION, _with_yaw("position")),
            (schema.HANDLE_VELOCITY, _fields("velocity")),
            # Exact both ways: so is a difference of floats within a factor of two of each other (Sterbenz's lemma).
            (schema.SAMPLE_AGE, lambda rows: rows["t"] - rows["device_t"]),
            (schema.HANDLE_FORCE, _fields("force")),
        ),
    ),
    (
        TICK_INPUTS,
        (
            (schema.TICK, _fields("tick", "dt", "fitted", "read", "homed", "present")),
            (schema.KNOWN, _fields("state_t", "status_t", "ranges_t", "command_t", "commands")),
        ),
    ),
    (
        SETPOINT,
        (
            *((quantity, _reference(axis)) for axis, quantity in enumerate(schema.REFERENCES)),
            (schema.HANDLE_AGE, lambda rows: _where(rows["active"] != 0, rows["t"] - rows["handle_t"])),
            (schema.SETPOINT_NUMBER, _fields("number")),
        ),
    ),
    (
        PILOT_STATE,
        (
            (schema.P_H, _fields("p_h")),
            (schema.P_H_RATE, _fields("p_h_rate")),
            (schema.ERROR, _fields("error")),
            (schema.V_REF, _fields("v_ref")),
            (schema.V_SAFE, _fields("v_safe")),
            (schema.V_C, _fields("v_c")),
            (schema.K1, _fields("k1")),
            (schema.PHASE_MARGIN, _fields("phase_margin")),
            (schema.SHARES, _fields("gain_share", "speed_share")),
            (schema.FORCE_CUE, _fields("force")),
            (schema.ENVIRONMENT_CUE, _fields("environment")),
            (schema.MISMATCH_CUE, _fields("mismatch")),
            (schema.GUARD_CUE, _fields("guard")),
            (schema.DAMPING_CUE, _fields("damping")),
            (schema.GUIDANCE_CUE, _fields("guidance")),
            (schema.CUE_SIZES, _sizes("force", "environment", "mismatch", "guard", "damping")),
            (schema.CUES_ON, _fields("cues")),
            (schema.PREDICTED, _fields("predicted")),
            (schema.PREDICTED_VELOCITY, _fields("predicted_velocity")),
            (schema.STOP, _fields("stop")),
            (schema.PUSH, _fields("push")),
            (schema.STATE_AGE, _fields("state_age")),
            (schema.RECKONED, _fields("delay")),
            (schema.HANDLE_ENERGY, _fields("port_energy", "dissipated")),
        ),
    ),
    (
        VEHICLE_STATE,
        (
            *((quantity, _executed(axis)) for axis, quantity in enumerate(schema.EXECUTED)),
            (schema.POSITION, _valid("position")),
            (schema.VELOCITY, _valid("velocity")),
            (schema.ATTITUDE, _fields("roll", "pitch")),
            (schema.BOOT_TIME, _fields("boot_t")),
        ),
    ),
    (
        OBSTACLES,
        (
            (schema.RING, _fields("ring")),
            (schema.RANGES, _ranges),
            (schema.RANGE_LIMIT, _fields("limit")),
        ),
    ),
    (
        VEHICLE_STATUS,
        (
            (schema.BATTERY, _fields("battery")),
            (schema.VOLTAGE, _fields("voltage")),
            (schema.HEALTH_BITS, _fields("health")),
            (schema.ROUND_TRIP, _fields("rtt")),
            (schema.SILENCE, lambda rows: _where(rows["heard_t"] > 0, rows["t"] - rows["heard_t"])),
            (schema.LOSS, _fields("loss")),
            (schema.GATE, _fields("sent", "dropped")),
        ),
    ),
    (
        SERVO_REPORT,
        (
            (schema.SERVO_RATE, _fields("rate")),
            (schema.SERVO_LATE, _fields("late_p50", "late_p99", "late_max")),
            (schema.SERVO_RUN, _fields("run_p50", "run_p99")),
            (schema.SERVO_TIME, _fields("read", "write", "step")),
            (schema.SERVO_TICKS, _fields("ticks", "missed")),
        ),
    ),
    (
        MISSION_PROGRESS,
        (
            (schema.TARGET_DISTANCE, _fields("target_distance")),
            (schema.CLEARANCE, _fields("clearance")),
            (schema.LEGS, _fields("leg", "legs")),
            (schema.COLLISIONS, _fields("collisions")),
        ),
    ),
    (
        ATTITUDE,
        (
            (schema.RAW_ATTITUDE, _fields("roll", "pitch", "yaw", "boot_t")),
            (schema.RAW_RATES, _fields("rates")),
        ),
    ),
    # A moment's length and not its end: the timeline has its beginning.
    (
        POINTS_LOST,
        ((schema.LOST, lambda rows: np.column_stack((rows["points"], rows["until"] - rows["t"]))),),
    ),
    (COMMAND, ((schema.COMMANDED, _fields("number", "kind", "value")),)),
    (COMMAND_ANSWER, ((schema.ANSWERED, _fields("number", "kind", "ok")),)),
)


# What changes seldom: a row only when it does.
_RARE: tuple[tuple[Topic[Any], Quantity, Callable[[Rows], Numbers]], ...] = (
    (HANDLE, schema.HANDLE_BUTTONS, _fields("buttons")),
    (HANDLE, schema.HANDLE_READY, _fields("present", "homed")),
    (PILOT_STATE, schema.CENTRED, _fields("centred")),
    (VEHICLE_STATUS, schema.SYSTEM_ID, _fields("system_id")),
    (VEHICLE_STATUS, schema.AUTOPILOT, _fields("autopilot", "component")),
    (SERVO_REPORT, schema.REALTIME, _fields("realtime")),
    (VEHICLE_STATUS, schema.STATUS, _fields("connected", "armed", "in_air", "mode", "streaming")),
    (VEHICLE_STATUS, schema.SPEED_LIMITS, _fields("speed_limits")),
    (DEVICE_REPORT, schema.LIMITS, _fields("axes", "workspace", "force_limit", "stiffness_limit", "rate")),
)


class Column(NamedTuple):
    """Numbers of a quantity: (n,) monotonic s, and (n, parts) or (n,) values."""

    quantity: Quantity
    t: Numbers
    values: Numbers


def number_columns(batch: Batch) -> Iterator[Column]:
    """Yield the numbers of a batch, a quantity each, a row a record."""
    for topic, quantities in _NUMBERS:
        if not batch.of(topic):
            continue
        rows = rows_in(batch, topic)
        t = rows["t"]
        for quantity, values in quantities:
            numbers = values(rows)
            if quantity is not schema.RING:
                numbers = _finite_or_nan(numbers)
            yield Column(quantity, t, numbers)
    if untrusted := [state for state in batch.of(VEHICLE_STATE) if not state.valid]:
        rows = rows_of(untrusted)
        told = np.column_stack((rows["position"], rows["velocity"]))
        yield Column(schema.UNTRUSTED, rows["t"], _finite_or_nan(told))


def number_chunks(columns: Iterable[Column], start: float) -> Iterator[Chunk]:
    """Yield numbers as they are sent, an entity each.

    Args:
        columns: The numbers.
        start: Monotonic time that is 0 on the timeline, s.
    """
    shared, times = np.empty(0), time_column(np.empty(0))
    for quantity, t, values in columns:
        # Quantities of one record have their times in common.
        if t is not shared:
            shared, times = t, time_column(t, start)
        yield Chunk(quantity.path, times, rr.Scalars.columns(scalars=values))


def _finite_or_nan(values: Numbers) -> Numbers:
    """Plots scale to what they are given: an infinite clearance, as in free flight, is no number to show.

    In the ring, which no plot shows, it says that nothing is there.
    """
    return np.where(np.isfinite(values), values, np.nan)


class Heartbeats:
    """Time between heartbeats, process by process."""

    def __init__(self) -> None:
        self._last: dict[str, float] = {}
        self._numbers: dict[str, int] = {}

    def chunks(self, batch: Batch, start: float) -> Iterator[Chunk]:
        """Yield a batch's heartbeats, an entity a process; each process's first only starts the count."""
        beats: dict[str, list[Heartbeat]] = {}
        for beat in batch.of(HEARTBEAT):
            beats.setdefault(text(beat.role), []).append(beat)
        for role, heard in beats.items():
            times = np.array([self._last.get(role, heard[0].t), *(beat.t for beat in heard)])
            self._last[role] = heard[-1].t
            column = time_column(times[1:], start)
            yield Chunk(schema.heartbeat(role).path, column, rr.Scalars.columns(scalars=np.diff(times)))
            if heard[-1].pid != self._numbers.get(role):
                self._numbers[role] = heard[-1].pid
                number = rr.Scalars.columns(scalars=np.array([float(heard[-1].pid)]))
                yield Chunk(schema.process_number(role).path, time_column(times[-1:], start), number)


class OnChange:
    """Numbers that seldom change, a row only when one does."""

    def __init__(self) -> None:
        self._last: dict[str, Numbers] = {}

    def columns(self, batch: Batch) -> Iterator[Column]:
        """Yield a batch's changes."""
        for topic, quantity, values_of in _RARE:
            if not batch.of(topic):
                continue
            rows = rows_in(batch, topic)
            values = values_of(rows).reshape(len(rows), -1)
            before = self._last.get(quantity.path, np.full(values.shape[1], np.nan))
            self._last[quantity.path] = values[-1]
            changed = np.logical_or.reduce(np.diff(values, axis=0, prepend=before[None]) != 0.0, axis=1)
            if changed.any():
                yield Column(quantity, rows["t"][changed], values[changed])
