"""The ghost in a recording: it moves with the flight, from take-off to landing, and begins anew with the next."""

from __future__ import annotations

import numpy as np
import pytest

from groundstation.messages import VEHICLE_STATUS, VehicleStatus
from groundstation.recording import entities
from groundstation.recording.batch import Batch
from groundstation.recording.ghost import Ghost
from groundstation.training.measures import Track

START = 100.0
TRACK = Track(1.0, tuple((float(step), 0.0, 2.0) for step in range(5)))


def batch(*statuses: tuple[float, bool]) -> Batch:
    found = Batch()
    found.add(
        VEHICLE_STATUS, [VehicleStatus(t=START + t, armed=flying, in_air=flying) for t, flying in statuses]
    )
    return found


def rows(ghost: Ghost, *batches: Batch) -> list[tuple[float, list[float]]]:
    """Return the ghost's places with their times, s on the timeline; [] where it is not there."""
    found: list[tuple[float, list[float]]] = []
    for each in batches:
        for chunk in ghost.chunks(each):
            if chunk.path != entities.GHOST:
                continue
            times = chunk.times.times.cast("int64").to_numpy() * 1e-9
            (column,) = chunk.columns
            places = [np.ravel(cell).tolist() for cell in column.as_arrow_array().to_pylist()]
            found += zip(times.tolist(), places, strict=True)
    return found


def test_it_moves_with_the_time_since_take_off_as_far_as_the_flight_has_come():
    ghost = Ghost(START, TRACK)
    found = rows(ghost, batch((1.0, False), (2.0, True)), batch((3.0, True), (4.5, True)))
    times = [t for t, _ in found]
    assert times == pytest.approx([2.0 + 0.1 * step for step in range(26)])
    assert found[0][1] == []
    for t, place in found[1:]:
        assert place == pytest.approx([t - 2.0, 0.0, 2.0], abs=1e-5)


def test_it_goes_with_the_landing_and_begins_anew_with_the_next_flight():
    ghost = Ghost(START, TRACK)
    found = rows(ghost, batch((2.0, True), (3.0, True), (3.05, False)), batch((10.0, True), (11.05, True)))
    landed = next(place for t, place in found if t == pytest.approx(3.05))
    assert landed == []
    assert found[-1] == (pytest.approx(11.0), pytest.approx([1.0, 0.0, 2.0], abs=1e-5))


def test_where_nobody_is_followed_nothing_is_written():
    assert rows(Ghost(START, None), batch((2.0, True), (5.0, True))) == []
