"""The models compiled by numba, from the same source. Only imported where numba is: the extra `fast`."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace

import numba
import numpy as np
import platformdirs
from numba.core import config

from sim.airframe import Airframe, Model
from sim.kinematics import Vector4
from sim.many import kernels
from sim.many.lanes import Flat, Law, law
from sim.many.rows import Array, Orders
from sim.models.one_source import bound

_PARTS = (
    kernels.three, kernels.four, kernels.eight, kernels.seventeen, kernels.twenty,
    kernels.put_four, kernels.put_eight, kernels.put_twenty,
    kernels.kinematic_constants, kernels.dynamic_constants, kernels.rigid_constants,
)  # fmt: skip
_KERNELS = (kernels.steer, kernels.move, kernels.rigid_blocks, kernels.light_blocks, kernels.single)


class Compiled:
    """Steps lanes in blocks; see `sim.many.batch.Stepper`.

    Args:
        law: The model.
    """

    lanes = kernels.LANES

    def __init__(self, law: Law) -> None:
        self._blocks: Callable[[Array, Orders, Array, int], None] = _compiled(law).blocks

    def step(self, state: Array, orders: Orders, constants: Flat, steps: int, /) -> None:
        """Advance `state` in place."""
        self._blocks(state, orders, np.array(constants), steps)


class Single:
    """One vehicle, at first at rest at the origin: the least between a caller and its steps.

    Args:
        airframe: What it is.
        model: How it moves.
        dt: The step, s.

    Attributes:
        v_ref: `[forward, left, up, yaw_rate]` asked for, m/s and rad/s; write into it.
        wind: The air's velocity, world, m/s; likewise.

    Raises:
        ScenarioError: The airframe lacks the model's numbers.
    """

    def __init__(self, airframe: Airframe, model: Model, dt: float = 0.004) -> None:
        self._airframe, self._law = airframe, law(airframe, model)
        self._width = width = self._law.width
        constants = self._law.constants(airframe, dt)
        self._data = np.array([*self._law.resting((0.0, 0.0, 0.0, 0.0)), *(0.0,) * 7, 1.0, *constants])
        self._lane, self.v_ref, self.wind, self._flying = np.split(
            self._data, (width, width + 4, width + 7, width + 8)
        )[:4]
        self._kernel: Callable[[Array, int, int], None] = _compiled(self._law).single

    @property
    def p(self) -> Vector4:
        """`[x, y, z, yaw]`, world, m and rad."""
        return self._law.seen(self.lane)[0]

    @property
    def v(self) -> Vector4:
        """`[forward, left, up, yaw_rate]`, m/s and rad/s."""
        return self._law.seen(self.lane)[1]

    @property
    def lane(self) -> Flat:
        """All that the vehicle is; see `sim.many.lanes`."""
        return tuple(self._lane.tolist())

    def hover(self, p: Vector4) -> None:
        """Hover at p in still air."""
        self._lane[:] = self._law.hover(p, self._airframe)

    def stop(self, *, stopped: bool = True) -> None:
        """Stop the motors, or start them again."""
        self._flying[0] = not stopped

    def step(self, steps: int = 1) -> None:
        """Advance by so many steps."""
        self._kernel(self._data, self._width, steps)


@lru_cache
def _compiled(law: Law) -> SimpleNamespace:
    """Return a law's kernels `blocks` and `single`. They are compiled when first called, or come from the cache.

    Floats are as strict as Python's, so that all ways to compute agree and NaN is seen; only a division by 0 raises
    nothing.
    """
    inlined = bound(
        (*law.functions, *_PARTS), numba.njit(error_model="numpy", fastmath=False, forceinline=True)
    )
    parts = vars(inlined)
    own = {
        "flown": parts[law.flown.__name__],
        "fallen": parts[law.fallen.__name__],
        "take": parts["twenty" if law.width == 20 else "eight"],
        "put": parts["put_twenty" if law.width == 20 else "put_eight"],
        "constants_of": parts[f"{law.name}_constants"],
    }
    names = {name: part for name, part in parts.items() if name != "wrap"} | own
    with _cache_folder(law) as writable:
        made = bound(_KERNELS, numba.njit(error_model="numpy", fastmath=False, cache=writable), **names)
    return SimpleNamespace(
        blocks=made.rigid_blocks if law.name == "rigid" else made.light_blocks, single=made.single
    )


@contextmanager
def _cache_folder(law: Law) -> Generator[bool]:
    """Let numba keep what is compiled here in a folder of its own; yield whether it can.

    Numba knows a kernel's file, not those of what it calls: so the folder is named by what all of them say.
    """
    room = Path(__file__).resolve().parents[1]
    sources = sorted([room / "kinematics.py", *room.glob("many/*.py"), *room.glob("models/**/*.py")])
    digest = hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:16]
    settings = config.__dict__
    before = settings["CACHE_DIR"]
    folder = Path(before or platformdirs.user_cache_dir("groundstation", appauthor=False))
    folder = folder / f"numba-{digest}" / law.name
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        yield False
        return
    if not os.access(folder, os.W_OK):
        yield False
        return
    settings["CACHE_DIR"] = str(folder)
    try:
        yield True
    finally:
        settings["CACHE_DIR"] = before
