"""`groundstation identify` on tables, PX4 logs and recordings: what it reads, says and writes."""

import json
import struct

import numpy as np
import pytest
from identify_support import a_flight
from recording_support import a_run, a_setpoint, a_vehicle_state

from groundstation import cli
from groundstation.errors import InputError
from groundstation.identification.sources import COLUMNS, read_flight
from groundstation.messages import SETPOINT, VEHICLE_STATE
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from sim.airframe import load_airframe
from sim.models.dynamic import astuple

YAW = 0.7


def world(raw):
    """Return the flight's way as somebody else would write it down: yaw and world velocities."""
    yaw = YAW + np.cumsum(raw.v[:, 3]) * np.median(np.diff(raw.t))
    c, s = np.cos(yaw), np.sin(yaw)
    return yaw, c * raw.v[:, 0] - s * raw.v[:, 1], s * raw.v[:, 0] + c * raw.v[:, 1]


def a_table(path, raw):
    yaw, vx, vy = world(raw)
    nothing = np.zeros_like(yaw)
    table = np.column_stack(
        (raw.t, nothing, nothing, nothing, yaw, vx, vy, raw.v[:, 2], raw.v[:, 3], raw.ref)
    )
    np.savetxt(path, table, delimiter=",", header=",".join(COLUMNS), comments="")
    return path


def a_ulog(path, raw):
    """Write a PX4 log, byte by byte after its published format: header, definitions, subscriptions, data."""
    formats = {
        "vehicle_local_position": "uint64_t timestamp;float vx;float vy;float vz;float heading;bool v_xy_valid;",
        "vehicle_angular_velocity": "uint64_t timestamp;float[3] xyz;",
        "trajectory_setpoint": "uint64_t timestamp;float[3] velocity;float yawspeed;",
    }

    def message(kind, content):
        return struct.pack("<HB", len(content), ord(kind)) + content

    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    out += message("B", bytes(40))
    for name, fields in formats.items():
        out += message("F", f"{name}:{fields}".encode())
    for number, name in enumerate(formats):
        out += message("A", struct.pack("<BH", 0, number) + name.encode())
    yaw, vx, vy = world(raw)
    c, s = np.cos(yaw), np.sin(yaw)
    rx, ry = c * raw.ref[:, 0] - s * raw.ref[:, 1], s * raw.ref[:, 0] + c * raw.ref[:, 1]
    for k, t in enumerate(raw.t):
        at = int((t + 1.0) * 1e6)
        # North, east, down, and heading clockwise from north.
        out += message(
            "D", struct.pack("<HQffff?", 0, at, vy[k], vx[k], -raw.v[k, 2], np.pi / 2 - yaw[k], True)
        )
        out += message("D", struct.pack("<HQfff", 1, at, 0.0, 0.0, -raw.v[k, 3]))
        out += message("D", struct.pack("<HQffff", 2, at, ry[k], rx[k], -raw.ref[k, 2], -raw.ref[k, 3]))
    path.write_bytes(out)
    return path


def a_recording(path, raw):
    run = a_run(path.with_suffix(""))
    session = Session(run, 0.0, lambda _severity, text: pytest.fail(text))
    yaw, vx, vy = world(raw)
    batch = Batch()
    states, setpoints = [], []
    for k, t in enumerate(raw.t):
        state = a_vehicle_state(float(t) + 0.001, position=(0.0, 0.0, 2.0, float(yaw[k])))
        state.velocity[:] = (vx[k], vy[k], raw.v[k, 2], raw.v[k, 3])
        setpoint = a_setpoint(float(t))
        setpoint.velocity[:] = raw.ref[k]
        states.append(state)
        setpoints.append(setpoint)
    batch.add(VEHICLE_STATE, states)
    batch.add(SETPOINT, setpoints)
    session.take(batch)
    session.close()
    return path


@pytest.mark.parametrize(("suffix", "write"), [(".csv", a_table), (".ulg", a_ulog), (".rrd", a_recording)])
def test_every_source_tells_the_same_flight(tmp_path, suffix, write):
    raw, _ = a_flight(seconds=12.0)
    samples = read_flight(write(tmp_path / f"flight{suffix}", raw))
    (v, ref), *more = samples.stretches
    assert not more
    assert samples.dt == pytest.approx(0.02, rel=1e-3)
    assert len(v) == pytest.approx(len(raw.t), abs=2)
    n = min(len(v), len(raw.v))
    assert v[:n] == pytest.approx(raw.v[:n], abs=5e-3)
    assert ref[:n] == pytest.approx(raw.ref[:n], abs=5e-3)


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["identify", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


def test_it_writes_an_airframe_that_flies_and_a_page(tmp_path, capsys):
    raw, chi = a_flight(seconds=24.0)
    flight = a_table(tmp_path / "flight.csv", raw)
    preset, page = tmp_path / "mine.toml", tmp_path / "mine.html"
    code, out, _ = run(capsys, flight, "--out", preset, "--page", page, "--json")
    assert code == 0
    found = json.loads(out)
    assert list(found["chi"].values()) == pytest.approx(chi, rel=0.1)
    assert found["flights"]["flight.csv"]["r2_free"] == pytest.approx([1.0] * 4, abs=0.02)
    airframe = load_airframe(str(preset))
    assert astuple(airframe.chi) == tuple(found["chi"].values())
    assert "dynamic" in airframe.models()
    assert page.read_text().count("<svg") == 2
    # Again is no trouble, and somebody else's file is left alone.
    assert run(capsys, flight, "--out", preset, "--json")[0] == 0
    preset.write_text("schema = 1")
    code, _, err = run(capsys, flight, "--out", preset)
    assert (code, "is there already" in err) == (2, True)
    assert preset.read_text() == "schema = 1"


def test_the_table_tells_what_was_not_learned_from(tmp_path, capsys):
    flights = [a_table(tmp_path / f"{seed}.csv", a_flight(seconds=16.0, seed=seed)[0]) for seed in (0, 1)]
    code, out, _ = run(capsys, flights[0], "--validate", flights[1])
    assert code == 0
    assert "1.csv (not learned from)" in out
    assert "free flight, start to end" in out


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("f.csv", b"", "has no column t"),
        ("f.csv", b"t,x\n1,2\n", "has no column y"),
        ("f.csv", ",".join(COLUMNS).encode() + b"\n1,2,three\n", "not a table of numbers"),
        ("f.csv", b"\xff\xfe\x00", "cannot be read as text"),
        ("f.ulg", b"ULog", "is not a PX4 log"),
        ("f.ulg", b"nothing of the kind, but long enough for a header", "is not a PX4 log"),
        ("f.rrd", b"", "is not a Rerun recording"),
        ("f.bag", b"", "is none of"),
    ],
)
def test_a_file_that_is_none_is_told_in_a_sentence(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=words) as told:
        read_flight(path)
    assert "\n" not in str(told.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_flight(tmp_path / "f.csv")
