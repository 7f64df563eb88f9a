"""The recorder process on a real bus, and what of a flight is in its file however the flight ends."""

from __future__ import annotations

import resource
import signal
import socket
import subprocess
import threading

import numpy as np
import numpy.testing as npt
import pytest
from recording_support import a_pilot_state, a_run, a_status, a_vehicle_state, recorder, until
from rerun.chunk import RrdReader

from groundstation.errors import InputError
from groundstation.messages import PILOT_STATE, VEHICLE_STATE, VEHICLE_STATUS, Severity
from groundstation.recording import entities, schema
from groundstation.recording.live import free_tcp_port, listening
from groundstation.recording.parts import is_growing
from groundstation.recording.program import LOOPBACK, program
from groundstation.review.flight import Flight
from groundstation.review.rrd import is_whole, open_reader

pytestmark = pytest.mark.flight

SECONDS = 3
TICKS = SECONDS * 1_000


def rows_of(path) -> int:
    """Return how many handle rows a file has, also while it is being written."""
    try:
        return len(Flight(path).series(schema.HANDLE_FORCE).t)
    except InputError:
        return 0


def test_a_flight_ended_properly_is_whole_and_has_every_row(tmp_path):
    with recorder(a_run(tmp_path / "flight")) as running:
        pilots = running.bus.publisher(PILOT_STATE)
        vehicles = running.bus.publisher(VEHICLE_STATE)
        statuses = running.bus.publisher(VEHICLE_STATUS)
        for i in range(100):
            pilots.send(a_pilot_state(1.0 + i * 0.02))
            vehicles.send(a_vehicle_state(1.0 + i * 0.02, position=(i * 0.1, 0.0, 2.0, 0.0)))
        statuses.send(a_status(1.0))
        sent = running.publish_handles(TICKS)
        running.bus.event(Severity.WARNING, "Something happened.")
        assert is_growing(running.path)
        assert running.end() == 0

    assert is_whole(open_reader(running.path))
    assert not is_growing(running.path)
    assert len(RrdReader(running.path).blueprints()) == 1
    flight = Flight(running.path)
    t, force = flight.series(schema.HANDLE_FORCE)
    npt.assert_array_equal(force, [tuple(record.force) for record in sent])
    npt.assert_allclose(np.diff(t), 1e-3, atol=2e-9)
    npt.assert_array_equal(flight.series(schema.HANDLE_POSITION).values[:, 3], [r.yaw for r in sent])
    assert len(flight.series(schema.P_H).t) == 100
    assert [line.text for line in flight.events() if line.source == "test"] == ["Something happened."]
    assert {
        entities.VEHICLE_TRAIL,
        entities.VEHICLE_POSE,
        entities.HAND,
        entities.LEASH,
        entities.FORCE_ARROW,
    } <= set(flight.entities)
    assert flight.mission == running.run.mission
    assert flight.settings == running.run.settings
    assert flight.properties()["schema"] == schema.VERSION
    assert not list(tmp_path.glob(".*"))


def test_a_killed_recorder_leaves_what_was_flown(tmp_path):
    with recorder(a_run(tmp_path / "flight")) as running:
        running.publish_handles(TICKS)
        until(lambda: rows_of(running.path) == TICKS, "the rows in the file")
        running.end(signal.SIGKILL)
    assert not is_whole(open_reader(running.path))
    assert not is_growing(running.path)
    flight = Flight(running.path)
    assert len(flight.series(schema.HANDLE_FORCE).t) == TICKS
    assert flight.properties()["mission"] == "paper"


@pytest.mark.parametrize("after", [0.31, 1.13, 1.94])
def test_killed_at_any_moment_it_leaves_all_but_the_last_second(tmp_path, after):
    with recorder(a_run(tmp_path / "flight")) as running:
        sent = running.publish_handles(round(after * 1000))
        running.end(signal.SIGKILL)
    kept = len(Flight(running.path).series(schema.HANDLE_FORCE).t)
    assert len(sent) - 1000 <= kept <= len(sent)


def test_a_recorder_whose_supervisor_hangs_up_ends_its_file(tmp_path):
    with recorder(a_run(tmp_path / "flight")) as running:
        running.publish_handles(200)
        assert running.end(signal.SIGHUP) == 0
    assert is_whole(open_reader(running.path))
    assert len(Flight(running.path).series(schema.HANDLE_FORCE).t) == 200


def test_a_recording_that_is_there_already_is_left_alone(tmp_path):
    for _ in range(2):
        with recorder(a_run(tmp_path / "flight")) as running:
            running.publish_handles(100)
            assert running.end() == 0
    assert sorted(path.name for path in tmp_path.glob("*.rrd")) == ["flight.rrd", "flight_2.rrd"]
    assert rows_of(tmp_path / "flight.rrd") == rows_of(tmp_path / "flight_2.rrd") == 100


@pytest.fixture
def silent_viewer():
    """Listen as a viewer that takes connections and reads nothing."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        taken: list[socket.socket] = []

        def take() -> None:
            while True:
                try:
                    taken.append(listener.accept()[0])
                except OSError:
                    return

        thread = threading.Thread(target=take, daemon=True)
        thread.start()
        yield listener.getsockname()[1]
        listener.shutdown(socket.SHUT_RDWR)
        thread.join()
        for connection in taken:
            connection.close()


def check_whole_flight(tmp_path, port: int) -> None:
    url = f"rerun+http://127.0.0.1:{port}/proxy"
    with recorder(a_run(tmp_path / "flight", viewer_url=url)) as running:
        running.publish_handles(TICKS)
        assert running.end() == 0
    assert is_whole(open_reader(running.path))
    assert len(Flight(running.path).series(schema.HANDLE_FORCE).t) == TICKS


def test_a_viewer_that_is_not_there_changes_nothing(tmp_path):
    check_whole_flight(tmp_path, free_tcp_port())


def test_a_viewer_that_never_reads_changes_nothing(tmp_path, silent_viewer):
    check_whole_flight(tmp_path, silent_viewer)


def test_a_viewer_that_reads_gets_the_flight_too(tmp_path):
    port, streamed = free_tcp_port(), tmp_path / "streamed.rrd"
    viewer = subprocess.Popen(
        [program(), "--save", streamed, "--port", str(port), *LOOPBACK],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        until(lambda: listening(port), "the viewer")
        check_whole_flight(tmp_path, port)
        until(lambda: rows_of(streamed) == TICKS, "the rows at the viewer")
    finally:
        viewer.terminate()
        viewer.wait()


def test_a_folder_that_cannot_be_written_is_an_alarm_and_the_recorder_lives(tmp_path):
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    with recorder(a_run(tmp_path / "file" / "flight")) as running:
        until(lambda: running.said(Severity.ALARM, "This flight is not recorded"), "the alarm")
        running.publish_handles(200)
        assert running.process.poll() is None
        assert running.end() == 0
    (alarm,) = [event.text.decode() for event in running.events if event.severity == Severity.ALARM]
    assert str(running.path) in alarm
    assert "choose another folder" in alarm


def test_a_disk_that_fills_is_an_alarm_and_what_was_written_stays_readable(tmp_path):
    with recorder(a_run(tmp_path / "flight")) as running:
        until(running.path.is_file, "the file")
        # What stands still takes 0.5 MB, and all of the flight 0.3 MB more.
        resource.prlimit(running.process.pid, resource.RLIMIT_FSIZE, (680_000, 680_000))
        running.publish_handles(TICKS)
        until(lambda: running.said(Severity.ALARM, "This flight is no longer recorded"), "the alarm")
        assert running.process.poll() is None
        assert running.end() == 0
    assert 0 < rows_of(running.path) < TICKS
