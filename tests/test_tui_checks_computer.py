"""This computer's own battery, from files as Linux shows them."""

import math

import pytest

from groundstation.messages import Severity
from groundstation.tui.checks_computer import discharging, judged


def battery(folder, name, capacity, status="Discharging", scope=None):
    (folder / name).mkdir()
    (folder / name / "capacity").write_text(f"{capacity}\n")
    (folder / name / "status").write_text(f"{status}\n")
    if scope:
        (folder / name / "scope").write_text(f"{scope}\n")


def test_the_emptiest_that_is_being_emptied_counts(tmp_path):
    (tmp_path / "AC").mkdir()
    (tmp_path / "AC" / "online").write_text("0\n")
    battery(tmp_path, "BAT0", 80)
    battery(tmp_path, "BAT1", 41)
    assert discharging(tmp_path) == 41.0


@pytest.mark.parametrize(("status", "scope"), [("Charging", None), ("Full", None), ("Discharging", "Device")])
def test_one_that_is_charged_and_a_mouses_do_not_count(tmp_path, status, scope):
    battery(tmp_path, "BAT0", 5, status, scope)
    assert math.isnan(discharging(tmp_path))


def test_what_cannot_be_read_is_not_known(tmp_path):
    battery(tmp_path, "BAT0", "none")
    assert math.isnan(discharging(tmp_path))
    assert math.isnan(discharging(tmp_path / "nosuch"))


@pytest.mark.parametrize(
    ("left", "severity"),
    [(math.nan, Severity.INFO), (80.0, Severity.INFO), (50.0, Severity.WARNING), (15.0, Severity.ALARM)],
)
def test_half_is_told_and_nearly_nothing_is_not_flown(left, severity):
    check = judged(left)
    assert check.severity is severity
    assert bool(check.remedy) is (severity is not Severity.INFO)
