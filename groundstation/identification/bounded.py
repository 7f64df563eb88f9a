"""Least squares within lower bounds, solved exactly by an active set.

Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23, on normal equations: in a regression and in
each step of a refinement it is that inertia and damping of a vehicle are positive.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from groundstation.identification.samples import Numbers

# Of the slope's own size: what is less is a slope of zero.
_FLAT = 1e-10


def bounded(squares: Numbers, slopes: Numbers, low: Numbers) -> Numbers:
    """Return x that minimises ½ xᵀ H x − gᵀ x with x ≥ low.

    At the solution the slope Hx − g is zero where x lies above its bound, and points into it where x lies on it:
    the conditions of Karush, Kuhn and Tucker.

    Args:
        squares: H, (k, k), symmetric, not indefinite.
        slopes: g, (k,).
        low: (k,); −∞ where there is no bound.
    """
    free = np.isneginf(low)
    x = np.where(free, 0.0, low)
    x = _solved(squares, slopes, x, free)
    flat = _FLAT * (1.0 + np.abs(slopes).max())
    # Each set of free parts is visited once at most: the cost falls from one to the next.
    for _ in range(3 * len(low)):
        downhill = np.where(free, -np.inf, slopes - squares @ x)
        if downhill.max() <= flat:
            break
        free[int(np.argmax(downhill))] = True
        x = _descended(squares, slopes, x, free, low)
    return x


def _descended(
    squares: Numbers,
    slopes: Numbers,
    x: Numbers,
    free: npt.NDArray[np.bool_],
    low: Numbers,
) -> Numbers:
    """Return the solution on the free parts; those that hit their bound on the way are free no longer."""
    while True:
        goal = _solved(squares, slopes, x, free)
        beyond = free & (goal < low)
        if not beyond.any():
            return goal
        shares = np.full(len(x), np.inf)
        shares[beyond] = (x - low)[beyond] / (x - goal)[beyond]
        x = x + shares.min() * (goal - x)
        hit = beyond & (shares <= shares.min())
        x[hit] = low[hit]
        free &= ~hit


def _solved(squares: Numbers, slopes: Numbers, x: Numbers, free: npt.NDArray[np.bool_]) -> Numbers:
    """Return x with its free parts at their least, the others as they are."""
    if not free.any():
        return x
    solved, fixed = x.copy(), ~free
    right = slopes[free] - squares[np.ix_(free, fixed)] @ x[fixed]
    solved[free] = np.linalg.lstsq(squares[np.ix_(free, free)], right, rcond=None)[0]
    return solved
