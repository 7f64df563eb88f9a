"""A recorded hand flies once more: the same on the same version, otherwise where something is changed."""

from __future__ import annotations

import json

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recording_support import a_run

from drivers.arm import ArmState
from drivers.device import ZERO3
from groundstation import cli
from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import OperatorHand
from groundstation.evaluation.local_site import handle_at
from groundstation.evaluation.trial import scenario_of
from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    HANDLE,
    Command,
    CommandAnswer,
    CommandKind,
    Handle,
    Preset,
)
from groundstation.pilot.choices import Choices
from groundstation.pilot.sight import ZERO4, VehicleSample
from groundstation.recording import schema
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.replay.changes import changed
from groundstation.replay.choosing import Change, chosen_over
from groundstation.replay.flying import Pace
from groundstation.replay.hand import RecordedHand, Stretch
from groundstation.replay.records import ReplayRecorder
from groundstation.review.flight import Flight
from groundstation.review.recorded_series import recorded_series
from groundstation.run import Run
from groundstation.training.director import Director
from groundstation.training.mission import find_mission, load_mission
from sim.environment.world import World
from sim.operator import Operator as Person

SECONDS = 12.0


class Switching:
    """An operator who lets go for a while, and moves finely from a moment on; time is the flight's."""

    def __init__(self):
        self.flight = None

    def couples(self):
        return self.flight is None or not 6.0 < self.flight.t < 8.0

    def choices(self):
        return Choices(fine=self.flight is not None and self.flight.t > 10.0)


def recorded(log, operator=None):
    """Fly in virtual time and return the recording."""
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
        log=str(log),
        viewer_url="",
        started="2026-11-26T10:00:00.000+00:00",
        seed=3,
    )
    session = Session(run, 0.0, lambda _severity, text: pytest.fail(text))
    scenario = scenario_of(mission, mission.wind)
    setup = Setup(scenario, mission.takeoff_altitude_m, settings, seed=3, operator=operator)
    person = Person(mission.route, mission.target.position, seed=3)
    watchers: list = []
    flight = VirtualFlight(
        setup,
        lambda mapping, _: OperatorHand(person, mapping),
        (lambda sample: [watch(sample) for watch in watchers],),
    )
    director = Director(mission, World(mission.obstacle), flight.vehicle.airframe.radius)
    recorder = ReplayRecorder(session, flight.local, director, handle_at(1000.0))
    watchers.append(recorder)
    if operator is not None:
        operator.flight = flight
    flight.fly(SECONDS)
    recorder.flush()
    if operator is not None:
        said = Batch()
        said.add(COMMAND, [Command(t=10.0, number=1, kind=CommandKind.FINE, value=1)])
        said.add(COMMAND_ANSWER, [CommandAnswer(t=10.0, number=1, kind=CommandKind.FINE, ok=1)])
        session.take(said)
    session.close()
    return run.recording


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A recording of a virtual flight: twelve seconds of the paper's mission."""
    return recorded(tmp_path_factory.mktemp("flown") / "flight")


@pytest.fixture(scope="module")
def switched(tmp_path_factory):
    """A recording with a release, a second coupling, and a choice in flight."""
    return recorded(tmp_path_factory.mktemp("switched") / "flight", Switching())


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


def test_every_stretch_and_every_choice_is_flown_again(switched, capsys):
    told = as_json(capsys, switched)["figures"]
    assert told["coupled for (s)"]["replayed"] == pytest.approx(told["coupled for (s)"]["recorded"], abs=0.3)
    assert told["ways apart, largest (m)"]["replayed"] < 0.3
    assert [change.choices.fine for change in chosen_over(Flight(switched), Settings())][-2:] == [False, True]


def test_what_is_asked_for_is_not_chosen_away_again(tmp_path):
    source = a_run(tmp_path / "flight")
    session = Session(source, 0.0, lambda _severity, text: pytest.fail(text))
    commands = [
        (1, CommandKind.PRESET, Preset.TRAINING, 1),
        (2, CommandKind.CLUTCH, 1, 0),
        (3, CommandKind.FINE, 1, 1),
    ]
    said = Batch()
    for number, kind, value, ok in commands:
        said.add(COMMAND, [Command(t=float(number), number=number, kind=kind, value=value)])
        said.add(COMMAND_ANSWER, [CommandAnswer(t=float(number), number=number, kind=kind, ok=ok)])
    said.add(
        HANDLE, [Handle(t=t, buttons=buttons, present=1) for t, buttons in ((0.5, 0), (5.0, 1), (6.0, 0))]
    )
    session.take(said)
    session.close()
    flight = Flight(source.recording)
    buttons = msgspec.structs.replace(source.settings.buttons, clutch=0)
    settings = msgspec.structs.replace(source.settings, buttons=buttons)
    last = chosen_over(flight, settings)[-1]
    assert (last.t, last.choices.preset, last.choices.fine, last.choices.clutched) == (
        6.0,
        Preset.TRAINING,
        True,
        False,
    )
    assert [c.choices.clutched for c in chosen_over(flight, settings)] == [
        False,
        False,
        False,
        False,
        True,
        False,
    ]
    paper = changed(settings, ['control.preset="paper"'])
    assert {change.choices.preset for change in chosen_over(flight, paper)} == {Preset.PAPER}


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
    changes = [Change(-1.0, Choices()), Change(0.2, Choices(fine=True))]
    spans = [Stretch(0.0, 0.4), Stretch(0.6, 0.99)]
    return RecordedHand(t, position, np.ones_like(position), 0.1 * t, stretches=spans, changes=changes)


def test_the_recorded_hand_rests_until_it_is_coupled_then_plays_and_lets_go():
    hand = a_hand()
    rest = ArmState()
    assert (hand.couples(), hand.choices().fine) == (True, False)
    assert hand.step(rest, 0.5, ZERO3, 0.0, (9.0, 9.0, 9.0)) == rest
    hand.decide(5.0, VehicleSample(ZERO4, ZERO4))
    moved = hand.step(rest, 0.505, ZERO3, 0.0, (9.0, 9.0, 9.0))
    assert moved.position == pytest.approx((0.005, -0.5, 0.5))
    assert moved.yaw == pytest.approx(0.05)
    assert not hand.done
    # Between its two stretches, and after the operator has chosen.
    assert not hand.couples()
    assert hand.choices().fine
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
