"""What is flown, and what came of it: a case, all that a process elsewhere needs to fly it, and its outcome."""

from __future__ import annotations

import hashlib

import msgspec
from msgspec import Struct

from groundstation import __version__
from groundstation.config import Settings
from groundstation.training.mission import Mission


class Case(Struct, frozen=True, forbid_unknown_fields=True):
    """One point of the grid: the columns by which flights are told apart.

    Attributes:
        controller: A preset of the program's own controller, or another's as `module:Class`.
        guard: As `shield.guard` of the settings; "off" with a preset that has none.
        mission: Its name.
        delay: Round trip, s: half of it each way.
        jitter: By how much each way's delay varies, s.
        loss: Share of frames lost each way.
        wind: "calm", "mission", or a speed in m/s, whose direction the seed chooses.
        operator: Who flies, by a name in `sim.people`.
        seed: Of all that is random: operator, air, estimate, channel.
        rate: Of the servo, Hz.
        airframe: What flies.
        model: How it moves.
    """

    controller: str
    guard: str
    mission: str
    delay: float
    jitter: float
    loss: float
    wind: str
    operator: str
    seed: int
    rate: float
    airframe: str
    model: str


class Task(Struct, frozen=True):
    """A case with all that flying it takes.

    Attributes:
        case: Which one.
        mission: As read from its file, with the case's airframe and model.
        settings: The pilot's, with the case's preset and guard.
        source: Fingerprint of the file that a controller of the user's own is in; "" for the program's.
    """

    case: Case
    mission: Mission
    settings: Settings
    source: str = ""

    @property
    def id(self) -> str:
        """The same for the same flight: whatever changes its outcome, be it mission, settings or code, changes it."""
        content = msgspec.json.encode((__version__, self), order="deterministic")
        return hashlib.sha256(content).hexdigest()[:20]


class Outcome(Struct, frozen=True):
    """What came of a case; see `docs/evaluate.md` for the formulas. A figure that does not exist is None.

    Attributes:
        completed: The mission's criteria hold.
        time: From the hand's coupling to the end of the hold at the target, s.
        rms_error: Root mean square of |p̃| while coupled, m.
        clearance: Least distance from hull to obstacle while coupled, m.
        collisions: Contacts, as in every flight or as the simulated vehicle counts them, whichever is more.
        max_force, mean_force: On the hand while coupled, N.
        hand_work: Work of the hand on the handle, J.
        dissipated: What the passivity controller took out of the force, J.
        disagreement: Mean |v_ref − v_safe| while coupled, m/s.
        uncoupled: How often the hand was uncoupled against its will.
        flown: Virtual time of the flight, s.
        processor: Processor time that it took, s.
        reason: Why it is not completed, in words.
    """

    completed: bool = False
    time: float | None = None
    rms_error: float | None = None
    clearance: float | None = None
    collisions: int = 0
    max_force: float | None = None
    mean_force: float | None = None
    hand_work: float = 0.0
    dissipated: float = 0.0
    disagreement: float | None = None
    uncoupled: int = 0
    flown: float = 0.0
    processor: float = 0.0
    reason: str = ""


class Result(Struct, frozen=True):
    """A case, its id and its outcome: one line of the log, one row of the table."""

    id: str
    case: Case
    outcome: Outcome
