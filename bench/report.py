"""How long a report on a ten-minute flight takes, and how long such a recording takes to load into arrays.

The recording is made by the recorder's own code from records at the full rates: the paper's route flown to and fro
with a hand that trembles. Report and loading each run in a process of their own, by the wall clock, imports included.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from groundstation.config import Settings
from groundstation.messages import (
    EVENT,
    HANDLE,
    HEARTBEAT,
    MISSION_PROGRESS,
    OBSTACLES,
    PILOT_STATE,
    SERVO_REPORT,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Event,
    FlightMode,
    Phase,
    Preset,
    Severity,
    Stream,
    Topic,
)
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.run import Run
from groundstation.training.mission import Mission, find_mission, load_mission

MINUTES = 10.0
REPORT_S, LOAD_S, PAGE_MB = 5.0, 1.0, 1.5
START = 1000.0
_SERVO_HZ, _PILOT_HZ, _STATUS_HZ, _SERVO_REPORT_HZ = 1000, 50, 10, 2
_ENGAGED_S, _LANDING_S = 8.0, 8.0
_LOOP_S, _LAG_S = 45.0, 0.3
_STIFFNESS = 4.0

_LOAD = """
import sys, time
began = time.perf_counter()
from pathlib import Path
from groundstation.recording import schema
from groundstation.review.flight import Flight
imported = time.perf_counter()
flight = Flight(Path(sys.argv[1]))
rows = sum(len(flight.series(quantity).t) for quantity in schema.QUANTITIES)
print(imported - began, time.perf_counter() - imported, rows)
"""
Numbers = npt.NDArray[np.float64]


def record(folder: Path, seconds: float) -> Path:
    """Record a flight that long and return its file."""
    mission = load_mission(find_mission("paper"))
    run = Run(
        run_id="1-bench",
        url="udpin://127.0.0.1:14540",
        simulated=True,
        device="made up",
        mission=mission,
        mission_path="",
        settings=Settings(),
        log=str(folder / "flight"),
        viewer_url="",
        started="2026-11-22T10:00:00.000+00:00",
    )
    session = Session(run, START, lambda _severity, words: sys.stderr.write(f"{words}\n"))
    tables = list(_tables(mission, seconds))
    for second in np.arange(seconds):
        batch = Batch()
        for topic, rows in tables:
            now = rows[(rows["t"] >= START + second) & (rows["t"] < START + second + 1.0)]
            kind: Any = topic.record * len(now)
            batch.add(topic, kind.from_buffer_copy(now.tobytes()))
        if second % 5 == 0:
            words = Event(
                t=START + second, severity=Severity.WARNING, source=b"pilot", text=b"Made up for the bench."
            )
            batch.add(EVENT, [words])
        session.take(batch)
    session.close()
    return run.recording


def _tables(mission: Mission, seconds: float) -> Iterator[tuple[Topic[Any], npt.NDArray[np.void]]]:
    """Yield a flight's records, topic by topic, a row each."""
    noise = np.random.default_rng(0)
    t = np.arange(0.0, seconds, 1.0 / _PILOT_HZ)
    p_h, rate = _way(mission, t, noise)
    p, velocity = _way(mission, t - _LAG_S, noise)
    flying = (t > _ENGAGED_S) & (t < seconds - _LANDING_S)
    yield PILOT_STATE, _rows(
        PILOT_STATE, t, p_h=p_h, p_h_rate=rate, error=p_h - p, v_ref=rate, v_safe=rate, v_c=rate,
        force=-_STIFFNESS * (p_h - p)[:, :3], environment=np.sin(p_h[:, :3]), push=0.1 * np.cos(p_h[:, :3]),
        state_age=noise.gamma(4.0, 0.005, len(t)), port_energy=0.02 * (1.0 - np.cos(t)), dissipated=1e-5 * t,
        phase=np.where(flying, Phase.ENGAGED, Phase.DISENGAGED), preset=Preset.ASSISTED,
    )  # fmt: skip
    yield SETPOINT, _rows(SETPOINT, t, velocity=rate, handle_t=START + t - 5e-4, active=flying)
    yield VEHICLE_STATE, _rows(VEHICLE_STATE, t, position=p, velocity=velocity, boot_t=t, valid=1)
    fast = np.arange(0.0, seconds, 1.0 / _SERVO_HZ)
    hand = 0.02 * np.column_stack((np.sin(fast), np.cos(0.7 * fast), np.sin(0.3 * fast)))
    trembling = hand + 1e-4 * noise.standard_normal(hand.shape)
    yield HANDLE, _rows(
        HANDLE, fast, position=trembling, velocity=np.gradient(hand, axis=0) * _SERVO_HZ, device_t=START + fast,
        force=-20.0 * hand + 0.02 * noise.standard_normal(hand.shape), tick=np.arange(len(fast)), homed=1,
        present=1,
    )  # fmt: skip
    yield from _slow(seconds, noise)


def _slow(seconds: float, noise: np.random.Generator) -> Iterator[tuple[Topic[Any], npt.NDArray[np.void]]]:
    """Yield what comes less often."""
    t = np.arange(0.0, seconds, 1.0 / _STATUS_HZ)
    in_air = (t > 1.0) & (t < seconds - 1.0)
    mode = np.where((t > _ENGAGED_S) & in_air, FlightMode.OFFBOARD, FlightMode.TAKEOFF)
    yield VEHICLE_STATUS, _rows(
        VEHICLE_STATUS, t, heard_t=START + t - noise.gamma(2.0, 0.005, len(t)), rtt=noise.gamma(9.0, 0.002, len(t)),
        battery=0.9, connected=1, armed=in_air, in_air=in_air, mode=mode, streaming=Stream.FLYING, system_id=1,
    )  # fmt: skip
    yield OBSTACLES, _rows(OBSTACLES, t, ring=3.0 + noise.random((len(t), 72)), below=2.0, above=np.inf)
    yield MISSION_PROGRESS, _rows(MISSION_PROGRESS, t, stage=b"on the way", legs=5, target_distance=5.0)
    for role in (b"pilot", b"link", b"sim", b"recorder", b"screen"):
        yield HEARTBEAT, _rows(HEARTBEAT, t, role=role, pid=1)
    t = np.arange(0.5, seconds, 1.0 / _SERVO_REPORT_HZ)
    yield SERVO_REPORT, _rows(
        SERVO_REPORT, t, rate=1000.0, late_p50=2e-5, late_p99=1e-4, late_max=noise.gamma(2.0, 2e-4, len(t)),
        read=3e-5, write=2e-5, step=2e-4, ticks=1000 * t,
    )  # fmt: skip


def _way(mission: Mission, t: Numbers, noise: np.random.Generator) -> tuple[Numbers, Numbers]:
    """Return place and velocity on the mission's route, flown to and fro, by a hand that trembles."""
    assert mission.target is not None
    points = np.array([(0.0, 0.0, 2.0), *mission.route, mission.target.position])
    along = (0.5 - 0.5 * np.cos(2.0 * np.pi * t / _LOOP_S)) * (len(points) - 1)
    place = np.column_stack([np.interp(along, range(len(points)), axis) for axis in points.T])
    place += 0.03 * np.cumsum(noise.standard_normal(place.shape), axis=0) / np.sqrt(len(t))
    place = np.column_stack((place, 0.2 * np.sin(t)))
    return place, np.gradient(place, axis=0) * _PILOT_HZ + 0.05 * noise.standard_normal(place.shape)


def _rows(topic: Topic[Any], t: Numbers, **fields: Any) -> npt.NDArray[np.void]:
    kind: npt.DTypeLike = np.dtype(topic.record)
    rows = np.zeros(len(t), kind)
    rows["t"] = START + t
    for name, values in fields.items():
        text = isinstance(values, bytes)
        rows[name] = np.frombuffer(values.ljust(rows[name].shape[1], b"\0"), dtype="S1") if text else values
    return rows


def _timed(*command: str | Path) -> tuple[float, str]:
    began = time.perf_counter()
    done = subprocess.run([sys.executable, *map(str, command)], check=True, capture_output=True, text=True)
    return time.perf_counter() - began, done.stdout


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    minutes, rounds = (2.0, 1) if short else (MINUTES, 3)
    with tempfile.TemporaryDirectory(prefix="groundstation-bench-") as folder:
        path = record(Path(folder), 60.0 * minutes)
        yield f"a recording of {minutes:g} minutes, {path.stat().st_size / 1e6:.0f} MB"
        loads = [_timed("-c", _LOAD, path)[1].split() for _ in range(rounds)]
        imports, load = (min(float(each[column]) for each in loads) for column in (0, 1))
        name = f"loaded to arrays, {loads[0][2]} rows"
        yield f"{name:<44} {load:6.2f} s  (≤ {LOAD_S:g} s; imports {imports:.2f} s)"
        page = path.with_suffix(".html")
        report = ("-m", "groundstation.cli", "report", path)
        took = min(_timed(*report)[0] for _ in range(rounds))
        size = page.stat().st_size / 1e6
        yield f"{'report, one page':<44} {took:6.2f} s  (≤ {REPORT_S:g} s)"
        yield f"{'its size':<44} {size:6.2f} MB (≤ {PAGE_MB:g} MB)"
        yield f"{'report, with a PDF':<44} {_timed(*report, '--pdf')[0]:6.2f} s"
        compare = ("-m", "groundstation.cli", "report", "--compare", path, path, "--out", page)
        yield f"{'comparison of two such':<44} {_timed(*compare)[0]:6.2f} s"
