"""Several flights: the list with what they came to, a flight by its number, two in one view."""

from __future__ import annotations

import json
import shutil

import pytest
import rerun as rr
from test_report_flight import recorded

from groundstation import cli
from groundstation.errors import InputError
from groundstation.review.choosing import chosen
from groundstation.review.comparison import write_comparison
from groundstation.review.flight import Flight, properties_of
from groundstation.review.listing import list_flights
from groundstation.review.results import CACHE, results_of
from groundstation.review.rrd import read_chunks


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two flights and what is none."""
    folder = tmp_path_factory.mktemp("flights")
    recorded(folder, "long", seconds=30.0, pilot="Ada")
    recorded(folder, "short", seconds=12.0, pilot="Ben")
    (folder / "junk.rrd").write_bytes(b"junk")
    return folder


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["review", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


def test_the_list_tells_pilot_result_and_score(folder, capsys):
    code, out, _ = run(capsys, "--list", "--logs", folder)
    assert code == 0
    head, *lines = out.splitlines()
    assert {"pilot", "score", "result", "started"} <= set(head.split())
    assert len(lines) == 2
    assert any("Ada" in line and "30.0 s" in line for line in lines)
    flights = json.loads(run(capsys, "--list", "--json", "--logs", folder)[1])
    assert {each["pilot"] for each in flights} == {"Ada", "Ben"}
    assert all(0.0 <= each["score"] <= 100.0 for each in flights)
    assert "No flights" in run(capsys, "--list", "--pilot", "Cem", "--logs", folder)[1]
    assert len(run(capsys, "--list", "--pilot", "Ben", "--logs", folder)[1].splitlines()) == 2


def test_what_was_read_once_is_kept_until_the_file_changes(folder, tmp_path):
    for name in ("long", "short"):
        shutil.copy(folder / f"{name}.rrd", tmp_path)
    entries, told = list_flights(tmp_path), []
    first = list(results_of(entries, tmp_path, told.append))
    assert len(told) == 2
    assert list(results_of(entries, tmp_path, told.append)) == first
    assert len(told) == 2
    (tmp_path / CACHE).write_text("{ not what it was")
    assert list(results_of(entries, tmp_path, told.append)) == first
    assert len(told) == 4
    shutil.copy(folder / "long.rrd", tmp_path / "short.rrd")
    again = dict(results_of(list_flights(tmp_path), tmp_path, told.append))
    assert {result.pilot for result in again.values()} == {"Ada"}


def test_a_flight_is_chosen_by_place_path_or_as_the_newest(folder, tmp_path):
    newest, older = (entry.path for entry in list_flights(folder))
    assert chosen(None, folder) == newest
    assert [chosen(type(newest)(number), folder) for number in ("1", "2")] == [newest, older]
    assert chosen(older, tmp_path) == older
    for number, words in (("3", "no number 3"), ("0", "no number 0")):
        with pytest.raises(InputError, match=words):
            chosen(type(newest)(number), folder)
    with pytest.raises(InputError, match="no recorded flights"):
        chosen(None, tmp_path)


def test_two_flights_lie_over_one_another_from_the_coupling_on(folder, tmp_path, capsys, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    out = tmp_path / "both.rrd"
    assert run(capsys, folder / "long.rrd", folder / "short.rrd", "--out", out)[0] == 0
    chunks = read_chunks(out)
    paths = {chunk.entity_path for chunk in chunks}
    for curve in ("error", "force", "clearance", "target", "speed", "asked"):
        assert {f"/{curve}/A", f"/{curve}/B"} <= paths
    assert {"/world/A/way", "/world/B/way", "/world/obstacles/crate", "/about"} <= paths
    starts = [
        min(chunk.to_record_batch().column("flight_time").cast("int64").to_pylist())
        for chunk in chunks
        if chunk.entity_path in {"/error/A", "/error/B"} and not chunk.is_static
    ]
    assert min(starts) == 0
    assert properties_of(chunks) is not None


def test_the_page_says_when_missions_differ(folder, tmp_path):
    other = recorded(tmp_path, "free", seconds=12.0, mission=False)
    out = tmp_path / "both.rrd"
    write_comparison([folder / "long.rrd", other], out)
    page = next(chunk for chunk in read_chunks(out) if chunk.entity_path == "/about")
    assert "missions differ" in str(page.to_record_batch().to_pydict())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["A", "B", "A"], "two flights fit"),
        (["A", "--out", "x.rrd"], "two flights; name two"),
        (["A", "B", "--out", "x.html"], "name an .rrd file"),
        (["A", "IDLE"], "never coupled"),
        (["A", "nowhere.rrd"], "no such recording"),
        (["9", "--logs", "FOLDER"], "no number 9"),
    ],
)
def test_what_is_wrong_is_one_sentence(folder, tmp_path, capsys, arguments, words):
    named = {"A": folder / "long.rrd", "B": folder / "short.rrd", "FOLDER": folder}
    if "IDLE" in arguments:
        named["IDLE"] = recorded(tmp_path, "idle", seconds=3.0)
    code, _, err = run(capsys, *(named.get(word, word) for word in arguments))
    assert code == 2
    assert words in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.parametrize("command", [["report"], ["replay"], ["review", "--list"]])
def test_a_recording_of_something_else_is_told(tmp_path, capsys, command):
    path = tmp_path / "foreign.rrd"
    stream = rr.RecordingStream("somebody_else")
    stream.save(path)
    stream.log("points", rr.Points3D([(0.0, 0.0, 0.0)]))
    stream.flush()
    stream.disconnect()
    with pytest.raises(SystemExit) as end:
        cli.main([*command, "--logs", str(tmp_path)])
    told = capsys.readouterr()
    assert end.value.code == (0 if "--list" in command else 2)
    assert "not of a flight" in told.err or "no flight of this program" in told.out
    assert "Traceback" not in told.err


def test_a_flight_reads_the_same_after_it_was_listed(folder):
    assert Flight(folder / "long.rrd").duration == pytest.approx(30.0, abs=0.1)
