"""How well a response tells a flight: one sample ahead, half a second ahead, and flown free from start to end."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from groundstation.identification.response import Asked, acted, flown, told
from groundstation.identification.samples import STILL, Numbers, Samples, Stretch
from sim.kinematics import Vector3
from sim.models.dynamic import ChiTuple, respond

# How far ahead a prediction looks beside the one of a single sample, s.
AHEAD_S = 0.5
# A block of the bootstrap, s: beyond it the errors of a free flight know little of each other.
BLOCK_S = 2.5
RESAMPLES = 400
LEVEL = (2.5, 97.5)
_CALM: Vector3 = (0.0, 0.0, 0.0)
_UNITS: tuple[Vector3, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class Ahead(NamedTuple):
    """A prediction from every sample on, each (4,) by axis.

    Attributes:
        model: R² of the response.
        nothing: R² of predicting that the velocity stays as it is: what a model has to beat.
    """

    model: Numbers
    nothing: Numbers


class Validation(NamedTuple):
    """How well a response tells a flight, each (4,) by axis; NaN where the axis hardly moved.

    Attributes:
        flight: Its name.
        one_step: One sample ahead.
        ahead: `AHEAD_S` ahead.
        free: R² of the free flight through all of it.
        low, high: 95 % interval of that, by drawing blocks of it anew.
        rms: What the free flight leaves, m/s and rad/s.
        windy: R² of the free flight in a steady wind that suits the flight best.
        push: (3,), what that wind accelerates, world, m/s².
    """

    flight: str
    one_step: Ahead
    ahead: Ahead
    free: Numbers
    low: Numbers
    high: Numbers
    rms: Numbers
    windy: Numbers
    push: Numbers


def validated(chi: Numbers, delays: Numbers, flight: Samples) -> Validation:
    """Return how well a response tells a flight. Nothing of the flight but its first velocity is given to it.

    Args:
        chi: (10,).
        delays: (3,), of level flight, up, yaw, s.
        flight: Any, of the same vehicle.
    """
    measured, ways = _end_to_end(chi, delays, flight)
    windy, push = _in_wind(chi, delays, flight)
    one_step, ahead = (_ahead(chi, delays, flight, seconds) for seconds in (flight.dt, AHEAD_S))
    low, high = _interval(measured, ways, max(1, round(BLOCK_S / flight.dt)))
    rms = np.sqrt(np.square(measured - ways).mean(axis=0))
    return Validation(flight.name, one_step, ahead, r_squared(measured, ways), low, high, rms, windy, push)


def free_flights(
    chi: Numbers, delays: Numbers, flight: Samples, push: Vector3 = _CALM
) -> Iterator[tuple[Numbers, Numbers]]:
    """Yield measured and freely flown velocities of each stretch, (n, 4) each.

    `sim.models.dynamic.respond` flies: what the simulator would do with the references of the flight.

    Args:
        chi: (10,).
        delays: (3,), s.
        flight: Whose references are flown.
        push: What the wind accelerates, world, m/s².
    """
    # Of a drag of 1/s, the wind's velocity is what it accelerates.
    constants = (_chi_tuple(chi), 1.0, flight.dt)
    for stretch in flight.stretches:
        first = acted(stretch.v[:, None], stretch.yaw[:, None], delays, flight.dt)[0, 0]
        p, v = (
            (0.0, 0.0, 0.0, float(stretch.yaw[0])),
            (float(first[0]), float(first[1]), float(first[2]), float(first[3])),
        )
        way = np.empty_like(stretch.v)
        for k, (forward, left, up, yaw_rate) in enumerate(stretch.ref.tolist()):
            way[k] = v
            p, v = respond(p, v, (forward, left, up, yaw_rate), push, constants)
        start = _latest(delays, flight.dt)
        yield stretch.v[start:], told(way[:, None], stretch.yaw[:, None], delays, flight.dt)[start:, 0]


def r_squared(measured: Numbers, told: Numbers) -> Numbers:
    """Return the share of each axis's variance that is told, 1 − Σ(v − v̂)² / Σ(v − v̄)², (4,); NaN if it is still."""
    measured, told = measured.reshape(-1, 4), told.reshape(-1, 4)
    left = np.square(measured - told).sum(axis=0)
    whole = np.square(measured - measured.mean(axis=0)).sum(axis=0)
    still = whole < len(measured) * STILL**2
    return np.where(still, np.nan, 1.0 - left / np.where(still, 1.0, whole))


def _end_to_end(
    chi: Numbers, delays: Numbers, flight: Samples, push: Vector3 = _CALM
) -> tuple[Numbers, Numbers]:
    """Return measured and freely flown velocities of all stretches, one behind the other."""
    pairs = list(free_flights(chi, delays, flight, push))
    return np.concatenate([measured for measured, _ in pairs]), np.concatenate([way for _, way in pairs])


def _in_wind(chi: Numbers, delays: Numbers, flight: Samples) -> tuple[Numbers, Numbers]:
    """Return R² of the free flight in the steady wind that leaves least, and what that wind accelerates.

    A push does not change how the vehicle turns, so the velocities are linear in it.
    """
    measured, calm = _end_to_end(chi, delays, flight)
    changes = [_end_to_end(chi, delays, flight, unit)[1] - calm for unit in _UNITS]
    spread = np.maximum(measured.std(axis=0), STILL)
    matrix = np.stack([(change / spread).ravel() for change in changes], axis=1)
    push = np.asarray(
        np.linalg.lstsq(matrix, ((measured - calm) / spread).ravel(), rcond=None)[0], np.float64
    )
    windy = calm + sum(share * change for share, change in zip(push, changes, strict=True))
    return r_squared(measured, windy), push


def _latest(delays: Numbers, dt: float) -> int:
    """Return after how many steps all that a reference did is told."""
    return int(np.ceil(delays.max() / dt))


def _ahead(chi: Numbers, delays: Numbers, flight: Samples, seconds: float) -> Ahead:
    """Return R² of velocities so far ahead, predicted from every sample on.

    Axes are told with different delays, so each is first brought to when its references acted: what is predicted
    lies `seconds` after the last velocity that was told of the same axis.
    """
    count = max(1, round(seconds / flight.dt))
    befores, afters, ways = [], [], []
    for stretch in flight.stretches:
        before, after, way = _predicted(stretch, delays, count, chi, flight.dt)
        befores.append(before)
        afters.append(after)
        ways.append(way)
    measured = np.concatenate(afters)
    return Ahead(r_squared(measured, np.concatenate(ways)), r_squared(measured, np.concatenate(befores)))


def _predicted(
    stretch: Stretch, delays: Numbers, count: int, chi: Numbers, dt: float
) -> tuple[Numbers, Numbers, Numbers]:
    """Return velocities, those measured `count` steps later, and those predicted for then, (n, 4) each."""
    v = acted(stretch.v[:, None], stretch.yaw[:, None], delays, dt)[:, 0]
    places = np.arange(len(v) - count - _latest(delays, dt))
    # Step by step for all places at once: references of a step are those that follow each place.
    ref = np.stack([stretch.ref[places + k] for k in range(count + 1)])
    way = flown(Asked(ref, np.zeros(ref.shape[:2]), dt), v[places], chi, np.zeros((1, 3)))[-1]
    return v[places], v[places + count], way


def _interval(measured: Numbers, ways: Numbers, block: int) -> tuple[Numbers, Numbers]:
    """Return the 95 % interval of R², (4,) each, by drawing blocks of the flight anew."""
    cuts = np.arange(0, len(measured), block)
    left = np.add.reduceat(np.square(measured - ways), cuts, axis=0)
    whole = np.add.reduceat(np.square(measured - measured.mean(axis=0)), cuts, axis=0)
    drawn = np.random.default_rng(0).integers(len(cuts), size=(RESAMPLES, len(cuts)))
    scores = 1.0 - left[drawn].sum(axis=1) / np.maximum(whole[drawn].sum(axis=1), 1e-12)
    low, high = np.percentile(scores, LEVEL, axis=0)
    still = np.isnan(r_squared(measured, ways))
    return np.where(still, np.nan, low), np.where(still, np.nan, high)


def _chi_tuple(chi: Numbers) -> ChiTuple:
    a, b, c, d, e, f, g, h, i, j = (float(value) for value in chi)
    return a, b, c, d, e, f, g, h, i, j
