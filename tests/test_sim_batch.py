"""Batches: every way to compute gives what `Motion` gives, and vehicles do not see each other."""

from importlib.util import find_spec

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.airframe import MODELS, load_airframe
from sim.many import batch as batch_module
from sim.many.batch import Batch
from sim.scenario import ScenarioError

DT = 0.004
ALIKE = 1e-12
needs_numba = pytest.mark.skipif(
    find_spec("numba") is None, reason="numba, the extra `fast`, is not installed"
)
backends = pytest.mark.parametrize("backend", ["numpy", pytest.param("numba", marks=needs_numba)])
models = pytest.mark.parametrize("model", ["kinematic", "dynamic", "rigid_body"])
START = (1.0, -2.0, 20.0, 0.4)


def orders(n, seed=0):
    numbers = np.random.default_rng(seed)
    return numbers.uniform(-1.5, 1.5, (n, 4)), numbers.uniform(-3.0, 3.0, (n, 3))


def flying(airframe, model):
    """A motion in flight, with its p and v."""
    motion = MODELS[model](airframe)
    return motion, *(motion.hover(START) if model == "rigid_body" else (START, (0.0,) * 4))


def stepped(motion, p, v, v_ref, wind, steps):
    for _ in range(steps):
        p, v = motion.step(p, v, v_ref, wind, DT)
    return motion, p, v


def hovering(model, n, backend="numpy", airframe="x500"):
    batch = Batch(load_airframe(airframe), model, n, backend)
    batch.hover(START)
    return batch


def assert_alike(batch, ps, vs):
    np.testing.assert_allclose(batch.p, ps, rtol=0.0, atol=ALIKE)
    np.testing.assert_allclose(batch.v, vs, rtol=0.0, atol=ALIKE)


@backends
@pytest.mark.parametrize(
    ("model", "airframe"),
    [("kinematic", "x500"), ("dynamic", "matrice_100"), ("dynamic", "x500"), ("rigid_body", "x500"),
     ("rigid_body", "crazyflie"), ("rigid_body", "hummingbird")],
)  # fmt: skip
def test_a_batch_flies_as_motion_does(model, airframe, backend):
    n, legs, steps = 5, 6, 125
    batch = hovering(model, n, backend, airframe)
    motions = [flying(load_airframe(airframe), model) for _ in range(n)]
    for leg in range(legs):
        v_ref, wind = orders(n, leg)
        # One falls for half a second; then its motors are told to fly again.
        stopped = np.arange(n) == (3 if leg == 2 else n)
        batch.step(v_ref, wind, DT, steps, stopped=stopped)
        for i in range(n):
            asked = None if stopped[i] else tuple(v_ref[i].tolist())
            motions[i] = stepped(*motions[i], asked, tuple(wind[i].tolist()), steps)
    assert_alike(batch, [p for _, p, _ in motions], [v for *_, v in motions])


@backends
@models
def test_a_batch_starts_at_rest_at_the_origin_as_motion_does(model, backend):
    airframe = load_airframe("x500")
    batch, motion = Batch(airframe, model, 1, backend), MODELS[model](airframe)
    assert_alike(batch, [(0.0,) * 4], [(0.0,) * 4])
    p, v = (0.0,) * 4, (0.0,) * 4
    for _ in range(200):
        batch.step((0.5, 0.0, 1.0, 0.2), (1.0, 0.0, 0.0), DT)
        p, v = motion.step(p, v, (0.5, 0.0, 1.0, 0.2), (1.0, 0.0, 0.0), DT)
    assert_alike(batch, [p], [v])


@backends
@models
@pytest.mark.parametrize("n", [1, 63, 64, 65, 130])
def test_how_many_there_are_makes_no_difference_to_one(n, model, backend):
    v_ref, wind = orders(130)
    many, alone = hovering(model, n, backend), hovering(model, 1, backend)
    many.step(v_ref[:n], wind[:n], DT, 50)
    alone.step(v_ref[n - 1], wind[n - 1], DT, 50)
    assert_alike(alone, many.p[-1:], many.v[-1:])
    assert many.p.shape == many.v.shape == (n, 4)


@models
@settings(max_examples=15, deadline=None)
@given(order=st.permutations(range(7)))
def test_vehicles_in_another_order_fly_the_same(model, order):
    v_ref, wind = orders(7)
    stopped = np.arange(7) == 2
    one, other = hovering(model, 7), hovering(model, 7)
    one.step(v_ref, wind, DT, 20, stopped=stopped)
    other.step(v_ref[order], wind[order], DT, 20, stopped=stopped[order])
    np.testing.assert_array_equal(one.lanes[order], other.lanes)


@backends
@models
def test_many_steps_a_call_are_as_many_calls(model, backend):
    v_ref, wind = orders(3)
    one, other = hovering(model, 3, backend), hovering(model, 3, backend)
    one.step(v_ref, wind, DT, 40)
    for _ in range(40):
        other.step(v_ref, wind, DT)
    np.testing.assert_allclose(one.lanes, other.lanes, rtol=0.0, atol=ALIKE)


@backends
@models
def test_what_is_not_a_number_stays_with_its_vehicle(model, backend):
    v_ref, wind = orders(70)
    clean, spoilt = hovering(model, 70, backend), hovering(model, 70, backend)
    clean.step(v_ref, wind, DT, 20)
    v_ref[33] = np.nan
    spoilt.step(v_ref, wind, DT, 20)
    others = np.arange(70) != 33
    np.testing.assert_array_equal(spoilt.p[others], clean.p[others])
    assert np.isnan(spoilt.p[33]).any()


@backends
@models
def test_who_is_stopped_falls_whatever_is_asked_of_it(model, backend):
    batch = hovering(model, 3, backend)
    asked = np.array([(0.0,) * 4, (np.nan,) * 4, (0.0,) * 4])
    batch.step(asked, 0.0, DT, 250, stopped=[False, True, False])
    assert batch.p[[0, 2], 2] == pytest.approx([20.0, 20.0], abs=1e-9)
    assert 15.0 < batch.p[1, 2] < 16.5
    assert np.isfinite(batch.p).all()


@backends
@models
def test_place_is_what_motion_does_when_something_moves_the_vehicle(model, backend):
    airframe = load_airframe("x500")
    v_ref, wind = orders(3)
    batch = hovering(model, 3, backend)
    motions = [flying(airframe, model) for _ in range(3)]
    for step in range(60):
        batch.step(v_ref, wind, DT)
        motions = [
            stepped(*motions[i], tuple(v_ref[i].tolist()), tuple(wind[i].tolist()), 1) for i in range(3)
        ]
        if step % 10 == 0:
            # The first is pushed aside, the second stopped and turned, the third left alone.
            p, v = batch.p.copy(), batch.v.copy()
            p[0, :3] += (0.1, 0.0, -0.05)
            p[1, 3] += 0.2
            v[1] *= (0.0, 1.0, 1.0, 0.5)
            batch.place(p, v)
            np.testing.assert_allclose(batch.p, p, rtol=0.0, atol=ALIKE)
            np.testing.assert_allclose(batch.v, v, rtol=0.0, atol=ALIKE)
            moved = list(motions)
            for i, change in enumerate(((0.1, 0.0, -0.05, 0.0), (0.0, 0.0, 0.0, 0.2))):
                motion, at, fast = motions[i]
                slower = (0.0, fast[1], fast[2], 0.5 * fast[3]) if i else fast
                moved[i] = motion, tuple(a + b for a, b in zip(at, change, strict=True)), slower
            motions = moved
    np.testing.assert_allclose(batch.p, [p for _, p, _ in motions], rtol=0.0, atol=ALIKE)
    np.testing.assert_allclose(batch.v, [v for *_, v in motions], rtol=0.0, atol=ALIKE)


@models
def test_rest_stands_those_asked_for_level_where_they_are(model):
    batch = hovering(model, 3)
    batch.step(*orders(3), DT, 100)
    before, flown = batch.p, batch.lanes
    batch.rest([False, True, False])
    np.testing.assert_allclose(batch.p, before, rtol=0.0, atol=ALIKE)
    assert not batch.v[1].any()
    np.testing.assert_array_equal(batch.lanes[[0, 2]], flown[[0, 2]])
    if model == "rigid_body":
        assert not batch.lanes[1, 7:9].any()
        assert not batch.lanes[1, 13:].any()


def test_p_and_v_are_told_not_taken():
    batch = hovering("dynamic", 2)
    batch.p[0, 0] = 99.0
    batch.step((0.0,) * 4, 0.0, DT)
    assert batch.p[0, 0] == pytest.approx(1.0)


def test_wrong_shapes_and_numbers_are_refused():
    batch = hovering("dynamic", 3)
    with pytest.raises(ValueError, match="broadcast"):
        batch.step(np.zeros((2, 4)))
    with pytest.raises(ValueError, match="broadcast"):
        batch.step(np.zeros((3, 4)), np.zeros((3, 4)))
    with pytest.raises(ValueError, match="1 or more"):
        Batch(load_airframe("x500"), "dynamic", 0)


def test_an_airframe_without_the_numbers_is_refused():
    bare = msgspec.structs.replace(load_airframe("x500"), body=None)
    with pytest.raises(ScenarioError, match="rigid_body"):
        Batch(bare, "rigid_body", 2)


def test_without_numba_rows_serve_and_who_asks_for_it_is_told(monkeypatch):
    monkeypatch.setattr(batch_module, "find_spec", lambda _name: None)
    assert hovering("dynamic", 1, "auto").backend == "numpy"
    with pytest.raises(ModuleNotFoundError, match="fast"):
        hovering("dynamic", 1, "numba")


@needs_numba
def test_with_numba_it_serves():
    assert hovering("kinematic", 1, "auto").backend == "numba"
