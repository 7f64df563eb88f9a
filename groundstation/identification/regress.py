"""The first estimate of χ: regularised least squares on the smoothed model equation, within physical bounds.

v_ref = M v̇ + C(ω) v − M·push is linear in its parameters, axis by axis. Instead of differentiating noisy
velocities, both sides are smoothed by the same Gaussian and integrated over two steps, for the integral of v̇ is
a difference of velocities.
"""

from __future__ import annotations

import numpy as np

from groundstation.identification.bounded import bounded
from groundstation.identification.response import (
    CHI,
    DELAY_OF_AXIS,
    DELAYS,
    NAMES,
    Windows,
    acted,
)
from groundstation.identification.samples import Numbers

# Width of the Gaussian, s: a response of 0.3 s and more passes, sensors' noise does not.
_SMOOTHING_S = 0.06
# Of the search for the delays, s.
_DELAY_STEP_S = 0.02
# No inertia (s) and no damping is less than this.
LEAST = 0.05
# Prior of a multirotor of which nothing is known: it follows with half a second's lag, and its axes are apart.
_PRIOR_INERTIA, _PRIOR_DAMPING = 0.5, 1.0
_PLACE = {name: place for place, name in enumerate(NAMES)}
# Of each axis: inertia, damping, and what the other axis does while turning.
_TERMS = (
    ("chi_1", "chi_10", "chi_11"),
    ("chi_3", "chi_14", "chi_13"),
    ("chi_5", "chi_16"),
    ("chi_9", "chi_19"),
)
POSITIVE = np.array([any(name in terms[:2] for terms in _TERMS) for name in NAMES])
PRIOR = np.zeros(CHI)
for _inertia, _damping, *_ in _TERMS:
    PRIOR[_PLACE[_inertia]], PRIOR[_PLACE[_damping]] = _PRIOR_INERTIA, _PRIOR_DAMPING


def regressed(pieces: Windows, delays: Numbers, ridge: float) -> Numbers:
    """Return χ, (10,), that fits the model equation best.

    Args:
        pieces: The flights.
        delays: (3,), of `DELAYS`, s.
        ridge: Weight of the prior, a share of the data's own.
    """
    chi = np.zeros(CHI)
    for axis, terms in enumerate(_TERMS):
        solution, _ = _axis(pieces, axis, delays, ridge)
        for name, value in zip(terms, solution, strict=False):
            chi[_PLACE[name]] = value
    return chi


def guessed_delays(pieces: Windows, ridge: float) -> Numbers:
    """Return the delays with which the model equation fits best, (3,), s, as finely as the search's step."""
    tried = np.arange(0.0, pieces.longest + 1e-9, _DELAY_STEP_S)
    left = np.array(
        [[_axis(pieces, axis, np.full(3, delay), ridge)[1] for axis in range(4)] for delay in tried]
    )
    # Axes that share a delay weigh by how well they are told at all.
    left = left / left.min(axis=0)
    sums = [left[:, number == DELAY_OF_AXIS].sum(axis=1) for number in range(len(DELAYS))]
    return np.array([tried[int(np.argmin(each))] for each in sums])


def _axis(pieces: Windows, axis: int, delays: Numbers, ridge: float) -> tuple[Numbers, float]:
    """Return an axis's terms, and what the equation leaves, as a mean square."""
    matrix, wanted = _equation(pieces, axis, delays)
    # The last column is a steady push; without it wind would count as damping.
    matrix = np.column_stack((matrix, np.ones(len(matrix))))
    names = _TERMS[axis]
    squares, slopes = matrix.T @ matrix, matrix.T @ wanted
    weight = np.zeros(len(squares))
    weight[:-1] = ridge * np.trace(squares) / len(squares)
    prior = np.append([PRIOR[_PLACE[name]] for name in names], 0.0)
    low = np.append([LEAST if POSITIVE[_PLACE[name]] else -np.inf for name in names], -np.inf)
    x = bounded(squares + np.diag(weight), slopes + weight * prior, low)
    return x[:-1], float(np.square(matrix @ x - wanted).mean())


def _equation(pieces: Windows, axis: int, delays: Numbers) -> tuple[Numbers, Numbers]:
    """Return matrix and right side of one axis's smoothed, integrated equation."""
    kernel = _gaussian(pieces.dt)
    # What was told is brought back to when it happened; the lead holds the references of then.
    v = acted(pieces.v, pieces.yaw, delays, pieces.dt)[: -pieces.lead]
    asked = pieces.ref[: -pieces.lead, :, axis]
    smooth, wanted = _smoothed(v[..., axis], kernel), _mean(_smoothed(asked, kernel))
    columns = [(smooth[2:] - smooth[:-2]) / (2.0 * pieces.dt), _mean(smooth)]
    if len(_TERMS[axis]) > len(columns):
        columns.append(_mean(_smoothed(v[..., 3] * v[..., 1 - axis], kernel)))
    return np.column_stack([column.ravel() for column in columns]), wanted.ravel()


def _mean(x: Numbers) -> Numbers:
    """Return the mean over two steps, (n − 2, ...), by Simpson's rule."""
    return (x[:-2] + 4.0 * x[1:-1] + x[2:]) / 6.0


def _gaussian(dt: float) -> Numbers:
    reach = max(1, round(3.0 * _SMOOTHING_S / dt))
    weights = np.exp(-0.5 * np.square(np.arange(-reach, reach + 1) * dt / _SMOOTHING_S))
    return weights / weights.sum()


def _smoothed(x: Numbers, kernel: Numbers) -> Numbers:
    """Return the rows smoothed, without the ends that the kernel does not reach."""
    left = len(x) - len(kernel) + 1
    return np.asarray(sum(weight * x[k : k + left] for k, weight in enumerate(kernel)), np.float64)
