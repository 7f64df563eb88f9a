"""The first estimate of χ: regularised least squares on the smoothed model equation, within physical bounds.

v_ref = M v̇ + C(ω) v − M·push is linear in its parameters, axis by axis. Instead of differentiating noisy
velocities, both sides are smoothed by the same Gaussian and integrated over two steps, for the integral of v̇ is
a difference of velocities.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from groundstation.identification.response import PARAMETERS, delayed
from groundstation.identification.samples import Numbers, Samples

# Width of the Gaussian, s: a response of 0.3 s and more passes, sensors' noise does not.
_SMOOTHING_S = 0.06
# No inertia (s) and no damping is less than this.
LEAST = 0.05
# Prior of a multirotor of which nothing is known: it follows with half a second's lag, and its axes are apart.
_PRIOR_INERTIA, _PRIOR_DAMPING = 0.5, 1.0
_PLACE = {name: place for place, name in enumerate(PARAMETERS)}
# Of each axis: inertia, damping, what the other axis does while turning, push; None where the model has none.
_TERMS = (
    ("chi_1", "chi_10", "chi_11", "push_forward"),
    ("chi_3", "chi_14", "chi_13", "push_left"),
    ("chi_5", "chi_16", None, "push_up"),
    ("chi_9", "chi_19", None, None),
)
POSITIVE = np.array([name in {term for terms in _TERMS for term in terms[:2]} for name in PARAMETERS])
PRIOR = np.zeros(len(PARAMETERS))
for _inertia, _damping, *_ in _TERMS:
    PRIOR[_PLACE[_inertia]], PRIOR[_PLACE[_damping]] = _PRIOR_INERTIA, _PRIOR_DAMPING


def regressed(samples: Samples, delay_s: float, ridge: float) -> Numbers:
    """Return the parameters as in `PARAMETERS`, (13,), that fit the model equation best.

    Args:
        samples: The flight.
        delay_s: From a reference's sending to its effect, s.
        ridge: Weight of the prior, a share of the data's own.
    """
    found = np.zeros(len(PARAMETERS))
    for axis, terms in enumerate(_TERMS):
        rows = [
            _equation(v, delayed(ref, delay_s / samples.dt), samples.dt, axis, terms)
            for v, ref in samples.stretches
        ]
        matrix = np.concatenate([left for left, _ in rows])
        wanted = np.concatenate([right for _, right in rows])
        names = [name for name in terms if name]
        prior = np.array([PRIOR[_PLACE[name]] for name in names])
        positive = np.array([POSITIVE[_PLACE[name]] for name in names])
        solution = bounded(matrix, wanted, prior, ridge, positive)
        for name, value in zip(names, solution, strict=True):
            found[_PLACE[name]] = value
    # The push stands on the model's left in the regression; in the model it is an acceleration.
    for inertia, _, _, push in _TERMS:
        if push:
            found[_PLACE[push]] /= found[_PLACE[inertia]]
    return found


def _equation(
    v: Numbers, ref: Numbers, dt: float, axis: int, terms: tuple[str | None, ...]
) -> tuple[Numbers, Numbers]:
    """Return matrix and right side of one axis's smoothed, integrated equation."""
    kernel = _gaussian(dt)
    smooth = _smoothed(v, kernel)
    other = 1 - axis if axis < 2 else axis
    turned = _smoothed((v[:, 3] * v[:, other])[:, None], kernel)
    asked = _smoothed(ref, kernel)
    columns = [(smooth[2:, axis] - smooth[:-2, axis]) / (2.0 * dt), _mean(smooth[:, axis])]
    if terms[2]:
        columns.append(_mean(turned[:, 0]))
    if terms[3]:
        columns.append(-np.ones(len(smooth) - 2))
    return np.column_stack(columns), _mean(asked[:, axis])


def _mean(x: Numbers) -> Numbers:
    """Return the mean over two steps, (n − 2,), by Simpson's rule."""
    return (x[:-2] + 4.0 * x[1:-1] + x[2:]) / 6.0


def _gaussian(dt: float) -> Numbers:
    reach = max(1, round(3.0 * _SMOOTHING_S / dt))
    weights = np.exp(-0.5 * np.square(np.arange(-reach, reach + 1) * dt / _SMOOTHING_S))
    return weights / weights.sum()


def _smoothed(x: Numbers, kernel: Numbers) -> Numbers:
    """Return each column smoothed, without the ends that the kernel does not reach."""
    return np.column_stack([np.convolve(column, kernel, mode="valid") for column in x.T])


def bounded(
    matrix: Numbers, wanted: Numbers, prior: Numbers, ridge: float, positive: npt.NDArray[np.bool_]
) -> Numbers:
    """Return the least-squares solution, drawn to a prior, with some parts not below `LEAST`.

    Few parts are bounded, so every choice of those that lie on their bound is tried: the best that is feasible is
    the solution, exactly.

    Args:
        matrix: (n, k).
        wanted: (n,).
        prior: (k,).
        ridge: Weight of the prior against the matrix's columns.
        positive: (k,), which are bounded.
    """
    normal, right = matrix.T @ matrix, matrix.T @ wanted
    weight = ridge * np.trace(normal) / len(prior)
    normal, right = normal + weight * np.eye(len(prior)), right + weight * prior
    best, least = np.maximum(prior, LEAST), np.inf
    for on_bound in product((False, True), repeat=int(positive.sum())):
        fixed = np.zeros(len(prior), bool)
        fixed[np.flatnonzero(positive)] = on_bound
        x = np.where(fixed, LEAST, 0.0)
        free = ~fixed
        x[free] = np.linalg.lstsq(
            normal[np.ix_(free, free)], right[free] - normal[np.ix_(free, fixed)] @ x[fixed], rcond=None
        )[0]
        cost = x @ normal @ x - 2.0 * right @ x
        if (x[positive] >= LEAST).all() and cost < least:
            best, least = x, cost
    return best
