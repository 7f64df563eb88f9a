"""Recordings read back: whole, unfinished, cut anywhere, or not recordings at all."""

from __future__ import annotations

import lzma
import math
from pathlib import Path

import numpy.testing as npt
import pytest
from recording_support import a_handle, a_pilot_state, a_run, a_status, a_vehicle_state

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.messages import (
    EVENT,
    HANDLE,
    HEARTBEAT,
    PILOT_STATE,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Event,
    FlightMode,
    Heartbeat,
    Severity,
)
from groundstation.recording import lanes, schema
from groundstation.recording.batch import Batch
from groundstation.recording.parts import is_growing
from groundstation.recording.session import Session
from groundstation.review.choosing import chosen
from groundstation.review.earlier import settings_from
from groundstation.review.flight import Flight
from groundstation.review.listing import list_flights
from groundstation.review.rrd import is_whole, mend, open_reader
from groundstation.review.show import review
from groundstation.review.table import list_all

WINDOW = {"DISPLAY": ":0"}
RECORDINGS = Path(__file__).parent / "recordings"


def a_batch(first: float, seconds: int) -> Batch:
    batch = Batch()
    batch.add(HANDLE, [a_handle(first + i * 1e-3, i) for i in range(seconds * 1_000)])
    batch.add(PILOT_STATE, [a_pilot_state(first + i * 0.02) for i in range(seconds * 50)])
    batch.add(VEHICLE_STATE, [a_vehicle_state(first + i * 0.02) for i in range(seconds * 50)])
    batch.add(VEHICLE_STATUS, [a_status(first, mode=FlightMode.HOLD), a_status(first + 0.5)])
    batch.add(EVENT, [Event(t=first + 0.25, severity=Severity.ALARM, source=b"link", text=b"Lost.")])
    beats = [Heartbeat(t=first + i, role=b"recorder", pid=1) for i in range(seconds + 1)]
    batch.add(HEARTBEAT, beats)
    return batch


def record(folder, name: str = "flight", *, mission: bool = True, seconds: int = 2):
    """Record a made-up flight, without a process, and return its file."""
    run = a_run(folder / name, mission=mission)
    told: list[str] = []
    session = Session(run, 0.0, lambda _severity, text: told.append(text))
    for second in range(seconds):
        session.take(a_batch(float(second), 1))
    session.close()
    assert told == []
    return run.recording


@pytest.fixture(scope="module")
def flight_file(tmp_path_factory):
    return record(tmp_path_factory.mktemp("flights"))


@pytest.fixture
def unfinished(flight_file, tmp_path):
    """Return a recording without its end, cut in the middle of its last rows."""
    path = tmp_path / "unfinished.rrd"
    content = flight_file.read_bytes()
    path.write_bytes(content[: len(content) * 3 // 4])
    return path


def test_a_flight_reads_as_it_was_recorded(flight_file):
    flight = Flight(flight_file)
    t, values = flight.series(schema.HANDLE_FORCE)
    assert values.shape == (2_000, 3)
    npt.assert_allclose(t[[0, -1]], [0.0, 1.999], atol=1e-9)
    npt.assert_allclose(values[999], (0.999, 2.0, -3.0))
    assert flight.states(lanes.MODE) == [(0.0, "hold"), (0.5, "offboard"), (1.0, "hold"), (1.5, "offboard")]
    assert flight.events()[0] == (0.25, "ERROR", "link", "Lost.")
    assert math.isclose(flight.duration, 2.0, abs_tol=1e-9)
    assert flight.mission
    assert flight.mission.name == "paper"


def test_what_was_never_recorded_is_empty_and_of_the_right_width(flight_file):
    flight = Flight(flight_file)
    assert flight.series(schema.SERVO_LATE).values.shape == (0, 3)
    assert flight.states(lanes.DEVICE_STATE) == []
    assert flight.properties(schema.DEVICE) == {}


def test_a_recording_of_the_first_schema_still_opens_and_reads(tmp_path):
    """Made by version 0.1.0, a tenth of a second of the same made-up flight as here."""
    path = tmp_path / "old.rrd"
    path.write_bytes(lzma.decompress((RECORDINGS / "flight_v1.rrd.xz").read_bytes()))
    assert is_whole(open_reader(path))
    (entry,) = list_flights(tmp_path)
    assert entry.mission == "paper"
    assert Flight(entry.path).duration == pytest.approx(0.1)
    assert review(path, environment=WINDOW, spawn=lambda _: 0) == 0
    flight = Flight(path)
    assert flight.properties()["schema"] == 1
    assert flight.series(schema.HANDLE_FORCE).values.shape == (20, 3)
    assert flight.series(schema.ERROR).values[0] == pytest.approx((0.5, 1.0, 0.5, 0.1))
    assert flight.states(lanes.PHASE) == [(0.0, "engaged")]
    assert flight.events()[0] == (0.05, "ERROR", "link", "Lost.")
    assert flight.mission
    assert flight.mission.name == "paper"
    # What there was not yet is empty; what there was is called as today.
    assert flight.series(schema.V_SAFE).values.shape == (0, 4)
    assert flight.series(schema.RING).values.shape == (0, 72)
    assert flight.states(lanes.GUARD) == []
    assert flight.settings.control.passivity == "observer"
    assert flight.settings.control.preset == "paper"
    assert flight.settings.shield.guard == "off"
    assert flight.settings.control.stiffness == (4.0, 4.0, 4.0)


def test_settings_of_a_later_schema_are_refused_in_a_sentence(flight_file):
    properties = Flight(flight_file).properties()
    assert settings_from(properties) == Settings()
    with pytest.raises(InputError, match="schema 99, this program knows up to 5"):
        settings_from(properties | {"schema": 99})


def test_a_flight_without_a_mission_has_none(tmp_path):
    assert Flight(record(tmp_path, mission=False, seconds=1)).mission is None


def test_an_unfinished_recording_reads_up_to_where_it_was_cut_and_stays_as_it_is(unfinished):
    before = unfinished.read_bytes()
    flight = Flight(unfinished)
    assert flight.properties()["mission"] == "paper"
    assert flight.entities
    assert unfinished.read_bytes() == before


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7, 0.9, 0.99])
def test_a_cut_recording_is_mended_wherever_it_was_cut(flight_file, tmp_path, share):
    path = tmp_path / "cut.rrd"
    content = flight_file.read_bytes()
    path.write_bytes(content[: int(len(content) * share)])
    assert not is_whole(open_reader(path))
    mend(path)
    assert is_whole(open_reader(path))
    assert [left.name for left in tmp_path.iterdir()] == ["cut.rrd"]


@pytest.mark.parametrize("content", [b"", b"RRF2", b"no recording at all, but longer than a header"], ids=len)
def test_what_is_no_recording_is_said_in_a_sentence(tmp_path, content):
    path = tmp_path / "junk.rrd"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"junk\.rrd: "):
        review(path, environment=WINDOW, spawn=lambda _: pytest.fail("opened"))
    assert path.read_bytes() == content


def test_a_missing_recording_and_a_folder_are_said_in_a_sentence(tmp_path):
    for path in (tmp_path / "nowhere.rrd", tmp_path):
        with pytest.raises(InputError, match="there is no such recording"):
            Flight(path)


def test_the_viewer_listens_on_loopback_with_a_limit_of_memory(flight_file):
    commands = []
    assert review(flight_file, environment=WINDOW, spawn=lambda c: commands.append(list(c)) or 0) == 0
    (command,) = commands
    assert command[-1] == str(flight_file)
    assert command[command.index("--bind") + 1] == "127.0.0.1"
    assert "--memory-limit" in command
    assert "--serve-web" not in command


def test_without_a_display_the_browser_is_the_way(flight_file, capsys):
    with pytest.raises(InputError, match="--web"):
        review(flight_file, environment={}, spawn=lambda _: pytest.fail("opened"))
    commands = []
    review(flight_file, web=True, environment={}, spawn=lambda c: commands.append(list(c)) or 0)
    (command,) = commands
    port = command[command.index("--web-viewer-port") + 1]
    assert f"http://127.0.0.1:{port}/?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A" in capsys.readouterr().err


def test_an_unfinished_recording_is_put_in_order_before_it_is_opened(unfinished, capsys):
    review(unfinished, environment=WINDOW, spawn=lambda _: 0)
    assert "did not end properly" in capsys.readouterr().err
    assert is_whole(open_reader(unfinished))


def test_a_recording_that_still_grows_is_not_touched(tmp_path, capsys):
    run = a_run(tmp_path / "flight")
    session = Session(run, 0.0, lambda _severity, _text: None)
    session.take(a_batch(0.0, 1))
    try:
        assert is_growing(run.recording)
        node = run.recording.stat().st_ino
        review(run.recording, environment=WINDOW, spawn=lambda _: 0)
        assert "still being recorded" in capsys.readouterr().err
        assert run.recording.stat().st_ino == node
    finally:
        session.close()
    assert not is_growing(run.recording)


def test_flights_are_listed_newest_first_with_mission_and_length(tmp_path, unfinished, capsys):
    record(tmp_path, "a", seconds=1)
    record(tmp_path, "b", mission=False, seconds=2)
    (tmp_path / "junk.rrd").write_bytes(b"junk")
    (tmp_path / ".hidden.rrd").write_bytes(b"junk")
    entries = {entry.path.stem: entry for entry in list_flights(tmp_path)}
    assert set(entries) == {"a", "b", "unfinished"}
    assert (entries["a"].mission, entries["b"].mission) == ("paper", "")
    assert Flight(entries["a"].path).duration == pytest.approx(1.0)
    assert Flight(entries["b"].path).duration == pytest.approx(2.0)
    assert entries["unfinished"].whole is False
    started = [entry.started for entry in list_flights(tmp_path)]
    assert started == sorted(started, reverse=True)

    assert list_all(tmp_path) == 0
    _, *lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    assert any("paper" in line and "1.0 s" in line for line in lines)


def test_a_folder_without_flights_is_said(tmp_path, capsys):
    assert list_flights(tmp_path / "nowhere") == []
    assert list_all(tmp_path) == 0
    assert "No flights" in capsys.readouterr().out
    with pytest.raises(InputError, match="no recorded flights"):
        chosen(None, tmp_path)
