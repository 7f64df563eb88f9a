"""`groundstation replay`: a recorded hand once more, and what came out beside what was recorded."""

from __future__ import annotations

import argparse
import datetime
import json
import os
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation.flight import VirtualFlight
from groundstation.evaluation.local_site import handle_at
from groundstation.evaluation.remote_site import TakeOffError
from groundstation.evaluation.sample import Observer
from groundstation.messages import Severity
from groundstation.pilot.guest import load_controller
from groundstation.recording.live import find_viewer, has_display, start_viewer
from groundstation.recording.session import Session
from groundstation.replay.changes import channel_for, mission_for, settings_for
from groundstation.replay.check import check
from groundstation.replay.figures import Row, fingerprint, rows
from groundstation.replay.flying import RATE_HZ, NotCoupledError, Pace, Replay, What
from groundstation.replay.records import ReplayRecorder
from groundstation.review.choosing import chosen
from groundstation.review.flight import Flight
from groundstation.review.recorded_series import recorded_series
from groundstation.run import Run
from groundstation.run_folder import new_run_id
from groundstation.status_line import StatusLine
from groundstation.training.director import Director
from groundstation.training.mission import Mission
from sim.environment.world import World

EXIT_FAILED = 1
_SLOWEST, _FASTEST = 1.0, 100.0


class Result(NamedTuple):
    """What a replay came to besides its figures.

    Attributes:
        collisions: With obstacles.
        speed: How many times life.
        decisions: Stands for all of them; the same whenever the same is replayed on the same version.
    """

    collisions: int
    speed: float
    decisions: str


def run(asked: argparse.Namespace) -> int:
    """Replay what was asked for and return the exit code.

    Raises:
        InputError: The recording, a setting, a file or the viewer cannot be had.
    """
    if asked.check:
        words, code = check(asked)
        print(words)
        return code
    if asked.speed is not None and not _SLOWEST <= asked.speed <= _FASTEST:
        raise InputError(
            f"--speed {asked.speed:g}: give {_SLOWEST:g} to {_FASTEST:g}, or leave it out to fly as fast as it goes."
        )
    if asked.out is not None and (asked.out.suffix != ".rrd" or asked.out.exists()):
        raise InputError(f"{asked.out}: name an .rrd file that is not there yet.")
    flight = Flight(chosen(asked.flight, asked.logs))
    settings, mission = settings_for(asked, flight), mission_for(asked, flight)
    facts = flight.properties()
    controller = asked.controller or str(facts.get("controller", "paper"))
    seed = int(facts.get("seed", 0)) if asked.seed is None else asked.seed
    what = What(settings, mission, load_controller(controller, settings), channel_for(asked), seed)
    began = time.monotonic()
    with ExitStack() as ending:
        session = (
            _session(asked, flight, settings, mission)
            if asked.out or asked.rerun or asked.viewer is not None
            else None
        )
        if session:
            ending.callback(session.close)
        line = ending.enter_context(StatusLine(sys.stderr))
        try:
            replay = Replay(
                flight,
                what,
                lambda virtual: [_shown(line), *_observers(asked, virtual, what, session, ending)],
            )
            replayed = replay.fly()
        except (TakeOffError, NotCoupledError) as error:
            line.note(f"groundstation: {error}")
            return EXIT_FAILED
        took = time.monotonic() - began
    recorded = recorded_series(flight)
    assert recorded is not None
    result = Result(replay.collisions, replay.seconds / max(took, 1e-9), fingerprint(replayed))
    _tell(asked, rows(recorded, replayed, mission), result)
    if asked.rerun and sys.stdin.isatty() and not has_display(os.environ):
        sys.stderr.write("The page is there until Ctrl-C.\n")
        threading.Event().wait()
    return 0


def _session(asked: argparse.Namespace, flight: Flight, settings: Settings, mission: Mission) -> Session:
    """Return where the replay is recorded and shown."""
    url = ""
    if asked.viewer is not None:
        url = find_viewer(asked.viewer)
    elif asked.rerun:
        url = start_viewer()
    out = asked.out or Path(f".{flight.path.stem}.replay.rrd")
    run = Run(
        run_id=new_run_id(),
        url=f"replay of {flight.path.name}",
        simulated=True,
        device="recorded hand",
        mission=mission,
        mission_path="",
        settings=settings,
        log=str(out.with_suffix("")),
        viewer_url=url,
        started=datetime.datetime.now().astimezone().isoformat(timespec="milliseconds"),
        pilot=str(flight.properties().get("pilot", "")),
    )

    def tell(severity: Severity, words: str) -> None:
        if severity is not Severity.INFO:
            sys.stderr.write(f"{words}\n")

    return Session(run, 0.0, tell, to_file=asked.out is not None)


def _observers(
    asked: argparse.Namespace,
    virtual: VirtualFlight,
    what: What,
    session: Session | None,
    ending: ExitStack,
) -> Iterator[Observer]:
    """Yield who sees the replay, in the order of what they do."""
    if session:
        director = Director(what.mission, World(what.mission.obstacle), virtual.vehicle.airframe.radius)
        recorder = ReplayRecorder(session, virtual.local, director, handle_at(RATE_HZ))
        ending.callback(recorder.flush)
        yield recorder
    if asked.speed:
        yield Pace(asked.speed)


def _shown(line: StatusLine) -> Observer:
    """Return who tells how far it is."""
    return lambda sample: line.step(f"{sample.t:.1f} s, {sample.phase.name.lower()}")


def _tell(asked: argparse.Namespace, found: Sequence[Row], result: Result) -> None:
    """Print what came out."""
    if asked.json:
        print(json.dumps(_as_json(found, result)))
        return
    print(_table(found))
    print(f"{'collisions in the replay':<40}{result.collisions:>12}")
    print(f"\n{result.speed:.0f} × life; decisions {result.decisions}")
    if asked.out:
        print(asked.out)


def _table(found: Sequence[Row]) -> str:
    lines = [f"{'':<28}{'recorded':>12}{'replayed':>12}"]
    for row in found:
        cells = "".join(("" if value is None else f"{value:.3f}").rjust(12) for value in row[2:])
        lines.append(f"{row.name + ', ' + row.unit:<28}{cells}")
    return "\n".join(lines)


def _as_json(found: Sequence[Row], result: Result) -> dict[str, object]:
    numbers = {
        f"{row.name} ({row.unit})": {"recorded": row.recorded, "replayed": row.replayed} for row in found
    }
    return {"figures": numbers, **result._asdict()}
