"""Hostile inputs at the operator's side, the short form; the long one is `python -m bench fuzz_station`."""

import random

import pytest

from bench.fuzz_station import BrokenError, _sound, gate, random_settings, station
from groundstation.config import Settings


def test_hostile_hands_vehicles_and_settings_give_no_nan_and_no_speed_over_a_limit() -> None:
    flown = station(25_000, seed=1)
    assert flown.inputs >= 25_000
    assert flown.settings >= 5
    assert flown.engaged > 1_000
    assert flown.setpoints > 50


def test_of_hostile_frames_no_kill_leaves_that_was_not_confirmed() -> None:
    passed = gate(30_000, seed=2)
    assert passed.frames >= 30_000
    assert passed.kills > 0
    assert passed.left < 0.5 * passed.frames


def test_settings_are_drawn_from_all_there_are() -> None:
    rng = random.Random(3)
    drawn = [random_settings(rng) for _ in range(200)]
    assert len({each.limits for each in drawn}) > 50
    assert {each.control.passivity for each in drawn} == {"observer", "wave", "tank", "off"}
    assert Settings().safety in {each.safety for each in drawn}


def test_what_reads_the_frames_would_see_a_kill() -> None:
    from pymavlink.dialects.v20 import common as m

    kill = m.MAVLink_command_long_message(1, 1, 400, 0, 0.0, 21196.0, *[0.0] * 5)
    frame = kill.pack(m.MAVLink(None, srcSystem=255, srcComponent=190))
    assert _sound(frame, killing=True)
    with pytest.raises(BrokenError, match="not meant"):
        _sound(frame, killing=False)
