"""Identification: delays, regularisation, χ with its confidence, and what held-out parts of the flights say."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from groundstation.errors import InputError
from groundstation.identification.refine import (
    Normal,
    Parameters,
    normal_at,
    refined,
    starts_of,
    stepped,
    unflat,
)
from groundstation.identification.regress import guessed_delays, regressed
from groundstation.identification.response import (
    CHI,
    DELAYS,
    LONGEST_DELAY_S,
    Windows,
    flown,
    told,
    windows,
)
from groundstation.identification.samples import Numbers, Samples, unexcited
from groundstation.identification.validate import BLOCK_S, LEVEL, RESAMPLES, r_squared
from sim.models.dynamic import Chi

_RIDGES = (0.0, 1e-3, 1e-2, 3e-2)
# Of the first estimates, from which the search begins.
_FIRST_RIDGE = 1e-4
_FOLDS = 4
_FEWEST_WINDOWS = 4
# A weight is preferred to the one before it if it tells so much more of what was held out.
_BETTER = 1e-4

Tell = Callable[[str], None]


class Identified(NamedTuple):
    """What was found.

    Attributes:
        parameters: χ, delays, and the steady push of each flight.
        low, high: (13,), 95 % confidence of χ and the delays, by drawing the windows anew.
        ridge: The prior's weight that told held-out windows best.
        crossed: (4,), R² of windows that were held out, by axis.
        crossed_regression: (4,), the same of the regression alone.
        longest_delay: That was looked for, s; 0 if none was.
        condition: Of χ's normal equations on χ's own scale: above some 1e4 not all of χ can be told apart.
    """

    parameters: Parameters
    low: Numbers
    high: Numbers
    ridge: float
    crossed: Numbers
    crossed_regression: Numbers
    longest_delay: float
    condition: float

    @property
    def chi(self) -> Chi:
        """χ as an airframe has it."""
        return Chi(*(float(value) for value in self.parameters.chi))


def identify(
    flights: Sequence[Samples], tell: Tell = lambda _words: None, longest_delay: float = LONGEST_DELAY_S
) -> Identified:
    """Identify the response from one or more flights of a vehicle.

    Args:
        flights: With the same step.
        tell: Told what is being done.
        longest_delay: That is looked for, s; 0 takes references to act at once, all lateness is χ's then.

    Raises:
        InputError: The flights are too short, or too little was asked of an axis.
    """
    pieces = _pieces(flights, longest_delay)
    tell("estimating delays and a first χ")
    first = _first(pieces, len(flights))
    start = refined(pieces, first, _FIRST_RIDGE)
    tell("cross-validating")
    ridge = _ridge(pieces, normal_at(pieces, start), start)
    crossed = _crossed(pieces, lambda training: refined(pieces.only(training), start, ridge))
    regression = _crossed(pieces, lambda training: _first(pieces.only(training), len(flights)))
    tell("fitting")
    parameters = refined(pieces, start, ridge)
    normal = normal_at(pieces, parameters)
    low, high = _confidence(pieces, normal, parameters, ridge, tell)
    return Identified(parameters, low, high, ridge, crossed, regression, longest_delay, _condition(normal))


def _pieces(flights: Sequence[Samples], longest_delay: float) -> Windows:
    name = " + ".join(flight.name for flight in flights)
    if still := unexcited(flights):
        raise InputError(
            f"{name}: hardly anything was asked of {' and '.join(still)}; fly all four axes, "
            "'groundstation excite' does."
        )
    pieces = windows(flights, BLOCK_S, longest_delay)
    if pieces.number < _FEWEST_WINDOWS:
        raise InputError(
            f"{name}: has {pieces.number} stretches of {BLOCK_S:g} s, {_FEWEST_WINDOWS} are needed; "
            "fly longer, or give several flights."
        )
    return pieces


def _first(pieces: Windows, flights: int) -> Parameters:
    delays = guessed_delays(pieces, _FIRST_RIDGE)
    return Parameters(regressed(pieces, delays, _FIRST_RIDGE), delays, np.zeros((flights, 3)))


def _ridge(pieces: Windows, normal: Normal, now: Parameters) -> float:
    """Return the prior's weight that tells held-out windows best, a Gauss-Newton step away from the estimate."""
    row = now.flat()

    def told_with(ridge: float) -> float:
        def fitted(training: npt.NDArray[np.intp]) -> Parameters:
            squares, slopes = normal.squares[training].sum(axis=0), normal.slopes[training].sum(axis=0)
            return unflat(stepped(squares, slopes, row, ridge))

        return float(np.nanmean(_crossed(pieces, fitted)))

    best, most = _RIDGES[0], -np.inf
    for ridge in _RIDGES:
        if (score := told_with(ridge)) > most + _BETTER:
            best, most = ridge, score
    return best


def _crossed(pieces: Windows, fitted: Callable[[npt.NDArray[np.intp]], Parameters]) -> Numbers:
    """Return R² by axis of windows told by what was fitted to the others; folds are blocks of time."""
    count = pieces.number
    fold = np.arange(count) * min(_FOLDS, count) // count
    ways = np.empty_like(pieces.v[pieces.lead :])
    for held_out in range(int(fold.max()) + 1):
        away = np.flatnonzero(fold == held_out)
        ways[:, away] = _told(pieces.only(away), fitted(np.flatnonzero(fold != held_out)))
    return r_squared(pieces.v[pieces.lead :], ways)


def _told(pieces: Windows, found: Parameters) -> Numbers:
    """Return the free ways through windows, (n, w, 4), each from its own first velocity."""
    start, push = starts_of(pieces, found.delays), found.push[pieces.flight]
    way = flown(pieces.asked(found.delays), start, found.chi, push)
    return told(way, pieces.yaw, found.delays, pieces.dt)[pieces.lead :]


def _confidence(
    pieces: Windows, normal: Normal, found: Parameters, ridge: float, tell: Tell
) -> tuple[Numbers, Numbers]:
    """Return the 95 % interval of χ and the delays: windows drawn anew, one Gauss-Newton step each."""
    count, now = pieces.number, found.flat()
    random = np.random.default_rng(0)
    drawn = np.empty((RESAMPLES, CHI + len(DELAYS)))
    # Each flight's windows are drawn among themselves: none is left without one, its push would be unknown.
    own = [np.flatnonzero(pieces.flight == number) for number in range(len(found.push))]
    for k in range(RESAMPLES):
        if k % 100 == 0:
            tell(f"drawing the windows anew, {k} of {RESAMPLES}")
        picked = np.concatenate([random.choice(mine, len(mine)) for mine in own])
        weights = np.bincount(picked, minlength=count)
        squares = np.tensordot(weights, normal.squares, 1)
        drawn[k] = stepped(squares, weights @ normal.slopes, now, ridge)[: drawn.shape[1]]
    lowest_drawn, highest_drawn = np.percentile(drawn, LEVEL, axis=0)
    return lowest_drawn, highest_drawn


def _condition(normal: Normal) -> float:
    """Return the condition number of χ's normal equations once delays and pushes are fitted, on χ's own scale."""
    squares = normal.squares.sum(axis=0)
    across = squares[:CHI, CHI:]
    own = squares[:CHI, :CHI] - across @ np.linalg.pinv(squares[CHI:, CHI:]) @ across.T
    lengths = np.sqrt(np.maximum(np.diag(own), 1e-30))
    return float(np.linalg.cond(own / np.outer(lengths, lengths)))
