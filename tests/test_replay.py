"""A recorded hand flies once more: the same on the same version, otherwise where something is changed."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.arm import ArmState
from drivers.device import ZERO3
from groundstation import cli
from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import OperatorHand
from groundstation.evaluation.local_site import handle_at
from groundstation.evaluation.trial import scenario_of
from groundstation.pilot.chooser import beginning
from groundstation.pilot.sight import ZERO4, VehicleSample
from groundstation.recording import schema
from groundstation.recording.session import Session
from groundstation.replay.changes import changed
from groundstation.replay.flying import Pace
from groundstation.replay.hand import RecordedHand
from groundstation.replay.records import ReplayRecorder
from groundstation.review.flight import Flight
from groundstation.review.recorded_series import recorded_series
from groundstation.run import Run
from groundstation.training.director import Director
from groundstation.training.mission import find_mission, load_mission
from sim.environment.world import World
from sim.operator import Operator

SECONDS = 12.0


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A virtual flight of the paper's mission by a simulated hand, recorded."""
    mission = load_mission(find_mission("paper"))
    settings = Settings()
    run = Run(
        run_id="1-flown",
        url="virtual",
        simulated=True,
        device="scripted",
        mission=mission,
        mission_path="",
        settings=settings,
        log=str(tmp_path_factory.mktemp("flown") / "flight"),
        viewer_url="",
        started="2026-11-26T10:00:00.000+00:00",
        seed=3,
    )
    session = Session(run, 0.0, lambda _severity, text: pytest.fail(text))
    setup = Setup(scenario_of(mission, mission.wind), mission.takeoff_altitude_m, settings, seed=3)
    operator = Operator(mission.route, mission.target.position, seed=3)
    watchers: list = []
    flight = VirtualFlight(
        setup,
        lambda mapping, _: OperatorHand(operator, mapping),
        (lambda sample: [watch(sample) for watch in watchers],),
    )
    director = Director(mission, World(mission.obstacle), flight.vehicle.airframe.radius)
    choices = beginning(settings).choices
    recorder = ReplayRecorder(session, flight.local.pilot, choices, director, handle_at(1000.0))
    watchers.append(recorder)
    flight.fly(SECONDS)
    recorder.flush()
    session.close()
    return run.recording


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["replay", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


def as_json(capsys, *arguments):
    code, out, err = run(capsys, *arguments, "--json")
    assert code == 0, err
    return json.loads(out)


def test_the_same_hand_flies_nearly_the_same_way(flown, capsys):
    """Nearly: 50 Hz of the handle were recorded, and the arm was moved by it between them."""
    told = as_json(capsys, flown)
    figures = told["figures"]
    assert figures["ways apart, largest (m)"]["replayed"] < 0.2
    way = figures["way flown (m)"]
    assert way["replayed"] == pytest.approx(way["recorded"], rel=0.05)
    assert told["collisions"] == 0
    assert told["speed"] > 1.0


def test_twice_the_same_decisions_and_others_when_something_is_changed(flown, capsys):
    first, again = (as_json(capsys, flown)["decisions"] for _ in range(2))
    assert first == again
    changes = (
        ("--set", "control.k1=[0.5,0.5,0.5,0.5]"),
        ("--preset", "transparent"),
        ("--channel", "delay=0.1"),
        ("--wind", "calm"),
        ("--seed", "4"),
    )
    others = {as_json(capsys, flown, *change)["decisions"] for change in changes}
    assert len(others) == len(changes)
    assert first not in others


def test_it_writes_a_recording_that_reads_back(flown, tmp_path, capsys):
    out = tmp_path / "what_if.rrd"
    code, told, _ = run(capsys, flown, "--preset", "paper", "--out", out)
    assert (code, str(out) in told) == (0, True)
    series = recorded_series(Flight(out))
    assert series.t[-1] == pytest.approx(recorded_series(Flight(flown)).t[-1], abs=0.1)
    assert Flight(out).settings.control.preset == "paper"
    assert np.isfinite(Flight(out).series(schema.CLEARANCE).values).all()
    assert Flight(out).series(schema.FORCE_SIZE).values[-1, 1] == handle_at(1000.0).force_limit
    assert run(capsys, flown, "--out", out)[0] == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.rrd"], "no such recording"),
        (["FILE", "--speed", "0.5"], "give 1 to 100"),
        (["FILE", "--set", "control.k9=1"], "is no setting"),
        (["FILE", "--set", "control"], "is no setting"),
        (["FILE", "--set", "control.k1=abc"], "control.k1"),
        (["FILE", "--set", "control.k1=[1,2,3,-4]"], "control.k1"),
        (["FILE", "--channel", "loss=2"], "--channel: loss=2"),
        (["FILE", "--airframe", "zeppelin"], "no such airframe"),
        (["FILE", "--controller", "odd"], "nor MODULE:CLASS"),
        (["FILE", "--out", "x.html"], "name an .rrd file"),
    ],
)
def test_what_is_wrong_is_one_sentence(flown, capsys, arguments, words):
    code, _, err = run(capsys, *(str(flown) if word == "FILE" else word for word in arguments))
    assert code == 2
    assert words in err
    assert len(err.strip().splitlines()) == 1


def test_a_flight_that_was_never_coupled_has_nothing_to_replay(tmp_path, flown, capsys):
    source = Flight(flown)
    run_ = Run(
        run_id="1-idle", url="", simulated=True, device="", mission=source.mission, mission_path="",
        settings=source.settings, log=str(tmp_path / "idle"), viewer_url="", started="2026-11-26T10:00:00+00:00",
    )  # fmt: skip
    Session(run_, 0.0, lambda _severity, text: pytest.fail(text)).close()
    code, _, err = run(capsys, tmp_path / "idle.rrd")
    assert (code, "never coupled" in err) == (2, True)


@pytest.mark.parametrize("channel", ["loss=0.9", "delay=3"])
def test_a_channel_over_which_nothing_is_coupled_is_told(flown, capsys, channel):
    code, out, err = run(capsys, flown, "--channel", channel)
    assert (code, out) == (1, "")
    assert "never coupled" in err


def a_hand():
    t = np.arange(0.0, 1.0, 0.01)
    position = np.column_stack((0.01 * t, -t, t))
    return RecordedHand(t, position, np.ones_like(position), 0.1 * t)


def test_the_recorded_hand_rests_until_it_is_coupled_then_plays_and_lets_go():
    hand = a_hand()
    rest = ArmState()
    assert hand.step(rest, 0.5, ZERO3, 0.0, (9.0, 9.0, 9.0)) == rest
    hand.decide(5.0, VehicleSample(ZERO4, ZERO4))
    moved = hand.step(rest, 0.505, ZERO3, 0.0, (9.0, 9.0, 9.0))
    assert moved.position == pytest.approx((0.005, -0.5, 0.5))
    assert moved.yaw == pytest.approx(0.05)
    assert not hand.done
    assert hand.step(moved, 0.6, ZERO3, 0.0, ZERO3) == rest
    assert hand.done


@given(st.sampled_from(["k1=[1,1,1,1]", "stiffness=[2.0,2.0,2.0]", 'preset="paper"', "preset=paper"]))
def test_a_setting_is_changed_and_nothing_else(change):
    before = Settings()
    after = changed(before, [f"control.{change}"])
    assert after.mapping == before.mapping
    assert after.shield == before.shield
    assert after.control != before.control


@given(st.text(max_size=30))
def test_any_words_change_a_setting_or_are_refused(words):
    try:
        assert isinstance(changed(Settings(), [words]), Settings)
    except InputError as error:
        assert "--set" in str(error)


def test_the_pace_waits_for_the_time_of_a_sample():
    now, waited = [100.0], []

    def sleep(seconds):
        waited.append(seconds)
        now[0] += seconds

    class Sample:
        def __init__(self, t):
            self.t = t

    pace = Pace(10.0, lambda: now[0], sleep)
    for t in (3.0, 4.0, 5.0):
        pace(Sample(t))
    now[0] += 1.0
    pace(Sample(6.0))
    assert waited == pytest.approx([0.1, 0.1])
