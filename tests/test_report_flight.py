"""Reports on recorded flights: one, several compared, a class; whatever a recording lacks."""

from __future__ import annotations

import lzma
import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest
from canned_flight import START, STEP_S, CannedFlight, canned_run

from groundstation import cli
from groundstation.config import Control, Settings
from groundstation.messages import (
    EVENT,
    HANDLE,
    PILOT_STATE,
    SERVO_REPORT,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Event,
    Severity,
)
from groundstation.progress.flown import Flown as Kept
from groundstation.progress.opening import store_in
from groundstation.progress.store import Store
from groundstation.recording import schema
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.report import classroom, comparison, flight_report, pdf
from groundstation.report.document import page
from groundstation.review.flight import Flight
from groundstation.review.recorded_series import recorded_series, thinned

RECORDINGS = Path(__file__).parent / "recordings"


def recorded(folder, name="flight", *, seconds=30.0, mission=True, pilot="Ada", settings=None, land=True):
    """Record the canned flight and return its file."""
    run = msgspec.structs.replace(canned_run(settings=settings), log=str(folder / name), pilot=pilot)
    session_run = run if mission else msgspec.structs.replace(run, mission=None)
    session = Session(session_run, START, lambda _severity, text: pytest.fail(text))
    flight, batch = CannedFlight(run), Batch()
    steps = round(seconds / STEP_S)
    for number in range(steps):
        flight.advance(STEP_S)
        view = flight.snapshot()
        if land and number == steps - 1:
            view.status.armed = view.status.in_air = 0
        view.vehicle.t = view.setpoint.t = view.pilot.t = view.handle.t = view.t
        view.status.t = view.t - STEP_S / 2
        for topic, record in (
            (VEHICLE_STATUS, view.status),
            (VEHICLE_STATE, view.vehicle),
            (HANDLE, view.handle),
            (PILOT_STATE, view.pilot),
            (SETPOINT, view.setpoint),
            (SERVO_REPORT, view.servo),
        ):
            batch.add(topic, [record])
    batch.add(EVENT, [Event(t=START + 9.0, severity=Severity.ALARM, source=b"link", text=b"Lost <it>.")])
    session.take(batch)
    session.close()
    return run.recording


@pytest.fixture(scope="module")
def flight_file(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("flights"))


def test_the_series_is_what_was_recorded_while_coupled(flight_file):
    flight = Flight(flight_file)
    series = recorded_series(flight)
    assert series.t[0] == 0.0
    assert np.diff(series.t) == pytest.approx(STEP_S, abs=1e-6)
    assert series.t[-1] == pytest.approx(30.0 - 6.0, abs=0.1)
    t, errors = flight.series(schema.ERROR)
    assert series.error == pytest.approx(errors[len(t) - len(series.t) :])
    assert series.p_h - series.seen == pytest.approx(series.error)
    assert np.isfinite(series.clearance).all()
    assert np.isnan(series.wind).all()
    thin = thinned(series, 100)
    assert len(thin.t) <= 100
    assert thin.error[1] == pytest.approx(series.error[12])


def test_a_flights_page_has_all_that_was_asked_for(flight_file):
    report = flight_report.report_on(flight_report.summarised(Flight(flight_file)))
    names = [plate.name for plate in report.plates]
    assert names == [
        "Figure 9", "Figure 11", "Cues", "Figure 12", "Figure 13", "Delay", "Passivity", "Timeline"
    ]  # fmt: skip
    titles = [table.title for table in report.tables]
    assert titles == [
        "Score", "Where points were lost", "How late", "The servo", "Passivity", "What happened",
        "Settings that differ", "All settings",
    ]  # fmt: skip
    content = page(report)
    assert content.count("<svg") == len(names)
    assert "Lost &lt;it&gt;." in content
    assert "Ada" in content
    assert "http" not in content.replace("http://www.w3.org", "")
    assert len(content) < 1_500_000


def test_the_findings_are_the_outcomes(flight_file):
    summary = flight_report.summarised(Flight(flight_file))
    found = {finding.what: finding for finding in flight_report.findings(summary)}
    figures = summary.outcome.figures
    assert found["collisions"].found == f"{figures.collisions}"
    assert found["collisions"].holds is (figures.collisions == 0)
    assert found["way flown"].found == f"{figures.path:.1f} m"
    assert found["score, of 100"].found == f"{summary.outcome.score.points:.0f}"


@pytest.mark.parametrize(
    ("changes", "plates"),
    [
        ({"mission": False}, {"Figure 11", "Figure 13", "Timeline"}),
        ({"seconds": 3.0}, {"Timeline"}),
        ({"seconds": 6.5, "land": False}, {"Figure 9", "Timeline"}),
    ],
)
def test_what_a_recording_lacks_is_left_out(tmp_path, changes, plates):
    report = flight_report.report_on(flight_report.summarised(Flight(recorded(tmp_path, **changes))))
    assert plates <= {plate.name for plate in report.plates}
    assert page(report)
    pdf.save(report, tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


def test_an_empty_recording_and_one_of_schema_1_have_reports(tmp_path):
    run = msgspec.structs.replace(canned_run(), log=str(tmp_path / "empty"))
    Session(run, START, lambda _severity, text: pytest.fail(text)).close()
    old = tmp_path / "old.rrd"
    with lzma.open(RECORDINGS / "flight_v1.rrd.xz") as packed, old.open("wb") as file:
        shutil.copyfileobj(packed, file)
    for path in (run.recording, old):
        assert page(flight_report.report_on(flight_report.summarised(Flight(path))))


def run_cli(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["report", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


def test_the_newest_flight_is_reported_beside_its_recording(tmp_path, flight_file, capsys):
    shutil.copy(flight_file, tmp_path / "flight.rrd")
    code, out, _ = run_cli(capsys, "--logs", tmp_path, "--pdf")
    assert code == 0
    assert str(tmp_path / "flight.html") in out
    assert (tmp_path / "flight.html").stat().st_size > 50_000
    assert (tmp_path / "flight.pdf").stat().st_size > 10_000
    assert "largest force" in out


def test_flights_are_compared(tmp_path, flight_file, capsys):
    stiff = recorded(
        tmp_path, "stiff", seconds=20.0, settings=Settings(control=Control(stiffness=(5.0, 5.0, 5.0)))
    )
    page_file = tmp_path / "both.html"
    code, out, _ = run_cli(capsys, "--compare", flight_file, stiff, "--out", page_file)
    assert code == 0
    assert "stiff" in out
    content = page_file.read_text()
    assert "control.stiffness" in content
    assert "● " in content
    assert content.count("<svg") == 2


def test_the_better_of_a_row_has_a_dot():
    row = comparison._Row("p̃", (0.3, 0.1, np.nan), "{:.2f}", -1)
    assert comparison._shown(row) == ("p̃", "0.30", "● 0.10", "–")
    same = comparison._Row("p̃", (0.301, 0.302), "{:.2f}", -1)
    assert comparison._shown(same) == ("p̃", "0.30", "0.30")


def a_flown(pilot, score, collisions=0, started="2026-11-26T10:00"):
    done = score > 60
    return classroom.Flown(pilot, "paper", started, done, score, collisions, "words", "file.rrd")


def test_a_class_says_who_needs_help():
    flights = [a_flown("Ada", 90), a_flown("Ben", 30), a_flown("Cem", 80, 1), a_flown("Ada", 85)]
    report = classroom.report_on(flights, ["x.rrd: is not a recording"])
    pilots = {row[0]: row for row in report.tables[0].rows}
    assert [pilots[name][-1] for name in ("Ada", "Ben", "Cem")] == ["", "needs help", "needs help"]
    assert pilots["Ada"][3:6] == ("88", "90", "85")
    assert "x.rrd" in page(report)


def test_a_class_with_a_store_shows_what_each_pilot_can_do(tmp_path, capsys):
    with Store(store_in(tmp_path)) as store:
        for pilot, points, passed in (("Ada", 90.0, True), ("Ben", 40.0, False)):
            store.add(Kept(pilot, "spring", "d", "2026-11-20T10:00:00+01:00", passed=passed, points=points))
    code, _, _ = run_cli(capsys, "--class", "--logs", tmp_path, "--out", tmp_path / "class.html")
    assert code == 0
    words = (tmp_path / "class.html").read_text()
    assert "<td>Ada</td><td>90</td>" in words
    assert "<td>Ben</td><td>▲ 20</td>" in words
    assert "not passed yet: fly it again" in words
    assert run_cli(capsys, "--class", "--logs", tmp_path, "--mission", "eight")[0] == 2


def test_a_class_is_summed_up_in_spite_of_a_broken_recording(tmp_path, flight_file, capsys):
    for name in ("a", "b"):
        shutil.copy(flight_file, tmp_path / f"{name}.rrd")
    (tmp_path / "odd.rrd").write_bytes(b"nothing")
    files = [tmp_path / f"{name}.rrd" for name in ("a", "b", "odd")]
    code, out, _ = run_cli(capsys, "--class", *files, "--out", tmp_path / "class.html")
    assert code == 0
    assert "flights" in out
    assert "odd.rrd: is not a Rerun recording" in (tmp_path / "class.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--logs", "EMPTY"], "no recorded flights"),
        (["7", "--logs", "FLIGHTS"], "no number 7"),
        (["nowhere.rrd"], "no such recording"),
        (["a.rrd", "b.rrd"], "--compare sets several"),
        (["--compare", "a.rrd"], "2 to 6 flights"),
        (["--class", "--logs", "EMPTY"], "no such flights"),
        (["--paper", "a.rrd"], "flies its own"),
        (["--mission", "paper"], "--class"),
        (["FILE", "--out", "/nowhere/x.html"], "cannot be written"),
        (["FILE", "--out", "x.pdf"], "the page is HTML"),
    ],
)
def test_what_is_wrong_is_one_sentence(tmp_path, flight_file, capsys, arguments, words):
    named = {"EMPTY": tmp_path, "FILE": flight_file, "FLIGHTS": flight_file.parent}
    code, _, err = run_cli(capsys, *(named.get(word, word) for word in arguments))
    assert code == 2
    assert words in err
    assert len(err.strip().splitlines()) == 1
