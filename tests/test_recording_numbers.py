"""From records to rows: every number arrives, where it belongs, and what is not known is NaN."""

from __future__ import annotations

import datetime
import itertools
import math

import numpy as np
import numpy.testing as npt
import pytest
import rerun as rr
from hypothesis import given
from hypothesis import strategies as st
from recording_support import a_handle, a_pilot_state, a_ranges, a_setpoint, a_status, a_vehicle_state

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
    Attitude,
    Command,
    CommandAnswer,
    CommandKind,
    DeviceReport,
    Heartbeat,
    MissionProgress,
    Phase,
    PointsLost,
    Record,
    ServoReport,
    TickInputs,
    Topic,
)
from groundstation.pilot.controller import vehicle_rates as control_law
from groundstation.recording import entities, schema
from groundstation.recording.batch import Batch
from groundstation.recording.columns import Heartbeats, OnChange, number_chunks, number_columns, vehicle_rates
from groundstation.recording.echoes import Echoes
from groundstation.recording.item import Chunk, nanoseconds, time_column
from groundstation.recording.motion import Motion, Trail, quaternions
from groundstation.run import start_of

START = 1_000.0
ANGLES = st.floats(-math.pi, math.pi)
SPEEDS = st.floats(-10, 10)


def batch_of(*pairs: tuple[Topic[Record], list[Record]]) -> Batch:
    batch = Batch()
    for topic, records in pairs:
        batch.add(topic, records)
    return batch


def numbers(chunk: Chunk) -> np.ndarray:
    return next(iter(chunk.columns)).as_arrow_array().flatten().to_numpy().reshape(len(chunk.times.times), -1)


def seconds(chunk: Chunk) -> np.ndarray:
    return chunk.times.times.cast("int64").to_numpy() * 1e-9


def by_path(chunks) -> dict[str, Chunk]:
    found: dict[str, Chunk] = {}
    for chunk in chunks:
        assert chunk.path not in found
        found[chunk.path] = chunk
    return found


def full_batch() -> Batch:
    t = START + 1.5
    progress = MissionProgress(t=t, leg=1, legs=4, target_distance=3.5, clearance=math.inf, collisions=2)
    servo = ServoReport(t=t, rate=999.0, late_p50=1e-5, late_p99=2e-5, late_max=3e-5, read=4e-5, write=5e-5)
    return batch_of(
        (HANDLE, [a_handle(t, 7)]),
        (TICK_INPUTS, [TickInputs(t=t, tick=7, dt=0.001, state_t=t, commands=1, read=1)]),
        (DEVICE_REPORT, [DeviceReport(t=t, axes=4, workspace=0.05, rate=1000.0)]),
        (SETPOINT, [a_setpoint(t)]),
        (PILOT_STATE, [a_pilot_state(t)]),
        (VEHICLE_STATE, [a_vehicle_state(t)]),
        (VEHICLE_STATUS, [a_status(t)]),
        (ATTITUDE, [Attitude(t=t, roll=0.1, pitch=0.2, yaw=0.3, rates=(0.4, 0.5, 0.6), boot_t=9.5)]),
        (COMMAND, [Command(t=t, number=7, kind=CommandKind.PRESET, value=2, source=b"screen")]),
        (COMMAND_ANSWER, [CommandAnswer(t=t, number=7, kind=CommandKind.PRESET, ok=1)]),
        (OBSTACLES, [a_ranges(t, at0=3.0, at18=2.0)]),
        (SERVO_REPORT, [servo]),
        (MISSION_PROGRESS, [progress]),
        (POINTS_LOST, [PointsLost(t=t, until=t + 2.0, points=4.5, part=b"path")]),
    )


def test_a_batch_of_everything_fills_every_quantity_of_the_schema():
    batch = full_batch()
    rows = [*number_columns(batch), *OnChange().columns(batch)]
    untrusted = number_columns(batch_of((VEHICLE_STATE, [a_vehicle_state(START + 1.5, valid=False)])))
    rows += [column for column in untrusted if column.quantity is schema.UNTRUSTED]
    chunks = by_path(number_chunks(rows, START))
    assert set(chunks) == {quantity.path for quantity in schema.QUANTITIES}
    for quantity in schema.QUANTITIES:
        assert numbers(chunks[quantity.path]).shape == (1, len(quantity.parts)), quantity.path
        npt.assert_allclose(seconds(chunks[quantity.path]), [1.5])


def test_an_empty_batch_has_no_rows():
    assert list(number_chunks(number_columns(Batch()), START)) == []


def test_numbers_stand_where_the_schema_says():
    chunks = by_path(number_chunks(number_columns(full_batch()), START))
    expected = {
        schema.HANDLE_POSITION: [7e-6, -7e-6, 0.01, 7e-4],
        schema.HANDLE_FORCE: [7e-3, 2.0, -3.0],
        schema.ERROR: [0.5, 1.0, 0.5, 0.1],
        schema.V_SAFE: [0.05, 0.2, 0.3, 0.4],
        schema.V_C: [0.04, 0.2, 0.3, 0.4],
        schema.K1: [1.2, 1.2, 1.1, 1.0],
        schema.PHASE_MARGIN: [0.8],
        schema.SHARES: [0.9, 0.7],
        schema.ENVIRONMENT_CUE: [-1.0, 0.0, 0.0],
        schema.MISMATCH_CUE: [0.0, -2.0, 0.0],
        schema.GUARD_CUE: [0.0, 0.0, 3.0],
        schema.DAMPING_CUE: [0.1, 0.2, 0.2],
        schema.CUE_SIZES: [5.0, 1.0, 2.0, 3.0, 0.3],
        schema.CUES_ON: [31],
        schema.PREDICTED: [2.5, 2.5, 2.0, 0.4],
        schema.PREDICTED_VELOCITY: [1.0, 0.5, 0.0],
        schema.STOP: [3.0, 2.75, 2.0],
        schema.PUSH: [0.1, -0.2, 0.0],
        schema.RECKONED: [0.31],
        schema.RANGES: [2.0, 1.5, math.nan],
        schema.RANGE_LIMIT: [12.0],
        schema.RING: [3.0, *[math.inf] * 17, 2.0, *[math.inf] * 53],
        schema.HANDLE_AGE: [0.004],
        schema.POSITION: [1.0, 2.0, 3.0, 0.4],
        schema.ATTITUDE: [0.1, -0.2],
        schema.SILENCE: [0.03],
        schema.ROUND_TRIP: [math.nan],
        schema.GATE: [10, 2],
        schema.SERVO_LATE: [1e-5, 2e-5, 3e-5],
        schema.LEGS: [1, 4],
        schema.CLEARANCE: [math.nan],
        schema.COLLISIONS: [2],
        schema.RAW_ATTITUDE: [0.1, 0.2, 0.3, 9.5],
        schema.RAW_RATES: [0.4, 0.5, 0.6],
        schema.COMMANDED: [7, CommandKind.PRESET, 2],
        schema.ANSWERED: [7, CommandKind.PRESET, 1],
    }
    for quantity, row in expected.items():
        npt.assert_allclose(numbers(chunks[quantity.path])[0], row, atol=1e-9, err_msg=quantity.path)


def test_executed_velocity_is_on_the_axes_of_the_reference():
    state = a_vehicle_state(START)
    chunks = by_path(number_chunks(number_columns(batch_of((VEHICLE_STATE, [state]))), START))
    executed = [numbers(chunks[quantity.path])[0, 0] for quantity in schema.EXECUTED]
    npt.assert_allclose(executed, control_law(tuple(state.velocity), state.position[3]))


@given(st.lists(st.tuples(SPEEDS, SPEEDS, SPEEDS, SPEEDS, ANGLES), min_size=1, max_size=8))
def test_turning_many_rows_is_the_control_laws_turn_of_each(rows):
    table = np.array(rows)
    turned = vehicle_rates(table[:, :4], table[:, 4])
    npt.assert_allclose(turned, [control_law(tuple(row[:4]), row[4]) for row in rows], atol=1e-12)


def test_what_the_vehicle_calls_invalid_is_not_known():
    states = [a_vehicle_state(START), a_vehicle_state(START + 0.02, valid=False)]
    chunks = by_path(number_chunks(number_columns(batch_of((VEHICLE_STATE, states))), START))
    for quantity in (*schema.EXECUTED, schema.POSITION, schema.VELOCITY):
        first, second = numbers(chunks[quantity.path])
        assert np.isfinite(first).all()
        assert np.isnan(second).all()


def test_without_an_active_setpoint_there_is_no_reference():
    setpoints = [a_setpoint(START), a_setpoint(START + 0.02, active=False)]
    chunks = by_path(number_chunks(number_columns(batch_of((SETPOINT, setpoints))), START))
    for quantity, value in zip(schema.REFERENCES, (1.0, 2.0, 3.0, 4.0), strict=True):
        npt.assert_array_equal(numbers(chunks[quantity.path])[:, 0], [value, np.nan])
    npt.assert_allclose(numbers(chunks[schema.HANDLE_AGE.path])[:, 0], [0.004, np.nan])


def test_heartbeats_are_counted_across_batches_by_process():
    def beats(*times: float) -> Batch:
        return batch_of((HEARTBEAT, [Heartbeat(t=START + t, role=b"pilot", pid=1) for t in times]))

    counted = Heartbeats()
    first = by_path(counted.chunks(beats(0.0, 0.1), START))["/processes/pilot"]
    second = by_path(counted.chunks(beats(0.5), START))["/processes/pilot"]
    npt.assert_allclose(numbers(first)[:, 0], [0.0, 0.1], atol=1e-9)
    npt.assert_allclose(numbers(second)[:, 0], [0.4], atol=1e-9)


def test_buttons_are_logged_when_pressed_or_let_go():
    def held(t: float, *buttons: int) -> Batch:
        handles = [a_handle(START + t + i, i) for i in range(len(buttons))]
        for handle, bits in zip(handles, buttons, strict=True):
            handle.buttons = bits
        return batch_of((HANDLE, handles))

    buttons = OnChange()
    first, ready = buttons.columns(held(0.0, 0, 0, 5, 5))
    assert (ready.quantity, len(ready.t)) == (schema.HANDLE_READY, 1)
    npt.assert_array_equal(first.t, [START, START + 2.0])
    npt.assert_array_equal(first.values[:, 0], [0, 5])
    assert not list(buttons.columns(held(4.0, 5, 5)))
    (last,) = buttons.columns(held(6.0, 0))
    npt.assert_array_equal(last.values[:, 0], [0])


@given(st.integers(0, 2**53 - 1), st.integers(0, 2**50))
def test_times_come_back_as_the_very_floats_of_the_clock(n, start):
    """Up to the 104 days for which a clock's floats tell one nanosecond of uptime from the next but one."""
    t = n / 1e9
    assert nanoseconds(np.array([t]))[0] / 1e9 == t
    since = time_column(np.array([t]), start / 1e9).times.cast("int64").to_numpy()
    assert (since[0] + start) / 1e9 == t


@given(ANGLES, st.floats(-1.5, 1.5), ANGLES)
def test_quaternions_turn_the_axes_by_yaw_pitch_and_roll(roll, pitch, yaw):
    (x, y, z, w) = quaternions(np.array([roll]), np.array([pitch]), np.array([yaw]))[0]
    turned = np.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        )
    )
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    about_x = np.array(((1, 0, 0), (0, cr, -sr), (0, sr, cr)))
    about_y = np.array(((cp, 0, sp), (0, 1, 0), (-sp, 0, cp)))
    about_z = np.array(((cy, -sy, 0), (sy, cy, 0), (0, 0, 1)))
    npt.assert_allclose(turned, about_z @ about_y @ about_x, atol=1e-12)


def strips(chunk: Chunk) -> list[np.ndarray]:
    cells = next(iter(chunk.columns)).as_arrow_array().to_pylist()
    return [np.array(strip) for cell in cells for strip in cell]


@given(st.lists(st.integers(1, 9), min_size=1, max_size=8))
def test_a_trail_is_one_unbroken_line_however_it_is_cut_into_batches(sizes):
    total = sum(sizes)
    points = np.column_stack((np.arange(total) * 0.1, np.zeros(total), np.ones(total)))
    trail, found, done = Trail("/world/trail"), [], 0
    for size in sizes:
        rows = slice(done, done + size)
        found += [s for chunk in trail.add(points[rows, 0], points[rows]) for s in strips(chunk)]
        done += size
    for before, after in itertools.pairwise(found):
        npt.assert_array_equal(before[-1], after[0])
    if total > 5:
        npt.assert_allclose(found[0][0], points[0], atol=1e-6)
        assert total - 1 - round(found[-1][-1][0] / 0.1) < 5


def test_a_trail_that_is_lifted_starts_anew_and_standing_still_adds_nothing():
    trail = Trail("/world/trail")
    assert not list(trail.add(np.arange(20.0), np.zeros((20, 3))))
    trail.lift()
    points = np.column_stack((np.arange(6.0) + 50, np.zeros((6, 2))))
    (chunk,) = trail.add(np.arange(6.0), points)
    assert [strip[0][0] for strip in strips(chunk)] == [50.0]


def component(chunk: Chunk, name: str) -> list:
    columns = {column.component_descriptor().component: column for column in chunk.columns}
    return columns[name].as_arrow_array().to_pylist()


def test_hand_leash_and_force_are_shown_while_engaged_and_cleared_after():
    handle = a_handle(START, 0)
    handle.force[:] = (4.0, 0.0, 1.0)
    pilot = [a_pilot_state(START + 0.01), a_pilot_state(START + 0.03, phase=Phase.DISENGAGED)]
    motion = Motion(START, heading=True)
    chunks = by_path(motion.chunks(batch_of((HANDLE, [handle]), (PILOT_STATE, pilot))))
    npt.assert_allclose(component(chunks[entities.HAND], "Points3D:positions")[0], [(2.0, 3.0, 2.5)])
    npt.assert_allclose(
        component(chunks[entities.LEASH], "LineStrips3D:strips")[0], [[(1.5, 2.0, 2.0), (2.0, 3.0, 2.5)]]
    )
    turn, scale = 0.4, entities.ARROW_M_PER_N
    arrow = (4.0 * math.cos(turn) * scale, 4.0 * math.sin(turn) * scale, scale)
    npt.assert_allclose(component(chunks[entities.FORCE_ARROW], "Arrows3D:vectors")[0], [arrow], rtol=1e-6)
    for path in (entities.HAND, entities.LEASH, entities.FORCE_ARROW):
        for column in chunks[path].columns:
            assert column.as_arrow_array().to_pylist()[1] == []


def test_force_is_not_turned_where_the_handle_moves_along_the_worlds_axes():
    handle = a_handle(START, 0)
    handle.force[:] = (4.0, 0.0, 1.0)
    batch = batch_of((HANDLE, [handle]), (PILOT_STATE, [a_pilot_state(START + 0.01)]))
    chunks = by_path(Motion(START, heading=False).chunks(batch))
    npt.assert_allclose(component(chunks[entities.FORCE_ARROW], "Arrows3D:vectors")[0], [(1.0, 0.0, 0.25)])


def test_what_the_forecast_says_is_shown_while_engaged_and_cleared_after():
    pilot = [a_pilot_state(START + 0.01), a_pilot_state(START + 0.03, phase=Phase.DISENGAGED)]
    chunks = by_path(Motion(START, heading=True).chunks(batch_of((PILOT_STATE, pilot))))
    npt.assert_allclose(component(chunks[entities.PREDICTED], "Points3D:positions")[0], [(2.5, 2.5, 2.0)])
    npt.assert_allclose(component(chunks[entities.STOP], "Points3D:positions")[0], [(3.0, 2.75, 2.0)])
    npt.assert_allclose(
        component(chunks[entities.PROSPECT], "LineStrips3D:strips")[0],
        [[(1.5, 2.0, 2.0), (2.5, 2.5, 2.0), (3.0, 2.75, 2.0)]],
    )
    for path in (entities.PREDICTED, entities.STOP, entities.PROSPECT):
        for column in chunks[path].columns:
            assert column.as_arrow_array().to_pylist()[1] == []


def test_what_the_sensors_see_is_placed_from_where_the_vehicle_was_then():
    echoes = Echoes(START)
    first = a_vehicle_state(START, position=(1.0, 2.0, 3.0, math.pi / 2))
    later = a_vehicle_state(START + 0.2, position=(5.0, 2.0, 3.0, 0.0))
    before = a_ranges(START - 0.1, at0=2.0)
    batch = batch_of(
        (VEHICLE_STATE, [first, later]), (OBSTACLES, [before, a_ranges(START + 0.1, at0=2.0, at18=1.0)])
    )
    (chunk,) = echoes.chunks(batch)
    unplaced, placed = component(chunk, "Points3D:positions")
    assert unplaced == []
    npt.assert_allclose(placed, [(1.0, 4.0, 3.0), (0.0, 2.0, 3.0), (1.0, 2.0, 1.5)], atol=1e-6)
    # The vehicle's place is known from one batch to the next.
    (chunk,) = echoes.chunks(batch_of((OBSTACLES, [a_ranges(START + 0.3, at36=1.0)])))
    npt.assert_allclose(
        component(chunk, "Points3D:positions")[0], [(4.0, 2.0, 3.0), (5.0, 2.0, 1.5)], atol=1e-6
    )


def test_an_invalid_state_moves_nothing():
    motion = Motion(START, heading=True)
    assert not list(motion.chunks(batch_of((VEHICLE_STATE, [a_vehicle_state(START, valid=False)]))))
    chunks = by_path(motion.chunks(batch_of((VEHICLE_STATE, [a_vehicle_state(START)]))))
    npt.assert_allclose(component(chunks[entities.VEHICLE_POSE], "Transform3D:translation")[0], [(1, 2, 3)])


NOON = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)


@pytest.mark.parametrize(
    ("ago", "start"), [(2.0, 98.0), (0.0, 100.0), (-3_600.0, 100.0), (3_600.0, 100.0)], ids=str
)
def test_the_run_began_where_the_wall_clock_says_unless_it_jumped(ago, start):
    began = NOON - datetime.timedelta(seconds=ago)
    assert start_of(began.isoformat(), NOON, 100.0) == pytest.approx(start)


def test_rerun_is_the_version_the_schema_was_tried_with():
    assert rr.__version__.startswith("0.41.")
