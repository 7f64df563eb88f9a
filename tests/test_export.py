"""`groundstation export`: what it writes holds the recording's very numbers; nothing is replaced unasked."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from pymavlink import mavutil
from pymavlink.dialects.v20 import common
from test_report_flight import recorded

from groundstation import cli
from groundstation.recording import schema
from groundstation.review.flight import Flight
from groundstation.vehicle.tlog import TlogWriter


@pytest.fixture(scope="module")
def flight_file(tmp_path_factory):
    path = recorded(tmp_path_factory.mktemp("flights"), seconds=8.0)
    a_tlog(path.with_suffix(".tlog"))
    return path


def a_tlog(path):
    log = TlogWriter(path, pytest.fail)
    mav = common.MAVLink(None, srcSystem=1)
    for number in range(50):
        log.write(mav.heartbeat_encode(2, 12, 0, 0, 3).pack(mav))
        log.write(
            mav.local_position_ned_encode(number * 20, number * 0.1, 0.0, -2.0, 0.0, 0.0, 0.0).pack(mav)
        )
    log.close()


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["export", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


@pytest.fixture(scope="module")
def flight(flight_file):
    return Flight(flight_file)


def test_parquet_holds_the_same_numbers_with_their_units(tmp_path, flight_file, flight, capsys):
    out = tmp_path / "tables"
    assert run(capsys, flight_file, "--to", "parquet", "--out", out)[0] == 0
    for quantity in (schema.P_H, schema.HANDLE_FORCE, schema.RECKONED):
        table = pq.read_table(out / f"{quantity.path[1:].replace('/', '.')}.parquet")
        t, values = flight.series(quantity)
        assert np.array_equal(table["t"].to_numpy(), t)
        for place, part in enumerate(quantity.parts):
            assert np.array_equal(table[part].to_numpy(), values[:, place], equal_nan=True)
        assert (
            table.schema.field(quantity.parts[0]).metadata[b"unit"].decode() == quantity.unit.split(", ")[0]
        )
        assert table.schema.metadata[b"meaning"].decode() == quantity.meaning
    events = pq.read_table(out / "events.parquet").to_pylist()
    assert [event["text"] for event in events] == [line.text for line in flight.events()]
    properties = json.loads((out / "properties.json").read_text())
    assert properties["flight"]["pilot"] == "Ada"


def test_csv_names_units_beside_its_tables(tmp_path, flight_file, flight, capsys):
    out = tmp_path / "tables"
    assert run(capsys, flight_file, "--to", "csv", "--out", out, "--only", "/pilot/*")[0] == 0
    with (out / "pilot.error.csv").open() as file:
        rows = list(csv.DictReader(file))
    _, errors = flight.series(schema.ERROR)
    assert [float(row["x"]) for row in rows] == list(errors[:, 0])
    assert not (out / "handle.force.csv").exists()
    with (out / "columns.csv").open() as file:
        units = {(row["table"], row["column"]): row["unit"] for row in csv.DictReader(file)}
    assert units["pilot.error", "yaw"] == "rad"
    assert units["pilot.error", "x"] == "m"


def test_one_wide_table_holds_values_as_last_known(tmp_path, flight_file, flight, capsys):
    out = tmp_path / "wide.csv"
    arguments = (flight_file, "--to", "csv", "--hz", "10", "--out", out, "--start", "6", "--end", "7")
    assert run(capsys, *arguments)[0] == 0
    with out.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 11
    t, errors = flight.series(schema.ERROR)
    assert (
        float(rows[5]["pilot.error.x"])
        == errors[np.searchsorted(t, float(rows[5]["t"]), side="right") - 1, 0]
    )


def test_mcap_holds_the_same_numbers_in_the_order_of_time(tmp_path, flight_file, flight, capsys):
    out = tmp_path / "flight.mcap"
    assert run(capsys, flight_file, "--to", "mcap", "--out", out)[0] == 0
    found: dict[str, list] = {}
    times: list[int] = []
    with out.open("rb") as file:
        reader = make_reader(file)
        for described, channel, message in reader.iter_messages(log_time_order=False):
            times.append(message.log_time)
            found.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
            assert described.encoding == "jsonschema"
        attached = {each.name: each.data for each in reader.iter_attachments()}
        metadata = {each.name: each.metadata for each in reader.iter_metadata()}
    assert times == sorted(times)
    t, errors = flight.series(schema.ERROR)
    rows = found[schema.ERROR.path]
    assert [[row[part] for part in schema.ERROR.parts] for _, row in rows] == errors.tolist()
    assert (rows[-1][0] - rows[0][0]) * 1e-9 == pytest.approx(t[-1] - t[0], abs=1e-6)
    assert {row["message"] for _, row in found["/log"]} == {line.text for line in flight.events()}
    assert found["/scene"][0][1]["entities"][0]["cubes"]
    pose = found["/tf"][-1][1]
    assert pose["translation"]["z"] == flight.series(schema.POSITION).values[-1, 2]
    assert sum(value**2 for value in pose["rotation"].values()) == pytest.approx(1.0)
    assert attached["flight.tlog"] == flight_file.with_suffix(".tlog").read_bytes()
    assert "obstacle" in tomllib.loads(attached["mission.toml"].decode())
    assert metadata["flight"]["mission"] == "paper"


def test_what_is_there_is_not_replaced_unasked(tmp_path, flight_file, capsys):
    out = tmp_path / "flight.mcap"
    out.write_bytes(b"mine")
    code, _, err = run(capsys, flight_file, "--to", "mcap", "--out", out)
    assert (code, out.read_bytes()) == (2, b"mine")
    assert "--force" in err
    assert run(capsys, flight_file, "--to", "mcap", "--out", out, "--force")[0] == 0
    assert out.stat().st_size > 1000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["flight.mcap"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.rrd", "--to", "csv"], "no such recording"),
        (["--to", "csv", "--logs", "EMPTY"], "no recorded flights"),
        (["FILE", "--to", "csv", "--only", "/nothing/*"], "has no entity like"),
        (["FILE", "--to", "csv", "--hz", "0"], "is not a rate"),
        (["FILE", "--to", "mcap", "--hz", "5"], "leave it out"),
        (["FILE", "--to", "csv", "--start", "5", "--end", "4"], "is after"),
        (["FILE", "--to", "mcap", "--out", "/nowhere/x.mcap"], "cannot be written"),
        (["FILE", "--to", "xlsx"], "invalid choice"),
    ],
)
def test_what_is_wrong_is_one_sentence(tmp_path, flight_file, capsys, arguments, words):
    named = {"EMPTY": tmp_path, "FILE": flight_file}
    code, _, err = run(capsys, *(named.get(word, word) for word in arguments))
    assert code == 2
    assert words in err
    assert len(err.strip().splitlines()) == 1


def test_the_mavlink_log_opens_in_mavlink_tools(flight_file):
    log = mavutil.mavlink_connection(str(flight_file.with_suffix(".tlog")))
    kinds: list[str] = []
    stamps: list[float] = []
    while (message := log.recv_match()) is not None:
        kinds.append(message.get_type())
        stamps.append(message._timestamp)
    log.close()
    assert kinds == ["HEARTBEAT", "LOCAL_POSITION_NED"] * 50
    assert stamps == sorted(stamps)
    tool = Path(sys.executable).with_name("mavlogdump.py")
    done = subprocess.run(
        [sys.executable, tool, "--format", "csv", "--types", "LOCAL_POSITION_NED", flight_file.with_suffix(".tlog")],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert len(list(csv.reader(io.StringIO(done.stdout)))) == 51
