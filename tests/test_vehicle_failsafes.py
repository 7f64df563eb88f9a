"""PX4's failsafe parameters judged: what is dangerous or unread keeps the hand from being coupled."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import REASON_TEXT, Severity
from groundstation.vehicle.failsafes import FAILSAFES, unsafe, verdict
from sim.autopilot.parameters import SPECS

GOOD = {
    "COM_OF_LOSS_T": 1.0,
    "COM_OBL_RC_ACT": 5.0,
    "NAV_RCL_ACT": 2.0,
    "NAV_DLL_ACT": 1.0,
    "COM_RC_OVERRIDE": 3.0,
    "GF_ACTION": 2.0,
    "COM_LOW_BAT_ACT": 3.0,
}


def severity(name: str, value: float) -> Severity:
    failsafe = next(each for each in FAILSAFES if each.name == name)
    return verdict(failsafe, {name: value}).severity


def test_what_is_well_set_is_well() -> None:
    assert unsafe(GOOD) == ""
    assert {verdict(each, GOOD).severity for each in FAILSAFES} == {Severity.INFO}


def test_px4_as_it_comes_can_be_flown_but_is_cautioned_about() -> None:
    usual = {each.name: SPECS[each.name].default for each in FAILSAFES}
    assert unsafe(usual) == ""
    cautioned = {each.name for each in FAILSAFES if verdict(each, usual).severity is Severity.WARNING}
    assert cautioned == {"NAV_DLL_ACT", "COM_RC_OVERRIDE", "COM_LOW_BAT_ACT"}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("COM_OF_LOSS_T", 2.1),
        ("COM_OF_LOSS_T", -1.0),
        ("COM_OF_LOSS_T", math.nan),
        ("COM_OBL_RC_ACT", 6),
        ("COM_OBL_RC_ACT", 7),
        ("COM_OBL_RC_ACT", 8),
        ("COM_OBL_RC_ACT", math.inf),
        ("NAV_RCL_ACT", 0),
        ("NAV_RCL_ACT", 5),
        ("NAV_DLL_ACT", 6),
        ("GF_ACTION", 4),
        ("COM_LOW_BAT_ACT", 9),
        ("COM_RC_OVERRIDE", 1.5),
    ],
)
def test_what_is_dangerous_is_refused_with_name_value_and_remedy(name: str, value: float) -> None:
    words = unsafe(GOOD | {name: float(value)})
    assert words.startswith(f"{name} = {value:g} (")
    assert "set" in words
    assert len(words.encode()) < REASON_TEXT


@pytest.mark.parametrize("name", GOOD)
def test_what_is_not_read_is_refused(name: str) -> None:
    words = unsafe({other: value for other, value in GOOD.items() if other != name})
    assert f"{name} is not read" in words


def test_nothing_read_is_said_in_one_line() -> None:
    assert "and 6 more" in unsafe({})


def test_a_late_loss_is_cautioned_about() -> None:
    assert severity("COM_OF_LOSS_T", 1.5) is Severity.WARNING


@given(name=st.sampled_from(sorted(GOOD)), value=st.floats())
def test_any_number_gets_a_verdict_in_words(name: str, value: float) -> None:
    failsafe = next(each for each in FAILSAFES if each.name == name)
    judged = verdict(failsafe, {name: value})
    assert judged.means
    assert (judged.severity is Severity.INFO) or judged.remedy
    assert bool(unsafe(GOOD | {name: value})) is (judged.severity is Severity.ALARM)
