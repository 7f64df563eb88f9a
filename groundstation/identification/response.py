"""The response with given parameters, flown free: what a vehicle would do if it were the model.

The model is `sim.models.dynamic`, v_ref = M v̇ + C(ω) v, the same that the simulator flies and the pilot compensates,
with a steady push in the world that stands for the wind of a flight. Between sending a reference and being told what
came of it lies a delay, each axis has its own: autopilots estimate yaw rates sooner than velocities. The model is
flown without, and what it does is told that much later.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, cast

import numpy as np
import numpy.typing as npt

from groundstation.identification.samples import Numbers, Samples
from sim.models.dynamic import Chi, rate

NAMES: tuple[str, ...] = Chi.__struct_fields__
CHI = len(NAMES)
# Delays are of level flight, of climbing and of turning; which of them an axis has.
DELAYS = ("level", "up", "yaw")
DELAY_OF_AXIS = np.array([0, 0, 1, 2])
LONGEST_DELAY_S = 0.5
# No multirotor is faster, m/s, nor turns faster, rad/s.
_FASTEST = 1e3

Vectors = tuple[Numbers, ...]
# One source for floats and rows, typed for floats.
_rate = cast(Callable[[Vectors, Vectors, Vectors, Vectors], Vectors], rate)


class Asked(NamedTuple):
    """What a vehicle was asked for in windows.

    Attributes:
        ref: (n, w, 4), references.
        yaw: (n, w), where it looked, rad; for the push.
        dt: Step, s.
    """

    ref: Numbers
    yaw: Numbers
    dt: float


class Windows(NamedTuple):
    """Flights cut into pieces of one length, w of them with lead + n samples each.

    Attributes:
        v: (lead + n, w, 4), velocities.
        ref: (lead + n, w, 4), references.
        yaw: (lead + n, w), rad.
        flight: (w,), which flight a window is from.
        lead: Samples before those that are looked at, a little longer than the longest delay.
        longest: Delay that is looked for, s; 0 if none is.
        dt: Step, s.
    """

    v: Numbers
    ref: Numbers
    yaw: Numbers
    flight: npt.NDArray[np.intp]
    lead: int
    longest: float
    dt: float

    def asked(self, delays: Numbers) -> Asked:
        """Return what was asked for in them, and where the vehicle looked as it acted, given delays, s."""
        return Asked(self.ref, _later(self.yaw, -delays[-1] / self.dt), self.dt)

    @property
    def number(self) -> int:
        """Number of windows."""
        return self.v.shape[1]

    def only(self, places: npt.NDArray[np.intp]) -> Windows:
        """Return some of the windows."""
        return self._replace(
            v=self.v[:, places],
            ref=self.ref[:, places],
            yaw=self.yaw[:, places],
            flight=self.flight[places],
        )


def windows(flights: Sequence[Samples], length_s: float, longest: float) -> Windows:
    """Cut flights into windows one behind the other.

    Args:
        flights: With the same step.
        length_s: Of what is looked at in a window, s.
        longest: Delay that will be looked for, s.
    """
    dt = flights[0].dt
    n, lead = max(2, round(length_s / dt)), int(np.ceil(longest / dt)) + 1
    places = [
        (number, stretch, first)
        for number, flight in enumerate(flights)
        for stretch in flight.stretches
        for first in range(lead, len(stretch.v) - n + 1, n)
    ]

    def pieces(part: Callable[[int], Numbers], *inner: int) -> Numbers:
        rows = [part(k) for k in range(len(places))]
        return np.stack(rows, axis=1) if rows else np.empty((lead + n, 0, *inner))

    def of(k: int) -> slice:
        return slice(places[k][2] - lead, places[k][2] + n)

    return Windows(
        pieces(lambda k: places[k][1].v[of(k)], 4),
        pieces(lambda k: places[k][1].ref[of(k)], 4),
        pieces(lambda k: places[k][1].yaw[of(k)]),
        np.array([number for number, _, _ in places], np.intp),
        lead,
        longest,
        dt,
    )


def told(way: Numbers, yaw: Numbers, delays: Numbers, dt: float) -> Numbers:
    """Return what is told of a way: each axis later by its delay, and level velocities on the axes of then.

    A velocity is estimated in the world and turned onto the vehicle's axes by a heading that is newer by the
    difference of the two delays, by which the vehicle has turned on.

    Args:
        way: (n, ..., w, 4), velocities as the references act.
        yaw: (n, w), as told, rad, not wrapped.
        delays: (3,), of `DELAYS`, s.
        dt: Step, s.
    """
    steps = delays[DELAY_OF_AXIS] / dt
    late = np.stack([_later(way[..., axis], by) for axis, by in enumerate(steps)], axis=-1)
    turn = yaw - _later(yaw, steps[0] - steps[3])
    return _turned(late, turn.reshape(len(yaw), *[1] * (way.ndim - 3), -1))


def acted(v: Numbers, yaw: Numbers, delays: Numbers, dt: float) -> Numbers:
    """Return velocities that were told, (n, w, 4), as the references acted: the other way round than `told`."""
    steps = delays[DELAY_OF_AXIS] / dt
    turned = _turned(v, _later(yaw, steps[0] - steps[3]) - yaw)
    return np.stack([_later(turned[..., axis], -by) for axis, by in enumerate(steps)], axis=-1)


def _turned(v: Numbers, by: Numbers) -> Numbers:
    """Return velocities on axes that are turned counter-clockwise by angles, rad."""
    c, s = np.cos(by), np.sin(by)
    forward, left = v[..., 0], v[..., 1]
    return np.stack((c * forward + s * left, c * left - s * forward, v[..., 2], v[..., 3]), axis=-1)


def _later(x: Numbers, steps: float) -> Numbers:
    """Return rows that come later, or earlier where negative, by a number of steps, whole or not.

    Between samples by the cubic through four of them; before the first and after the last the ends go on.
    """
    n = len(x)
    place = np.clip(np.arange(n) - steps, 0.0, n - 1.0)
    first = np.clip(np.floor(place).astype(np.intp) - 1, 0, max(0, n - 4))
    u = (place - first).reshape(-1, *[1] * (x.ndim - 1))
    a, b, c, d = (x[np.minimum(first + k, n - 1)] for k in range(4))
    return (
        -(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0 * a
        + u * (u - 2.0) * (u - 3.0) / 2.0 * b
        - u * (u - 1.0) * (u - 3.0) / 2.0 * c
        + u * (u - 1.0) * (u - 2.0) / 6.0 * d
    )


def flown(asked: Asked, start: Numbers, chi: Numbers, push: Numbers) -> Numbers:
    """Fly the model freely through windows, all at once, without a delay.

    Args:
        asked: What for.
        start: (..., w, 4), first velocities.
        chi: (..., 10); leading axes fly the windows with each of them.
        push: (..., w, 3), steady accelerations, world, m/s².

    Returns:
        (n, ..., w, 4), velocities.
    """
    ref, yaw, dt = asked
    out = np.empty((len(ref), *np.broadcast_shapes(start.shape, (*chi.shape[:-1], *ref.shape[1:]))))
    parameters = tuple(chi[..., i, None] for i in range(CHI))
    c, s = np.cos(yaw), np.sin(yaw)
    east, north, up = push[..., 0], push[..., 1], push[..., 2]
    pushed = bool(push.any())
    out[0] = start
    none = (np.zeros(1),) * 3
    for k in range(len(ref) - 1):
        body = (c[k] * east + s[k] * north, c[k] * north - s[k] * east, up) if pushed else none
        v = tuple(out[k, ..., i] for i in range(4))
        after = _step(v, tuple(ref[k, :, i] for i in range(4)), body, parameters, dt)
        for i in range(4):
            # A response that turns unstable shall lose against others, not overflow.
            np.clip(after[i], -_FASTEST, _FASTEST, out=out[k + 1, ..., i])
    return out


def _step(v: Vectors, ref: Vectors, push: Vectors, chi: Vectors, dt: float) -> Vectors:
    """Return the velocities a step later, fourth-order Runge-Kutta as `sim.models.dynamic.respond`."""
    k1 = _rate(v, ref, push, chi)
    k2 = _rate(_along(v, k1, 0.5 * dt), ref, push, chi)
    k3 = _rate(_along(v, k2, 0.5 * dt), ref, push, chi)
    k4 = _rate(_along(v, k3, dt), ref, push, chi)
    return tuple(v[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) for i in range(4))


def _along(v: Vectors, slope: Vectors, dt: float) -> Vectors:
    return tuple(v[i] + slope[i] * dt for i in range(4))
