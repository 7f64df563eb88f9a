"""What a recording holds: every entity with its parts and units. `docs/logs.md` shows these tables.

A recording is a Rerun file (`.rrd`) with one timeline, `flight_time`: s since the run was started, as a
duration. Numbers are 64-bit scalars, one row a record, one series a part; states are logged when they change;
words are text logs. World is ENU with its origin where the vehicle was first armed, vehicle FLU with yaw only,
handle x toward the drone's front, y left, z up; angles in rad, counter-clockwise. NaN is not known.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from groundstation.training.director import Stage

APPLICATION = "groundstation"
VERSION = 1
TIMELINE = "flight_time"

# Static text and properties of the whole flight.
ABOUT = "/about"
FLIGHT = "flight"
DEVICE = "device"

_AXES = ("x", "y", "z")
_POSE = ("x", "y", "z", "yaw")
_BODY = ("forward", "left", "up", "yaw rate")


@dataclass(frozen=True, slots=True)
class Quantity:
    """A measured or computed thing: one entity of scalars.

    Attributes:
        path: Entity.
        parts: Names of its series, in the order of a row's values.
        unit: Of the parts, in their order where they differ.
        rate: How often a row comes.
        meaning: What it is, with its frame.
    """

    path: str
    parts: tuple[str, ...]
    unit: str
    rate: str
    meaning: str


HANDLE_POSITION = Quantity(
    "/handle/position",
    _POSE,
    "m, rad",
    "servo",
    "Handle's displacement from its centre, handle frame; its yaw",
)
HANDLE_VELOCITY = Quantity("/handle/velocity", _AXES, "m/s", "servo", "Handle's velocity, handle frame")
HANDLE_BUTTONS = Quantity("/handle/buttons", ("buttons",), "bits", "on change", "One bit a button")
HANDLE_FORCE = Quantity("/handle/force", _AXES, "N", "servo", "Force rendered on the hand, handle frame")
HANDLE_ENERGY = Quantity(
    "/handle/energy",
    ("account", "dissipated"),
    "J",
    "50 Hz",
    "What the hand has given and not been given back; what the passivity controller took out of the force",
)

P_H = Quantity("/pilot/p_h", _POSE, "m, rad", "50 Hz", "p_h: where the hand wants the drone, world")
P_H_RATE = Quantity("/pilot/p_h_rate", _POSE, "m/s, rad/s", "50 Hz", "ṗ_h: how fast the hand moves it, world")
ERROR = Quantity("/pilot/error", _POSE, "m, rad", "50 Hz", "p̃ = p_h(t) − p(t − d₁), world")
V_REF = Quantity(
    "/pilot/v_ref", _BODY, "m/s, rad/s", "50 Hz", "v_ref of equation (4), vehicle's axes, before the limits"
)
FORCE_CUE = Quantity("/pilot/force", _AXES, "N", "50 Hz", "Force of equation (5), f = −K p̃, world")

REFERENCES = tuple(
    Quantity(
        f"/velocity/{part.replace(' ', '_')}/reference",
        ("reference",),
        "rad/s" if part == "yaw rate" else "m/s",
        "50 Hz",
        f"{part.capitalize()} part of the setpoint sent; NaN while none is active",
    )
    for part in _BODY
)
EXECUTED = tuple(
    Quantity(
        f"/velocity/{part.replace(' ', '_')}/executed",
        ("executed",),
        "rad/s" if part == "yaw rate" else "m/s",
        "telemetry",
        f"{part.capitalize()} part of the vehicle's velocity, turned from the world by its yaw",
    )
    for part in _BODY
)

POSITION = Quantity("/vehicle/position", _POSE, "m, rad", "telemetry", "Vehicle's position and yaw, world")
VELOCITY = Quantity(
    "/vehicle/velocity", _POSE, "m/s, rad/s", "telemetry", "Vehicle's velocity, world; yaw rate"
)
ATTITUDE = Quantity("/vehicle/attitude", ("roll", "pitch"), "rad", "telemetry", "About x forward, y left")
BOOT_TIME = Quantity(
    "/vehicle/boot_time", ("boot time",), "s", "telemetry", "Vehicle's own clock at the state"
)
BATTERY = Quantity("/vehicle/battery", ("charge",), "share", "10 Hz", "Battery left, 0 to 1")
VOLTAGE = Quantity("/vehicle/voltage", ("voltage",), "V", "10 Hz", "Battery's voltage")

STATE_AGE = Quantity(
    "/delay/state_age", ("vehicle's state",), "s", "50 Hz", "Age of the state the pilot used, d₁"
)
ROUND_TRIP = Quantity("/delay/round_trip", ("round trip",), "s", "10 Hz", "There and back by TIMESYNC")
SILENCE = Quantity("/delay/silence", ("silence",), "s", "10 Hz", "Since the vehicle's last frame")
HANDLE_AGE = Quantity("/delay/handle_age", ("handle",), "s", "50 Hz", "From handle sample to active setpoint")

LOSS = Quantity(
    "/link/loss", ("lost",), "share", "10 Hz", "Share of the vehicle's frames lost lately, 0 to 1"
)
GATE = Quantity(
    "/link/gate", ("sent", "dropped"), "frames", "10 Hz", "Setpoint frames that left, and kept back"
)
HEALTH_BITS = Quantity(
    "/vehicle/health", ("health",), "bits", "10 Hz", "Flags of `groundstation.messages.Health`"
)

SERVO_RATE = Quantity("/servo/rate", ("rate",), "Hz", "2 Hz", "Ticks a second in the last window")
SERVO_LATE = Quantity("/servo/lateness", ("p50", "p99", "largest"), "s", "2 Hz", "Lateness of a tick's start")
SERVO_TIME = Quantity(
    "/servo/duration", ("read", "write", "step"), "s", "2 Hz", "Longest time each part took"
)
SERVO_TICKS = Quantity("/servo/ticks", ("run", "missed"), "ticks", "2 Hz", "Since the servo's start")

TARGET_DISTANCE = Quantity(
    "/mission/target_distance", ("distance",), "m", "mission", "To the mission's target"
)
CLEARANCE = Quantity(
    "/mission/clearance", ("clearance",), "m", "mission", "From the hull to the nearest obstacle"
)
LEGS = Quantity("/mission/legs", ("flown", "of"), "legs", "mission", "How far along the route")
COLLISIONS = Quantity("/mission/collisions", ("collisions",), "contacts", "mission", "With obstacles, so far")

QUANTITIES: tuple[Quantity, ...] = (
    HANDLE_POSITION, HANDLE_VELOCITY, HANDLE_FORCE, HANDLE_ENERGY, HANDLE_BUTTONS,
    P_H, P_H_RATE, ERROR, V_REF, FORCE_CUE,
    *REFERENCES, *EXECUTED,
    POSITION, VELOCITY, ATTITUDE, BOOT_TIME, BATTERY, VOLTAGE, HEALTH_BITS,
    STATE_AGE, HANDLE_AGE, ROUND_TRIP, SILENCE,
    LOSS, GATE,
    SERVO_RATE, SERVO_LATE, SERVO_TIME, SERVO_TICKS,
    TARGET_DISTANCE, CLEARANCE, LEGS, COLLISIONS,
)  # fmt: skip

PROCESSES = "/processes"


def heartbeat(role: str) -> Quantity:
    """Return the quantity of a process's heartbeats; which processes there are, the run decides."""
    return Quantity(f"{PROCESSES}/{role}", (role,), "s", "10 Hz", "Time since the process's heartbeat before")


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
        (Stage.HOLDING.value, Tone.GOOD),
        (Stage.RETURNING.value, Tone.GOOD),
        (Stage.DONE.value, Tone.IDLE),
    ),
)
LANES: tuple[Lane, ...] = (PHASE, MODE, STREAM, VEHICLE, DEVICE_STATE, STAGE)

EVENTS = "/events"
COMMANDS = f"{EVENTS}/commands"
REASON = "/pilot/reason"

WORLD = "/world"
GROUND = "/world/ground"
PAD = "/world/pad"
OBSTACLES = "/world/obstacles"
ROUTE = "/world/route"
TARGET = "/world/target"
VEHICLE_POSE = "/world/vehicle"
AIRFRAME = "/world/vehicle/airframe"
CHASED = "/world/vehicle/chased"
VEHICLE_TRAIL = "/world/vehicle_trail"
HAND_TRAIL = "/world/hand_trail"
HAND = "/world/hand"
PLUMB = "/world/plumb"
LEASH = "/world/leash"
FORCE_ARROW = "/world/force"
# Length of the arrow that shows the force on the hand, m a newton.
ARROW_M_PER_N = 0.25

SCENE: tuple[tuple[str, str], ...] = (
    (f"{GROUND}, {PAD}", "the plane z = 0 and the place the vehicle starts from"),
    (
        f"{OBSTACLES}/NAME, {PAD}/NAME, {ROUTE}, {TARGET}",
        "the mission's obstacles (a gate's parts below its name), pads, route and target",
    ),
    (
        VEHICLE_POSE,
        "the vehicle's pose; `airframe` below it is a quadrotor 0.65 m wide, whatever it really is",
    ),
    (CHASED, "what the Chase view follows: corners without size, far enough apart to keep its distance"),
    (PLUMB, "a line from the vehicle down to z = 0"),
    (VEHICLE_TRAIL, "the way flown, in strips of five states"),
    (HAND_TRAIL, "the way of p_h while engaged, likewise"),
    (HAND, "p_h as a point, while engaged"),
    (LEASH, "p̃ as a line from p(t − d₁) to p_h, while engaged"),
    (
        FORCE_ARROW,
        f"the force on the hand as an arrow at the vehicle, {ARROW_M_PER_N} m a newton, while engaged",
    ),
)


def tables() -> str:
    """Return the schema as Markdown tables, as `docs/logs.md` shows it."""
    lines = ["| entity | parts | unit | rows | meaning |", "|---|---|---|---|---|"]
    for quantity in (*QUANTITIES, heartbeat("ROLE")):
        parts = ", ".join(quantity.parts)
        lines.append(
            f"| `{quantity.path}` | {parts} | {quantity.unit} | {quantity.rate} | {quantity.meaning} |"
        )
    lines += ["", "| state | meaning | values |", "|---|---|---|"]
    for lane in LANES:
        words = ", ".join(word for word, _ in lane.states)
        lines.append(f"| `{lane.path}` | {lane.meaning} | {words} |")
    lines += ["", "| in the scene | what it shows |", "|---|---|"]
    lines += [f"| `{path}` | {meaning} |" for path, meaning in SCENE]
    return "\n".join(lines)
