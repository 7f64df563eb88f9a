"""What the tests of recording and review share: a recorder process on a bus of its own, and records to publish."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import (
    EVENT,
    HANDLE,
    HEARTBEAT,
    RING_SECTORS,
    Event,
    FlightMode,
    Handle,
    Phase,
    PilotState,
    Preset,
    Ranges,
    Setpoint,
    Stream,
    VehicleState,
    VehicleStatus,
)
from groundstation.recording.batch import Batch
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep
from groundstation.training.mission import find_mission, load_mission

PATIENCE_S = 60.0
STARTED = "2026-11-22T10:00:00.000+00:00"


def a_run(log: Path, *, viewer_url: str = "", mission: bool = True) -> Run:
    path = find_mission("paper")
    return Run(
        run_id=new_run_id(),
        url="udpin://127.0.0.1:14540",
        simulated=True,
        device="scripted:test",
        mission=load_mission(path) if mission else None,
        mission_path=str(path),
        settings=Settings(),
        log=str(log),
        viewer_url=viewer_url,
        started=STARTED,
    )


def batch_of(topic, *records) -> Batch:
    batch = Batch()
    batch.add(topic, records)
    return batch


def rows(chunks) -> dict[str, list[tuple[float, str]]]:
    found: dict[str, list[tuple[float, str]]] = {}
    for chunk in chunks:
        times = (chunk.times.times.cast("int64").to_numpy() * 1e-9).round(6).tolist()
        cells = next(iter(chunk.columns)).as_arrow_array().to_pylist()
        found[chunk.path] = [(t, cell[0]) for t, cell in zip(times, cells, strict=True)]
    return found


def until(condition: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"waited {PATIENCE_S:.0f} s for {what}"
        time.sleep(0.02)


class Recorder:
    """A recorder process and the bus it listens on."""

    def __init__(self, run: Run, bus: Bus, process: subprocess.Popen[bytes]) -> None:
        self.run, self.bus, self.process = run, bus, process
        self._events = bus.subscriber(EVENT)
        self.events: list[Event] = []

    @property
    def path(self) -> Path:
        return self.run.recording

    def said(self, severity: int, words: str) -> bool:
        self.events.extend(self._events.drain())
        return any(e.severity == severity and words in e.text.decode() for e in self.events)

    def publish_handles(self, count: int, *, start: float | None = None) -> list[Handle]:
        """Publish a servo's records, 50 at a time every 50 ms as at 1 kHz, and return them."""
        publisher = self.bus.publisher(HANDLE)
        base = time.monotonic() if start is None else start
        sent = [a_handle(base + tick * 1e-3, tick) for tick in range(count)]
        for first in range(0, count, 50):
            for record in sent[first : first + 50]:
                publisher.send(record)
            time.sleep(0.05)
        return sent

    def end(self, number: int = signal.SIGTERM) -> int:
        self.process.send_signal(number)
        return self.process.wait(PATIENCE_S)


@contextmanager
def recorder(run: Run) -> Iterator[Recorder]:
    """Start a recorder process and wait until its loop turns; end it and sweep its bus."""
    run_file = write_run(run)
    bus = Bus(run.run_id, "test")
    heartbeats = bus.subscriber(HEARTBEAT)
    process = subprocess.Popen(
        [sys.executable, "-m", "groundstation.recording.recorder", str(run_file)],
        # Rerun swallows wrong data with a warning unless it is strict.
        env={**os.environ, "RERUN_STRICT": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    beats = 0

    def turns() -> bool:
        nonlocal beats
        assert process.poll() is None, "the recorder died at its start"
        beats += sum(beat.role == b"recorder" for beat in heartbeats.drain())
        return beats > 1

    started = Recorder(run, bus, process)
    try:
        until(turns, "the recorder's heartbeats")
        yield started
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        bus.close()
        sweep(run.run_id)


def a_handle(t: float, tick: int) -> Handle:
    record = Handle(t=t, yaw=tick * 1e-4, device_t=t, tick=tick, buttons=0, homed=1, present=1)
    record.position[:] = (tick * 1e-6, -tick * 1e-6, 0.01)
    record.velocity[:] = (0.1, -0.2, tick * 1e-3)
    record.force[:] = (tick * 1e-3, 2.0, -3.0)
    return record


def a_pilot_state(
    t: float, *, phase: Phase = Phase.ENGAGED, on_leash: bool = False, guarding: bool = False
) -> PilotState:
    record = PilotState(t=t, state_age=0.02, phase=phase, on_leash=on_leash, centred=1)
    record.p_h[:] = (2.0, 3.0, 2.5, 0.5)
    record.error[:] = (0.5, 1.0, 0.5, 0.1)
    record.v_ref[:] = (0.1, 0.2, 0.3, 0.4)
    record.v_safe[:] = (0.05, 0.2, 0.3, 0.4)
    record.v_c[:] = (0.04, 0.2, 0.3, 0.4)
    record.force[:] = (0.0, 3.0, 4.0)
    record.environment[:] = (-1.0, 0.0, 0.0)
    record.mismatch[:] = (0.0, -2.0, 0.0)
    record.guard[:] = (0.0, 0.0, 3.0)
    record.damping[:] = (0.1, 0.2, 0.2)
    record.predicted[:] = (2.5, 2.5, 2.0, 0.4)
    record.predicted_velocity[:] = (1.0, 0.5, 0.0)
    record.stop[:] = (3.0, 2.75, 2.0)
    record.push[:] = (0.1, -0.2, 0.0)
    record.k1[:] = (1.2, 1.2, 1.1, 1.0)
    record.delay, record.phase_margin, record.gain_share, record.speed_share = 0.31, 0.8, 0.9, 0.7
    record.preset, record.cues, record.guarding, record.guarded_by = Preset.ASSISTED, 31, guarding, b"crate"
    return record


def a_ranges(t: float, **distances: float) -> Ranges:
    """Return what sensors see: nothing around but what is said of a sector, 1.5 m below, and nothing known above."""
    record = Ranges(t=t, below=1.5, above=float("nan"), limit=12.0)
    record.ring[:] = [float("inf")] * RING_SECTORS
    for sector, distance in distances.items():
        record.ring[int(sector.removeprefix("at"))] = distance
    return record


def a_vehicle_state(t: float, *, position: tuple[float, ...] = (1.0, 2.0, 3.0, 0.4), valid: bool = True):
    record = VehicleState(t=t, roll=0.1, pitch=-0.2, boot_t=t + 100.0, valid=valid)
    record.position[:] = position
    record.velocity[:] = (1.0, -2.0, 0.5, 0.25)
    return record


def a_setpoint(t: float, *, active: bool = True) -> Setpoint:
    record = Setpoint(t=t, handle_t=t - 0.004, number=1, active=active)
    record.velocity[:] = (1.0, 2.0, 3.0, 4.0)
    return record


def a_status(t: float, *, mode: FlightMode = FlightMode.OFFBOARD, connected: bool = True) -> VehicleStatus:
    return VehicleStatus(
        t=t,
        heard_t=t - 0.03,
        loss=0.02,
        rtt=float("nan"),
        battery=0.9,
        voltage=22.0,
        sent=10,
        dropped=2,
        health=127,
        system_id=1,
        connected=connected,
        armed=1,
        in_air=1,
        mode=mode,
        streaming=Stream.FLYING,
    )
