"""From options to tasks: every combination once, what is compared side by side, wrong input told in a sentence."""

import argparse
import sys

import pytest
from evaluation_support import STEP_TOML

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation import grid, options
from groundstation.evaluation.axes import read_axes


def axes(*arguments):
    parser = argparse.ArgumentParser()
    options.fill(parser)
    return read_axes(parser.parse_args(arguments))


def tasks(*arguments):
    return grid.tasks(axes(*arguments), Settings())


def test_without_options_the_papers_controller_meets_the_assisted_one():
    found = tasks()
    assert len(found) == 20
    assert {(each.case.controller, each.settings.control.preset) for each in found} == {
        ("paper", "paper"),
        ("assisted", "assisted"),
    }
    assert {each.case.seed for each in found} == set(range(10))
    assert {each.case.rate for each in found} == {1000.0}


def test_every_combination_is_flown_once_with_every_seed():
    given = (
        "--delay",
        "0,0.1,0.3,0.1",
        "--loss",
        "0, 0.05",
        "--wind",
        "calm,2",
        "--operator",
        "novice,expert",
    )
    found = tasks(*given, "--seeds", "3")
    assert len(found) == len({each.id for each in found}) == 2 * 3 * 2 * 2 * 2 * 3


def test_what_is_compared_is_flown_one_after_the_other():
    first, second, *_ = tasks("--delay", "0,0.1")
    assert (first.case.controller, second.case.controller) == ("paper", "assisted")
    assert (first.case.seed, first.case.delay) == (second.case.seed, second.case.delay)


def test_a_guard_is_varied_only_where_the_preset_has_one():
    found = tasks("--guard", "barrier,off", "--seeds", "1")
    assert [(each.case.controller, each.case.guard) for each in found] == [
        ("paper", "off"),
        ("assisted", "barrier"),
        ("assisted", "off"),
    ]
    assert [each.settings.shield.guard for each in found] == ["off", "barrier", "off"]


def test_airframe_and_model_may_be_others_than_the_missions():
    (found,) = tasks("--airframe", "x500", "--model", "rigid_body", "--seeds", "1", "--controller", "paper")
    assert (found.case.airframe, found.case.model) == ("x500", "rigid_body")
    assert found.mission.vehicle.model == "rigid_body"


def test_a_controller_that_was_changed_is_flown_anew(tmp_path, monkeypatch):
    file = tmp_path / "law_of_mine.py"
    code = "from groundstation.pilot.controller import PaperController\n"
    code += "class Mine(PaperController):\n    def __init__(self, settings):\n        super().__init__()\n"
    file.write_text(code)
    monkeypatch.syspath_prepend(str(tmp_path))
    given = ("--controller", "law_of_mine:Mine", "--seeds", "1")
    (before,) = tasks(*given)
    assert tasks(*given)[0].id == before.id
    file.write_text(code + "    gain = 2\n")
    assert tasks(*given)[0].id != before.id
    del sys.modules["law_of_mine"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--mission", "nope"), "nope: no such mission"),
        (("--mission", "free"), "--mission free: has no target"),
        (("--delay", "soon"), "--delay soon: is not a number from 0 to 10"),
        (("--delay", "nan"), "--delay nan: is not a number"),
        (("--jitter", "0,-1"), "--jitter -1"),
        (("--loss", "1"), "--loss 1: is not a number from 0 to 0.95"),
        (("--wind", "storm"), "--wind storm: is neither calm, mission nor a speed"),
        (("--operator", "ace"), "--operator ace: is none of novice, average, expert"),
        (("--controller", "pid"), "--controller pid: is none of paper, assisted, transparent, training, nor"),
        (("--controller", "no_such_module:Law"), "no module 'no_such_module'"),
        (("--guard", "wall"), "--guard wall: is none of barrier, risk_field, off"),
        (("--operator", ","), "--operator: is empty"),
        (("--seeds", "0"), "--seeds 0"),
        (("--rate", "300"), "--rate 300: is not a multiple of 250"),
        (("--airframe", "brick"), "brick: no such airframe"),
        (("--model", "rigid_body"), "cannot fly the model rigid_body"),
    ],
)
def test_wrong_input_is_one_sentence_before_anything_is_flown(arguments, words):
    with pytest.raises(InputError, match=words) as told:
        tasks(*arguments)
    assert "\n" not in str(told.value)


def test_two_missions_of_one_name_cannot_be_told_apart(tmp_path):
    for name in ("a.toml", "b.toml"):
        (tmp_path / name).write_text(STEP_TOML)
    with pytest.raises(InputError, match="its name is 'step'"):
        tasks("--mission", f"{tmp_path / 'a.toml'},{tmp_path / 'b.toml'}")
