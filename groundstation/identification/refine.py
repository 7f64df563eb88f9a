"""The final estimate of χ: the parameters whose free flight is nearest to the vehicle's (output error).

A regression on the equation is drawn to zero by noise in what it regresses on; a free flight is not. Windows of some
seconds are flown side by side, and the steps are Gauss and Newton's with Levenberg and Marquardt's damping.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from groundstation.identification.regress import LEAST, POSITIVE, PRIOR
from groundstation.identification.response import PARAMETERS, Windows, flown
from groundstation.identification.samples import Numbers

ROUNDS = 30
_NUDGE = 1e-4
# What no vehicle's parameters go beyond; within it a free flight of seconds stays finite.
_MOST = 10.0
_LOWEST = np.where(POSITIVE, LEAST, -_MOST)
# A step that changes no parameter by more than this share ends the search.
_SETTLED = 1e-6


class Normal(NamedTuple):
    """What each window says of the parameters around an estimate: JᵀJ (w, k, k), Jᵀr (w, k), and its rᵀr (w,)."""

    squares: Numbers
    slopes: Numbers
    left: Numbers


def refined(pieces: Windows, start: Numbers, ridge: float, rounds: int = ROUNDS) -> Numbers:
    """Return the parameters, (13,), that fly the windows best, from a first estimate on.

    Args:
        pieces: The windows.
        start: (13,), as in `PARAMETERS`.
        ridge: Weight of the prior, a share of the data's own.
        rounds: Most steps.
    """
    now, damping = start.copy(), 1e-3
    scale = _scale(pieces)
    normal = normal_of(pieces, now, scale)
    for _ in range(rounds):
        step = _step(normal, now, ridge, damping)
        after = np.clip(now + step, _LOWEST, _MOST)
        better = normal_of(pieces, after, scale)
        if _cost(better, after, ridge) < _cost(normal, now, ridge):
            moved = np.max(np.abs(after - now) / (np.abs(now) + LEAST))
            now, normal, damping = after, better, damping / 5.0
            if moved < _SETTLED:
                break
        elif (damping := damping * 8.0) > 1e6:
            break
    return now


def normal_of(pieces: Windows, parameters: Numbers, scale: Numbers | None = None) -> Normal:
    """Return the windows' normal equations at an estimate; the axes weigh by their own spread.

    Each window's first velocity is measured with noise, so it is fitted too, and taken out of the equations.
    """
    scale = _scale(pieces) if scale is None else scale
    k = len(PARAMETERS)
    nudges = _NUDGE * np.maximum(np.abs(parameters), 0.1)
    ways = _ways(pieces, parameters, nudges) / scale
    w = pieces.v.shape[1]
    way, nudged, started = ways[:, 0], ways[:, 1 : 1 + k], ways[:, 1 + k :]
    residual = (pieces.v / scale - way).transpose(1, 0, 2).reshape(w, -1)
    jacobian = ((nudged - way[:, None]) / nudges[:, None, None]).transpose(2, 0, 3, 1).reshape(w, -1, k)
    starts = ((started - way[:, None]) / _NUDGE).transpose(2, 0, 3, 1).reshape(w, -1, 4)
    # Each window's own four first velocities are projected out: what they explain says nothing of χ.
    basis = np.linalg.qr(starts)[0]
    jacobian = jacobian - basis @ (basis.transpose(0, 2, 1) @ jacobian)
    residual = residual - (basis @ (basis.transpose(0, 2, 1) @ residual[..., None]))[..., 0]
    turned = jacobian.transpose(0, 2, 1)
    return Normal(turned @ jacobian, (turned @ residual[..., None])[..., 0], np.square(residual).sum(axis=1))


def _ways(pieces: Windows, parameters: Numbers, nudges: Numbers) -> Numbers:
    """Return free ways, (n, 1 + k + 4, w, 4): as estimated, by each nudged parameter, from each nudged start."""
    k = len(parameters)
    tried = np.vstack((parameters, parameters + np.diag(nudges), np.tile(parameters, (4, 1))))
    first = np.broadcast_to(pieces.v[0], (1 + k + 4, *pieces.v[0].shape)).copy()
    for axis in range(4):
        first[1 + k + axis, :, axis] += _NUDGE
    return flown(pieces, tried, first)


def solved(squares: Numbers, slopes: Numbers, ridge: float, now: Numbers) -> Numbers:
    """Return the step from an estimate that summed normal equations ask for, drawn to the prior."""
    weight = ridge * _weights(squares)
    step = np.linalg.lstsq(squares + np.diag(weight), slopes + weight * (PRIOR - now), rcond=None)[0]
    return np.asarray(step, np.float64)


def _step(normal: Normal, now: Numbers, ridge: float, damping: float) -> Numbers:
    squares, slopes = normal.squares.sum(axis=0), normal.slopes.sum(axis=0)
    return solved(squares + damping * np.diag(np.diag(squares) + 1e-9), slopes, ridge, now)


def _cost(normal: Normal, now: Numbers, ridge: float) -> float:
    weight = ridge * _weights(normal.squares.sum(axis=0))
    return float(normal.left.sum() + (weight * np.square(now - PRIOR)).sum())


def _weights(squares: Numbers) -> Numbers:
    return np.full(len(squares), np.trace(squares) / len(squares))


def _scale(pieces: Windows) -> Numbers:
    return np.maximum(pieces.v.reshape(-1, 4).std(axis=0), 1e-3)
