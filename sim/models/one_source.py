"""One source for three ways to compute: Python floats, NumPy rows and numba.

The equations of motion are pure functions on flat tuples of scalars that use only `+ − × ÷`, `abs` and, by name,
the globals of their module: `sqrt`, `cos`, `sin`, `clip`, and each other. Called as they are they step one vehicle on
Python's floats. `bound` makes the same code look its names up elsewhere: with NumPy's functions in that place a
"scalar" is a row of many vehicles; numba compiles it with the floats' functions as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import FunctionType, SimpleNamespace


def clip(value: float, low: float, high: float) -> float:
    """Return `value` within [low, high]; NaN stays NaN."""
    if value < low:
        return low
    if value > high:
        return high
    return value


def bound(
    functions: Iterable[Callable[..., object]],
    wrap: Callable[[Callable[..., object]], Callable[..., object]] | None = None,
    **names: object,
) -> SimpleNamespace:
    """Return the functions by name, made anew on the same code with other meanings of their globals.

    Args:
        functions: From modules like `sim.models.rigid.dynamics`, callees before their callers.
        wrap: Applied to each of them, as `numba.njit`; callers then see what it returned.
        names: What `sqrt`, `clip`, `cos`, `sin` shall be; those not given stay the floats'.
    """
    made = SimpleNamespace()
    # By identity: a module may know one of them under another name.
    own: dict[int, object] = {}
    for function in functions:
        assert isinstance(function, FunctionType)
        scope = {name: own.get(id(value), value) for name, value in function.__globals__.items()}
        again = FunctionType(function.__code__, scope | names, function.__name__)
        again.__doc__, again.__qualname__ = function.__doc__, function.__qualname__
        again.__module__ = function.__module__
        own[id(function)] = again if wrap is None else wrap(again)
        setattr(made, function.__name__, own[id(function)])
    return made
