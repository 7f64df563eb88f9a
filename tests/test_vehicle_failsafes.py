"""The vehicle's parameters judged: what is dangerous or unread keeps the hand from being coupled."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import REASON_TEXT, Autopilot, Severity
from groundstation.vehicle.failsafes import verdict
from groundstation.vehicle.profiles import PROFILES, outdated, profile_of, speed_limits, unsafe_for
from sim.autopilot.parameters import SPECS

GOOD = {
    "COM_OF_LOSS_T": 1.0,
    "COM_OBL_RC_ACT": 5.0,
    "NAV_RCL_ACT": 2.0,
    "NAV_DLL_ACT": 1.0,
    "COM_RC_IN_MODE": 3.0,
    "COM_RCL_EXCEPT": 0.0,
    "COM_RC_OVERRIDE": 3.0,
    "GF_ACTION": 2.0,
    "COM_LOW_BAT_ACT": 3.0,
    "MPC_XY_VEL_MAX": 12.0,
    "MPC_Z_VEL_MAX_UP": 3.0,
    "MPC_Z_VEL_MAX_DN": 1.5,
}
GOOD_ARDUPILOT = {
    "GUID_TIMEOUT": 1.0,
    "FS_GCS_ENABLE": 1.0,
    "FS_THR_ENABLE": 1.0,
    "FS_OPTIONS": 16.0,
    "FENCE_ACTION": 4.0,
    "BATT_FS_LOW_ACT": 2.0,
    "WPNAV_SPEED": 1000.0,
    "WPNAV_SPEED_UP": 250.0,
    "WPNAV_SPEED_DN": 150.0,
}
PX4, ARDUPILOT = PROFILES[Autopilot.PX4], PROFILES[Autopilot.ARDUPILOT]


def unsafe(values: dict[str, float]) -> str:
    return unsafe_for(PX4, values)


def severity(name: str, value: float) -> Severity:
    failsafe = next(each for each in PX4.judged if each.name == name)
    return verdict(failsafe, {name: value}).severity


def test_what_is_well_set_is_well() -> None:
    assert unsafe(GOOD) == ""
    assert {verdict(each, GOOD).severity for each in PX4.judged} == {Severity.INFO}


def test_px4_as_it_comes_can_be_flown_but_is_cautioned_about() -> None:
    usual = {each.name: SPECS[each.name].default for each in PX4.judged}
    assert unsafe(usual) == ""
    cautioned = {each.name for each in PX4.judged if verdict(each, usual).severity is Severity.WARNING}
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
        ("COM_RC_IN_MODE", 9),
        ("COM_RCL_EXCEPT", 32),
        ("COM_RCL_EXCEPT", -1),
        ("MPC_XY_VEL_MAX", 0.0),
        ("MPC_Z_VEL_MAX_DN", math.nan),
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
    assert "and 11 more" in unsafe({})


def test_a_late_loss_is_cautioned_about() -> None:
    assert severity("COM_OF_LOSS_T", 1.5) is Severity.WARNING


@given(name=st.sampled_from(sorted(GOOD)), value=st.floats())
def test_any_number_gets_a_verdict_in_words(name: str, value: float) -> None:
    failsafe = next(each for each in PX4.judged if each.name == name)
    judged = verdict(failsafe, {name: value})
    assert judged.means
    assert (judged.severity is Severity.INFO) or judged.remedy
    assert bool(unsafe(GOOD | {name: value})) is (judged.severity is Severity.ALARM)


def test_a_transmitter_that_is_excused_in_offboard_is_cautioned_about() -> None:
    assert severity("COM_RCL_EXCEPT", 4) is severity("COM_RCL_EXCEPT", 7) is Severity.WARNING
    assert severity("COM_RCL_EXCEPT", 3) is Severity.INFO


def test_speed_limits_are_the_vehicle_s_own_and_not_known_before_they_are_read() -> None:
    assert speed_limits(PX4, GOOD) == (12.0, 3.0, 1.5)
    assert speed_limits(ARDUPILOT, GOOD_ARDUPILOT) == pytest.approx((10.0, 2.5, 1.5))
    assert speed_limits(PX4, GOOD_ARDUPILOT) == speed_limits(None, GOOD) == (0.0, 0.0, 0.0)


def test_ardupilot_has_parameters_of_its_own_and_is_called_untested() -> None:
    assert unsafe_for(ARDUPILOT, GOOD_ARDUPILOT) == ""
    assert "GUID_TIMEOUT and 8 more" in unsafe_for(ARDUPILOT, GOOD)
    assert ARDUPILOT.label == "ArduPilot (untested)"
    assert PX4.label == "PX4"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("GUID_TIMEOUT", 3.1),
        ("GUID_TIMEOUT", 0.0),
        ("FS_GCS_ENABLE", 2),
        ("FS_OPTIONS", 64),
        ("BATT_FS_LOW_ACT", 5),
        ("FENCE_ACTION", 9),
        ("WPNAV_SPEED", 0.0),
    ],
)
def test_what_is_dangerous_on_ardupilot_is_refused(name: str, value: float) -> None:
    assert unsafe_for(ARDUPILOT, GOOD_ARDUPILOT | {name: float(value)}).startswith(f"{name} = {value:g} (")


def test_ardupilot_as_it_comes_can_be_flown_but_is_cautioned_about() -> None:
    """Defaults of ArduCopter 4.6."""
    usual = GOOD_ARDUPILOT | {
        "GUID_TIMEOUT": 3.0,
        "FS_GCS_ENABLE": 0.0,
        "FENCE_ACTION": 1.0,
        "BATT_FS_LOW_ACT": 0.0,
    }
    assert unsafe_for(ARDUPILOT, usual) == ""
    cautioned = {each.name for each in ARDUPILOT.judged if verdict(each, usual).severity is Severity.WARNING}
    assert cautioned == {"GUID_TIMEOUT", "FS_GCS_ENABLE", "BATT_FS_LOW_ACT"}


def test_another_autopilot_is_not_flown() -> None:
    assert profile_of(Autopilot.UNKNOWN) is None
    assert "neither PX4 nor ArduPilot" in unsafe_for(None, GOOD)


@pytest.mark.parametrize("profile", PROFILES.values(), ids=lambda each: each.name)
def test_what_bounds_the_speed_is_among_what_is_judged(profile) -> None:
    assert set(profile.speeds) <= {each.name for each in profile.judged}


@pytest.mark.parametrize("profile", PROFILES.values(), ids=lambda each: each.name)
def test_the_documentation_names_every_parameter_that_is_judged(profile) -> None:
    text = (Path(__file__).resolve().parents[1] / "docs" / "operating.md").read_text(encoding="utf-8")
    assert [each.name for each in profile.judged if f"`{each.name}`" not in text] == []


@pytest.mark.parametrize(
    ("profile", "firmware", "old"),
    [
        (PX4, "1.13.3", True),
        (PX4, "1.14.0", False),
        (PX4, "1.16.0 (beta)", False),
        (PX4, "2.0.0", False),
        (PX4, "", False),
        (PX4, "custom", False),
        (ARDUPILOT, "4.0.7", True),
        (ARDUPILOT, "4.6.1", False),
    ],
)
def test_a_firmware_older_than_what_is_known_is_outdated(profile, firmware: str, old: bool) -> None:
    assert outdated(profile, firmware) is old
