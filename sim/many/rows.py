"""Lanes on NumPy: every number of a lane is a row, one element per vehicle."""

from __future__ import annotations

from functools import lru_cache
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.many.lanes import Flat, Law
from sim.models.one_source import bound, clip

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Orders(NamedTuple):
    """What a batch of vehicles is told, in blocks.

    Attributes:
        v_ref: (blocks, 4, lanes).
        wind: (blocks, 3, lanes).
        flying: (blocks, lanes); False where the motors have stopped.
    """

    v_ref: Array
    wind: Array
    flying: Flags


class Rows:
    """Steps all lanes as one block; see `sim.many.batch.Stepper`.

    Args:
        law: The model.
    """

    lanes = 0

    def __init__(self, law: Law) -> None:
        self._law = on_rows(law)

    def step(self, state: Array, orders: Orders, constants: Flat, steps: int, /) -> None:
        """Advance `state` in place."""
        fallen = np.flatnonzero(~orders.flying[0])
        lane, v_ref, wind = tuple(state[0]), tuple(orders.v_ref[0]), tuple(orders.wind[0])
        # What is not a number stays so and is the caller's to see; the others fly on.
        with np.errstate(all="ignore"):
            for _ in range(steps):
                after = self._law.flown(lane, v_ref, wind, constants)
                if fallen.size:
                    after = self._mixed(lane, after, wind, constants, fallen)
                lane = after
        for row, numbers in zip(state[0], lane, strict=True):
            row[:] = numbers

    def _mixed(
        self,
        before: tuple[Array, ...],
        flown: tuple[Array, ...],
        wind: tuple[Array, ...],
        constants: Flat,
        fallen: NDArray[np.intp],
    ) -> tuple[Array, ...]:
        """Return the lanes `flown`, but those at `fallen` one step of a fall after `before`."""
        fell = self._law.fallen(
            tuple(row[fallen] for row in before), None, tuple(row[fallen] for row in wind), constants
        )
        mixed = tuple(row.copy() for row in flown)
        for row, numbers in zip(mixed, fell, strict=True):
            row[fallen] = numbers
        return mixed


@lru_cache
def on_rows(law: Law) -> SimpleNamespace:
    """Return a law's functions `flown`, `fallen`, `seen`, `resting` and `placed`, on tuples of rows."""
    made = bound(
        (function for function in law.functions if function is not clip),
        sqrt=np.sqrt, cos=np.cos, sin=np.sin, atan2=np.arctan2, max=np.maximum, clip=_clip,
    )  # fmt: skip
    names = ("flown", "fallen", "seen", "resting", "placed")
    return SimpleNamespace(**{name: getattr(made, getattr(law, name).__name__) for name in names})


def _clip(values: Array, low: Array | float, high: Array | float) -> Array:
    return np.minimum(np.maximum(values, low), high)
