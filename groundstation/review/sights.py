"""The rows of a recording as who measures a flight is shown them: the very numbers seen live, in their order."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator

import numpy as np

from groundstation.errors import InputError
from groundstation.recording import entities, lanes, schema
from groundstation.recording.schema import Quantity
from groundstation.review.flight import Flight, Numbers
from groundstation.training.happening import INSTRUCTOR, Happening, unpacked
from groundstation.training.measurer import HandSight, VehicleSight

COUPLED = frozenset({"engaged", "on leash"})
_ON_LEASH = "on leash"


def sights(flight: Flight) -> Iterator[VehicleSight | HandSight]:
    """Yield what a flight's measurer is shown. Times are those of the machine's clock; before schema 4 of the run."""
    # Of two at the same time the vehicle comes first, as live.
    yield from heapq.merge(_vehicle(flight), _hand(flight), key=lambda sight: sight.t)


def instructed(flight: Flight) -> Iterator[tuple[float, Happening]]:
    """Yield what an instructor let happen, and when, s on the clock of the sights."""
    for line in flight.texts(entities.INTERVENTIONS):
        answer, _, source, packed = line.text.split(" ", 3)
        happening = unpacked(packed.encode())
        if answer == "done" and source.encode() == INSTRUCTOR and happening is not None:
            yield origin(flight) + line.t, happening


def origin(flight: Flight) -> float:
    """Return when the recording begins on the clock of its sights, s."""
    try:
        return flight.start
    except InputError:
        return 0.0


def words_at(flight: Flight, lane: lanes.Lane, t: Numbers) -> list[str]:
    """Return a lane's word at each time, "" before its first."""
    changes = flight.states(lane)
    words = ["", *(word for _, word in changes)]
    places = np.searchsorted(np.array([when for when, _ in changes]), t, side="right")
    return [words[place] for place in places]


def _vehicle(flight: Flight) -> Iterator[VehicleSight]:
    t, positions = flight.series(schema.POSITION)
    velocities = flight.series(schema.VELOCITY).values[:, :3]
    known = np.isfinite(positions.sum(axis=1))
    rows = zip(
        _clock(flight, schema.POSITION, t), positions.tolist(), velocities.tolist(), known, _flags(flight, t),
        strict=True,
    )  # fmt: skip
    for when, (x, y, z, yaw), (vx, vy, vz), good, (armed, in_air) in rows:
        # Nothing is known of the motors before the first status; NaN is not.
        if good and armed == armed:  # noqa: PLR0124
            yield VehicleSight(when, (x, y, z, yaw), (vx, vy, vz), bool(armed), bool(in_air))


def _hand(flight: Flight) -> Iterator[HandSight]:
    t, errors = flight.series(schema.ERROR)
    forces = _newest(flight, schema.HANDLE_FORCE, t)
    changed = _changed(flight, len(t))
    rows = zip(
        _clock(flight, schema.ERROR, t), errors.tolist(), changed, forces, words_at(flight, lanes.PHASE, t),
        strict=True,
    )  # fmt: skip
    for when, (ex, ey, ez, _), disagreement, (fx, fy, fz), phase in rows:
        yield HandSight(
            when, phase in COUPLED, (ex, ey, ez), disagreement, (fx, fy, fz), on_leash=phase == _ON_LEASH
        )


def _clock(flight: Flight, quantity: Quantity, t: Numbers) -> list[float]:
    try:
        return flight.clock(quantity).tolist()
    except InputError:
        return t.tolist()


def _flags(flight: Flight, t: Numbers) -> list[list[float]]:
    """Return whether the vehicle was armed and in the air at each time; NaN where it is not known."""
    changes, states = flight.series(schema.STATUS)
    if len(changes):
        rows = np.concatenate((np.full((1, 2), np.nan), states[:, 1:3]))
        return rows[np.searchsorted(changes, t, side="right")].tolist()
    # Schema 1 has the words only; a link that is lost says nothing of the motors.
    in_air = [word == "in air" for word in words_at(flight, lanes.VEHICLE, t)]
    armed = [word in {"armed", "in air"} for word in words_at(flight, lanes.VEHICLE, t)]
    return [[float(one), float(other)] for one, other in zip(armed, in_air, strict=True)]


def _newest(flight: Flight, quantity: Quantity, t: Numbers) -> list[list[float]]:
    """Return a quantity's last row at each time, zeros before its first."""
    times, values = flight.series(quantity)
    rows = np.concatenate((np.zeros((1, len(quantity.parts))), values))
    return rows[np.searchsorted(times, t, side="right")].tolist()


def _changed(flight: Flight, count: int) -> list[float]:
    """Return |v_ref − v_safe| without yaw of each row, m/s; NaN of a schema that does not have them."""
    asked, left = (flight.series(quantity).values for quantity in (schema.V_REF, schema.V_SAFE))
    if not len(asked) == len(left) == count:
        return [math.nan] * count
    return [math.hypot(*row) for row in (asked - left)[:, :3].tolist()]
