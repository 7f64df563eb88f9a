"""Many vehicles of one airframe, stepped together: the models' own equations on rows of NumPy, or compiled.

Vehicles do not see each other, and nothing of a world is here: no floor, no obstacles, no autopilot. What steers them
and what they hit is up to the caller, who may put them elsewhere with `Batch.place`.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from sim.airframe import Airframe, Model
from sim.many.lanes import Flat, Law, law
from sim.many.rows import Array, Orders, Rows, on_rows

Backend = Literal["auto", "numpy", "numba"]


class Stepper(Protocol):
    """A way to step lanes, which lie in blocks: arrays (blocks, rows, `lanes`), a row per number of a lane.

    Attributes:
        lanes: Of a block; 0 for as many as there are vehicles.
    """

    lanes: int

    def step(self, state: Array, orders: Orders, constants: Flat, steps: int, /) -> None:
        """Advance `state` in place.

        Args:
            state: (blocks, width, lanes).
            orders: What the vehicles are told.
            constants: The law's, for the step's length.
            steps: How many.
        """
        ...


class Batch:
    """N vehicles, at first at rest at the origin; each is stepped as `sim.models.motion.Motion` steps one.

    Args:
        airframe: What they are.
        model: How they move.
        n: How many.
        backend: "numpy"; "numba", which the extra `fast` installs; or "auto", the latter where it is installed.

    Raises:
        ScenarioError: The airframe lacks the model's numbers.
        ModuleNotFoundError: numba was asked for and is not installed.
    """

    def __init__(self, airframe: Airframe, model: Model, n: int, backend: Backend = "auto") -> None:
        if n < 1:
            raise ValueError(f"a batch of {n} vehicles is none; give 1 or more.")
        self.airframe, self.model, self.n = airframe, model, n
        self._law = law(airframe, model)
        self._rows = on_rows(self._law)
        self.backend, self._stepper = _stepper(self._law, backend)
        lanes = self._stepper.lanes or n
        blocks = -(-n // lanes)
        self._orders = Orders(
            np.zeros((blocks, 4, lanes)),
            np.zeros((blocks, 3, lanes)),
            np.ones((blocks, lanes), dtype=np.bool_),
        )
        self._dt: float = 0.0
        self._constants: Flat = ()
        self._state = np.empty((blocks, self._law.width, lanes))
        # Places past the last vehicle are filled too, and fly along.
        self._state[:] = np.array(self._law.resting((0.0, 0.0, 0.0, 0.0)))[:, np.newaxis]
        self._seen: tuple[Array, Array] | None = None

    @property
    def p(self) -> Array:
        """`[x, y, z, yaw]` of each, world, m and rad, shape (n, 4). Writing into it moves nothing: see `place`."""
        return self._look()[0]

    @property
    def v(self) -> Array:
        """`[forward, left, up, yaw_rate]` of each, m/s and rad/s, shape (n, 4); likewise."""
        return self._look()[1]

    @property
    def lanes(self) -> Array:
        """A copy of all that the vehicles are, shape (n, width); for `rigid_body` see `sim.models.rigid.dynamics`."""
        return self._state.swapaxes(1, 2).reshape(-1, self._law.width)[: self.n].copy()

    def step(
        self,
        v_ref: ArrayLike,
        wind: ArrayLike = 0.0,
        dt: float = 0.004,
        steps: int = 1,
        *,
        stopped: ArrayLike = False,
    ) -> None:
        """Advance by `steps` times `dt` seconds.

        Args:
            v_ref: `[forward, left, up, yaw_rate]` asked for, m/s and rad/s, shape (n, 4), or (4,) for all alike.
            wind: The air's velocity, world, m/s, shape (n, 3), or (3,).
            dt: The step, s.
            steps: How many, with the same references and wind.
            stopped: Whose motors are stopped: those fall. Shape (n,).
        """
        if dt != self._dt:
            self._dt, self._constants = dt, self._law.constants(self.airframe, dt)
        orders = self._orders
        _fill(orders.v_ref, v_ref, self.n)
        _fill(orders.wind, wind, self.n)
        orders.flying.reshape(-1)[: self.n] = ~np.asarray(stopped, dtype=np.bool_)
        self._stepper.step(self._state, orders, self._constants, steps)
        self._seen = None

    def hover(self, p: ArrayLike) -> None:
        """Let all hover in still air at p, shape (n, 4) or (4,)."""
        at = _shaped(p, self.n, 4)
        self._put(np.array([self._law.hover((x, y, z, yaw), self.airframe) for x, y, z, yaw in at.tolist()]))

    def rest(self, which: ArrayLike = True) -> None:
        """Let those of `which`, shape (n,), stand level where they are, motors idle."""
        standing = np.broadcast_to(np.asarray(which, dtype=np.bool_), self.n)
        lanes = self.lanes
        for column, numbers in zip(lanes.T, self._rows.resting(tuple(self.p[standing].T)), strict=True):
            column[standing] = numbers
        self._put(lanes)

    def place(self, p: ArrayLike, v: ArrayLike) -> None:
        """Put the vehicles elsewhere, as an obstacle does: where p or v, shape (n, 4), are not what they were.

        A rigid body keeps what p and v leave out: tilt, the rest of its body rates, and its rotors' speeds.
        """
        p, v = _shaped(p, self.n, 4), _shaped(v, self.n, 4)
        before_p, before_v = self._look()
        moved = (v != before_v).any(axis=1) | (p[:, 3] != before_p[:, 3])
        lanes = self.lanes
        lanes[:, :3] = p[:, :3]
        placed = self._rows.placed(
            *(tuple(each[moved].T) for each in (lanes, before_p, before_v, p, v)),
        )
        for column, numbers in zip(lanes.T, placed, strict=True):
            column[moved] = numbers
        self._put(lanes)

    def _look(self) -> tuple[Array, Array]:
        if self._seen is None:
            p, v = self._rows.seen(tuple(self.lanes.T))
            self._seen = np.stack(p).T, np.stack(v).T
        return self._seen

    def _put(self, lanes: Array) -> None:
        _fill(self._state, lanes, self.n)
        self._seen = None


def _fill(blocks: Array, values: ArrayLike, n: int) -> None:
    """Write the numbers of n vehicles, shape (n, k) or (k,), into blocks (blocks, k, lanes)."""
    _count, k, lanes = blocks.shape
    each = _shaped(values, n, k)
    full = n // lanes
    by_vehicle = blocks.swapaxes(1, 2)
    by_vehicle[:full] = each[: full * lanes].reshape(full, lanes, k)
    by_vehicle[full:, : n - full * lanes] = each[full * lanes :]


def _shaped(values: ArrayLike, n: int, k: int) -> Array:
    """Return values as (n, k); one row serves all."""
    return np.broadcast_to(np.asarray(values, dtype=np.float64), (n, k))


def _stepper(law: Law, backend: Backend) -> tuple[Literal["numpy", "numba"], Stepper]:
    installed = find_spec("numba") is not None
    if backend == "numpy" or (backend == "auto" and not installed):
        return "numpy", Rows(law)
    if not installed:
        raise ModuleNotFoundError("numba is not installed; the extra `fast` brings it: groundstation[fast].")
    from sim.many.fast import Compiled

    return "numba", Compiled(law)
