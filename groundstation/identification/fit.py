"""Identification and validation: delay, regularisation, χ with its confidence, and how well it tells flights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from groundstation.errors import InputError
from groundstation.identification.refine import normal_of, refined, solved
from groundstation.identification.regress import LEAST, POSITIVE, regressed
from groundstation.identification.response import (
    CHI,
    Windows,
    delayed,
    flown,
    r_squared,
    windows,
)
from groundstation.identification.samples import Numbers, Samples
from sim.models.dynamic import Chi

# A window's length: long enough for every response to settle, short enough for several in a short flight, s.
WINDOW_S = 2.5
_LONGEST_DELAY_S = 0.4
_DELAY_STEP_S = 0.02
_RIDGES = (0.0, 1e-5, 1e-4, 1e-3)
_FOLDS = 4
_RESAMPLES = 400
_LEVEL = (2.5, 97.5)
# How far ahead a prediction looks beside the one of a single sample, s.
AHEAD_S = 0.5
_FEWEST_WINDOWS = 4

Tell = Callable[[str], None]


class Told(NamedTuple):
    """How well a response tells a flight, each (4,) by axis.

    Attributes:
        flight: Its name.
        one_step: R² of the prediction one sample ahead.
        ahead: R² of that `AHEAD_S` ahead.
        free: R² of the free flight through all of it.
        rms: What the free flight leaves, m/s and rad/s.
    """

    flight: str
    one_step: Numbers
    ahead: Numbers
    free: Numbers
    rms: Numbers


class Identified(NamedTuple):
    """What was found.

    Attributes:
        parameters: (13,), as in `response.PARAMETERS`.
        low, high: (13,), 95 % confidence, by resampling the windows.
        delay: From a reference's sending to its effect, s.
        ridge: The prior's weight that told held-out windows best.
        crossed: (4,), R² of windows that were held out, by axis.
        condition: Of the normal equations on χ's own scale: above some 1e4 not all of χ can be told apart.
        step: The samples', s.
    """

    parameters: Numbers
    low: Numbers
    high: Numbers
    delay: float
    ridge: float
    crossed: Numbers
    condition: float
    step: float

    @property
    def chi(self) -> Chi:
        """χ as an airframe has it."""
        return Chi(*(float(value) for value in self.parameters[:CHI]))


def identify(flights: Sequence[Samples], tell: Tell = lambda _words: None) -> Identified:
    """Identify the response from one or more flights of a vehicle.

    Args:
        flights: With the same step, within a tenth of a percent; else each is used on the first one's.
        tell: Told what is being done.

    Raises:
        InputError: The flights are too short.
    """
    together = joined(flights)
    tell("looking for the delay")
    delay = _delay(together)
    pieces = windows(together, WINDOW_S, delay)
    if pieces.v.shape[1] < _FEWEST_WINDOWS:
        raise InputError(
            f"{together.name}: has {pieces.v.shape[1]} stretches of {WINDOW_S:g} s, {_FEWEST_WINDOWS} are needed; "
            "fly longer, or give several flights."
        )
    tell("cross-validating")
    ridge, crossed = _ridge(together, pieces, delay)
    tell("fitting")
    parameters = refined(pieces, regressed(together, delay, ridge), ridge)
    tell("resampling")
    low, high = _confidence(pieces, parameters, ridge)
    return Identified(
        parameters, low, high, delay, ridge, crossed, _condition(pieces, parameters), together.dt
    )


def joined(flights: Sequence[Samples]) -> Samples:
    """Return the stretches of several flights on the first one's step."""
    first = flights[0]
    stretches = [each for flight in flights for each in stepped(flight, first.dt)]
    return Samples(" + ".join(flight.name for flight in flights), first.dt, tuple(stretches))


def stepped(flight: Samples, dt: float) -> Sequence[tuple[Numbers, Numbers]]:
    """Return a flight's stretches on another step, s."""
    if abs(flight.dt - dt) < 1e-3 * dt:
        return flight.stretches
    changed: list[tuple[Numbers, Numbers]] = []
    for v, ref in flight.stretches:
        t = np.arange(len(v)) * flight.dt
        grid = np.arange(0.0, t[-1], dt)
        held = np.clip(np.searchsorted(t, grid + 1e-9, side="right") - 1, 0, len(t) - 1)
        changed.append((np.column_stack([np.interp(grid, t, column) for column in v.T]), ref[held]))
    return changed


def told(found: Identified, flight: Samples) -> Told:
    """Return how well a response tells a flight; the steady push of the flights it is from is left out."""
    flight = Samples(flight.name, found.step, tuple(stepped(flight, found.step)))
    still = found.parameters.copy()
    still[CHI:] = 0.0
    one_step, ahead = (_ahead(flight, still, found.delay, seconds) for seconds in (flight.dt, AHEAD_S))
    measured: list[Numbers] = []
    ways: list[Numbers] = []
    for v, way in free_flights(found, flight):
        measured.append(v)
        ways.append(way)
    everything, all_ways = np.concatenate(measured), np.concatenate(ways)
    rms = np.sqrt(np.square(everything - all_ways).mean(axis=0))
    return Told(flight.name, one_step, ahead, r_squared(everything, all_ways), rms)


def free_flights(found: Identified, flight: Samples) -> list[tuple[Numbers, Numbers]]:
    """Return measured and freely flown velocities of each stretch, (n, 4) each; only the first sample is given."""
    still = found.parameters.copy()
    still[CHI:] = 0.0
    pairs: list[tuple[Numbers, Numbers]] = []
    for v, ref in flight.stretches:
        start = int(np.ceil(found.delay / flight.dt))
        late = delayed(ref, found.delay / flight.dt)[start:]
        whole = Windows(v[start:, None], late[:, None], flight.dt)
        pairs.append((v[start:], flown(whole, still)[:, 0]))
    return pairs


def _ahead(flight: Samples, parameters: Numbers, delay: float, seconds: float) -> Numbers:
    """Return R² of the velocity so far ahead, told from every sample on, (4,)."""
    steps = max(1, round(seconds / flight.dt))
    measured: list[Numbers] = []
    ways: list[Numbers] = []
    for v, ref in flight.stretches:
        late = delayed(ref, delay / flight.dt)
        places = np.arange(int(np.ceil(delay / flight.dt)), len(v) - steps)
        offsets = np.arange(steps + 1)[:, None]
        pieces = Windows(v[places + offsets], late[places + offsets], flight.dt)
        measured.append(pieces.v[-1])
        ways.append(flown(pieces, parameters)[-1])
    return r_squared(np.concatenate(measured), np.concatenate(ways))


def _delay(samples: Samples) -> float:
    """Return the delay with which the refined response flies the windows best, s, between the steps of the search."""
    delays = np.arange(0.0, _LONGEST_DELAY_S + 1e-9, _DELAY_STEP_S)
    longest = windows(samples, WINDOW_S, float(delays[-1])).v.shape[1]
    costs: list[float] = []
    start = regressed(samples, 0.0, _RIDGES[1])
    for delay in delays:
        pieces = windows(samples, WINDOW_S, float(delay)).only(np.arange(longest))
        start = refined(pieces, start, _RIDGES[1], rounds=4)
        costs.append(float(normal_of(pieces, start).left.sum()))
        if len(costs) > 4 and costs[-1] > 1.5 * min(costs):
            break
    best = int(np.argmin(costs))
    if 0 < best < len(costs) - 1:
        before, at, after = costs[best - 1 : best + 2]
        bend = before - 2.0 * at + after
        return (
            float(delays[best] + 0.5 * _DELAY_STEP_S * (before - after) / bend)
            if bend > 0.0
            else float(delays[best])
        )
    return float(delays[best])


def _ridge(samples: Samples, pieces: Windows, delay: float) -> tuple[float, Numbers]:
    """Return the prior's weight that tells held-out windows best, and how well, by axis."""
    count = pieces.v.shape[1]
    fold = np.arange(count) * min(_FOLDS, count) // count
    best: tuple[float, float, Numbers] | None = None
    for ridge in _RIDGES:
        start = regressed(samples, delay, ridge)
        ways = np.empty_like(pieces.v)
        for held in range(int(fold.max()) + 1):
            away = np.flatnonzero(fold == held)
            found = refined(pieces.only(np.flatnonzero(fold != held)), start, ridge)
            ways[:, away] = flown(pieces.only(away), found)
        scores = r_squared(pieces.v[1:], ways[1:])
        if best is None or scores.mean() > best[1] + 1e-4:
            best = (ridge, float(scores.mean()), scores)
    assert best is not None
    return best[0], best[2]


def _confidence(pieces: Windows, parameters: Numbers, ridge: float) -> tuple[Numbers, Numbers]:
    """Return the 95 % interval of each parameter: windows drawn anew, one Gauss-Newton step each."""
    normal = normal_of(pieces, parameters)
    count = len(normal.left)
    random = np.random.default_rng(0)
    drawn: list[Numbers] = []
    for _ in range(_RESAMPLES):
        weights = np.bincount(random.integers(count, size=count), minlength=count)
        squares = np.tensordot(weights, normal.squares, 1)
        step = solved(squares, weights @ normal.slopes, ridge, parameters)
        drawn.append(np.where(POSITIVE, np.maximum(parameters + step, LEAST), parameters + step))
    low, high = np.percentile(np.array(drawn), _LEVEL, axis=0)
    return low, high


def _condition(pieces: Windows, parameters: Numbers) -> float:
    """Return the condition number of χ's normal equations, columns brought to the same length."""
    squares = normal_of(pieces, parameters).squares.sum(axis=0)[:CHI, :CHI]
    lengths = np.sqrt(np.maximum(np.diag(squares), 1e-30))
    return float(np.linalg.cond(squares / np.outer(lengths, lengths)))
