"""One moment as the instruments see it: the snapshot and what the screen itself knows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from groundstation.console import Snapshot
from groundstation.messages import CommandKind, PilotState, Record
from groundstation.run import Run
from groundstation.training.director import Figures
from groundstation.training.guide import Guide
from groundstation.training.judgement import Judgement
from groundstation.training.score import Score
from groundstation.tui.acts import PILOT_STALE_S
from groundstation.tui.alarms import Alarms
from groundstation.tui.hand import Share4
from groundstation.tui.notes import Note
from groundstation.tui.track import History, Track
from groundstation.tui.ways import KEYS, Ways

# Reports come twice a second.
REPORT_STALE_S = 2.0
STATUS_STALE_S = 1.0
FALLBACK_WORKSPACE_M = 0.1
FALLBACK_FORCE_N = 5.0


class Reader(Protocol):
    """What the screen needs of `groundstation.console.Console`."""

    def snapshot(self) -> Snapshot:
        """Return the newest of everything."""
        ...

    def command(self, kind: CommandKind, value: int = 0, name: str = "", amount: float = 0.0) -> int:
        """Send a command with its value and return its number."""
        ...


class Supervisor(Protocol):
    """What the screen needs of `groundstation.processes.Supervisor`."""

    def poll(self) -> Sequence[str]:
        """Look at every process; tell of the newly dead or silent, and return a sentence for each death."""
        ...

    def states(self) -> Mapping[str, str]:
        """Return a word a role: starting, running, silent or ended."""
        ...


@dataclass(frozen=True, slots=True)
class Frame:
    """What is drawn in one frame.

    Attributes:
        started: Time of the first snapshot, s.
        states: A word for each process.
        stick: Deflection asked for with the on-screen stick, or None where another device is in use.
        hindrances: Why each act and choice cannot be made now, by name; "" where it can.
        guarded_by: What the guard keeps away from, now or a moment ago, or "".
        notes: What the screen itself has to say, oldest first.
        figures: What the mission has come to so far, or None without one.
        guide: How far the mission is and what is next, or None without one.
        coaching: What the trainee does wrong and should do instead, or "".
        score: What that is worth so far, as of a second ago; None where there is nothing to be judged by.
        judgement: Of the last flight that landed, or None before.
        alarms: What is wrong, as of the frame before.
        paint_hz: Frames painted a second, as the terminal takes them.
        device_found: The haptic device has been there since the start.
        ways: How acts are asked for.
    """

    snapshot: Snapshot
    run: Run
    started: float
    states: Mapping[str, str]
    stick: Share4 | None
    hindrances: Mapping[str, str]
    guarded_by: str
    notes: Sequence[Note]
    track: Track
    history: History
    figures: Figures | None = None
    guide: Guide | None = None
    coaching: str = ""
    score: Score | None = None
    judgement: Judgement | None = None
    alarms: Alarms = field(default_factory=Alarms)
    paint_hz: float = math.nan
    device_found: bool = True
    ways: Ways = KEYS

    @property
    def now(self) -> float:
        """The snapshot's time, s."""
        return self.snapshot.t

    @property
    def guided(self) -> bool:
        """The hand is guided to the mission's way."""
        return self.run.guidance > 0.0

    def age(self, record: Record | None) -> float:
        """Return a record's age, s; infinite where there is none."""
        return math.inf if record is None else max(self.now - record.t, 0.0)

    @property
    def pilot(self) -> PilotState | None:
        """The controller's state, or None where it is too old to be true still."""
        return self.snapshot.pilot if self.age(self.snapshot.pilot) <= PILOT_STALE_S else None

    @property
    def seeking(self) -> bool:
        """The haptic device has not been found yet: what was never there is not gone."""
        device = self.snapshot.device
        return device is not None and not device.present and not self.device_found

    @property
    def force_limit(self) -> float:
        """What the device can render at most, N."""
        device = self.snapshot.device
        return device.force_limit if device and device.force_limit > 0 else FALLBACK_FORCE_N

    @property
    def workspace(self) -> float:
        """Radius the handle can be moved in, m."""
        return workspace(self.snapshot)


def workspace(snapshot: Snapshot) -> float:
    """Return the radius the handle can be moved in, m; a usual one until the device has said its own."""
    device = snapshot.device
    return device.workspace if device and 0 < device.workspace < math.inf else FALLBACK_WORKSPACE_M
