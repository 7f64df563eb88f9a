"""The par of missions: kept beside them, held to be theirs by a digest."""

import math

import msgspec
import pytest
from operators_support import HOP

from groundstation.operators.exercise import Exercise, fly
from groundstation.training.measures import Measures, Track
from groundstation.training.mission import MISSIONS_FOLDER, SUFFIX, load_mission
from groundstation.training.reference import (
    Reference,
    digest_of,
    file_of,
    load_reference,
    reference_fault,
    save_reference,
)
from sim.people import PEOPLE

REFERENCE = Reference(
    digest_of(HOP),
    {"expert": {0: Measures(time_s=20.00004, reached=1.0, smoothness=-2.34567)}},
    {"expert": Track(0.5, ((0.0, 0.0, 0.0), (1.0, 0.5, 1.2)))},
)
SHIPPED = [path for path in sorted(MISSIONS_FOLDER.glob(f"*{SUFFIX}")) if load_mission(path).judged]


def test_what_is_saved_is_loaded_again_rounded(tmp_path):
    path = tmp_path / "hop.toml"
    assert save_reference(REFERENCE, path) == file_of(path)
    found = load_reference(HOP, path)
    assert found is not None
    par = found.par(0)
    assert par is not None
    assert (par.time_s, par.smoothness, par.collisions) == (20.0, -2.3457, 0)
    assert math.isnan(par.landing_error_m)
    assert found.par(1) is None
    assert found.tracks == REFERENCE.tracks
    assert reference_fault(HOP, path) == ""
    assert [each.name for each in file_of(path).parent.iterdir()] == ["hop.json"]


def test_a_par_of_another_form_of_the_mission_is_not_used(tmp_path):
    path = tmp_path / "hop.toml"
    save_reference(REFERENCE, path)
    longer = msgspec.structs.replace(HOP, takeoff_altitude_m=3.0)
    assert load_reference(longer, path) is None
    assert "another form of this mission; measure it with" in reference_fault(longer, path)


def test_texts_and_the_place_in_the_school_leave_the_par_as_it_is():
    route = tuple(msgspec.structs.replace(point, say="Go there.") for point in HOP.waypoints)
    told = msgspec.structs.replace(
        HOP, title="Other", teaches="Much.", route=route, level=4, needs=("hover",)
    )
    assert digest_of(told) == digest_of(HOP)
    nearer = (msgspec.structs.replace(HOP.waypoints[0], radius=0.4), HOP.waypoints[1])
    assert digest_of(msgspec.structs.replace(HOP, route=nearer)) != digest_of(HOP)


def test_without_a_par_it_is_said_how_to_get_one(tmp_path):
    path = tmp_path / "hop.toml"
    assert load_reference(HOP, path) is None
    assert reference_fault(HOP, path).endswith(
        f"there is no par yet; measure it with `groundstation missions measure {path}`."
    )


@pytest.mark.parametrize("content", [b"", b"{", b'{"digest": 1}', b"\xff\xfe"])
def test_a_spoilt_par_is_none_and_is_told(tmp_path, content):
    path = tmp_path / "hop.toml"
    file_of(path).parent.mkdir()
    file_of(path).write_bytes(content)
    assert load_reference(HOP, path) is None
    assert "is no reference" in reference_fault(HOP, path)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_mission_that_comes_with_the_program_has_its_par(path):
    mission = load_mission(path)
    assert reference_fault(mission, path) == ""
    reference = load_reference(mission, path)
    assert reference is not None
    assert {name: list(flights) for name, flights in reference.flights.items()} == {
        name: [0, 1, 2, 3, 4] for name in PEOPLE
    }
    assert set(reference.tracks) == set(PEOPLE)
    for flights in reference.flights.values():
        assert all(measures.reached == 1.0 for measures in flights.values())


def test_a_par_is_what_flying_the_mission_gives():
    path = MISSIONS_FOLDER / "hover.toml"
    mission = load_mission(path)
    reference = load_reference(mission, path)
    assert reference is not None
    kept, flown = reference.par(1), fly(Exercise(mission, "expert", 1)).measures
    assert kept is not None
    assert flown.time_s == pytest.approx(kept.time_s, abs=0.5)
    assert flown.path_error_m == pytest.approx(kept.path_error_m, abs=0.01)
