"""Airframe files: the presets, and every way to get one wrong."""

import pytest

from sim.airframe import PRESETS_FOLDER, find_airframe, load_airframe
from sim.scenario import ScenarioError

PRESETS = sorted(path.stem for path in PRESETS_FOLDER.glob("*.toml"))


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
    good = (PRESETS_FOLDER / "matrice_100.toml").read_text(encoding="utf-8")
    assert line in good
    path = tmp_path / "mine.toml"
    path.write_text(good.replace(line, replacement), encoding="utf-8")
    with pytest.raises(ScenarioError, match=key.replace(".", r"\.")) as caught:
        load_airframe(str(path))
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_airframe_may_be_a_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text((PRESETS_FOLDER / "x500.toml").read_text(encoding="utf-8"), encoding="utf-8")
    assert load_airframe(str(path)) == load_airframe("x500")


@pytest.mark.parametrize("name", ["phantom", "../../secret", "", "missing.toml"])
def test_what_does_not_exist_is_said(name):
    with pytest.raises(ScenarioError, match=r"no such airframe|cannot be read"):
        load_airframe(name)


def test_the_presets_are_listed_when_none_matches():
    with pytest.raises(ScenarioError, match=", ".join(PRESETS)):
        find_airframe("phantom")
