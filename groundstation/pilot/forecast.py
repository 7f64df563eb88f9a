"""Where the vehicle will be when what is sent now reaches it: its response, flown through the setpoints under way.

What the pilot sees is old by the way back, and what it sends acts after the way there. From the moment that a
sample is about until a setpoint sent now arrives, the vehicle follows setpoints that have been sent already, so its
motion is known but for the wind (Smith 1957, Closer control of loops with dead time). An observer takes what the
vehicle does otherwise than its response says for a disturbing acceleration, the *push*.
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from drivers.device import ZERO3, Vector3
from groundstation.frames import Vector4, body_from_world
from groundstation.pilot.margin import USUAL_LAGS
from groundstation.pilot.sight import ZERO4, VehicleSample
from sim.models.dynamic import Chi, ChiTuple, along, carried, rate

# A response without coupling and of gain 1, for a vehicle whose own is not known.
USUAL_CHI = Chi(
    chi_1=USUAL_LAGS[0].time, chi_3=USUAL_LAGS[1].time, chi_5=USUAL_LAGS[2].time, chi_9=USUAL_LAGS[3].time,
    chi_10=1.0, chi_11=0.0, chi_13=0.0, chi_14=1.0, chi_16=1.0, chi_19=1.0,
)  # fmt: skip
# How often a setpoint is noted, s, and how long it is remembered: beyond that nothing is flown.
MARK_S = 0.02
MEMORY_S = 2.0
# The observer's bandwidth, rad/s: gusts of a second are followed, a sample's jitter is not.
_OBSERVER = 3.0
_MOST_PUSH = 4.0
# Samples further apart than this say nothing about what happened between them, s.
_APART_S = 0.25


class Mark(NamedTuple):
    """A setpoint, and from when on it was the one that was sent, s."""

    t: float
    setpoint: Vector4


class Forecast(NamedTuple):
    """What is known between ticks.

    Attributes:
        t: Time since the start, s.
        marks: Setpoints lately, oldest first.
        sample: The newest of the vehicle.
        sample_t: When the setpoint was sent that acted as the sample was taken, s.
        p: Where the vehicle will be as what is sent now arrives, world, m and rad; yaw is not wrapped.
        v: Its velocities then, vehicle's axes, m/s and rad/s.
        velocity: The same, world, m/s.
        push: Disturbing acceleration, world, m/s².
        believed: The observer's velocity at the sample, world, m/s.
    """

    t: float = 0.0
    marks: tuple[Mark, ...] = ()
    sample: VehicleSample | None = None
    sample_t: float = 0.0
    p: Vector4 = ZERO4
    v: Vector4 = ZERO4
    velocity: Vector3 = ZERO3
    push: Vector3 = ZERO3
    believed: Vector3 = ZERO3


class Forecaster:
    """Keeps the forecast.

    Args:
        chi: The vehicle's velocity response; the usual one where it is not known.
    """

    def __init__(self, chi: Chi | None) -> None:
        known = chi or USUAL_CHI
        self._chi: ChiTuple = tuple(getattr(known, name) for name in Chi.__struct_fields__)  # pyright: ignore[reportAttributeAccessIssue]

    def look(self, before: Forecast, sample: VehicleSample, age: float, delay: float, dt: float) -> Forecast:
        """Look at the newest sample, and carry the forecast on for a tick with the setpoint sent in it.

        Args:
            before: Of the tick before.
            sample: The newest; another object only if it is another sample.
            age: Since it came, s.
            delay: Round trip, s.
            dt: Since the tick before, s.
        """
        t = before.t + dt
        if sample is before.sample:
            # Over a tick, and anew from every sample, the slope at its beginning will do.
            p, v = self._onward(before.p, before.v, _newest(before.marks), before.push, dt)
            world = _in_world(v, p[3])
            return Forecast(
                t, before.marks, sample, before.sample_t, p, v, world, before.push, before.believed
            )
        sample_t = t - age - delay
        push, believed = self._observed(before, sample, sample_t)
        p, v = self._through(before.marks, sample, push, sample_t, t)
        return Forecast(t, before.marks, sample, sample_t, p, v, _in_world(v, p[3]), push, believed)

    def _through(
        self, marks: tuple[Mark, ...], sample: VehicleSample, push: Vector3, begin: float, end: float
    ) -> tuple[Vector4, Vector4]:
        """Fly from a sample through the setpoints sent from `begin` to `end`, s."""
        p, v = sample.position, _on_axes(sample.velocity, sample.position[3])
        begin = max(begin, end - MEMORY_S)
        setpoint = ZERO4
        for mark in marks:
            if mark.t > begin:
                p, v = self._flown(p, v, setpoint, push, mark.t - begin)
                begin = mark.t
            setpoint = mark.setpoint
        return self._flown(p, v, setpoint, push, end - begin)

    def _flown(
        self, p: Vector4, v: Vector4, setpoint: Vector4, push: Vector3, dt: float
    ) -> tuple[Vector4, Vector4]:
        """Return p and v after a short time, by the midpoint rule; a longer one in pieces."""
        while dt > 2.0 * MARK_S:
            p, v = self._step(p, v, setpoint, push, MARK_S)
            dt -= MARK_S
        return self._step(p, v, setpoint, push, dt) if dt > 0.0 else (p, v)

    def _step(
        self, p: Vector4, v: Vector4, setpoint: Vector4, push: Vector3, dt: float
    ) -> tuple[Vector4, Vector4]:
        chi, onto = self._chi, body_from_world(push, p[3])
        middle = along(v, rate(v, setpoint, onto, chi), 0.5 * dt)
        after = along(v, rate(middle, setpoint, onto, chi), dt)
        return carried(p, v, after, dt), after

    def _onward(
        self, p: Vector4, v: Vector4, setpoint: Vector4, push: Vector3, dt: float
    ) -> tuple[Vector4, Vector4]:
        after = along(v, rate(v, setpoint, body_from_world(push, p[3]), self._chi), dt)
        return carried(p, v, after, dt), after

    def _observed(self, before: Forecast, sample: VehicleSample, sample_t: float) -> tuple[Vector3, Vector3]:
        """Return the push and the believed velocity as the sample corrects them.

        A Luenberger observer of velocity and push with both poles at −ω: gains 2 ω and ω².
        """
        x, y, z, _ = sample.velocity
        dt = sample_t - before.sample_t
        if before.sample is None or not 0.0 < dt < _APART_S:
            return before.push, (x, y, z)
        # The velocities of a vehicle that turns stay on its axes, so they turn with it.
        yaw = before.sample.position[3]
        u, v, w = before.believed
        start = _on_axes((u, v, w, before.sample.velocity[3]), yaw)
        setpoint = _in_force(before.marks, before.sample_t)
        _, after = self._flown((0.0, 0.0, 0.0, yaw), start, setpoint, before.push, dt)
        c, s = cos(sample.position[3]), sin(sample.position[3])
        expected = (c * after[0] - s * after[1], s * after[0] + c * after[1], after[2])
        ex, ey, ez = x - expected[0], y - expected[1], z - expected[2]
        share, gain = min(1.0, 2.0 * _OBSERVER * dt), _OBSERVER * _OBSERVER * dt
        a, b, d = before.push
        return (
            (_bounded(a + gain * ex), _bounded(b + gain * ey), _bounded(d + gain * ez)),
            (expected[0] + share * ex, expected[1] + share * ey, expected[2] + share * ez),
        )


def noted(forecast: Forecast, setpoint: Vector4) -> Forecast:
    """Return the forecast with the setpoint that is sent from now on noted."""
    marks = forecast.marks
    if marks and forecast.t - marks[-1].t < MARK_S - 1e-9:
        return forecast
    oldest = 0
    while oldest + 1 < len(marks) and marks[oldest + 1].t < forecast.t - MEMORY_S:
        oldest += 1
    return forecast._replace(marks=(*marks[oldest:], Mark(forecast.t, setpoint)))


def _newest(marks: tuple[Mark, ...]) -> Vector4:
    return marks[-1].setpoint if marks else ZERO4


def _in_force(marks: tuple[Mark, ...], t: float) -> Vector4:
    """Return the setpoint that was the newest at a time."""
    for mark in reversed(marks):
        if mark.t <= t:
            return mark.setpoint
    return ZERO4


def _in_world(v: Vector4, yaw: float) -> Vector3:
    c, s = cos(yaw), sin(yaw)
    return c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]


def _on_axes(velocity: Vector4, yaw: float) -> Vector4:
    c, s = cos(yaw), sin(yaw)
    x, y, z, turn = velocity
    return c * x + s * y, c * y - s * x, z, turn


def _bounded(push: float) -> float:
    return max(-_MOST_PUSH, min(_MOST_PUSH, push))
