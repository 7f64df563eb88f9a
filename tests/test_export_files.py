"""A recording exported as Parquet, CSV and MCAP, read back by those formats' own readers."""

from __future__ import annotations

import json
import lzma
import math
import resource
import subprocess
import sys
import tomllib
from pathlib import Path

import msgspec
import numpy as np
import numpy.testing as npt
import pyarrow.csv
import pyarrow.parquet
import pytest
from mcap.reader import make_reader
from recording_support import (
    STARTED,
    a_handle,
    a_pilot_state,
    a_ranges,
    a_run,
    a_setpoint,
    a_status,
    a_vehicle_state,
)

from groundstation.cli import main
from groundstation.config import Settings, load_settings
from groundstation.export.selection import Asked, Selection, unit_of
from groundstation.export.tables import column_of, file_of
from groundstation.messages import (
    EVENT,
    HANDLE,
    HEARTBEAT,
    OBSTACLES,
    PILOT_STATE,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Event,
    FlightMode,
    Heartbeat,
    Severity,
)
from groundstation.recording import lanes, schema
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.review.flight import Flight
from groundstation.training.mission import load_mission

STARTED_NS = 1_795_341_600_000_000_000
SECONDS = 3
OLD = Path(__file__).parent / "recordings" / "flight_v1.rrd.xz"


def a_second(first: float) -> Batch:
    batch = Batch()
    batch.add(HANDLE, [a_handle(first + i / 1000, round(1000 * first) + i) for i in range(1000)])
    batch.add(PILOT_STATE, [a_pilot_state(first + i / 50, guarding=first > 0) for i in range(50)])
    batch.add(
        VEHICLE_STATE,
        [a_vehicle_state(first + i / 50, position=(1 / 3, math.sin(first + i), 3.0, 0.4)) for i in range(50)],
    )
    batch.add(SETPOINT, [a_setpoint(first + i / 50, active=first > 0) for i in range(50)])
    batch.add(OBSTACLES, [a_ranges(first, at3=4.5)])
    batch.add(VEHICLE_STATUS, [a_status(first, mode=FlightMode.HOLD), a_status(first + 0.5)])
    batch.add(
        EVENT, [Event(t=first + 0.25, severity=Severity.ALARM, source=b"link", text='Größe, "x"'.encode())]
    )
    batch.add(HEARTBEAT, [Heartbeat(t=first + i / 10, role=b"recorder", pid=1) for i in range(10)])
    return batch


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> Path:
    """A made-up flight of three seconds with all that is awkward: NaN, infinity, quotes."""
    run = a_run(tmp_path_factory.mktemp("flight") / "flight")
    told: list[str] = []
    session = Session(run, 0.0, lambda _severity, text: told.append(text))
    for second in range(SECONDS):
        session.take(a_second(float(second)))
    session.close()
    assert told == []
    run.tlog.write_bytes(b"\x00" * 8 + b"\xfd not really")
    return run.recording


def export(*arguments: object) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["export", *map(str, arguments)])
    assert ended.value.code == 0


def refused(capsys, *arguments: object) -> str:
    with pytest.raises(SystemExit) as ended:
        main(["export", *map(str, arguments)])
    assert ended.value.code == 2
    return capsys.readouterr().err


def recorded(path: Path) -> dict[str, tuple[schema.Quantity, np.ndarray, np.ndarray]]:
    flight = Flight(path)
    known = (*schema.QUANTITIES, schema.heartbeat("recorder"))
    found = {quantity.path: (quantity, *flight.series(quantity)) for quantity in known}
    return {path: row for path, row in found.items() if len(row[1])}


def same_bits(found: np.ndarray, expected: np.ndarray) -> None:
    npt.assert_array_equal(found, expected)
    known = ~np.isnan(expected)
    npt.assert_array_equal(np.signbit(found[known]), np.signbit(expected[known]))


@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_a_folder_holds_every_number_to_the_last_bit_with_its_units(recording, tmp_path, suffix):
    export(recording, "--to", suffix, "--out", tmp_path / "out")
    everything = recorded(recording)
    assert np.isinf(everything["/ranges/ring"][2]).any()
    assert np.isnan(everything["/velocity/up/reference"][2]).any()
    for path, (quantity, t, values) in everything.items():
        file = tmp_path / "out" / f"{file_of(path)}.{suffix}"
        table = pyarrow.csv.read_csv(file) if suffix == "csv" else pyarrow.parquet.read_table(file)
        assert table.column_names == ["t", "time", *map(column_of, quantity.parts)]
        same_bits(table["t"].to_numpy(), t)
        stamps = table["time"].cast(pyarrow.timestamp("ns", "UTC")).cast("int64").to_numpy()
        npt.assert_array_equal(stamps - STARTED_NS, np.rint(t * 1e9))
        for place, part in enumerate(quantity.parts):
            same_bits(table[column_of(part)].cast("float64").to_numpy(zero_copy_only=False), values[:, place])


def test_units_and_meaning_are_in_parquet_s_schema_and_in_the_table_of_columns(recording, tmp_path):
    export(recording, "--to", "parquet", "--out", tmp_path / "out")
    told = pyarrow.parquet.read_schema(tmp_path / "out" / "vehicle.position.parquet")
    assert told.metadata[b"entity"] == b"/vehicle/position"
    assert told.metadata[b"meaning"] == schema.POSITION.meaning.encode()
    assert [told.field(name).metadata[b"unit"] for name in ("x", "y", "z", "yaw")] == [
        b"m",
        b"m",
        b"m",
        b"rad",
    ]
    rows = pyarrow.csv.read_csv(tmp_path / "out" / "columns.csv").to_pylist()
    assert {"table": "vehicle.velocity", "column": "yaw", "unit": "rad/s", "rows": "telemetry",
            "meaning": schema.VELOCITY.meaning} in rows  # fmt: skip
    assert "handle.force.parquet: 3000 rows" in (tmp_path / "out" / "README.txt").read_text()


@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_a_folder_holds_events_states_and_properties(recording, tmp_path, suffix):
    export(recording, "--to", suffix, "--out", tmp_path / "out")
    read = pyarrow.csv.read_csv if suffix == "csv" else pyarrow.parquet.read_table
    flight = Flight(recording)
    events = read(tmp_path / "out" / f"events.{suffix}").to_pylist()
    assert [row["text"] for row in events if row["source"] == "link"] == ['Größe, "x"'] * SECONDS
    assert len(events) == len(flight.events())
    states = read(tmp_path / "out" / f"states.{suffix}").to_pylist()
    assert [(row["t"], row["value"]) for row in states if row["state"] == "/state/mode"] == flight.states(
        lanes.MODE
    )
    told = json.loads((tmp_path / "out" / "properties.json").read_text())
    assert told["flight"]["started"] == STARTED
    assert msgspec.convert(told["settings"], Settings) == flight.settings
    assert told["mission"]["name"] == "paper"


def test_every_unit_of_the_schema_belongs_to_a_part():
    for quantity in schema.QUANTITIES:
        units = {unit_of(quantity, place) for place in range(len(quantity.parts))}
        assert units == set(quantity.unit.split(", ")), quantity.path
    assert [unit_of(schema.P_H, place) for place in range(4)] == ["m", "m", "m", "rad"]
    for quantity in schema.QUANTITIES:
        assert len(set(map(column_of, quantity.parts))) == len(quantity.parts)


@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_a_wide_table_holds_what_was_last_recorded_and_nothing_in_between(recording, tmp_path, suffix):
    out = tmp_path / f"wide.{suffix}"
    export(recording, "--to", suffix, "--hz", 30, "--out", out)
    table = pyarrow.csv.read_csv(out) if suffix == "csv" else pyarrow.parquet.read_table(out)
    grid = table["t"].to_numpy()
    npt.assert_allclose(np.diff(grid), 1 / 30, atol=1e-12)
    for path, (quantity, t, values) in recorded(recording).items():
        for place, part in enumerate(quantity.parts):
            column = table[f"{file_of(path)}.{column_of(part)}"].to_pylist()
            for at, found in zip(grid, column, strict=True):
                before = values[t <= at + 1e-9, place]
                if not len(before):
                    assert found is None
                else:
                    same_bits(np.array([found], dtype=float), before[-1:])
    modes = table["state.mode"].to_pylist()
    assert modes[0] == "hold"
    assert modes[-1] == "offboard"


def test_a_wide_csv_has_its_units_beside_it(recording, tmp_path):
    export(recording, "--to", "csv", "--hz", 10, "--out", tmp_path / "wide.csv", "--entities", "/handle/*")
    names = pyarrow.csv.read_csv(tmp_path / "wide.csv").column_names
    rows = pyarrow.csv.read_csv(tmp_path / "wide.columns.csv").to_pylist()
    assert [row["column"] for row in rows] == names
    assert {row["unit"] for row in rows if row["column"].startswith("handle.force")} == {"N"}
    assert not [name for name in names if not name.startswith(("handle.", "t"))]


def test_a_time_and_some_entities_are_cut_out(recording):
    flight = Flight(recording)
    selection = Selection(flight, Asked(("/handle/*", "/events/link"), 1.0, 2.0))
    assert {table.quantity.path.split("/")[1] for table in selection.tables} == {"handle"}
    t, values = flight.series(schema.HANDLE_FORCE)
    cut = next(table for table in selection.tables if table.quantity is schema.HANDLE_FORCE)
    within = (t >= 1.0) & (t <= 2.0)
    npt.assert_array_equal(cut.t, t[within])
    npt.assert_array_equal(cut.values, values[within])
    assert [line.t for line in selection.events] == [1.25]
    # What held as the time began is told as of then.
    phases = Selection(flight, Asked(("/state/phase", "/handle/*"), 1.0, 2.0)).states[0]
    assert (phases.path, phases.changes) == ("/state/phase", [(1.0, "engaged")])


def messages(path: Path):
    """Return all messages by topic: log times, and what the JSON says, by Python's own reader of JSON."""
    found: dict[str, tuple[str, list[int], list[dict]]] = {}
    last = 0
    with path.open("rb") as file:
        for kind, channel, message in make_reader(file, validate_crcs=True).iter_messages(
            log_time_order=False
        ):
            assert (kind.encoding, channel.message_encoding) == ("jsonschema", "json")
            assert message.log_time >= last, "messages lie in the order of their times"
            last = message.log_time
            _, times, rows = found.setdefault(channel.topic, (kind.name, [], []))
            times.append(message.log_time)
            rows.append(json.loads(message.data))
    return found


def test_an_mcap_file_holds_every_number_to_the_last_bit(recording, tmp_path):
    export(recording, "--to", "mcap", "--out", tmp_path / "flight.mcap")
    found = messages(tmp_path / "flight.mcap")
    for path, (quantity, t, values) in recorded(recording).items():
        _, times, rows = found[path]
        npt.assert_array_equal(np.array(times) - STARTED_NS, np.rint(t * 1e9))
        assert all(set(row) <= set(quantity.parts) for row in rows)
        same_bits(np.array([[row.get(part, math.nan) for part in quantity.parts] for row in rows]), values)


def test_an_mcap_file_says_what_its_channels_mean(recording, tmp_path):
    export(recording, "--to", "mcap", "--out", tmp_path / "flight.mcap")
    with (tmp_path / "flight.mcap").open("rb") as file:
        reader = make_reader(file)
        kinds = {kind.name: json.loads(kind.data) for kind in reader.get_summary().schemas.values()}
        told = {record.name: record.metadata for record in reader.iter_metadata()}
        attached = {record.name: record.data for record in reader.iter_attachments()}
    assert kinds["/vehicle/velocity"]["properties"]["yaw"]["description"].startswith("rad/s")
    assert schema.VELOCITY.meaning in kinds["/vehicle/velocity"]["description"]
    assert told["flight"]["started"] == STARTED
    assert attached["flight.tlog"] == recording.with_suffix(".tlog").read_bytes()
    flight = Flight(recording)
    for name, load, expected in (
        ("mission.toml", load_mission, flight.mission),
        ("settings.toml", load_settings, flight.settings),
    ):
        assert tomllib.loads(attached[name].decode())
        (tmp_path / name).write_bytes(attached[name])
        assert load(tmp_path / name) == expected


def test_an_mcap_file_shows_the_flight_in_foxglove(recording, tmp_path):
    export(recording, "--to", "mcap", "--out", tmp_path / "flight.mcap")
    found = messages(tmp_path / "flight.mcap")
    kind, times, transforms = found["/tf"]
    assert kind == "foxglove.FrameTransform"
    assert (transforms[0]["parent_frame_id"], transforms[0]["child_frame_id"]) == ("world", "vehicle")
    t, values = Flight(recording).series(schema.POSITION)
    translations = [list(row["translation"].values()) for row in transforms]
    npt.assert_array_equal(np.array(translations), values[:, :3])
    stamp = transforms[7]["timestamp"]
    assert stamp["sec"] * 10**9 + stamp["nsec"] == times[7] == STARTED_NS + round(t[7] * 1e9)
    x, y, z, w = transforms[0]["rotation"].values()
    # Turned by yaw 0.4, pitch −0.2, roll 0.1: where the nose points.
    nose = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
    npt.assert_allclose(nose, (math.cos(-0.2) * math.cos(0.4), math.cos(-0.2) * math.sin(0.4), math.sin(0.2)))
    assert found["/vehicle/pose"][0] == "foxglove.PoseInFrame"
    kind, _, logs = found["/log"]
    assert kind == "foxglove.Log"
    assert {"level": 4, "message": 'Größe, "x"', "name": "link"}.items() <= logs[1].items()
    kind, _, scenes = found["/scene"]
    assert kind == "foxglove.SceneUpdate"
    shapes = {entity["id"]: entity for entity in scenes[0]["entities"]}
    assert shapes["crate/0"]["cubes"][0]["size"] == {"x": 1.2, "y": 1.6, "z": 3.0}
    assert shapes["column/0"]["cylinders"][0]["size"] == {"x": 0.8, "y": 0.8, "z": 4.0}
    assert shapes["balloon/0"]["spheres"][0]["pose"]["position"] == {"x": 5.6, "y": -1.6, "z": 2.2}
    assert len(shapes["route"]["lines"][0]["points"]) == 6
    assert [row["state"] for row in found["/state/mode"][2]][:2] == ["hold", "offboard"]


def test_only_events_are_an_mcap_file_too(recording, tmp_path):
    export(recording, "--to", "mcap", "--out", tmp_path / "flight.mcap", "--entities", "/events/*")
    found = messages(tmp_path / "flight.mcap")
    assert len(found["/log"][1]) == SECONDS


def test_a_recording_of_an_earlier_schema_is_exported(tmp_path):
    path = tmp_path / "old.rrd"
    path.write_bytes(lzma.decompress(OLD.read_bytes()))
    export(path, "--to", "mcap")
    export(path, "--to", "parquet")
    found = messages(tmp_path / "old.mcap")
    t, values = Flight(path).series(schema.POSITION)
    same_bits(np.array([list(row.values()) for row in found["/vehicle/position"][2]]), values)
    assert pyarrow.parquet.read_table(tmp_path / "old_parquet" / "vehicle.position.parquet").num_rows == len(
        t
    )


def test_the_newest_flight_is_the_default(recording, tmp_path, capsys):
    export("--logs", recording.parent, "--to", "csv", "--hz", 1, "--out", tmp_path / "x.csv")
    assert f"{tmp_path / 'x.csv'} (" in capsys.readouterr().out


def test_nothing_is_overwritten_unless_asked_for(recording, tmp_path, capsys):
    out = tmp_path / "flight.mcap"
    out.write_text("precious")
    assert "is there already" in refused(capsys, recording, "--to", "mcap", "--out", out)
    assert out.read_text() == "precious"
    export(recording, "--to", "mcap", "--out", out, "--force")
    assert out.read_bytes().startswith(b"\x89MCAP")


def test_a_folder_that_no_export_wrote_is_not_replaced(recording, tmp_path, capsys):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years")
    words = refused(capsys, recording, "--to", "csv", "--out", tmp_path / "mine", "--force")
    assert "was not written by an export" in words
    assert (tmp_path / "mine" / "thesis.txt").read_text() == "years"
    export(recording, "--to", "csv", "--out", tmp_path / "out", "--entities", "/handle/*")
    (tmp_path / "out" / "stale.csv").write_text("of an export before")
    export(recording, "--to", "csv", "--out", tmp_path / "out", "--force")
    assert not (tmp_path / "out" / "stale.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--to", "mcap", "--hz", "50"), "an MCAP file holds none"),
        (("--to", "csv", "--hz", "0"), "is not a rate"),
        (("--to", "csv", "--hz", "nan"), "is not a rate"),
        (("--to", "csv", "--hz", "1e9"), "rows; choose fewer"),
        (("--to", "csv", "--start", "2", "--end", "1"), "is after"),
        (("--to", "csv", "--start", "100"), "holds nothing of that"),
        (("--to", "csv", "--entities", "/nothing/*"), "has no entity like"),
        (("--to", "csv", "--out", "no/such/folder/x"), "there is no folder"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(recording, tmp_path, capsys, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    out = () if "--out" in arguments else ("--out", "out")
    told = refused(capsys, recording, *arguments, *out)
    assert words in told.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_recording_is_refused(tmp_path, capsys):
    path = tmp_path / "x.rrd"
    path.write_text("no recording")
    assert "is not a Rerun recording" in refused(capsys, path, "--to", "mcap")


@pytest.mark.parametrize("to", ["mcap", "csv", "parquet"])
def test_a_full_disk_is_told_and_leaves_nothing(recording, tmp_path, to):
    """A limit of the size of files stands for the disk: the system refuses the bytes all the same."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    done = subprocess.run(
        [sys.executable, "-m", "groundstation.cli", "export", str(recording), "--to", to, "--out", "out"],
        cwd=tmp_path, capture_output=True, text=True, check=False, preexec_fn=limit,
        env={"PYTHONPATH": str(Path(__file__).parents[1]), "PATH": "", "PYTHONDONTWRITEBYTECODE": "1"},
    )  # fmt: skip
    assert done.returncode == 2
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_one_that_is_stopped_leaves_nothing(recording, tmp_path, monkeypatch):
    from groundstation.export import mcap_file

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(mcap_file, "_attach", stop)
    with pytest.raises(SystemExit) as ended:
        main(["export", str(recording), "--to", "mcap", "--out", str(tmp_path / "x.mcap")])
    assert ended.value.code == 130
    assert list(tmp_path.iterdir()) == []
