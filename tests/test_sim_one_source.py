"""One source: the floats' functions on rows of many vehicles give each of them the floats' own flight."""

import numpy as np
import pytest

from sim.airframe import load_airframe
from sim.kinematics import advance as step_kinematic
from sim.kinematics import world_rates
from sim.models import dynamic, falling
from sim.models.one_source import bound, clip
from sim.models.rigid import dynamics
from sim.models.rigid.constants import Limits, gains, hover, inertias, rotors
from sim.models.rigid.control import control

DT = 0.004
RIGID = (dynamics.pulls, dynamics.derivative, dynamics.along, dynamics.turned, dynamics.advance, control)
DYNAMIC = (dynamic.rate, dynamic.along, dynamic.carried, dynamic.respond)
ROWS = {"sqrt": np.sqrt, "clip": lambda v, low, high: np.minimum(np.maximum(v, low), high)}


def references(count, seed=1):
    """Of many vehicles: forward, left, up, yaw rate, one row each."""
    return tuple(np.random.default_rng(seed).normal(0.0, size, count) for size in (4.0, 4.0, 2.0, 1.0))


@pytest.mark.parametrize("name", ["crazyflie", "x500"])
def test_rows_of_rigid_bodies_fly_as_each_alone(name):
    rows, count = bound(RIGID, **ROWS), 5
    airframe = load_airframe(name)
    turning, body = rotors(airframe.body, DT), inertias(airframe.body)
    keeping = gains(airframe.body, Limits(0.6, 2.0), DT)
    start, integral = hover((0.0, 0.0, 0.2, 0.3), turning, body)
    asked, wind = references(count), (2.0, -1.0, 0.5)
    many, sums = (
        tuple(np.full(count, part) for part in start),
        tuple(np.full(count, part) for part in integral),
    )
    for _ in range(500):
        command, sums = rows.control(many, sums, asked, keeping)
        many = rows.advance(many, command, wind, turning, body)
    for one in range(count):
        now, held = start, integral
        for _ in range(500):
            command, held = control(now, held, tuple(float(part[one]) for part in asked), keeping)
            now = dynamics.advance(now, command, wind, turning, body)
        assert [float(part[one]) for part in many] == pytest.approx(now, rel=0.0, abs=1e-12)


def test_rows_of_the_other_models_fly_as_each_alone():
    trigonometry = {"cos": np.cos, "sin": np.sin}
    rows = bound((*DYNAMIC, world_rates, step_kinematic, falling.fall), **trigonometry)
    asked = references(4)
    wind = (2.0, -1.0, 0.5)
    airframe = load_airframe("matrice_100")
    chi = tuple(getattr(airframe.chi, key) for key in airframe.chi.__struct_fields__)
    constants = (chi, 0.3, DT)
    decay = falling.decay(0.3, DT)
    p, v = ((np.zeros(4),) * 4 for _ in range(2))
    q, f = (np.zeros(4),) * 4, ((np.zeros(4),) * 4, asked)
    for _ in range(300):
        p, v = rows.respond(p, v, asked, wind, constants)
        q = rows.advance(q, asked, DT)
        f = rows.fall(*f, wind, 0.3, decay)
    for one in range(4):
        own = tuple(float(part[one]) for part in asked)
        a, b, c, d = (0.0,) * 4, (0.0,) * 4, (0.0,) * 4, ((0.0,) * 4, own)
        for _ in range(300):
            a, b = dynamic.respond(a, b, own, wind, constants)
            c = step_kinematic(c, own, DT)
            d = falling.fall(*d, wind, 0.3, decay)
        for row, alone in ((p, a), (v, b), (q, c), (f[0], d[0]), (f[1], d[1])):
            assert [float(part[one]) for part in row] == pytest.approx(alone, rel=0.0, abs=1e-12)


def test_what_is_bound_leaves_the_floats_own_functions_as_they_were():
    bound(RIGID, sqrt=None, clip=None)
    assert control.__globals__["clip"] is clip
    assert dynamics.advance.__globals__["derivative"] is dynamics.derivative


def test_what_wraps_is_applied_and_seen_by_the_callers():
    called = set()

    def wrap(function):
        def watched(*values):
            called.add(function.__name__)
            return function(*values)

        return watched

    airframe = load_airframe("x500")
    turning, body = rotors(airframe.body, DT), inertias(airframe.body)
    start, _ = hover((0.0, 0.0, 2.0, 0.3), turning, body)
    rows = bound((clip, *RIGID), wrap=wrap)
    assert rows.advance(start, start[13:], (1.0, 0.0, 0.0), turning, body) == dynamics.advance(
        start, start[13:], (1.0, 0.0, 0.0), turning, body
    )
    assert called == {"clip", "pulls", "derivative", "along", "turned", "advance"}


@pytest.mark.parametrize(("value", "kept"), [(0.5, 0.5), (-1.0, 0.0), (9.0, 1.0), (0.0, 0.0), (1.0, 1.0)])
def test_clip(value, kept):
    assert clip(value, 0.0, 1.0) == kept


def test_clip_lets_nan_be_seen():
    assert np.isnan(clip(float("nan"), 0.0, 1.0))
