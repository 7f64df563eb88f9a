"""`groundstation excite`: what it refuses, what it plans, and one real flight with all processes."""

from __future__ import annotations

import argparse
import datetime
import json
import math
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from pymavlink import mavutil

from groundstation.cli import build_parser, main
from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.excite import Plan, planned_for, settings_for
from groundstation.identification.excitation import FADE_S
from groundstation.pilot.setpoint import SetpointMaker
from groundstation.pilot.shield.nearby import Candidates, Neighbourhood
from groundstation.pilot.surroundings import surroundings_of
from groundstation.recording import lanes, schema
from groundstation.review.flight import Flight

NARROW = """
schema = 1
name = "narrow"
title = "Between two walls"
[[obstacle]]
shape = "wall"
name = "east wall"
from = [3.15, -5.0]
to = [3.15, 5.0]
height = 10.0
"""


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def asked(*arguments: str) -> argparse.Namespace:
    return build_parser().parse_args(["excite", *arguments])


def planned(*arguments: str) -> Plan:
    return planned_for(asked(*arguments))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "say which, with --sim or --connect"),
        (("--connect", "udpin://0.0.0.0:14540"), "add --confirm-real"),
        (
            ("--connect", "udpin://0.0.0.0:14540", "--confirm-real", "--model", "dynamic"),
            "are the simulator's",
        ),
        (("--sim", "--axes", "forward,sideways"), "there is no 'sideways'"),
        (("--sim", "--amplitude", "0"), "give 0.05 to 1"),
        (("--sim", "--amplitude", "nan"), "give 0.05 to 1"),
        (("--sim", "--seconds", "inf"), "give 5 to 300"),
        (("--sim", "--band", "1,0.1"), "must rise"),
        (("--sim", "--band", "low"), "is not two numbers"),
        (("--sim", "--band", "0.1,nan"), "must rise"),
        (("--sim", "--band", "0.5,0.6"), "3 an axis are needed"),
        (("--sim", "--altitude", "80"), "is not a place to fly at"),
        (("--sim", "--altitude", "1"), "the floor is 0.5 m from the start at 1 m"),
        (("--sim", "--mission", "nowhere"), "no such mission"),
        (("--sim", "--airframe", "nothing"), "no such airframe"),
        (("--sim", "--config", "off.toml"), "only with the guard on"),
        (("--sim", "--config", "fence.toml"), "the fence is 1.0 m from the start"),
        (
            ("--sim", "--config", "ceiling.toml", "--altitude", "4"),
            "the ceiling is 0.5 m from the start at 4 m",
        ),
        (("--sim", "--mission", "narrow.toml"), "obstacle 'east wall' is 2.6 m from the start"),
    ],
)
def test_what_cannot_be_flown_is_refused_before_anything_starts(tmp_path, capsys, arguments, words):
    (tmp_path / "off.toml").write_text('[shield]\nguard = "off"\n')
    (tmp_path / "fence.toml").write_text("[shield]\nfence = 1.5\n")
    (tmp_path / "ceiling.toml").write_text("[shield]\nceiling = 4.5\n")
    (tmp_path / "narrow.toml").write_text(NARROW)
    with pytest.raises(SystemExit) as ended:
        main(["excite", *arguments])
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert words in told
    assert len(told.splitlines()) == 1
    assert not list((tmp_path / "logs").glob("*.rrd"))


def test_less_amplitude_fits_where_more_does_not(tmp_path):
    (tmp_path / "narrow.toml").write_text(NARROW)
    with pytest.raises(InputError, match="lower --amplitude"):
        planned("--sim", "--mission", "narrow.toml")
    found = planned("--sim", "--mission", "narrow.toml", "--amplitude", "0.1")
    assert max(found.room) < 2.6


def test_it_is_flown_with_the_guard_and_without_compensation():
    flown = settings_for(Settings())
    assert (flown.control.preset, flown.shield.guard) == ("assisted", "barrier")
    found = planned("--sim")
    run = found.run
    # The response is known, so without the switch the preset would compensate it.
    maker = SetpointMaker(run.settings, surroundings_of(run))
    assert surroundings_of(run).chi is not None
    assert not maker._compensates(maker_assistance())
    assert max(run.settings.control.k1) <= 0.6
    assert run.device.startswith("scripted:")


def maker_assistance():
    from groundstation.messages import Preset
    from groundstation.pilot.presets import PRESETS

    assert PRESETS[Preset.ASSISTED].compensation
    return PRESETS[Preset.ASSISTED]


def test_settings_that_are_gentler_stay():
    from msgspec.structs import replace

    gentle = Settings(control=replace(Settings().control, k1=(0.2, 0.3, 0.4, 0.5)))
    assert settings_for(gentle).control.k1 == (0.2, 0.3, 0.4, 0.5)


def test_a_fence_stands_around_the_start_that_the_plan_does_not_touch():
    found = planned("--sim", "--amplitude", "1")
    run = found.run
    mission = run.mission
    assert mission is not None
    assert mission.fence is not None
    known = surroundings_of(run)
    neighbourhood = Neighbourhood(known, run.settings.shield)
    x, y, z = 0.0, 0.0, mission.takeoff_altitude_m
    level, upright = found.room
    _, near = neighbourhood.look(Candidates(), (x + 1e-3, y, z), (), 50.0)
    gaps = {thing.name: thing.gap for thing in near}
    assert gaps["fence"] == pytest.approx(level, abs=0.01)
    assert gaps["ceiling"] == pytest.approx(upright)
    assert gaps["floor"] >= upright - 1e-9
    assert level > found.excursion > max(found.excitation.furthest()[:3])


def test_a_narrower_fence_of_the_settings_is_kept(tmp_path):
    (tmp_path / "wide.toml").write_text("[shield]\nfence = 5.3\nceiling = 9.0\nfloor = 1.5\n")
    mission = planned("--sim", "--config", "wide.toml").run.mission
    assert mission is not None
    assert mission.fence is not None
    assert mission.fence.radius <= 5.3
    assert 1.5 <= mission.fence.floor < mission.takeoff_altitude_m < mission.fence.ceiling <= 9.0


def test_where_the_response_is_not_known_the_worst_of_the_usual_counts():
    known = planned("--sim", "--airframe", "x500", "--model", "dynamic")
    unknown = planned("--sim", "--airframe", "x500", "--model", "rigid_body")
    assert surroundings_of(unknown.run).chi is None
    assert unknown.excursion > known.excursion


def test_a_real_vehicle_needs_no_mission():
    found = planned("--connect", "udpin://127.0.0.1:14999", "--confirm-real")
    mission = found.run.mission
    assert mission is not None
    assert (mission.name, mission.obstacle, mission.target) == ("excite", (), None)
    assert not found.run.simulated


ARGUMENTS = ("--sim", "--axes", "left", "--seconds", "8", "--band", "0.25,1")


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """A short excitation, flown by all processes: its recording, and what was said."""
    folder = tmp_path_factory.mktemp("flown")
    done = subprocess.run(
        [sys.executable, "-m", "groundstation.cli", "excite", *ARGUMENTS, "--logs", str(folder)],
        capture_output=True, text=True, timeout=150, check=False, cwd=Path(__file__).parents[1],
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return next(folder.glob("*_excite.rrd")), done


@pytest.mark.flight
@pytest.mark.timeout(180)
def test_an_excitation_is_flown_and_recorded_as_it_was_planned(flown):
    recording, done = flown
    assert "Ctrl-C: it holds and lands" in done.stderr
    assert f"groundstation identify {recording}" in done.stdout
    found, flight = planned(*ARGUMENTS), Flight(recording)
    assert flight.states(lanes.GUARD)[-1][1] == "lets pass"
    assert [word for _, word in flight.states(lanes.COMPENSATION)] == ["off"]
    assert flight.states(lanes.VEHICLE)[-1][1] == "disarmed"

    sines = found.excitation.stretches[0].signals[1]
    assert sines is not None
    grid = np.arange(0.0, sines.period, 0.02)
    engaged = next(t for t, word in flight.states(lanes.PHASE) if word == "engaged")
    sent, moved = (
        spectrum(held(flight.series(quantities[1]), engaged + 0.1 + FADE_S + grid))
        for quantities in (schema.REFERENCES, schema.EXECUTED)
    )
    on, beside = sines.lines, slice(2 * int(sines.lines.max()), None)
    wanted = sines.amplitudes * math.tau * sines.frequencies
    assert (sent[on] > 0.8 * wanted).all()
    assert sent[on].min() > 10 * sent[beside].max()
    assert moved[on].min() > 4 * moved[beside].max()

    t, p = flight.series(schema.POSITION)
    within = (t > engaged) & (t < engaged + found.excitation.duration)
    away = np.linalg.norm((p[within] - p[within][0])[:, :3], axis=1)
    assert 0.5 * max(found.excitation.furthest()[:3]) < away.max() < found.excursion


@pytest.mark.flight
@pytest.mark.timeout(180)
def test_the_mavlink_log_of_a_flight_opens_in_mavlink_tools(flown):
    """Every message is whole, in the order of time, of this hour, from both sides; mavlogdump sees the same."""
    recording, _ = flown
    path = recording.with_suffix(".tlog")
    started = datetime.datetime.fromisoformat(Flight(recording).properties()["started"]).timestamp()
    log = mavutil.mavlink_connection(str(path))
    kinds: dict[int, set[str]] = {}
    stamps: list[float] = []
    while (message := log.recv_match()) is not None:
        kinds.setdefault(message.get_srcSystem(), set()).add(message.get_type())
        stamps.append(message._timestamp)
    log.close()
    assert stamps == sorted(stamps)
    assert started - 0.1 < stamps[0] < stamps[-1] < started + 150.0
    assert set(kinds) == {1, 255}
    assert {"HEARTBEAT", "COMMAND_LONG", "SET_POSITION_TARGET_LOCAL_NED"} <= kinds[255]
    assert {"HEARTBEAT", "COMMAND_ACK", "LOCAL_POSITION_NED", "STATUSTEXT"} <= kinds[1]
    assert "BAD_DATA" not in kinds[1] | kinds[255]
    dumped = tool(
        "mavlogdump.py", "--format", "json", "--types", "LOCAL_POSITION_NED", str(path)
    ).splitlines()
    rows = [json.loads(line) for line in dumped]
    heights = [-row["data"]["z"] for row in rows if row["meta"]["type"] == "LOCAL_POSITION_NED"]
    assert len(heights) > 500
    assert max(heights) == pytest.approx(
        np.nanmax(Flight(recording).series(schema.POSITION).values[:, 2]), abs=0.05
    )
    assert {"TAKEOFF", "OFFBOARD", "LAND"} <= set(re.findall(r"[A-Z]+", tool("mavflightmodes.py", str(path))))


def tool(name: str, *arguments: str) -> str:
    command = [sys.executable, str(Path(sys.executable).with_name(name)), *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=100, check=True).stdout


def held(series, at):
    places = np.searchsorted(series.t, at, side="right") - 1
    return series.values[places, 0]


def spectrum(values):
    return np.abs(np.fft.rfft(values)) * 2 / len(values)


@pytest.mark.flight
@pytest.mark.timeout(180)
def test_ctrl_c_ends_it_landed_with_130(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "groundstation.cli", "excite", "--sim", "--logs", str(tmp_path)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=Path(__file__).parents[1],
    )  # fmt: skip
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if line == "flying\n":
                break
        else:
            pytest.fail("it did not come to fly")
        time.sleep(2.0)  # In the middle of a stretch.
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "NOT flown to its end: stopped by the operator" in out
    assert err.index("letting go\n") < err.index("landing\n")
    flight = Flight(next(tmp_path.glob("*_excite.rrd")))
    assert flight.states(lanes.VEHICLE)[-1][1] == "disarmed"
