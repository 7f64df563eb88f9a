"""The final estimate: the parameters whose free flight is nearest to the vehicle's (output error).

A regression on the equation is drawn to zero by noise in what it regresses on; a free flight is not. Windows of some
seconds are flown side by side, and the steps are Gauss and Newton's with Levenberg and Marquardt's damping, each
within the physical bounds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from groundstation.identification.bounded import bounded
from groundstation.identification.regress import LEAST, POSITIVE, PRIOR
from groundstation.identification.response import (
    CHI,
    DELAYS,
    Windows,
    acted,
    flown,
    told,
)
from groundstation.identification.samples import Numbers

_ROUNDS = 30
# Of differences that stand for derivatives: a share of a parameter, and of delays, s.
_NUDGE, _DELAY_NUDGE_S = 1e-4, 1e-5
# A step that betters the cost by less than this share of it ends the search.
_SETTLED = 1e-6
_MOST_DAMPING = 1e6


class Parameters(NamedTuple):
    """What is estimated.

    Attributes:
        chi: (10,), in the order of `sim.models.dynamic.Chi`.
        delays: (3,), of level flight, up, yaw, s.
        push: (f, 3), steady acceleration of each flight, world, m/s².
    """

    chi: Numbers
    delays: Numbers
    push: Numbers

    def flat(self) -> Numbers:
        """Return all in one row."""
        return np.concatenate((self.chi, self.delays, self.push.ravel()))


def unflat(row: Numbers) -> Parameters:
    """Return a row's parameters."""
    delays = CHI + len(DELAYS)
    return Parameters(row[:CHI], row[CHI:delays], row[delays:].reshape(-1, 3))


class Normal(NamedTuple):
    """What each window says of the parameters around an estimate.

    Attributes:
        squares: (w, k, k), JᵀJ.
        slopes: (w, k), Jᵀr.
        left: (w,), rᵀr.
        starts: (w, 4), first velocities that leave this least.
    """

    squares: Numbers
    slopes: Numbers
    left: Numbers
    starts: Numbers


def refined(pieces: Windows, start: Parameters, ridge: float) -> Parameters:
    """Return the parameters that fly the windows best, from a first estimate on.

    Args:
        pieces: The windows.
        start: The estimate.
        ridge: Weight of the prior, a share of the data's own.
    """
    now, damping = start.flat(), 1e-4
    scale = spread(pieces)
    normal = normal_of(pieces, now, scale)
    for _ in range(_ROUNDS):
        after = stepped(normal.squares.sum(axis=0), normal.slopes.sum(axis=0), now, ridge, damping)
        after[CHI : CHI + len(DELAYS)] = np.minimum(after[CHI : CHI + len(DELAYS)], pieces.longest)
        better = normal_of(pieces, after, scale, normal.starts)
        gain = _cost(normal, now, ridge) - _cost(better, after, ridge)
        if gain >= 0.0:
            settled = gain < _SETTLED * _cost(normal, now, ridge)
            now, normal, damping = after, better, damping / 10.0
            if settled:
                break
        elif (damping := damping * 10.0) > _MOST_DAMPING:
            break
    return unflat(now)


def spread(pieces: Windows) -> Numbers:
    """Return by what the axes' velocities are divided so that they weigh alike, (4,)."""
    return np.maximum(pieces.v.reshape(-1, 4).std(axis=0), 1e-3)


def stepped(squares: Numbers, slopes: Numbers, now: Numbers, ridge: float, damping: float = 0.0) -> Numbers:
    """Return where summed normal equations lead from an estimate, drawn to the prior and within the bounds."""
    weight, prior = _prior(squares, ridge)
    whole = squares + np.diag(weight + damping * (np.diag(squares) + 1e-9))
    return now + bounded(whole, slopes + weight * (prior - now), _lowest(len(now)) - now)


def normal_of(pieces: Windows, row: Numbers, scale: Numbers, starts: Numbers | None = None) -> Normal:
    """Return the windows' normal equations at an estimate.

    Each window's first velocity is measured with noise, so it is fitted too, and taken out of the equations.

    Args:
        pieces: The windows.
        row: The estimate, flat.
        scale: (4,), as of `spread`.
        starts: (w, 4), first velocities; those measured where None.
    """
    now = unflat(row)
    starts = starts_of(pieces, now.delays) if starts is None else starts
    way, changes = _ways(pieces, now, starts)
    w = pieces.number
    residual = ((pieces.v[pieces.lead :] - way) / scale).transpose(1, 0, 2).reshape(w, -1)
    columns = (np.stack(changes) / scale).transpose(2, 1, 3, 0).reshape(w, residual.shape[1], -1)
    jacobian, by_start = columns[..., :-4], columns[..., -4:]
    # Each window's own four first velocities are projected out: what they explain says nothing of the rest.
    basis, triangle = np.linalg.qr(by_start)
    across = basis.transpose(0, 2, 1)
    own = (across @ residual[..., None])[..., 0]
    jacobian = jacobian - basis @ (across @ jacobian)
    residual = residual - (basis @ own[..., None])[..., 0]
    turned = jacobian.transpose(0, 2, 1)
    squares, slopes = turned @ jacobian, (turned @ residual[..., None])[..., 0]
    squares, slopes = _by_flight(squares, slopes, pieces.flight, len(now.push))
    starts = starts + np.linalg.solve(triangle, own[..., None])[..., 0]
    return Normal(squares, slopes, np.square(residual).sum(axis=1), starts)


def normal_at(pieces: Windows, now: Parameters) -> Normal:
    """Return the windows' normal equations at an estimate, around the first velocities that suit it best."""
    scale = spread(pieces)
    return normal_of(pieces, now.flat(), scale, normal_of(pieces, now.flat(), scale).starts)


def starts_of(pieces: Windows, delays: Numbers) -> Numbers:
    """Return each window's first velocities, (w, 4), as they are told a delay later."""
    first = slice(0, pieces.lead + 2)
    return acted(pieces.v[first], pieces.yaw[first], delays, pieces.dt)[0]


def _ways(pieces: Windows, now: Parameters, start: Numbers) -> tuple[Numbers, list[Numbers]]:
    """Return the free way, (n, w, 4), and how it changes with χ, the delays, the push, and the start."""
    push = now.push[pieces.flight]
    nudges = _NUDGE * np.maximum(np.abs(now.chi), 0.1)
    many = 1 + CHI + 3 + 4
    chis, pushes = np.tile(now.chi, (many, 1)), np.tile(push, (many, 1, 1))
    starts = np.tile(start, (many, 1, 1))
    chis[1 : 1 + CHI] += np.diag(nudges)
    for part in range(3):
        pushes[1 + CHI + part, :, part] += _NUDGE
    for axis in range(4):
        starts[1 + CHI + 3 + axis, :, axis] += _NUDGE
    flight = flown(pieces.asked(now.delays), starts, chis, pushes)
    late = told(flight, pieces.yaw, now.delays, pieces.dt)[pieces.lead :]
    way = late[:, 0]
    sizes = [*nudges, *(_NUDGE,) * 7]
    changes = [(late[:, 1 + k] - way) / sizes[k] for k in range(many - 1)]
    if not pieces.longest:
        return way, [*changes[:CHI], *(np.zeros_like(way) for _ in DELAYS), *changes[CHI:]]
    delays: list[Numbers] = []
    for nudge in _DELAY_NUDGE_S * np.eye(len(DELAYS)):
        nudged = told(flight[:, 0], pieces.yaw, now.delays + nudge, pieces.dt)[pieces.lead :]
        delays.append((nudged - way) / _DELAY_NUDGE_S)
    return way, [*changes[:CHI], *delays, *changes[CHI:]]


def _by_flight(
    squares: Numbers, slopes: Numbers, flight: npt.NDArray[np.intp], flights: int
) -> tuple[Numbers, Numbers]:
    """Give each window's three push columns to the flight it is from."""
    own = CHI + len(DELAYS)
    k = own + 3 * flights
    all_squares, all_slopes = np.zeros((len(squares), k, k)), np.zeros((len(squares), k))
    for number in range(flights):
        mine = np.flatnonzero(flight == number)
        places = np.concatenate((np.arange(own), own + 3 * number + np.arange(3)))
        all_squares[np.ix_(mine, places, places)] = squares[mine]
        all_slopes[np.ix_(mine, places)] = slopes[mine]
    return all_squares, all_slopes


def _lowest(count: int) -> Numbers:
    """Return the bound of each of so many parameters: inertia and damping are positive, no delay is negative."""
    low = np.full(count, -np.inf)
    low[:CHI][POSITIVE] = LEAST
    low[CHI : CHI + len(DELAYS)] = 0.0
    return low


def _cost(normal: Normal, now: Numbers, ridge: float) -> float:
    weight, prior = _prior(normal.squares.sum(axis=0), ridge)
    return float(normal.left.sum() + (weight * np.square(now - prior)).sum())


def _prior(squares: Numbers, ridge: float) -> tuple[Numbers, Numbers]:
    """Return the weight of the prior on each parameter, none on the delays and the pushes, and the prior."""
    weight, prior = np.zeros(len(squares)), np.zeros(len(squares))
    weight[:CHI] = ridge * np.trace(squares[:CHI, :CHI]) / CHI
    prior[:CHI] = PRIOR
    return weight, prior
