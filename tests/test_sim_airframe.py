"""Airframe files: the presets, and every way to get one wrong."""

import pytest

from sim.airframe import MODELS, PRESETS_FOLDER, find_airframe, load_airframe
from sim.scenario import ScenarioError

PRESETS = sorted(path.stem for path in PRESETS_FOLDER.glob("*.toml"))


def test_the_presets_are_those_of_the_table():
    assert PRESETS == ["crazyflie", "f450", "hummingbird", "matrice_100", "phantom", "x500"]


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_flies_the_models_it_has_numbers_for_and_says_why_not_the_others(name):
    airframe = load_airframe(name)
    for model, make in MODELS.items():
        if model in airframe.models():
            assert make(airframe).attitude.roll == 0.0
        else:
            with pytest.raises(
                ScenarioError, match=rf"{name} has no \[\w+\] table.*choose {airframe.models()[0]}"
            ):
                make(airframe)


def test_every_preset_flies_all_models_but_the_one_whose_body_nobody_has_published():
    flies = {name: set(load_airframe(name).models()) for name in PRESETS}
    assert flies.pop("matrice_100") == {"kinematic", "dynamic"}
    assert all(models == set(MODELS) for models in flies.values())


def test_without_a_velocity_response_the_dynamic_model_is_refused(tmp_path):
    good = (PRESETS_FOLDER / "x500.toml").read_text(encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(good[: good.index("[chi]")] + good[good.index("[body]") :], encoding="utf-8")
    airframe = load_airframe(str(path))
    assert airframe.models() == ("kinematic", "rigid_body")
    with pytest.raises(ScenarioError, match=r"no \[chi\] table.*dynamic; choose kinematic or rigid_body"):
        MODELS["dynamic"](airframe)


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_loads_under_its_own_name_and_says_where_it_is_from(name):
    airframe = load_airframe(name)
    assert airframe.name == name
    assert airframe.source


def test_the_published_response_is_the_published_one():
    chi = load_airframe("matrice_100").chi
    published = (0.6756, 0.6344, 0.4080, 0.2953, 0.5941, -0.8109, 0.3984, 0.7040, 0.9365, 0.9752)
    assert (
        tuple(getattr(chi, f"chi_{number}") for number in (1, 3, 5, 9, 10, 11, 13, 14, 16, 19)) == published
    )


def test_an_estimate_says_that_it_is_one():
    x500 = load_airframe("x500")
    assert "estimate" in x500.title
    assert "chi" in x500.estimated
    assert "estimate" in load_airframe("phantom").title
    for name in ("crazyflie", "f450", "hummingbird", "phantom"):
        assert "chi: fitted" in load_airframe(name).estimated.replace("\n", " ")


def refused(tmp_path, preset, line, replacement, key):
    good = (PRESETS_FOLDER / f"{preset}.toml").read_text(encoding="utf-8")
    assert line in good
    path = tmp_path / "mine.toml"
    path.write_text(good.replace(line, replacement), encoding="utf-8")
    with pytest.raises(ScenarioError, match=key.replace(".", r"\.")) as caught:
        load_airframe(str(path))
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("line", "replacement", "key"),
    [
        ("mass = 2.0643", "mass = 0.0", "body.mass"),
        ("mass = 2.0643", "mass = 2.0643\nwheels = 4", "wheels"),
        ("mass = 2.0643", "mass = 3.0", "body.rotor_thrust: four rotors lift 1.16 times the weight"),
        ("inertia = [0.0239, 0.0239, 0.0440]", "inertia = [0.0176, 0.0176, 0.0362]", "body.inertia"),
        ("inertia = [0.0239, 0.0239, 0.0440]", "inertia = [0.0239, -0.0239, 0.0440]", "body.inertia"),
        ("inertia = [0.0239, 0.0239, 0.0440]", "inertia = [0.0239, 0.0440]", "body.inertia"),
        (
            "inertia = [0.0239, 0.0239, 0.0440]",
            "inertia = [23.9, 23.9, 44.0]",
            "body.inertia: 44.0 is too large",
        ),
        ("rotor_thrust = 8.54858", "rotor_thrust = inf", "body.rotor_thrust"),
        ("motor_up_s = 0.0125", "motor_up_s = 0.0", "body.motor_up_s"),
        ("drag = [0.248, 0.248]", "drag = [0.248, -0.1]", "body.drag"),
        ("drag = [0.248, 0.248]", "", "drag"),
        ("radius = 0.38", "radius = 0.2", "radius: 0.2 is less than body.arm"),
    ],
)
def test_a_body_that_cannot_be_or_cannot_fly_is_refused(tmp_path, line, replacement, key):
    refused(tmp_path, "x500", line, replacement, key)


def test_with_neither_response_nor_body_there_is_nothing_to_fly(tmp_path):
    good = (PRESETS_FOLDER / "matrice_100.toml").read_text(encoding="utf-8")
    refused(tmp_path, "matrice_100", good[good.index("[chi]") :], "", "chi, body: both are missing")


@pytest.mark.parametrize(
    ("line", "replacement", "key"),
    [
        ("radius = 0.5", "radius = -0.5", "radius"),
        ("radius = 0.5", "radius = nan", "radius"),
        ("radius = 0.5", "radius = 'wide'", "radius"),
        ("radius = 0.5", "radius = 0.5\nwings = 2", "wings"),
        ("schema = 1", "schema = 2", "schema"),
        ("chi_1 = 0.6756", "chi_1 = 0.0", "chi.chi_1"),
        ("chi_16 = 0.9365", "chi_16 = -1.0", "chi.chi_16"),
        ("chi_19 = 0.9752", "", "chi_19"),
        ("chi_11 = -0.8109", "chi_11 = 5.0", "chi.chi_11"),
        ("cells = 6", "cells = 0", "cells"),
        ("tilt_deg = 35.0", "tilt_deg = 90.0", "tilt_deg"),
    ],
)
def test_what_is_wrong_is_named_with_file_and_key(tmp_path, line, replacement, key):
    refused(tmp_path, "matrice_100", line, replacement, key)


def test_an_airframe_may_be_a_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text((PRESETS_FOLDER / "x500.toml").read_text(encoding="utf-8"), encoding="utf-8")
    assert load_airframe(str(path)) == load_airframe("x500")


@pytest.mark.parametrize("name", ["zeppelin", "../../secret", "", "missing.toml"])
def test_what_does_not_exist_is_said(name):
    with pytest.raises(ScenarioError, match=r"no such airframe|cannot be read"):
        load_airframe(name)


def test_the_presets_are_listed_when_none_matches():
    with pytest.raises(ScenarioError, match=", ".join(PRESETS)):
        find_airframe("zeppelin")
