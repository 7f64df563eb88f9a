"""One run of the program: what the supervisor decides once and every process reads."""

from __future__ import annotations

import datetime
from pathlib import Path

import msgspec
from msgspec import Struct

from groundstation.config import Settings
from groundstation.run_folder import own_folder, run_folder
from groundstation.training.measures import Measures, Track
from groundstation.training.mission import Mission

RUN_FILE = "run.json"
_LONGEST_START_S = 60.0


class Run(Struct, frozen=True):
    """What a run is made of.

    Attributes:
        run_id: Names the bus and the run's folder.
        url: Where the vehicle is, as in `--connect`.
        simulated: The vehicle is ours. For labels, for asking back, and for what an instructor or a timetable lets
            happen; never for control.
        device: Which haptic device, as `driver` or `driver:address`.
        mission: The mission, or None for free flight.
        mission_path: Its file, or "".
        settings: All settings.
        log: Path of the recording without suffix; `.rrd` and `.tlog` are beside each other.
        viewer_url: A live Rerun viewer to stream to, or "".
        terminal: The terminal the screen is on, or "": who is left gives it back when the screen is killed.
        controller: What flies, as `module:Class`, or "paper".
        started: Wall-clock time of the start, ISO 8601.
        pilot: Who flies, as people know them.
        seed: Of all that is random in the simulation.
        config: The settings file, or "" where they are the defaults.
        par: What the flight is held against; None where nobody has flown the mission for reference.
        par_from: Whose it is, in words, or "".
        signing_key: The file with the key for MAVLink signing, or "". The key itself is nowhere but there.
        ghost: The flight that is followed on map and in the viewer, or None.
        guidance: How strongly the hand is guided towards the mission's way, 0 to 1.
        skill: What the pilot can of what the mission trains, 0 to 1: the coach says the less.
    """

    run_id: str
    url: str
    simulated: bool
    device: str
    mission: Mission | None
    mission_path: str
    settings: Settings
    log: str
    viewer_url: str
    started: str
    terminal: str = ""
    controller: str = "paper"
    pilot: str = ""
    seed: int = 0
    config: str = ""
    par: Measures | None = None
    par_from: str = ""
    signing_key: str = ""
    ghost: Track | None = None
    guidance: float = 0.0
    skill: float = 0.0

    @property
    def hand(self) -> Path | None:
        """The socket by which this program itself moves the device, or None where a person holds it.

        It lies in the run's own folder, and stands last in the device's address.
        """
        path = Path(self.device.replace("@", ":").rpartition(":")[2])
        return path if path.parent == run_folder(self.run_id) else None

    @property
    def recording(self) -> Path:
        """The Rerun recording's path."""
        return Path(f"{self.log}.rrd")

    @property
    def tlog(self) -> Path:
        """The MAVLink log's path."""
        return Path(f"{self.log}.tlog")


def write_run(run: Run) -> Path:
    """Write the run file where its processes find it and return its path."""
    path = own_folder(run.run_id) / RUN_FILE
    new = path.with_suffix(".new")
    new.write_bytes(msgspec.json.encode(run))
    # In one step: a process that reads it meanwhile finds the one or the other.
    new.replace(path)
    return path


def run_file(run_id: str) -> Path:
    """Return where a run's file is."""
    return run_folder(run_id) / RUN_FILE


def read_run(path: Path) -> Run:
    """Read a run file back."""
    return msgspec.json.decode(path.read_bytes(), type=Run)


def start_of(started: str, wall: datetime.datetime, monotonic: float) -> float:
    """Return when a run was started on the monotonic clock, s.

    Args:
        started: Wall-clock time of the start, ISO 8601.
        wall: Wall-clock time now.
        monotonic: Monotonic time now, s; also the answer where the wall clock was put right in between.
    """
    age = (wall - datetime.datetime.fromisoformat(started)).total_seconds()
    return monotonic - age if 0.0 <= age <= _LONGEST_START_S else monotonic
