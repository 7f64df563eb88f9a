"""Long flights in parts, and room for them: nothing is lost between parts, nothing but old flights is removed."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recording_support import a_handle, a_pilot_state, a_run, recorder, until

from groundstation.config import Recording, Settings
from groundstation.messages import HANDLE, PILOT_STATE, Severity
from groundstation.recording import lanes, room, schema
from groundstation.recording.batch import Batch
from groundstation.recording.file import free_ended
from groundstation.recording.parts import is_part, part_path, parts_of
from groundstation.recording.session import Session
from groundstation.review.flight import Flight
from groundstation.review.listing import list_flights
from groundstation.review.rrd import is_whole, open_reader
from groundstation.review.show import review

SECONDS = 12


def record(folder, limits, told=None):
    run = msgspec.structs.replace(a_run(folder / "long"), settings=Settings(recording=limits))
    words = [] if told is None else told
    session = Session(run, 0.0, lambda severity, text: words.append((severity, text)))
    noise = np.random.default_rng(0).standard_normal((SECONDS * 1000, 3))
    for second in range(SECONDS):
        batch = Batch()
        handles = [a_handle(second + i * 1e-3, i) for i in range(1000)]
        for handle, row in zip(handles, noise[second * 1000 :], strict=False):
            handle.force[:] = row
        batch.add(HANDLE, handles)
        batch.add(PILOT_STATE, [a_pilot_state(second + i * 0.02) for i in range(50)])
        session.take(batch)
        session._file._flush()
    session.close()
    return run.recording, noise


@pytest.fixture(scope="module")
def long_flight(tmp_path_factory):
    return record(tmp_path_factory.mktemp("parts"), Recording(part_mb=1.0, warn_gb=0.0))


def test_a_long_flight_goes_on_in_parts_that_are_complete_and_one_flight(long_flight):
    path, noise = long_flight
    parts = parts_of(path)
    assert len(parts) > 2
    assert [part.name for part in parts[:2]] == ["long.rrd", "long.part-2.rrd"]
    assert all(is_whole(open_reader(part)) for part in parts)
    flight = Flight(path)
    t, force = flight.series(schema.HANDLE_FORCE)
    assert np.array_equal(force, noise)
    assert (np.diff(t) > 0).all()
    # What a state was does not begin anew with a part.
    assert len(flight.states(lanes.PHASE)) == 1
    assert Flight(parts[1]).mission == flight.mission


def threads() -> int:
    return sum(1 for _ in Path("/proc/self/task").iterdir())


def test_a_part_that_ended_leaves_no_thread_behind(tmp_path):
    """Each kept two threads and 4 MB, hour after hour."""
    record(tmp_path / "before", Recording(part_mb=100.0, warn_gb=0.0))
    free_ended()
    before = threads()
    path, _ = record(tmp_path / "flight", Recording(part_mb=0.5, warn_gb=0.0))
    assert len(parts_of(path)) > 3
    free_ended()
    # The viewer's layout is converted once a flight, and keeps two.
    assert threads() <= before + 2


# What was written is given back in a thread of Rerun's, which needs the interpreter for it.
OPENS_AND_FREES = """
import os, sys, threading
from pathlib import Path
import numpy as np
import rerun as rr
from groundstation.recording.file import FlightFile, free_ended
from groundstation.recording.item import Chunk, time_column

folder, ended = Path(sys.argv[1]), threading.Event()

def free():
    while not ended.is_set():
        free_ended()

running = FlightFile(folder / "running.rrd", "flight", None)
freeing = threading.Thread(target=free)
freeing.start()
for number in range(60):
    t = np.arange(2000.0)
    columns = rr.Scalars.columns(scalars=t.copy())
    running.write(Chunk(f"/{name}", time_column(t), columns) for name in range(20))
    part = FlightFile(folder / f"{number}.rrd", "flight", None)
    part._closing.set()
    part._stream.disconnect()
ended.set()
freeing.join()
os.write(1, b"ended")
os._exit(0)
"""


def test_a_part_can_begin_while_another_is_given_back(tmp_path):
    """Rerun held its list for the one and the interpreter for the other, and waited for each with the other."""
    command = [sys.executable, "-c", OPENS_AND_FREES, str(tmp_path)]
    told = subprocess.run(
        command, env=os.environ | {"RUST_LOG": "off"}, capture_output=True, text=True, check=True, timeout=90
    )
    assert told.stdout == "ended"


def test_parts_are_one_flight_in_the_list_and_in_the_viewer(long_flight):
    path, _ = long_flight
    (entry,) = list_flights(path.parent)
    parts = parts_of(path)
    assert (entry.path, entry.size) == (path, sum(part.stat().st_size for part in parts))
    commands = []
    assert (
        review(path, environment={"DISPLAY": ":0"}, spawn=lambda command: commands.append(command) or 0) == 0
    )
    assert commands[0][-len(parts) :] == [str(part) for part in parts]


def test_a_flight_whose_last_part_was_cut_off_did_not_end_properly(long_flight, tmp_path):
    path, _ = long_flight
    for part in parts_of(path):
        shutil.copy(part, tmp_path)
    last = parts_of(tmp_path / "long.rrd")[-1]
    assert list_flights(tmp_path)[0].whole
    last.write_bytes(last.read_bytes()[: -last.stat().st_size // 4])
    assert not list_flights(tmp_path)[0].whole
    last.write_bytes(b"spoilt")
    assert not list_flights(tmp_path)[0].whole


def test_a_part_that_cannot_be_read_costs_only_itself(long_flight, tmp_path):
    path, _ = long_flight
    for part in parts_of(path):
        shutil.copy(part, tmp_path)
    (tmp_path / "long.part-2.rrd").write_bytes(b"spoilt")
    kept = len(Flight(tmp_path / "long.rrd").series(schema.HANDLE_FORCE).t)
    assert 0 < kept < SECONDS * 1000


@given(st.text("ab[]*?. -", min_size=1, max_size=8), st.integers(2, 40))
def test_parts_are_found_in_their_order_whatever_the_name(tmp_path_factory, name, count):
    folder = tmp_path_factory.mktemp("names")
    first = folder / f"x{name}x.rrd"
    for number in range(1, count + 1):
        part_path(first, number).touch()
    (folder / f"x{name}xy.part-2.rrd").touch()
    assert parts_of(first) == [part_path(first, number) for number in range(1, count + 1)]
    assert [is_part(path) for path in parts_of(first)[:2]] == [False, True]


def a_folder(folder, names, size=1000):
    for name in names:
        (folder / name).write_bytes(bytes(size))


def test_the_oldest_flights_go_with_all_their_files_and_nothing_else(tmp_path):
    old, middle, new = (f"2026-11-0{day}_10-00-00_paper" for day in (1, 2, 3))
    a_folder(tmp_path, [f"{old}.rrd", f"{old}.part-2.rrd", f"{old}.tlog", f"{middle}.rrd", f"{new}.rrd"])
    a_folder(tmp_path, ["thesis.txt", "my.rrd", f"{old}.html", "2026-11-01_paper.rrd"], 100_000)
    assert room.make_room(tmp_path, 0.0, new) == []
    assert room.make_room(tmp_path, 2.5e-6, new) == [old]
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {
        f"{middle}.rrd",
        f"{new}.rrd",
        "thesis.txt",
        "my.rrd",
        f"{old}.html",
        "2026-11-01_paper.rrd",
    }
    assert room.make_room(tmp_path, 1e-9, new) == [middle]


def test_what_is_still_written_stays(tmp_path):
    name = "2026-11-01_10-00-00_paper"
    a_folder(tmp_path, [f"{name}.rrd"])
    fd = os.open(tmp_path / f"{name}.rrd", os.O_RDWR)
    try:
        fcntl.flock(fd, fcntl.LOCK_EX)
        assert room.make_room(tmp_path, 1e-9, "other") == []
    finally:
        os.close(fd)
    assert room.make_room(tmp_path, 1e-9, "other") == [name]


def test_a_disk_that_gets_full_is_told_once(tmp_path):
    told = []
    record(tmp_path, Recording(warn_gb=1e6), told)
    assert [severity for severity, _ in told] == [Severity.WARNING]
    assert "GB left" in told[0][1]


@pytest.mark.flight
def test_the_recorder_makes_room_and_says_so(tmp_path):
    a_folder(tmp_path, ["2026-11-01_10-00-00_paper.rrd", "2026-11-01_10-00-00_paper.tlog"])
    settings = Settings(recording=Recording(folder_gb=1e-6))
    run = msgspec.structs.replace(a_run(tmp_path / "2026-11-26_10-00-00_paper"), settings=settings)
    with recorder(run) as running:
        words = "Removed the oldest flights, 2026-11-01_10-00-00_paper"
        until(lambda: running.said(Severity.INFO, words), "the words about room")
        running.publish_handles(100)
        assert running.end() == 0
    assert [path.name for path in tmp_path.iterdir()] == ["2026-11-26_10-00-00_paper.rrd"]
