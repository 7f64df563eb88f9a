"""A recording holds all that a tick was made from: the same servo on it decides the same, to the last bit."""

from __future__ import annotations

import json
import lzma
import math
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from replay_support import Flown

from drivers.stick import StickSender
from drivers.virtual import VirtualHandle
from groundstation import cli
from groundstation.config import Settings
from groundstation.messages import CommandKind, Cue, FlightMode, MappingMode, Preset
from groundstation.recording import lanes, schema
from groundstation.replay.again import Again, run_of
from groundstation.replay.comparing import Difference, Said, differences
from groundstation.replay.ticks import ticks_of
from groundstation.review.flight import Flight, Series

RECORDINGS = Path(__file__).parent / "recordings"


def differing(path: Path, settings: Settings | None = None) -> list[Difference]:
    """Return where today's servo differs on a recording; with other settings where told."""
    flight = Flight(path)
    again = Again(flight, run_of(flight, settings or flight.settings, "paper"))
    said = Said(flight.start)
    for _, batch in again.batches():
        said.add(batch)
    return differences(flight, said, again.ticks.t)


def fly_about(flown: Flown) -> None:
    """Engage, choose this and that, meet a wall, and be uncoupled in every way."""
    hand, now = flown.device, lambda: flown.tick_number * 1e-3

    def move() -> None:
        t = now()
        hand.position = (0.03 * math.sin(t) + 0.01, 0.02 * math.sin(1.7 * t), 0.01 * math.cos(2.0 * t))
        hand.velocity = (0.03 * math.cos(t), 0.034 * math.cos(1.7 * t), -0.02 * math.sin(2.0 * t))
        hand.yaw = 0.2 * math.sin(0.9 * t)

    def rest() -> None:
        hand.position, hand.velocity, hand.yaw = (0.0,) * 3, (0.0,) * 3, 0.0

    def moving(seconds: float) -> None:
        for _ in range(round(seconds * 1000)):
            flown.tick(1, move)

    flown.command(CommandKind.ENGAGE)
    flown.run(0.3)
    flown.engage()
    moving(0.7)
    for kind, value in (
        (CommandKind.PRESET, Preset.PAPER), (CommandKind.FINE, 1), (CommandKind.CUES, Cue.POSITION | Cue.GUARD),
        (CommandKind.CLUTCH, 1), (CommandKind.CLUTCH, 0), (CommandKind.MAPPING, MappingMode.POSITION),
        (CommandKind.PRESET, 9), (CommandKind.PRESET, Preset.TRAINING),
    ):  # fmt: skip
        flown.command(kind, value)
        moving(0.15)
    # Two in one tick, and buttons: clutch, turn left, the mapping's.
    flown.command(CommandKind.FINE, 0)
    flown.command(CommandKind.PRESET, Preset.TRANSPARENT)
    for buttons in (1, 4, 16, 0):
        hand.buttons = buttons
        moving(0.1)
    # Late ticks, a state that the vehicle does not trust, one that cannot be, and a reboot.
    for dt in (2, 7, 1, 3):
        flown.tick(dt, move)
    flown.state.valid = 0
    moving(0.1)
    flown.state.valid = 1
    rest()
    flown.engage()
    moving(0.4)
    flown.state.velocity[1] = math.nan
    moving(0.05)
    flown.state.velocity[1], flown.state.position[1] = 0.3, -0.1
    rest()
    flown.engage()
    moving(0.2)
    flown.state.boot_t = 1.0
    moving(0.1)
    # The link is lossy, then gone; the operator ends it; the vehicle is taken over.
    flown.status.rtt, flown.status.loss = 0.35, 0.2
    rest()
    flown.engage()
    moving(0.3)
    flown.command(CommandKind.HOLD)
    moving(0.1)
    flown.status.rtt = math.nan
    rest()
    flown.engage()
    moving(0.1)
    flown.status.mode = FlightMode.RETURN
    moving(0.2)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    flown = Flown(tmp_path_factory.mktemp("about") / "flight")
    flown.run(0.1)
    fly_about(flown)
    flown.device.silent = True
    flown.run(0.4)
    flown.device.silent = False
    flown.device.position, flown.device.velocity, flown.device.yaw = (0.0,) * 3, (0.0,) * 3, 0.0
    flown.run(0.6)
    flown.engage()
    flown.run(0.1)
    flown.command(CommandKind.DISENGAGE)
    flown.run(0.05)
    return flown.close()


def test_the_same_servo_decides_the_same_on_what_was_recorded(recording):
    flight = Flight(recording)
    phases = [word for _, word in flight.states(lanes.PHASE)]
    assert phases.count("engaged") + phases.count("on leash") >= 6, "it was to be coupled again and again"
    assert len(flight.texts("/pilot/reason")) >= 5
    assert np.isfinite(flight.series(schema.UNTRUSTED).values).all()
    assert differing(recording) == []


def test_ticks_come_back_as_the_servo_had_them(recording):
    ticks = ticks_of(Flight(recording))
    assert ticks.ending == ""
    assert sorted(set(ticks.rows[:, 1].tolist())) == [0.001, 0.002, 0.003, 0.007]
    assert (np.diff(ticks.t) > 0).all()
    assert set(ticks.rows[:, 3].tolist()) == {0.0, 1.0}


def test_a_changed_gain_is_found_at_the_first_tick_that_it_matters_to(recording):
    """That is where the hand is engaged first: until then nothing is flown, and no gain is in effect."""
    flight = Flight(recording)
    control = flight.settings.control
    changed = msgspec.structs.replace(control, k1=(*control.k1[:3], control.k1[3] + 1e-12))
    found = differing(recording, msgspec.structs.replace(flight.settings, control=changed))
    engaged = next(t for t, word in flight.states(lanes.PHASE) if word in {"engaged", "on leash"})
    assert found[0].t - flight.start == pytest.approx(engaged, abs=1e-9)
    assert found == sorted(found, key=lambda each: each.t)
    names = {each.what for each in found}
    assert "/pilot/k1 yaw" in names
    assert not any(name.startswith(("/handle/position", "/handle/age", "/state/phase")) for name in names)


def test_an_on_screen_stick_that_falls_silent_replays_the_same(tmp_path):
    """With the real driver: its filter, its silence, its samples that are older than the tick."""
    socket = str(tmp_path / "hand.sock")
    flown = Flown(tmp_path / "flight", lambda clock: VirtualHandle(socket, clock))
    stick = StickSender(socket)

    def hold(seconds: float, x: float = 0.0, buttons: int = 0) -> None:
        for _ in range(round(seconds * 100)):
            stick.send((x, 0.2 * x, 0.0), 0.0, buttons, flown.now)
            flown.run(0.01)

    def engage() -> None:
        flown.status.mode, flown.status.streaming = FlightMode.HOLD, 0
        hold(0.2)
        flown.command(CommandKind.ENGAGE)
        hold(0.2)
        flown.status.mode, flown.status.streaming = FlightMode.OFFBOARD, 2
        hold(0.2)

    hold(1.2)
    engage()
    hold(0.6, 0.06)
    hold(0.1, 0.06, 1)
    flown.run(0.6)
    hold(1.0)
    engage()
    hold(0.3, -0.04)
    stick.close()
    flown.device.close()
    path = flown.close()
    phases = [word for _, word in Flight(path).states(lanes.PHASE)]
    assert sum(word in {"engaged", "on leash"} for word in phases) >= 2
    assert differing(path) == []


ACTS = st.sampled_from(["run", "silent", "deaf", "another", "unhomed", "engage", "move", "invalid", "late"])


@settings(max_examples=5, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(ACTS, min_size=3, max_size=9), st.integers(0, 40))
def test_whatever_device_and_vehicle_do_it_replays_the_same(tmp_path_factory, acts, opening):
    flown = Flown(tmp_path_factory.mktemp("any") / "flight", opening=opening)
    for act in acts:
        hand = flown.device
        hand.silent = act == "silent"
        hand.deaf = act == "deaf"
        hand.another = act == "another"
        hand.homed = act != "unhomed"
        flown.state.valid = act != "invalid"
        if act == "engage":
            hand.position = (0.0, 0.0, 0.0)
            flown.engage()
        elif act == "late":
            flown.run(0.2, dt=4)
        elif act == "another":
            hand.silent = True
            flown.run(0.55)
            hand.silent = False
        elif act == "move":
            hand.position, hand.velocity = (0.02, -0.01, 0.005), (0.1, 0.0, 0.0)
        flown.run(0.15)
    assert differing(flown.close()) == []


def run(capsys, *arguments) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as end:
        cli.main(["replay", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


def test_the_command_says_identical(recording, capsys):
    code, out, err = run(capsys, recording, "--check")
    assert (code, err) == (0, "")
    assert out.startswith("identical: ")
    assert "recorded with " in out
    code, out, _ = run(capsys, recording, "--check", "--json")
    told = json.loads(out)
    assert (code, told["identical"], told["differences"]) == (0, True, [])
    assert told["ticks"] == len(ticks_of(Flight(recording)).t)
    assert told["coupled"] == 6


def test_the_command_says_where_it_first_differs(recording, capsys, monkeypatch):
    """As when another version decides otherwise: here one whose force fades more slowly."""
    monkeypatch.setattr("groundstation.pilot.pilot.FADE_S", 0.09)
    code, out, _ = run(capsys, recording, "--check")
    assert code == 1
    assert out.startswith("different at tick ")
    assert "/handle/force" in out.splitlines()[0]
    code, out, _ = run(capsys, recording, "--check", "--json")
    told = json.loads(out)
    assert (code, told["identical"]) == (1, False)
    first = told["differences"][0]
    assert first["what"].startswith("/handle/force")
    ticks = ticks_of(Flight(recording)).t
    assert ticks[first["tick"] - 1] - Flight(recording).start == pytest.approx(first["t"], abs=1e-9)


def test_a_number_that_differs_in_its_last_bit_is_found(recording):
    """Of what the recording says that the servo said: the check must read all of it."""
    flight = Flight(recording)
    series = Flight.series
    quantities = (*schema.REFERENCES, schema.P_H, schema.STOP, schema.HANDLE_FORCE, schema.PUSH)
    for odd in quantities:

        def altered(self: Flight, quantity: schema.Quantity, odd: schema.Quantity = odd) -> Series:
            t, values = series(self, quantity)
            if quantity is odd:
                place = np.flatnonzero(np.isfinite(values[:, 0]))[-1]
                values = values.copy()
                values[place, 0] = np.nextafter(values[place, 0], np.inf)
            return Series(t, values)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(Flight, "series", altered)
            (found,) = differing(recording)
        assert found.what == f"{odd.path} {odd.parts[0]}"
        assert float(found.now) == np.nextafter(float(found.recorded), -np.inf)
    assert flight.texts("/events/pilot")


def test_another_choice_of_settings_is_told_where_it_decides_otherwise(recording, capsys):
    code, out, _ = run(capsys, recording, "--check", "--set", "control.stiffness=[8,8,8]", "--json")
    first = json.loads(out)["differences"][0]
    assert code == 1
    assert first["what"].startswith(("/pilot", "/handle/force"))


def test_a_recording_that_lacks_ticks_is_checked_up_to_there(tmp_path, capsys):
    flown = Flown(tmp_path / "gap")
    flown.run(0.1)
    flown.engage()
    flown.device.position = (0.02, 0.0, 0.0)
    flown.run(0.3)
    flown.take()
    flown.run(0.05)
    # The recorder was held up: this is never seen.
    flown.lose()
    flown.run(0.3)
    path = flown.close()
    code, out, _ = run(capsys, path, "--check")
    assert code == 0
    assert out.startswith("identical: ")
    assert "lacks ticks after " in out


def test_a_recording_without_the_first_ticks_cannot_be_checked(tmp_path, capsys):
    flown = Flown(tmp_path / "late", recorded_from=70)
    flown.run(0.3)
    code, _, err = run(capsys, flown.close(), "--check")
    assert code == 2
    assert "begins at the servo's tick " in err
    assert len(err.splitlines()) == 1


def test_a_recording_that_did_not_end_properly_is_checked_but_for_its_end(recording, tmp_path, capsys):
    path = tmp_path / "cut.rrd"
    content = recording.read_bytes()
    path.write_bytes(content[: len(content) * 9 // 10])
    code, out, _ = run(capsys, path, "--check")
    assert (code, "did not end properly" in out) == (0, True), out


def test_a_recording_of_an_earlier_schema_says_so(tmp_path, capsys):
    path = tmp_path / "old.rrd"
    path.write_bytes(lzma.decompress((RECORDINGS / "flight_v1.rrd.xz").read_bytes()))
    code, _, err = run(capsys, path, "--check")
    assert code == 2
    assert "before schema 4" in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    "option", ["--wind=calm", "--seed=0", "--model=kinematic", "--channel=delay=0.1", "--rerun"]
)
def test_what_changes_the_world_does_not_go_with_a_check(recording, capsys, option):
    code, _, err = run(capsys, recording, "--check", option)
    assert code == 2
    assert "--check flies nothing" in err
