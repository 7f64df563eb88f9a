"""What a recording holds: every entity with its parts and units. `docs/logs.md` shows these tables.

A recording is a Rerun file (`.rrd`) with one timeline, `flight_time`: s since the run was started, as a
duration. Numbers are 64-bit scalars, one row a record, one series a part; states are logged when they change;
words are text logs. World is ENU with its origin where the vehicle was first armed, vehicle FLU with yaw only,
handle x toward the drone's front, y left, z up; angles in rad, counter-clockwise. NaN is not known.
"""

from __future__ import annotations

from dataclasses import dataclass

from groundstation.messages import RING_SECTORS
from groundstation.recording.entities import SCENE
from groundstation.recording.lanes import LANES

APPLICATION = "groundstation"
# 5: what the flight is held against, and where it lost points; guidance of the hand, and a ghost in the scene; what
#    an instructor or a timetable let happen.
# 4: all that a tick of the servo was made from, to the last bit.
# 3: every attitude and body rate that the vehicle tells, and commands and answers as numbers.
# 2: what stands around equations (4) and (5), and the vehicle's own distance sensors. A reader of 5 reads 1 to 4.
VERSION = 5
TIMELINE = "flight_time"

# Properties of the whole flight.
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
HANDLE_READY = Quantity(
    "/handle/ready",
    ("present", "homed"),
    "flag",
    "on change",
    "Whether samples come, and know where they are",
)
CENTRED = Quantity(
    "/handle/centred", ("centred",), "flag", "on change", "Near enough to its centre to engage"
)
SAMPLE_AGE = Quantity("/handle/age", ("age",), "s", "servo", "From the handle's sample to the tick")
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
    "/pilot/v_ref", _BODY, "m/s, rad/s", "50 Hz", "What the controller asks for, equation (4); vehicle's axes"
)
V_SAFE = Quantity("/pilot/v_safe", _BODY, "m/s, rad/s", "50 Hz", "v_ref as the guard leaves it")
V_C = Quantity(
    "/pilot/v_c", _BODY, "m/s, rad/s", "50 Hz", "v_safe within the limits: what the vehicle is meant to fly"
)
K1 = Quantity("/pilot/k1", _POSE, "1/s", "50 Hz", "Diagonal of K₁ in effect; NaN while nothing is flown")
PHASE_MARGIN = Quantity(
    "/pilot/phase_margin", ("margin",), "rad", "50 Hz", "Phase margin of the position loop"
)
SHARES = Quantity(
    "/pilot/shares", ("gains", "speed"), "share", "50 Hz", "What the link's state leaves of them, 0 to 1"
)
PREDICTED = Quantity(
    "/pilot/predicted",
    _POSE,
    "m, rad",
    "50 Hz",
    "Where the vehicle will be when what is sent now reaches it, world",
)
PREDICTED_VELOCITY = Quantity("/pilot/predicted_velocity", _AXES, "m/s", "50 Hz", "Its velocity then, world")
STOP = Quantity(
    "/pilot/stop", _AXES, "m", "50 Hz", "Where it would come to rest from there with a centred handle, world"
)
PUSH = Quantity(
    "/pilot/push",
    _AXES,
    "m/s²",
    "50 Hz",
    "Acceleration by wind and all else that the model does not know, world",
)

FORCE_CUE = Quantity("/pilot/force", _AXES, "N", "50 Hz", "Force of equation (5), f = −K p̃, world")
ENVIRONMENT_CUE = Quantity("/pilot/cue/environment", _AXES, "N", "50 Hz", "Away from what is near, world")
MISMATCH_CUE = Quantity(
    "/pilot/cue/mismatch", _AXES, "N", "50 Hz", "By the velocity that is asked for and not flown, world"
)
GUARD_CUE = Quantity(
    "/pilot/cue/guard", _AXES, "N", "50 Hz", "Against what the guard does not let pass, world"
)
DAMPING_CUE = Quantity(
    "/pilot/cue/damping", _AXES, "N", "50 Hz", "Against the handle's velocity, handle frame"
)
GUIDANCE_CUE = Quantity("/pilot/cue/guidance", _AXES, "N", "50 Hz", "Towards the mission's way, world")
CUE_SIZES = Quantity(
    "/pilot/cue/sizes",
    ("position", "environment", "mismatch", "guard", "damping"),
    "N",
    "50 Hz",
    "Norms of equation (5)'s force and of the other cues",
)
CUES_ON = Quantity(
    "/pilot/cue/on", ("cues",), "bits", "50 Hz", "Flags of `groundstation.messages.Cue` that are on"
)

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
RAW_ATTITUDE = Quantity(
    "/vehicle/raw/attitude",
    ("roll", "pitch", "yaw", "boot time"),
    "rad, s",
    "as told",
    "Every attitude the vehicle tells, about x forward, y left, z up; its own clock",
)
RAW_RATES = Quantity(
    "/vehicle/raw/rates", ("roll", "pitch", "yaw"), "rad/s", "as told", "Body rates about the same axes"
)
UNTRUSTED = Quantity(
    "/vehicle/untrusted",
    (*_POSE, *(f"{axis} rate" for axis in _POSE)),
    "m, rad, m/s, rad/s",
    "while not valid",
    "Position and velocity, world, that the vehicle told and did not trust itself: elsewhere they are not known",
)
STATUS = Quantity(
    "/vehicle/status",
    ("connected", "armed", "in air", "mode", "stream"),
    "code",
    "on change",
    "What the lanes show in words: 1 or 0, `FlightMode`, `Stream`",
)
COMMANDED = Quantity(
    "/operator/command",
    ("number", "kind", "value"),
    "code",
    "as given",
    "Commands: number, `CommandKind`, and what it chooses; `/events/commands` has them in words",
)
ANSWERED = Quantity(
    "/operator/answer",
    ("number", "kind", "done"),
    "code",
    "as given",
    "Answers: of which command, its `CommandKind`, and 1 where it was done, 0 where refused",
)
SPEED_LIMITS = Quantity(
    "/vehicle/speed_limits",
    ("around", "up", "down"),
    "m/s",
    "on change",
    "Largest speeds that the vehicle allows; 0 is not known",
)
SYSTEM_ID = Quantity(
    "/vehicle/system_id", ("system id",), "count", "on change", "The vehicle's own in MAVLink"
)
AUTOPILOT = Quantity(
    "/vehicle/autopilot",
    ("autopilot", "component"),
    "code",
    "on change",
    "Which it is, `Autopilot`, and its MAVLink component; `/vehicle/firmware` has its version",
)
BOOT_TIME = Quantity(
    "/vehicle/boot_time", ("boot time",), "s", "telemetry", "Vehicle's own clock at the state"
)
BATTERY = Quantity("/vehicle/battery", ("charge",), "share", "10 Hz", "Battery left, 0 to 1")
VOLTAGE = Quantity("/vehicle/voltage", ("voltage",), "V", "10 Hz", "Battery's voltage")

RING = Quantity(
    "/ranges/ring",
    tuple(f"{place * 360 // RING_SECTORS}°" for place in range(RING_SECTORS)),
    "m",
    "10 Hz",
    "Distance that the vehicle's sensors see, counter-clockwise from forward; infinite: nothing is there",
)
RANGES = Quantity(
    "/ranges/nearest",
    ("around", "below", "above"),
    "m",
    "10 Hz",
    "Least of the ring; straight down and up",
)
RANGE_LIMIT = Quantity("/ranges/limit", ("limit",), "m", "10 Hz", "How far the ring sees")

STATE_AGE = Quantity(
    "/delay/state_age", ("vehicle's state",), "s", "50 Hz", "Age of the state the pilot used, d₁"
)
ROUND_TRIP = Quantity("/delay/round_trip", ("round trip",), "s", "10 Hz", "There and back by TIMESYNC")
RECKONED = Quantity(
    "/delay/reckoned", ("reckoned",), "s", "50 Hz", "Round trip that the controller reckons with"
)
SILENCE = Quantity("/delay/silence", ("silence",), "s", "10 Hz", "Since the vehicle's last frame")
SETPOINT_NUMBER = Quantity("/setpoint/number", ("number",), "count", "50 Hz", "Of the setpoint")
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
SERVO_RUN = Quantity(
    "/servo/lateness_so_far", ("p50", "p99"), "s", "2 Hz", "The same since the servo's start"
)
REALTIME = Quantity(
    "/servo/realtime", ("granted",), "flag", "on change", "The system grants real-time priority"
)
SERVO_TIME = Quantity(
    "/servo/duration", ("read", "write", "step"), "s", "2 Hz", "Longest time each part took"
)
SERVO_TICKS = Quantity("/servo/ticks", ("run", "missed"), "ticks", "2 Hz", "Since the servo's start")

TICK = Quantity(
    "/servo/tick",
    ("tick", "dt", "fitted", "read", "homed", "present"),
    "ticks, s, times, 1 or 0",
    "on change",
    "The tick's number; time since the last by the loop's pace; how often the controller was fitted to a device; "
    "whether that was read, is homed, took the force",
)
KNOWN = Quantity(
    "/servo/known",
    ("state", "status", "ranges", "command", "commands"),
    "s, commands",
    "on change",
    "What the tick knew: monotonic times of the newest vehicle state, status, ranges and command; commands so far",
)
LIMITS = Quantity(
    "/servo/device",
    ("axes", "workspace", "force limit", "stiffness limit", "rate"),
    "axes, m, N, N/m, Hz",
    "on change",
    "What the device can do, `drivers.device.DeviceInfo`",
)

TARGET_DISTANCE = Quantity(
    "/mission/target_distance", ("distance",), "m", "mission", "To the mission's target"
)
CLEARANCE = Quantity(
    "/mission/clearance", ("clearance",), "m", "mission", "From the hull to the nearest obstacle"
)
LEGS = Quantity("/mission/legs", ("flown", "of"), "legs", "mission", "How far along the route")
COLLISIONS = Quantity("/mission/collisions", ("collisions",), "contacts", "mission", "With obstacles, so far")

LOST = Quantity(
    "/mission/lost",
    ("points", "length"),
    "of 100, s",
    "once landed",
    "What a moment cost of the score, and how long it was",
)

QUANTITIES: tuple[Quantity, ...] = (
    HANDLE_POSITION, HANDLE_VELOCITY, SAMPLE_AGE, HANDLE_FORCE, HANDLE_ENERGY, HANDLE_BUTTONS,
    HANDLE_READY, CENTRED, SETPOINT_NUMBER,
    P_H, P_H_RATE, ERROR, V_REF, V_SAFE, V_C, K1, PHASE_MARGIN, SHARES,
    FORCE_CUE, ENVIRONMENT_CUE, MISMATCH_CUE, GUARD_CUE, DAMPING_CUE, GUIDANCE_CUE, CUE_SIZES, CUES_ON,
    PREDICTED, PREDICTED_VELOCITY, STOP, PUSH,
    *REFERENCES, *EXECUTED,
    POSITION, VELOCITY, UNTRUSTED, ATTITUDE, RAW_ATTITUDE, RAW_RATES, SYSTEM_ID, AUTOPILOT, BOOT_TIME,
    BATTERY, VOLTAGE, HEALTH_BITS, STATUS, SPEED_LIMITS,
    RING, RANGES, RANGE_LIMIT,
    STATE_AGE, HANDLE_AGE, ROUND_TRIP, RECKONED, SILENCE,
    LOSS, GATE,
    SERVO_RATE, SERVO_LATE, SERVO_RUN, REALTIME, SERVO_TIME, SERVO_TICKS, TICK, KNOWN, LIMITS,
    TARGET_DISTANCE, CLEARANCE, LEGS, COLLISIONS, LOST,
    COMMANDED, ANSWERED,
)  # fmt: skip

# In which version a quantity was added, where that is not the first.
SINCE = {GUIDANCE_CUE: 5, SPEED_LIMITS: 5, AUTOPILOT: 5, LOST: 5}

FORCE_SIZE = Quantity(
    "/handle/force_size",
    ("size", "limit"),
    "N",
    "50 Hz",
    "Largest norm of the force on the hand in 20 ticks of the servo; what the device can render",
)
MARGIN = Quantity(
    "/mission/margin",
    ("margin",),
    "m",
    "mission",
    "Least clearance that the guard keeps; NaN where it is off",
)
# Drawn from the others, the device and the settings, to be read beside them.
GAUGES: tuple[Quantity, ...] = (FORCE_SIZE, MARGIN)

PROCESSES = "/processes"
# Of so many parts only the first and the last are named.
_MANY = 10


def heartbeat(role: str) -> Quantity:
    """Return the quantity of a process's heartbeats; which processes there are, the run decides."""
    return Quantity(f"{PROCESSES}/{role}", (role,), "s", "10 Hz", "Time since the process's heartbeat before")


def process_number(role: str) -> Quantity:
    """Return the quantity of a process's number in the system."""
    return Quantity(
        f"/process_numbers/{role}", (role,), "count", "on change", "The process's number in the system"
    )


def tables() -> str:
    """Return the schema as Markdown tables, as `docs/logs.md` shows it."""
    lines = ["| entity | parts | unit | rows | meaning |", "|---|---|---|---|---|"]
    for quantity in (*QUANTITIES, *GAUGES, heartbeat("ROLE"), process_number("ROLE")):
        parts = _listed(quantity.parts)
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


def _listed(parts: tuple[str, ...]) -> str:
    return ", ".join(parts) if len(parts) < _MANY else f"{parts[0]}, {parts[1]}, … {parts[-1]}"
