"""One flight being recorded: batches of records in, a file and perhaps a live view out."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import rerun.blueprint as rrb

from groundstation.conditions import Conditions
from groundstation.failsafe import BY_FAULT, Fault
from groundstation.messages import DEVICE_REPORT, Severity
from groundstation.recording.about import about_device, about_flight
from groundstation.recording.batch import Batch
from groundstation.recording.blueprint import blueprint
from groundstation.recording.changes import Changes
from groundstation.recording.columns import Heartbeats, OnChange, number_chunks, number_columns
from groundstation.recording.echoes import Echoes
from groundstation.recording.feed import LiveFeed
from groundstation.recording.file import FlightFile, RecordingError, free_ended
from groundstation.recording.gauges import Gauges
from groundstation.recording.ghost import Ghost
from groundstation.recording.incidents import Incidents
from groundstation.recording.interventions import Interventions
from groundstation.recording.item import Item
from groundstation.recording.motion import Motion
from groundstation.recording.parts import part_path
from groundstation.recording.room import left_gb
from groundstation.recording.scene import static_scene
from groundstation.recording.story import Story
from groundstation.recording.style import static_styles
from groundstation.run import Run

Tell = Callable[[Severity, str], None]

_MB = 1e6
_DISK_LOW = BY_FAULT[Fault.DISK_LOW]
# Of a record all but its time.
_AFTER_TIME = 8


class Translator:
    """Turns batches of records into items; holds what reaches from one batch into the next.

    Args:
        run: The run.
        start: Monotonic time that is 0 on the timeline, s.
    """

    def __init__(self, run: Run, start: float) -> None:
        self._run = run
        self._start = start
        self._changes = Changes(start)
        self._heartbeats = Heartbeats()
        self._on_change = OnChange()
        self._motion = Motion(start, heading=run.settings.mapping.frame == "heading")
        self._echoes = Echoes(start)
        self._gauges = Gauges(start, run.settings.shield)
        self._incidents = Incidents(start)
        self._story = Story(start)
        self._ghost = Ghost(start, run.ghost)
        self._interventions = Interventions(start)
        self._device = b""

    def opening(self) -> Iterator[Item]:
        """Yield what is logged before all else."""
        yield from about_flight(self._run, self._start)
        yield from static_styles()
        yield from static_scene(self._run.mission)

    def items(self, batch: Batch) -> Iterator[Item]:
        """Yield a batch's items."""
        yield from number_chunks(number_columns(batch), self._start)
        yield from number_chunks(self._on_change.columns(batch), self._start)
        yield from self._heartbeats.chunks(batch, self._start)
        yield from self._changes.chunks(batch)
        yield from self._changes.texts(batch)
        yield from self._motion.chunks(batch)
        yield from self._echoes.chunks(batch)
        yield from self._gauges.chunks(batch)
        yield from self._incidents.chunks(batch)
        yield from self._story.chunks(batch)
        yield from self._ghost.chunks(batch)
        yield from self._interventions.chunks(batch)
        for report in batch.of(DEVICE_REPORT):
            if report.present and (known := bytes(report)[_AFTER_TIME:]) != self._device:
                self._device = known
                yield from about_device(self._run, report)


class Session:
    """Where the items go: files, part after part, and perhaps a live view.

    Args:
        run: The run.
        start: Monotonic time that is 0 on the timeline, s.
        tell: Makes an event of what people must know.
        to_file: Into files, not only the live view.
    """

    def __init__(self, run: Run, start: float, tell: Tell, *, to_file: bool = True) -> None:
        self._run = run
        self._limits = run.settings.recording
        self._translator = Translator(run, start)
        self._tell = tell
        layout = blueprint(run.mission)
        self._file: FlightFile | None = None
        self._parts = 1
        self._ending: list[threading.Thread] = []
        if to_file:
            self._open(run.recording, layout)
        self._first = self._file.path if self._file else run.recording
        self._feed = LiveFeed(run.viewer_url, run.run_id, layout) if run.viewer_url else None
        self._slow_viewer = self._told_full = False
        self._spread(list(self._translator.opening()))

    def take(self, batch: Batch) -> None:
        """Record a batch."""
        if self._file or self._feed:
            self._spread(list(self._translator.items(batch)))
        if self._file:
            self._watch(self._file)

    def close(self) -> None:
        """End the files and the live view."""
        if self._feed:
            self._feed.close()
        if self._file:
            self._end(self._file)
        for thread in self._ending:
            thread.join()

    def _open(self, path: Path, layout: rrb.Blueprint | None = None) -> None:
        """Begin a file; the first has the layout for all: Rerun keeps 2 MB of each that it is given."""
        try:
            self._file = FlightFile(path, self._run.run_id, layout)
        except RecordingError as error:
            self._file = None
            self._tell(Severity.ALARM, str(error))

    def _watch(self, file: FlightFile) -> None:
        """Go on in a next part where this one is large; say once that the disk gets full."""
        if file.size > self._limits.part_mb * _MB:
            # To put a part in order takes seconds: beside the loop that reads the bus.
            thread = threading.Thread(target=self._end_part, args=(file,), name="part")
            self._ending.append(thread)
            thread.start()
            self._parts += 1
            self._open(part_path(self._first, self._parts))
            self._write(list(self._translator.opening()))
        left = left_gb(file.path.parent)
        c = Conditions(disk_gb=left, disk_least_gb=self._limits.warn_gb)
        if _DISK_LOW.holds(c, self._run.settings.safety) and not self._told_full:
            self._told_full = True
            self._tell(_DISK_LOW.severity, f"The disk of {file.path.parent} has {_DISK_LOW.say(c)}.")

    def _end_part(self, file: FlightFile) -> None:
        """End a file that another follows, and give back what it took, unless that waits for a viewer."""
        self._end(file)
        if self._feed is None:
            free_ended()

    def _end(self, file: FlightFile) -> None:
        """End a file and put it in order."""
        try:
            if not file.close():
                self._tell(
                    Severity.INFO,
                    f"{file.path} is complete; making it smaller took too long and was left out.",
                )
        except RecordingError as error:
            self._tell(Severity.ALARM, str(error))

    def _spread(self, items: list[Item]) -> None:
        self._write(items)
        if self._feed and not self._feed.offer(items) and not self._slow_viewer:
            self._slow_viewer = True
            self._tell(
                Severity.WARNING, "The live viewer does not keep up and misses data; the recording does not."
            )

    def _write(self, items: list[Item]) -> None:
        if self._file:
            try:
                self._file.write(items)
            except RecordingError as error:
                self._tell(Severity.ALARM, str(error))
                self._file = None
