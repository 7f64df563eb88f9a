"""The response with given parameters: how well it tells what a vehicle did, from one sample to a whole flight.

The model is `sim.models.dynamic`, v_ref = M v̇ + C(ω) v, the same that the simulator flies and the pilot compensates,
with a steady push that stands for wind. It is flown free: only its first velocity is the vehicle's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, cast

import numpy as np
import numpy.typing as npt

from groundstation.identification.samples import Numbers, Samples
from sim.models.dynamic import Chi, rate

# χ in the order of `Chi`, then the push on forward, left, up.
PARAMETERS = (*Chi.__struct_fields__, "push_forward", "push_left", "push_up")
CHI = len(Chi.__struct_fields__)
# No multirotor is faster, m/s, nor turns faster, rad/s.
_FASTEST = 1e3


Vectors = tuple[Numbers, ...]
# One source for floats and rows, typed for floats.
_rate = cast(Callable[[Vectors, Vectors, Vectors, Vectors], Vectors], rate)


class Windows(NamedTuple):
    """Stretches cut into pieces of one length, w of them with n samples each.

    Attributes:
        v: (n, w, 4), velocities.
        ref: (n, w, 4), references as they reached the vehicle.
        dt: Step, s.
    """

    v: Numbers
    ref: Numbers
    dt: float

    def only(self, places: npt.NDArray[np.intp]) -> Windows:
        """Return some of the windows."""
        return Windows(self.v[:, places], self.ref[:, places], self.dt)


def windows(samples: Samples, length_s: float, delay_s: float) -> Windows:
    """Cut a flight into windows one behind the other, the references shifted by a delay.

    Args:
        samples: The flight.
        length_s: Of a window, s.
        delay_s: From the reference's sending to its effect, s.
    """
    n = max(2, round(length_s / samples.dt))
    vs: list[Numbers] = []
    refs: list[Numbers] = []
    for v, ref in samples.stretches:
        late = delayed(ref, delay_s / samples.dt)
        start = int(np.ceil(delay_s / samples.dt))
        for first in range(start, len(v) - n + 1, n):
            vs.append(v[first : first + n])
            refs.append(late[first : first + n])
    if not vs:
        return Windows(np.empty((n, 0, 4)), np.empty((n, 0, 4)), samples.dt)
    return Windows(np.stack(vs, axis=1), np.stack(refs, axis=1), samples.dt)


def delayed(ref: Numbers, steps: float) -> Numbers:
    """Return references that come later by a number of steps, whole or not, (n, 4)."""
    places = np.arange(len(ref), dtype=np.float64)
    return np.column_stack([np.interp(places - steps, places, column) for column in ref.T])


def flown(pieces: Windows, parameters: Numbers, start: Numbers | None = None) -> Numbers:
    """Fly the model freely through windows, all at once.

    Args:
        pieces: The windows.
        parameters: (..., 13), as in `PARAMETERS`; leading axes fly the windows with each of them.
        start: (w, 4), or with the leading axes too, first velocities; the measured ones where None.

    Returns:
        (n, ..., w, 4), velocities; the first is the vehicle's own.
    """
    parameters = np.asarray(parameters)
    many = (*parameters.shape[:-1], pieces.v.shape[1])
    chi = tuple(parameters[..., i, None] for i in range(CHI))
    push = tuple(parameters[..., i, None] for i in range(CHI, len(PARAMETERS)))
    first = pieces.v[0] if start is None else start
    v = tuple(np.broadcast_to(first[..., i], many).astype(np.float64) for i in range(4))
    out = np.empty((len(pieces.v), *many, 4))
    dt = pieces.dt
    for k in range(len(pieces.v)):
        for i in range(4):
            # A response that turns unstable shall lose against others, not overflow.
            out[k, ..., i] = v[i].clip(-_FASTEST, _FASTEST)
        if k + 1 < len(pieces.v):
            v = _step(tuple(out[k, ..., i] for i in range(4)), pieces.ref[k], push, chi, dt)
    return out


def _step(v: Vectors, ref: Numbers, push: Vectors, chi: Vectors, dt: float) -> Vectors:
    """Return the velocities a step later, fourth-order Runge-Kutta as `sim.models.dynamic.respond`."""
    asked = tuple(ref[:, i] for i in range(4))
    k1 = _rate(v, asked, push, chi)
    k2 = _rate(_along(v, k1, 0.5 * dt), asked, push, chi)
    k3 = _rate(_along(v, k2, 0.5 * dt), asked, push, chi)
    k4 = _rate(_along(v, k3, dt), asked, push, chi)
    return tuple(v[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) for i in range(4))


def _along(v: Vectors, slope: Vectors, dt: float) -> Vectors:
    return tuple(v[i] + slope[i] * dt for i in range(4))


def r_squared(measured: Numbers, told: Numbers) -> Numbers:
    """Return the share of each axis's variance that is told, 1 − Σ(v − v̂)² / Σ(v − v̄)², (4,)."""
    measured, told = measured.reshape(-1, 4), told.reshape(-1, 4)
    left = np.square(measured - told).sum(axis=0)
    whole = np.square(measured - measured.mean(axis=0)).sum(axis=0)
    return 1.0 - left / np.maximum(whole, 1e-12)
