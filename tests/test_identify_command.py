"""`groundstation identify` on tables, PX4 logs and recordings: what it reads, says and writes."""

import json
import struct
from contextlib import redirect_stdout
from io import StringIO

import msgspec
import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from identify_support import DT, a_flight
from recording_support import a_run, a_setpoint, a_vehicle_state

from groundstation import cli
from groundstation.errors import InputError
from groundstation.identification.samples import on_grid, step_of
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
    yaw = (yaw + np.pi) % (2.0 * np.pi) - np.pi
    table = np.column_stack((raw.t, yaw, vx, vy, raw.v[:, 2], raw.v[:, 3], raw.ref))
    np.savetxt(path, table, delimiter=",", header=",".join(COLUMNS), comments="")
    return path


# As PX4 names them since 1.13, and before.
NEW = "trajectory_setpoint", "float[3] position;float[3] velocity;float yawspeed;"
FORMER = "trajectory_setpoint", "float x;float y;float z;float vx;float vy;float vz;float yawspeed;"
OLD = "vehicle_local_position_setpoint", "float x;float y;float z;float vx;float vy;float vz;float yawspeed;"
NOWHERE = (float("nan"),) * 3


def a_ulog(path, raw, setpoints=NEW, *, position=NOWHERE, every=1, heading=True, landed=False):
    """Write a PX4 log, byte by byte after its published format: header, definitions, subscriptions, data."""
    looks = "float heading;" if heading else ""
    formats = {
        "vehicle_local_position": f"float vx;float vy;float vz;{looks}bool v_xy_valid;",
        "vehicle_angular_velocity": "float[3] xyz;",
        setpoints[0]: setpoints[1],
        "vehicle_attitude": "float[4] q;",
        "vehicle_land_detected": "bool landed;",
    }

    def message(kind, content):
        return struct.pack("<HB", len(content), ord(kind)) + content

    out = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    out += message("B", bytes(40))
    for name, fields in formats.items():
        out += message("F", f"{name}:uint64_t timestamp;{fields}".encode())
    for number, name in enumerate(formats):
        out += message("A", struct.pack("<BH", 0, number) + name.encode())
    yaw, vx, vy = world(raw)
    c, s = np.cos(yaw), np.sin(yaw)
    rx, ry = c * raw.ref[:, 0] - s * raw.ref[:, 1], s * raw.ref[:, 0] + c * raw.ref[:, 1]
    for k, t in enumerate(raw.t):
        at = int((t + 1.0) * 1e6)
        # North, east, down, and heading clockwise from north.
        towards = np.pi / 2 - yaw[k]
        looking = (towards,) if heading else ()
        velocity = (vy[k], vx[k], -raw.v[k, 2])
        out += message("D", struct.pack(f"<HQ{3 + heading}f?", 0, at, *velocity, *looking, True))
        out += message("D", struct.pack("<HQ3f", 1, at, 0.0, 0.0, -raw.v[k, 3]))
        if k % every == 0:
            asked = (ry[k], rx[k], -raw.ref[k, 2], -raw.ref[k, 3])
            out += message("D", struct.pack("<HQ7f", 2, at, *position, *asked))
        turned = np.cos(towards / 2), 0.0, 0.0, np.sin(towards / 2)
        out += message("D", struct.pack("<HQ4f", 3, at, *turned))
        out += message("D", struct.pack("<HQ?", 4, at, landed))
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


def an_old_ulog(path, raw):
    return a_ulog(path, raw, OLD, heading=False)


def a_former_ulog(path, raw):
    return a_ulog(path, raw, FORMER)


def a_sparse_ulog(path, raw):
    return a_ulog(path, raw, every=10)


@pytest.mark.parametrize(
    ("suffix", "write", "exact"),
    [
        (".csv", a_table, 1e-3),
        (".ulg", a_ulog, 0.03),
        (".ulg", a_former_ulog, 0.03),
        (".ulg", an_old_ulog, 0.03),
        (".ulg", a_sparse_ulog, 0.25),
        (".rrd", a_recording, 0.03),
    ],
)
def test_every_source_tells_the_same_flight(tmp_path, suffix, write, exact):
    raw, _ = a_flight(seconds=12.0, noise=(0.0,) * 4)
    read = read_flight(write(tmp_path / f"flight{suffix}", raw))
    assert step_of("flight", read) == pytest.approx(DT, rel=1e-3)
    (stretch,) = on_grid("flight", read, DT).stretches
    n = min(len(stretch.v), len(raw.t))
    assert n > 0.95 * len(raw.t)
    assert stretch.v[:n] == pytest.approx(raw.v[:n], abs=5e-3)
    # References may be told as much as a step sooner or later.
    assert stretch.ref[:n] == pytest.approx(raw.ref[:n], abs=exact)


@pytest.mark.parametrize("changes", [{"position": (0.0, 0.0, -2.0)}, {"landed": True}])
def test_only_velocity_setpoints_in_the_air_count_in_a_ulog(tmp_path, changes):
    raw, _ = a_flight(seconds=8.0)
    read = read_flight(a_ulog(tmp_path / "flight.ulg", raw, **changes))
    with pytest.raises(InputError, match="references were sent and velocities known"):
        on_grid("flight", read, DT)


@given(st.data())
@settings(max_examples=25, deadline=None)
def test_a_damaged_ulog_is_read_as_far_as_possible_or_told_in_a_sentence(a_whole_ulog, data):
    whole, path = a_whole_ulog
    spoilt = bytearray(whole)
    for place in data.draw(st.lists(st.integers(0, min(1500, len(whole) - 1)), max_size=4)):
        spoilt[place] ^= data.draw(st.integers(1, 255))
    path.write_bytes(spoilt[: data.draw(st.integers(0, len(spoilt)))])
    with redirect_stdout(StringIO()) as printed:
        try:
            read = read_flight(path)
            assert read.v.shape == (len(read.t), 4)
        except InputError as error:
            assert "\n" not in str(error)
    assert not printed.getvalue()


@pytest.fixture(scope="module")
def a_whole_ulog(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ulog")
    return a_ulog(folder / "whole.ulg", a_flight(seconds=6.0)[0]).read_bytes(), folder / "spoilt.ulg"


def test_a_log_that_was_cut_off_is_used_and_said_to_be_damaged(tmp_path, capsys):
    path = a_ulog(tmp_path / "cut.ulg", a_flight(seconds=20.0)[0])
    path.write_bytes(path.read_bytes()[:-37] + bytes(100))
    code, out, err = run(capsys, path)
    assert code == 0
    assert "cut.ulg: is damaged; what could be read is used." in err
    assert "learned from cut.ulg" in out


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["identify", *map(str, arguments)])
    out = capsys.readouterr()
    return end.value.code, out.out, out.err


def test_it_writes_an_airframe_that_flies_and_a_page(tmp_path, capsys):
    raw, chi = a_flight(seconds=60.0)
    flight = a_table(tmp_path / "flight.csv", raw)
    preset, page = tmp_path / "mine.toml", tmp_path / "mine.html"
    code, out, _ = run(
        capsys, flight, "--out", preset, "--report", page, "--compare", "matrice_100", "--json"
    )
    assert code == 0
    found = json.loads(out)
    assert list(found["chi"].values()) == pytest.approx(chi, rel=0.03)
    assert all(found["low"][name] <= value <= found["high"][name] for name, value in found["chi"].items())
    assert found["flights"]["flight.csv"]["r2_free"] == pytest.approx([1.0] * 4, abs=0.02)
    assert list(found["compared"]["chi"].values()) == list(chi)
    airframe = load_airframe(str(preset))
    assert astuple(airframe.chi) == pytest.approx(tuple(found["chi"].values()), abs=1e-5)
    assert airframe.body is None
    assert "dynamic" in airframe.models()
    written = preset.read_text()
    assert "# Learned from flight.csv, 60 s." in written
    assert f"chi_19 = {round(found['chi']['chi_19'], 5)}  # {found['low']['chi_19']:.4f} to" in written
    assert page.read_text().count("<svg") == 2
    # Again is no trouble, and somebody else's file is left alone.
    assert run(capsys, flight, "--out", preset, "--json")[0] == 0
    preset.write_text("schema = 1")
    code, _, err = run(capsys, flight, "--out", preset)
    assert (code, "is there already" in err) == (2, True)
    assert preset.read_text() == "schema = 1"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["flight.csv", "mine.html", "mine.toml"]


def test_an_airframe_that_cannot_fly_is_not_written(tmp_path, capsys):
    """Its cross terms are harmless at 40 degrees/s, and unstable at the 90 of the airframe that it is made like."""
    slow = msgspec.to_builtins(load_airframe("matrice_100"))
    slow["chi"] |= {"chi_11": 0.5, "chi_13": 0.5}
    slow["yaw_rate_deg"] = 40.0
    path = tmp_path / "slow.toml"
    path.write_text(tomli_w.dumps({key: value for key, value in slow.items() if value is not None}))
    flight = a_table(tmp_path / "flight.csv", a_flight(str(path), seconds=40.0)[0])
    code, _, err = run(capsys, flight, "--out", tmp_path / "mine.toml")
    assert code == 2
    assert (
        "mine.toml: is not written, for what was found cannot be flown (chi.chi_11, chi.chi_13: unstable"
        in err
    )
    assert run(capsys, flight, "--out", tmp_path / "mine.toml", "--like", path)[0] == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["flight.csv", "mine.toml", "slow.toml"]


def test_the_table_tells_what_was_not_learned_from_and_the_matrix(tmp_path, capsys):
    flights = [a_table(tmp_path / f"{seed}.csv", a_flight(seconds=16.0, seed=seed)[0]) for seed in range(3)]
    code, out, err = run(capsys, flights[0], flights[1], "--validate", flights[2])
    assert code == 0
    assert "2.csv (not learned from)" in out
    assert "0.csv → 1.csv" in out
    assert "free flight, start to end" in out
    assert "if nothing changed" in out
    # Not on a terminal: a line a step, and no control characters.
    assert "cross-validating\n" in err
    assert "\x1b" not in out + err


def test_a_delay_that_the_airframe_does_not_have_is_told(tmp_path, capsys):
    flight = a_table(tmp_path / "flight.csv", a_flight(seconds=30.0, delay=0.2)[0])
    _, _, err = run(capsys, flight, "--out", tmp_path / "mine.toml")
    assert "The delay of 0.20 s is not in the airframe" in err
    code, out, err = run(capsys, flight, "--out", tmp_path / "late.toml", "--no-delay")
    assert code == 0
    assert "no delay looked for" in out
    assert "is not in the airframe" not in err
    sooner, later = (load_airframe(str(tmp_path / name)).chi for name in ("mine.toml", "late.toml"))
    assert later.chi_1 > sooner.chi_1 + 0.05


def test_what_hardly_moved_is_told_as_still(tmp_path, capsys):
    raw, _ = a_flight(seconds=25.0)
    v, ref = raw.v.copy(), raw.ref.copy()
    v[:, 2] = ref[:, 2] = 0.0
    flights = [a_table(tmp_path / "a.csv", raw), a_table(tmp_path / "b.csv", raw._replace(v=v, ref=ref))]
    code, out, _ = run(capsys, flights[0], "--validate", flights[1], "--json")
    assert code == 0
    assert json.loads(out)["flights"]["b.csv"]["r2_free"][2] is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--out", "x.txt"), "ends in .toml"),
        (("--report", "x.pdf"), "ends in .html"),
        (("--out", "nowhere/x.toml"), "there is no folder"),
        (("--like", "nothing"), "--like: nothing: no such airframe"),
        (("--compare", "nothing"), "--compare: nothing: no such airframe"),
    ],
)
def test_what_cannot_be_written_or_compared_is_told_before_anything_is_computed(
    tmp_path, capsys, monkeypatch, arguments, words
):
    monkeypatch.chdir(tmp_path)
    flight = a_table(tmp_path / "flight.csv", a_flight(seconds=6.0)[0])
    code, _, err = run(capsys, flight, *arguments)
    assert (code, words in err) == (2, True)
    assert "estimating" not in err


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("f.csv", b"", "has no column t"),
        ("f.csv", b"t,x\n1,2\n", "has no column yaw, vx"),
        ("f.csv", ",".join(COLUMNS).encode() + b"\n", "has no rows"),
        (
            "f.csv",
            ",".join((*COLUMNS, "more")).encode() + b"\n" + b",".join([b"1"] * len(COLUMNS)),
            "11 names but 10",
        ),
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
