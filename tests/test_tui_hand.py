"""The on-screen stick's deflection, and what the screen remembers of the flight."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from canned_flight import NOTHING, CannedFlight, canned_run
from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import VehicleState
from groundstation.tui.hand import CENTRED, STEP, Hand
from groundstation.tui.track import History, Ring, Track, velocity_on_vehicle
from groundstation.tui.widgets.stick import pads

anything = st.floats(allow_nan=True, allow_infinity=True)


def test_steps_add_up_stay_and_end_at_the_edge():
    hand = Hand()
    hand.step(0, 1)
    hand.step(0, 1)
    hand.step(3, -1)
    assert hand.share == pytest.approx((2 * STEP, 0.0, 0.0, -STEP))
    for _ in range(9):
        hand.step(0, 1)
    assert hand.share[0] == 1.0
    for _ in range(5):
        hand.step(0, -1)
    assert hand.share[0] == 0.0


def test_centring_centres_all_axes():
    hand = Hand()
    for axis in range(4):
        hand.place(axis, 0.7)
    hand.centre()
    assert hand.share == CENTRED
    assert hand.deflection(0.1, 1.0) == ((0.0, 0.0, 0.0), 0.0)


@given(
    st.lists(st.tuples(st.integers(0, 3), anything), max_size=20), st.floats(0.001, 1.0), st.floats(0.1, 3.1)
)
def test_a_deflection_is_always_finite_and_within_the_workspace(places, workspace, yaw_range):
    hand = Hand()
    for axis, share in places:
        hand.place(axis, share)
    position, yaw = hand.deflection(workspace, yaw_range)
    assert math.hypot(*position) <= workspace * (1 + 1e-9)
    assert abs(yaw) <= yaw_range


def test_a_deflection_is_the_share_of_the_workspace():
    hand = Hand()
    hand.place(1, -0.5)
    hand.place(3, 0.25)
    assert hand.deflection(0.1, 2.0) == ((0.0, -0.05, 0.0), 0.5)


@pytest.mark.parametrize(("width", "height"), [(34, 7), (54, 14), (20, 4)])
def test_the_middle_of_a_pad_is_the_centre_and_its_edges_are_full(width, height):
    for pad in pads(width, height):
        middle = (pad.column + pad.columns / 2, pad.rows / 2)
        assert pad.share(*middle) == pytest.approx((0.0, 0.0))
        assert pad.share(pad.column + pad.columns, pad.rows / 2) == pytest.approx((1.0, 0.0))
        assert pad.share(pad.column - 9, -9) == (-1.0, 1.0)


@given(st.lists(st.floats(-1e6, 1e6), max_size=50), st.integers(1, 8))
def test_a_ring_keeps_the_last_rows_in_order(values, size):
    ring = Ring(size, 1)
    for value in values:
        ring.add((value,))
    assert ring.rows()[:, 0].tolist() == values[-size:]


def test_hovering_adds_nothing_to_the_track_and_a_jump_starts_it_anew():
    track = Track()
    for step in range(100):
        track.add(0.001 * step, 0.0, 2.0, 10.0 + step)
    assert len(track.points()) == 2
    track.add(math.nan, 1.0, 2.0, 111.0)
    assert len(track.points()) == 2
    track.add(50.0, 0.0, 2.0, 112.0)
    assert track.points().tolist() == [[50.0, 0.0, 2.0, 112.0]]


def test_the_history_samples_at_its_rate_and_leaves_gaps_for_what_is_old():
    history = History()
    flight = CannedFlight(canned_run())
    flight.advance(8.0)
    for _ in range(50):
        flight.advance(0.02)
        history.add(flight.snapshot(), 0.5)
    rows = history.rows()
    assert len(rows) == 10
    assert np.isfinite(rows).all()
    assert history.rows()[-1, History.FLOWN] == pytest.approx(
        velocity_on_vehicle(flight.snapshot().vehicle)[0], abs=0.1
    )
    blank = History()
    blank.add(NOTHING, 0.5)
    assert np.isnan(blank.rows()[0, 1:]).all()


def test_the_history_keeps_what_is_meant_and_not_the_compensated_setpoint():
    flight = CannedFlight(canned_run())
    flight.advance(8.0)
    snapshot = flight.snapshot()
    snapshot.pilot.v_c[:] = (0.5, 0.25, 0.125, 0.0)
    snapshot.setpoint.velocity[:] = (9.0, 9.0, 9.0, 9.0)
    history = History()
    history.add(snapshot, 0.5)
    assert history.rows()[0, History.MEANT : History.MEANT + 3].tolist() == [0.5, 0.25, 0.125]
    snapshot.setpoint.active = 0
    history.add(replace(snapshot, t=snapshot.t + 0.2), 0.5)
    assert np.isnan(history.rows()[1, History.MEANT : History.MEANT + 3]).all()


def test_the_velocity_flown_is_turned_onto_the_vehicles_axes():
    state = VehicleState(position=(0, 0, 0, math.pi / 2), velocity=(0.0, 2.0, 0.3, 0.1))
    assert velocity_on_vehicle(state) == pytest.approx((2.0, 0.0, 0.3, 0.1))
    state.position[3] = math.nan
    assert math.isnan(velocity_on_vehicle(state)[0])
