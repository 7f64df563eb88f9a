"""What a recording holds of states: lanes of words that exclude each other, logged when they change."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from groundstation.training.director import Stage
from groundstation.training.events import DeviceLoss, GpsLoss, LinkLoss
from groundstation.training.in_force import NOTHING, STATES
from groundstation.training.score import UNFINISHED, YARDSTICKS


class Tone(Enum):
    """What a state means for the operator; the viewer's colour of it."""

    IDLE = "idle"
    WORKING = "working"
    GOOD = "good"
    WARNING = "warning"
    FAULT = "fault"


@dataclass(frozen=True, slots=True)
class Lane:
    """Something with states that exclude each other, logged when it changes.

    Attributes:
        path: Entity.
        meaning: What it is.
        states: The words it can take, with their meaning for the operator.
    """

    path: str
    meaning: str
    states: tuple[tuple[str, Tone], ...]


MODE = Lane(
    "/state/mode",
    "Who steers the vehicle, as its heartbeat says",
    (
        ("unknown", Tone.IDLE),
        ("ready", Tone.IDLE),
        ("takeoff", Tone.WORKING),
        ("hold", Tone.WORKING),
        ("offboard", Tone.GOOD),
        ("return", Tone.WARNING),
        ("land", Tone.WORKING),
        ("mission", Tone.WARNING),
        ("position", Tone.WARNING),
        ("altitude", Tone.WARNING),
        ("manual", Tone.WARNING),
        ("other", Tone.WARNING),
    ),
)
PHASE = Lane(
    "/state/phase",
    "How far the hand is coupled to the vehicle",
    (
        ("disengaged", Tone.IDLE),
        ("engaging", Tone.WORKING),
        ("engaged", Tone.GOOD),
        ("on leash", Tone.WARNING),
    ),
)
STREAM = Lane(
    "/state/stream",
    "The setpoints' stream to the vehicle",
    (("idle", Tone.IDLE), ("starting", Tone.WORKING), ("flying", Tone.GOOD), ("ended", Tone.WARNING)),
)
VEHICLE = Lane(
    "/state/vehicle",
    "Vehicle's motors and link",
    (
        ("no link", Tone.FAULT),
        ("disarmed", Tone.IDLE),
        ("armed", Tone.WORKING),
        ("in air", Tone.GOOD),
    ),
)
DEVICE_STATE = Lane(
    "/state/device",
    "The haptic device",
    (("absent", Tone.FAULT), ("not homed", Tone.WARNING), ("ready", Tone.GOOD)),
)
STAGE = Lane(
    "/state/stage",
    "The mission's stage",
    (
        (Stage.WAITING.value, Tone.IDLE),
        (Stage.TAKING_OFF.value, Tone.WORKING),
        (Stage.ROUTE.value, Tone.WORKING),
        (Stage.STAYING.value, Tone.GOOD),
        (Stage.HOLDING.value, Tone.GOOD),
        (Stage.RETURNING.value, Tone.GOOD),
        (Stage.LANDING.value, Tone.WORKING),
        (Stage.FREE.value, Tone.WORKING),
        (Stage.DONE.value, Tone.IDLE),
    ),
)
MAPPING = Lane(
    "/state/mapping",
    "How the handle moves p_h",
    (
        ("rate", Tone.WORKING),
        ("rate, fine", Tone.WORKING),
        ("position", Tone.GOOD),
        ("position, fine", Tone.GOOD),
        ("clutched", Tone.IDLE),
        ("waiting for the centre", Tone.WARNING),
    ),
)
PRESET = Lane(
    "/state/preset",
    "Which cues and helps there are",
    (
        ("paper", Tone.IDLE),
        ("assisted", Tone.GOOD),
        ("transparent", Tone.WORKING),
        ("training", Tone.WORKING),
    ),
)
GUARD = Lane(
    "/state/guard",
    "Whether the guard changes what the hand asks for",
    (("lets pass", Tone.GOOD), ("guards", Tone.WARNING)),
)
COMPENSATION = Lane(
    "/state/compensation",
    "Whether the vehicle's dynamics are compensated",
    (("off", Tone.IDLE), ("on", Tone.GOOD)),
)
_FAULTS = frozenset({STATES[LinkLoss], STATES[DeviceLoss], STATES[GpsLoss]})
INTERVENTION = Lane(
    "/state/intervention",
    "What an instructor or the mission's timetable does, the gravest of it; from the first on",
    (
        (NOTHING, Tone.IDLE),
        *((word, Tone.FAULT if word in _FAULTS else Tone.WARNING) for word in STATES.values()),
    ),
)
QUIET, WARNING, COLLISION, ALARM = "quiet", "warning", "collision", "alarm"
ALERT = Lane(
    "/state/alert",
    "What went wrong: each warning, collision and alarm for half a second",
    ((QUIET, Tone.IDLE), (WARNING, Tone.WARNING), (COLLISION, Tone.FAULT), (ALARM, Tone.FAULT)),
)
POINTS = Lane(
    "/state/points",
    "Where points were lost, by part of the score, once the vehicle has landed",
    (
        (QUIET, Tone.IDLE),
        *((yard.part, Tone.WARNING) for yard in YARDSTICKS),
        (UNFINISHED, Tone.FAULT),
    ),
)
LANES: tuple[Lane, ...] = (
    ALERT, POINTS, PHASE, MODE, STREAM, VEHICLE, DEVICE_STATE, STAGE, MAPPING, PRESET, GUARD, COMPENSATION,
    INTERVENTION,
)  # fmt: skip
