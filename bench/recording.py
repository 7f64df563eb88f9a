"""What recording costs: the real recorder on a real bus, its share of a core, its size, whether rows are lost.

`ordinary` is a flight's own load; `bar's` is that of the bar, 40 numbers a millisecond and 250 poses a
second; `heavy` is twice as much. How many numbers were recorded is counted in the file. The numbers
tremble as a hand's and a sensor's do, in their last digits too, which no compression can shorten.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import (
    HANDLE,
    HEARTBEAT,
    PILOT_STATE,
    TICK_INPUTS,
    VEHICLE_STATE,
    Handle,
    PilotState,
    TickInputs,
    VehicleState,
)
from groundstation.recording import schema
from groundstation.recording.parts import parts_of
from groundstation.review.flight import Flight
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep
from groundstation.training.mission import find_mission, load_mission

BAR_SHARE, BAR_MB = 3.0, 1.5
# How often each topic comes, Hz.
LOADS = {"ordinary": (1000, 50, 50), "bar's": (1000, 333, 250), "heavy": (1000, 1000, 250)}
_WARM_S = 3.0


class Measured(NamedTuple):
    """What recording came to.

    Attributes:
        share: Of a core, %.
        size: MB a minute, in order.
        numbers: Recorded a millisecond.
        rows: Published.
        missing: Of these.
    """

    share: float
    size: float
    numbers: float
    rows: int
    missing: int


def _measured(load: str, seconds: float) -> Measured:
    """Record a load for a while."""
    with tempfile.TemporaryDirectory(prefix="groundstation-bench-") as folder:
        path = find_mission("paper")
        run = Run(
            run_id=new_run_id(), url="udpin://127.0.0.1:14540", simulated=True, device="made up",
            mission=load_mission(path), mission_path=str(path), settings=Settings(), log=str(Path(folder) / "flight"),
            viewer_url="", started="2026-11-22T10:00:00.000+00:00",
        )  # fmt: skip
        bus = Bus(run.run_id, "bench")
        beats = bus.subscriber(HEARTBEAT)
        process = subprocess.Popen(
            [sys.executable, "-m", "groundstation.recording.recorder", str(write_run(run))],
            stdin=subprocess.PIPE,
        )
        try:
            while not any(beat.role == b"recorder" for beat in beats.drain()):
                time.sleep(0.05)
            counts, share = _publish(bus, process.pid, LOADS[load], seconds)
        finally:
            process.terminate()
            process.wait(60.0)
            bus.close()
            sweep(run.run_id)
        flight = Flight(run.recording)
        kept = [len(flight.series(each).t) for each in (schema.HANDLE_FORCE, schema.ERROR, schema.POSITION)]
        minutes = (seconds + _WARM_S) / 60.0
        size = sum(part.stat().st_size for part in parts_of(run.recording)) / 1e6 / minutes
        every = sum(flight.series(each).values.size for each in schema.QUANTITIES)
        return Measured(share, size, every / minutes / 60e3, sum(counts), sum(counts) - sum(kept))


def _publish(bus: Bus, recorder: int, rates: tuple[int, int, int], seconds: float) -> tuple[list[int], float]:
    """Publish for a while; return how much, and the recorder's share of a core, %, once it has warmed up."""
    handles, pilots, states = (bus.publisher(topic) for topic in (HANDLE, PILOT_STATE, VEHICLE_STATE))
    inputs = bus.publisher(TICK_INPUTS)
    noise = np.random.default_rng(0).standard_normal((997, 64))
    counts = [0, 0, 0]
    began = time.monotonic()
    used = wall = 0.0
    tick = 0
    while (now := time.monotonic()) - began < seconds + _WARM_S:
        if not wall and now - began > _WARM_S:
            used, wall = _cpu(recorder), now
        row = tuple(noise[tick % len(noise)].tolist())
        handles.send(_handle(now, row))
        counts[0] += 1
        if tick % (1000 // rates[1]) == 0:
            pilots.send(_pilot(now, row))
            counts[1] += 1
        if tick % (1000 // rates[2]) == 0:
            states.send(
                VehicleState(t=now, position=row[:4], velocity=row[4:8], roll=row[8], pitch=row[9], valid=1)
            )
            inputs.send(
                TickInputs(t=now, tick=tick + 1, dt=0.001, state_t=now, fitted=2, read=1, homed=1, present=1)
            )
            counts[2] += 1
        tick += 1
        time.sleep(max(0.0, began + tick * 1e-3 - time.monotonic()))
    return counts, 100.0 * (_cpu(recorder) - used) / (time.monotonic() - wall)


def _handle(t: float, row: tuple[float, ...]) -> Handle:
    return Handle(
        t=t, position=row[:3], velocity=row[3:6], force=row[6:9], yaw=row[9], device_t=t - 1e-4 * row[10],
        homed=1, present=1,
    )  # fmt: skip


def _pilot(t: float, row: tuple[float, ...]) -> PilotState:
    return PilotState(
        t=t, p_h=row[:4], p_h_rate=row[4:8], error=row[8:12], v_ref=row[12:16], v_safe=row[16:20], v_c=row[20:24],
        force=row[24:27], environment=row[27:30], predicted=row[30:34], phase=2,
    )  # fmt: skip


def _cpu(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _floor() -> float:
    """Return what a minute of 40 trembling numbers a millisecond takes at least, MB."""
    numbers = np.random.default_rng(0).standard_normal((10_000, 40))
    packed = pa.Codec("zstd", compression_level=19).compress(numbers.T.tobytes(), asbytes=True)
    return len(packed) / 1e6 * 6.0


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    seconds = 10.0 if short else 60.0
    for load, (servo, pilot, state) in LOADS.items():
        found = _measured(load, seconds)
        yield (
            f"{load:<9} handle {servo} Hz, pilot {pilot} Hz, pose {state} Hz, {found.numbers:3.0f} numbers a ms: "
            f"{found.share:4.1f} % of a core (≤ {BAR_SHARE:g}), {found.size:5.1f} MB a minute, "
            f"{found.missing} of {found.rows} rows missing"
        )
    yield f"40 trembling numbers a millisecond, zstd 19, columns: {_floor():.1f} MB a minute (bar {BAR_MB:g})"
