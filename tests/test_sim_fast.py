"""The compiled models: they agree with floats, are compiled once and not once a process, and need no cache."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from bench.cpp.loop import BLOCK, CppLoop, NoCompilerError, built
from sim.airframe import MODELS, load_airframe
from sim.many.batch import Batch
from sim.many.lanes import law

ROOT = Path(__file__).resolve().parents[1]
DT = 0.004
needs_numba = pytest.mark.skipif(
    find_spec("numba") is None, reason="numba, the extra `fast`, is not installed"
)
models = pytest.mark.parametrize("model", ["kinematic", "dynamic", "rigid_body"])
LEGS = [
    ((1.0, 0.5, 0.2, 0.3), (0.5, -0.3, 0.1)),
    ((-1.2, 0.0, -0.3, -0.8), (3.0, 1.0, 0.0)),
    (None, (3.0, 1.0, 0.0)),
    ((4.0, -4.0, 2.0, 1.0), (0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0, 0.0), (-2.0, 0.0, 0.5)),
]


def by_motion(model, airframe, steps):
    motion = MODELS[model](airframe)
    p, v = (0.0, 0.0, 50.0, 0.3), (0.0,) * 4
    if model == "rigid_body":
        p, v = motion.hover(p)
    for v_ref, wind in LEGS:
        for _ in range(steps):
            p, v = motion.step(p, v, v_ref, wind, DT)
    return p, v


@needs_numba
@models
@pytest.mark.parametrize("calls", [1, 250])
def test_a_compiled_vehicle_flies_as_motion_does(model, calls):
    from sim.many.fast import Single

    airframe = load_airframe("x500")
    single = Single(airframe, model, DT)
    single.hover((0.0, 0.0, 50.0, 0.3))
    for v_ref, wind in LEGS:
        single.stop(stopped=v_ref is None)
        single.v_ref[:] = np.nan if v_ref is None else v_ref
        single.wind[:] = wind
        for _ in range(calls):
            single.step(250 // calls)
    p, v = by_motion(model, airframe, 250)
    assert single.p == pytest.approx(p, rel=0.0, abs=1e-12)
    assert single.v == pytest.approx(v, rel=0.0, abs=1e-12)


def test_the_loops_are_right_before_they_are_compiled():
    from sim.many import kernels

    airframe = load_airframe("x500")
    kinematic = law(airframe, "kinematic")
    lane = kinematic.resting((0.0, 0.0, 5.0, 0.2))
    data = np.array([*lane, 1.0, 0.0, 0.5, 0.3, 0.0, 0.0, 0.0, 1.0, *kinematic.constants(airframe, DT)])
    kernels.single(data, 8, 10)
    motion, p, v = MODELS["kinematic"](airframe), (0.0, 0.0, 5.0, 0.2), (0.0,) * 4
    for _ in range(10):
        p, v = motion.step(p, v, (1.0, 0.0, 0.5, 0.3), (0.0,) * 3, DT)
    assert data[:8].tolist() == pytest.approx([*p, *v], abs=1e-15)


def test_a_lane_is_read_and_written_row_by_row():
    from sim.many import kernels

    memory = np.arange(200.0)
    assert kernels.twenty(memory, 3, 7) == tuple(memory[3:143:7])
    assert kernels.seventeen(memory, 3, 7) == tuple(memory[3:122:7])
    there = np.zeros(200)
    kernels.put_twenty(there, 3, 7, kernels.twenty(memory, 3, 7))
    np.testing.assert_array_equal(there[3:143:7], memory[3:143:7])
    assert np.count_nonzero(there) == 20
    for name, model in (("kinematic", "kinematic"), ("dynamic", "dynamic"), ("rigid", "rigid_body")):
        constants = law(load_airframe("x500"), model).constants(load_airframe("x500"), DT)
        read = getattr(kernels, f"{name}_constants")
        assert read(np.array([0.0, *constants]), 1) == constants


PROBE = """
from sim.airframe import load_airframe
from sim.many.fast import Single
single = Single(load_airframe("x500"), "kinematic")
single.step()
stats = single._kernel.stats
print(sum(stats.cache_hits.values()), sum(stats.cache_misses.values()))
"""


def probe(**environment):
    ran = subprocess.run(
        [sys.executable, "-W", "error", "-c", PROBE],
        cwd=ROOT, env=os.environ | environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return tuple(int(word) for word in ran.stdout.split())


@needs_numba
def test_what_is_compiled_is_kept_for_the_next_process(tmp_path):
    assert probe(NUMBA_CACHE_DIR=str(tmp_path)) == (0, 1)
    assert probe(NUMBA_CACHE_DIR=str(tmp_path)) == (1, 0)


@needs_numba
def test_where_nothing_can_be_kept_it_is_compiled_all_the_same(tmp_path):
    (tmp_path / "file").write_text("in the way")
    assert probe(NUMBA_CACHE_DIR=str(tmp_path / "file")) == (0, 1)


@needs_numba
def test_other_sources_have_another_cache(tmp_path, monkeypatch):
    from numba.core import config

    from sim.many import fast

    kept = []
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    kinematic = law(load_airframe("x500"), "kinematic")
    for word in (b"one", b"other", b"one"):
        monkeypatch.setattr(Path, "read_bytes", lambda _path, word=word: word)
        with fast._cache_folder(kinematic) as writable:
            assert writable
            kept.append(config.CACHE_DIR)
        assert str(tmp_path) == config.CACHE_DIR
    assert kept[0] == kept[2] != kept[1]


def test_the_loop_in_cpp_agrees():
    try:
        built()
    except NoCompilerError as error:
        pytest.skip(f"the C++ loop is not built: {error}")
    airframe = load_airframe("x500")
    rigid, n = law(airframe, "rigid_body"), 2 * BLOCK
    numbers = np.random.default_rng(4)
    v_ref, wind = numbers.uniform(-2.0, 2.0, (n, 4)), numbers.uniform(-3.0, 3.0, (n, 3))
    batch = Batch(airframe, "rigid_body", n, "numpy")
    batch.hover((0.0, 0.0, 20.0, 0.3))
    loop = CppLoop(np.ascontiguousarray(batch.lanes.T), v_ref.T, wind.T, rigid.constants(airframe, DT))
    loop.step(2500)
    batch.step(v_ref, wind, DT, 2500)
    np.testing.assert_allclose(loop.lanes.T, batch.lanes, rtol=0.0, atol=1e-12)
