"""The records on the bus, one a topic.

Every record has its time `t`, s on the monotonic clock all processes of a machine share. World is ENU with
its origin where the vehicle was first armed; vectors of four are `[x, y, z, yaw]` in the world and
`[forward, left, up, yaw_rate]` on the vehicle; SI throughout.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import Generic, TypeVar

_F64 = ctypes.c_double
_U64 = ctypes.c_uint64
_U32 = ctypes.c_uint32
_U8 = ctypes.c_uint8


# Sizes of text fields, bytes, with the closing zero.
EVENT_TEXT = 240
ANSWER_TEXT = 200
REASON_TEXT = 160
NAME_TEXT = 49
FIRMWARE_TEXT = 24
PARAMETER_TEXT = 17
SCORE_TEXT = 256
PART_TEXT = 16
HAPPENING_TEXT = 200
# Sectors of the ring in `Ranges`, as many as MAVLink's OBSTACLE_DISTANCE has room for.
RING_SECTORS = 72


class Record(ctypes.Structure):
    """What all records share."""

    t: float

    @classmethod
    def type_name(cls) -> str:
        """Name under which iceoryx2 checks that both ends mean the same record."""
        return cls.__name__


class FlightMode(IntEnum):
    """Who steers the vehicle now, as its heartbeat says."""

    UNKNOWN = 0
    READY = 1
    TAKEOFF = 2
    HOLD = 3
    OFFBOARD = 4
    RETURN = 5
    LAND = 6
    MISSION = 7
    POSITION = 8
    ALTITUDE = 9
    MANUAL = 10
    OTHER = 11


class Phase(IntEnum):
    """How far the hand is coupled to the vehicle."""

    DISENGAGED = 0
    ENGAGING = 1
    ENGAGED = 2


class Stream(IntEnum):
    """State of the setpoints' stream from the link to the vehicle."""

    IDLE = 0
    STARTING = 1
    FLYING = 2
    ENDED = 3


class Autopilot(IntEnum):
    """What flies the vehicle, as its heartbeat says."""

    UNKNOWN = 0
    PX4 = 1
    ARDUPILOT = 2


class CommandKind(IntEnum):
    """What the operator can ask for."""

    ARM = 1
    DISARM = 2
    TAKEOFF = 3
    LAND = 4
    RETURN = 5
    HOLD = 6
    ENGAGE = 7
    DISENGAGE = 8
    KILL = 9
    MAPPING = 10
    FINE = 11
    CLUTCH = 12
    PRESET = 13
    CUES = 14
    PARAMETERS = 15
    SET_PARAMETER = 16
    SETTINGS = 17


class MappingMode(IntEnum):
    """How the handle moves p_h; the value of a MAPPING command."""

    RATE = 0
    POSITION = 1


class Preset(IntEnum):
    """Which cues and helps there are; the value of a PRESET command."""

    PAPER = 0
    ASSISTED = 1
    TRANSPARENT = 2
    TRAINING = 3


class Cue(IntFlag):
    """The parts of the force; the value of a CUES command is those that are on."""

    POSITION = 1
    ENVIRONMENT = 2
    MISMATCH = 4
    GUARD = 8
    DAMPING = 16
    GUIDANCE = 32


class Severity(IntEnum):
    """How much an event matters."""

    INFO = 0
    WARNING = 1
    ALARM = 2


class Health(IntFlag):
    """What the vehicle's estimator, sensors and receiver say of themselves."""

    GYRO = 1
    ACCELEROMETER = 2
    MAGNETOMETER = 4
    LOCAL_POSITION = 8
    GLOBAL_POSITION = 16
    HOME = 32
    ARMABLE = 64
    TRANSMITTER = 128


class Handle(Record):
    """The hand and the force on it, every servo tick (handle frame)."""

    position: ctypes.Array[_F64]
    velocity: ctypes.Array[_F64]
    force: ctypes.Array[_F64]
    yaw: float
    device_t: float
    tick: int
    buttons: int
    homed: int
    present: int
    _fields_ = (
        ("t", _F64),
        ("position", _F64 * 3),
        ("velocity", _F64 * 3),
        ("force", _F64 * 3),
        ("yaw", _F64),
        ("device_t", _F64),
        ("tick", _U64),
        ("buttons", _U32),
        ("homed", _U8),
        ("present", _U8),
    )


class TickInputs(Record):
    """What the servo's ticks are made from, besides the hand in `Handle`, from this tick on: sent on a change.

    With the records that it names, a recording can run every tick again (`groundstation replay --check`).

    Attributes:
        t: Of the tick.
        tick: Its number, from 1.
        dt: Since the tick before by the loop's pace, s.
        state_t: `t` of the newest `VehicleState` that it knew; 0 before the first.
        status_t, ranges_t: Likewise of `VehicleStatus` and `Ranges`.
        command_t: Of the last `Command` that it took.
        commands: Commands taken since the servo's start.
        fitted: How often the controller has been fitted to a device since then.
        read: The device was read; else the hand is what stands for none.
        homed: As in `Handle`.
        present: The device also took the force.
    """

    tick: int
    dt: float
    state_t: float
    status_t: float
    ranges_t: float
    command_t: float
    commands: int
    fitted: int
    read: int
    homed: int
    present: int
    _fields_ = (
        ("t", _F64),
        ("tick", _U64),
        ("dt", _F64),
        ("state_t", _F64),
        ("status_t", _F64),
        ("ranges_t", _F64),
        ("command_t", _F64),
        ("commands", _U32),
        ("fitted", _U32),
        ("read", _U8),
        ("homed", _U8),
        ("present", _U8),
    )


class Setpoint(Record):
    """What the vehicle shall do: v_ref of equation (4) on its own axes, within limits; 50 Hz while active."""

    velocity: ctypes.Array[_F64]
    handle_t: float
    number: int
    active: int
    _fields_ = (
        ("t", _F64),
        ("velocity", _F64 * 4),
        ("handle_t", _F64),
        ("number", _U64),
        ("active", _U8),
    )


class PilotState(Record):
    """The inside of the controller, 50 Hz: equations (4) and (5) term by term, and what stands around them.

    Attributes:
        v_ref: As the controller gives it, vehicle's axes; equation (4) unless another controller flies.
        v_safe: The same after the guard.
        v_c: That within the limits: the velocity that the vehicle is meant to have. `Setpoint` makes it have it.
        force: As equation (5) gives it, world, N; `Handle` has what is rendered, damped, ramped and limited.
        environment, mismatch, guard, guidance: The other cues as they are weighted into the force, world, N.
        damping: Likewise against the handle's velocity, handle frame, N.
        state_age: Age of the vehicle's state, s; infinite before the first.
        delay: Round trip that the controller reckons with, s.
        predicted: Where the vehicle will be when what is sent now reaches it, world, m and rad.
        predicted_velocity: Its velocity then, world, m/s.
        stop: Where it would come to rest from there with a centred handle, world, m.
        push: Acceleration by wind and all else that the model does not know, world, m/s².
        k1: Diagonal of K₁ in effect, 1/s.
        phase_margin: Of the position loop, rad.
        gain_share, speed_share: What the link's state leaves of gains and speed, 0 to 1.
        port_energy: What the hand has given through the haptic port and not been given back, J.
        dissipated: What the passivity controller has taken out of the force so far, J.
        centred: The handle is where engaging is possible.
        mapping, preset, cues: A `MappingMode`, a `Preset`, and those of `Cue` that are on.
        fine, clutched: The handle moves finely; it moves nothing.
        waiting: The handle moves nothing until it has been in its centre, after a switch to rate mode or the clutch.
        guarding: The guard changes what the hand asks for.
        compensated: The vehicle's dynamics are compensated.
        guarded_by: What the guard keeps away from: an obstacle's name, "floor", "ceiling", "fence", "sensor".
        reason: Why the hand was last uncoupled, or could not be coupled; empty while it is.
    """

    p_h: ctypes.Array[_F64]
    p_h_rate: ctypes.Array[_F64]
    error: ctypes.Array[_F64]
    v_ref: ctypes.Array[_F64]
    v_safe: ctypes.Array[_F64]
    v_c: ctypes.Array[_F64]
    force: ctypes.Array[_F64]
    environment: ctypes.Array[_F64]
    mismatch: ctypes.Array[_F64]
    guard: ctypes.Array[_F64]
    damping: ctypes.Array[_F64]
    guidance: ctypes.Array[_F64]
    predicted: ctypes.Array[_F64]
    predicted_velocity: ctypes.Array[_F64]
    stop: ctypes.Array[_F64]
    push: ctypes.Array[_F64]
    k1: ctypes.Array[_F64]
    state_age: float
    delay: float
    phase_margin: float
    gain_share: float
    speed_share: float
    port_energy: float
    dissipated: float
    phase: int
    on_leash: int
    centred: int
    mapping: int
    preset: int
    cues: int
    fine: int
    clutched: int
    waiting: int
    guarding: int
    compensated: int
    guarded_by: bytes
    reason: bytes
    _fields_ = (
        ("t", _F64),
        ("p_h", _F64 * 4),
        ("p_h_rate", _F64 * 4),
        ("error", _F64 * 4),
        ("v_ref", _F64 * 4),
        ("v_safe", _F64 * 4),
        ("v_c", _F64 * 4),
        ("force", _F64 * 3),
        ("environment", _F64 * 3),
        ("mismatch", _F64 * 3),
        ("guard", _F64 * 3),
        ("damping", _F64 * 3),
        ("guidance", _F64 * 3),
        ("predicted", _F64 * 4),
        ("predicted_velocity", _F64 * 3),
        ("stop", _F64 * 3),
        ("push", _F64 * 3),
        ("k1", _F64 * 4),
        ("state_age", _F64),
        ("delay", _F64),
        ("phase_margin", _F64),
        ("gain_share", _F64),
        ("speed_share", _F64),
        ("port_energy", _F64),
        ("dissipated", _F64),
        ("phase", _U8),
        ("on_leash", _U8),
        ("centred", _U8),
        ("mapping", _U8),
        ("preset", _U8),
        ("cues", _U8),
        ("fine", _U8),
        ("clutched", _U8),
        ("waiting", _U8),
        ("guarding", _U8),
        ("compensated", _U8),
        ("guarded_by", ctypes.c_char * NAME_TEXT),
        ("reason", ctypes.c_char * REASON_TEXT),
    )


class VehicleState(Record):
    """Where the vehicle says it is, each time it says so (`t` is the arrival); all of it in the world."""

    position: ctypes.Array[_F64]
    velocity: ctypes.Array[_F64]
    roll: float
    pitch: float
    boot_t: float
    valid: int
    _fields_ = (
        ("t", _F64),
        ("position", _F64 * 4),
        ("velocity", _F64 * 4),
        ("roll", _F64),
        ("pitch", _F64),
        ("boot_t", _F64),
        ("valid", _U8),
    )


class Attitude(Record):
    """How the vehicle says it lies, each time it says so (`t` is the arrival), whether a position comes or not.

    Attributes:
        roll, pitch, yaw: About x forward, y left, z up, rad; yaw counter-clockwise from east.
        rates: About the same axes of the body, rad/s.
        boot_t: The vehicle's own clock, s.
    """

    roll: float
    pitch: float
    yaw: float
    rates: ctypes.Array[_F64]
    boot_t: float
    _fields_ = (
        ("t", _F64),
        ("roll", _F64),
        ("pitch", _F64),
        ("yaw", _F64),
        ("rates", _F64 * 3),
        ("boot_t", _F64),
    )


class Ranges(Record):
    """What the vehicle's own distance sensors see, about 10 Hz where it has any (`t` is the arrival).

    Distances are from the vehicle's middle, m: infinite where there is nothing, NaN where it is not known.

    Attributes:
        ring: On its level, by sectors of 5°, counter-clockwise; the middle of the first is forward.
        below, above: Straight down and up.
        limit: How far the ring sees, m; NaN without one.
    """

    ring: ctypes.Array[_F64]
    below: float
    above: float
    limit: float
    _fields_ = (
        ("t", _F64),
        ("ring", _F64 * RING_SECTORS),
        ("below", _F64),
        ("above", _F64),
        ("limit", _F64),
    )


class VehicleStatus(Record):
    """What changes slowly about vehicle and link: 10 Hz, and at once on a change.

    Attributes:
        heard_t: When the last frame of the vehicle came, s; 0 before the first.
        loss: Share of the vehicle's frames lost in the last seconds, 0 to 1.
        rtt: Round trip by TIMESYNC, s; NaN before the first answer.
        speed_limits: Largest speeds that the vehicle allows, m/s: around, up, down; 0 where not known.
        sent: Setpoint frames that left.
        dropped: Frames the gate kept back: stale setpoints, and what is not on its list.
        streaming: State of the setpoint stream, a `Stream`; FLYING only once the vehicle has confirmed offboard
            for this very stream.
        autopilot: An `Autopilot`.
        component: Of the autopilot in MAVLink; 0 until it has told its version.
        firmware: That version, or "".
        unsafe: Why its own failsafes keep the hand from being coupled, or "".
    """

    heard_t: float
    loss: float
    rtt: float
    battery: float
    voltage: float
    speed_limits: ctypes.Array[_F64]
    sent: int
    dropped: int
    health: int
    system_id: int
    connected: int
    armed: int
    in_air: int
    mode: int
    streaming: int
    autopilot: int
    component: int
    firmware: bytes
    unsafe: bytes
    _fields_ = (
        ("t", _F64),
        ("heard_t", _F64),
        ("loss", _F64),
        ("rtt", _F64),
        ("battery", _F64),
        ("voltage", _F64),
        ("speed_limits", _F64 * 3),
        ("sent", _U64),
        ("dropped", _U64),
        ("health", _U32),
        ("system_id", _U32),
        ("connected", _U8),
        ("armed", _U8),
        ("in_air", _U8),
        ("mode", _U8),
        ("streaming", _U8),
        ("autopilot", _U8),
        ("component", _U8),
        ("firmware", ctypes.c_char * FIRMWARE_TEXT),
        ("unsafe", ctypes.c_char * REASON_TEXT),
    )


class Parameter(Record):
    """One of the vehicle's own parameters, each time it is read.

    Attributes:
        whole: It is an integer.
        count: How many the vehicle has; 0 where they have not all been asked for.
    """

    name: bytes
    value: float
    count: int
    whole: int
    _fields_ = (
        ("t", _F64),
        ("name", ctypes.c_char * PARAMETER_TEXT),
        ("value", _F64),
        ("count", _U32),
        ("whole", _U8),
    )


class Command(Record):
    """An act of the operator. Every one gets one `CommandAnswer`.

    Attributes:
        value: What a MAPPING, PRESET or CUES command chooses; of FINE and CLUTCH 1 for on, 0 for off; else 0.
        name, amount: Which parameter of the vehicle SET_PARAMETER sets, and to what.
    """

    number: int
    kind: int
    value: int
    source: bytes
    name: bytes
    amount: float
    _fields_ = (
        ("t", _F64),
        ("number", _U64),
        ("kind", _U8),
        ("value", _U8),
        ("source", ctypes.c_char * 16),
        ("name", ctypes.c_char * PARAMETER_TEXT),
        ("amount", _F64),
    )


class CommandAnswer(Record):
    """What became of a command, in words where it was refused."""

    number: int
    kind: int
    ok: int
    text: bytes
    _fields_ = (
        ("t", _F64),
        ("number", _U64),
        ("kind", _U8),
        ("ok", _U8),
        ("text", ctypes.c_char * ANSWER_TEXT),
    )


class Intervention(Record):
    """An instructor, or a mission's timetable, wants something to happen to the flight.

    Attributes:
        number: Distinguishes it from all others of the run; its `InterventionAnswer` has the same.
        source: Who wants it, as in "instructor" or "mission".
        happening: What, as `groundstation.training.happening.packed` gives it.
    """

    number: int
    source: bytes
    happening: bytes
    _fields_ = (
        ("t", _F64),
        ("number", _U64),
        ("source", ctypes.c_char * 16),
        ("happening", ctypes.c_char * HAPPENING_TEXT),
    )


class InterventionAnswer(Record):
    """What became of an `Intervention`, which it repeats: who comes late gets to know what has been done.

    Attributes:
        ok: It was done; else `text` says why not.
    """

    number: int
    ok: int
    source: bytes
    happening: bytes
    text: bytes
    _fields_ = (
        ("t", _F64),
        ("number", _U64),
        ("ok", _U8),
        ("source", ctypes.c_char * 16),
        ("happening", ctypes.c_char * HAPPENING_TEXT),
        ("text", ctypes.c_char * ANSWER_TEXT),
    )


class Event(Record):
    """Something that happened, in words."""

    severity: int
    source: bytes
    text: bytes
    _fields_ = (
        ("t", _F64),
        ("severity", _U8),
        ("source", ctypes.c_char * 16),
        ("text", ctypes.c_char * EVENT_TEXT),
    )


class ServoReport(Record):
    """How well the servo keeps its time, 2 Hz. Counts are since its start, figures of the last half second.

    Attributes:
        ticks: Ticks run since start.
        missed: Ticks that did not run because an earlier one was too late.
        late_p50: Lateness of a tick's start, s; also p99 and largest.
        run_p50: The same since the start; also p99.
        read: Longest time to read the device, s; likewise to write the force.
        realtime: The system granted real-time priority.
    """

    rate: float
    late_p50: float
    late_p99: float
    late_max: float
    run_p50: float
    run_p99: float
    read: float
    write: float
    step: float
    ticks: int
    missed: int
    realtime: int
    _fields_ = (
        ("t", _F64),
        ("rate", _F64),
        ("late_p50", _F64),
        ("late_p99", _F64),
        ("late_max", _F64),
        ("run_p50", _F64),
        ("run_p99", _F64),
        ("read", _F64),
        ("write", _F64),
        ("step", _F64),
        ("ticks", _U64),
        ("missed", _U64),
        ("realtime", _U8),
    )


class DeviceReport(Record):
    """Which haptic device there is and what it can do, 2 Hz."""

    name: bytes
    serial: bytes
    renders: bytes
    workspace: float
    force_limit: float
    stiffness_limit: float
    rate: float
    axes: int
    present: int
    homed: int
    _fields_ = (
        ("t", _F64),
        ("name", ctypes.c_char * 64),
        ("serial", ctypes.c_char * 64),
        ("renders", ctypes.c_char * 16),
        ("workspace", _F64),
        ("force_limit", _F64),
        ("stiffness_limit", _F64),
        ("rate", _F64),
        ("axes", _U32),
        ("present", _U8),
        ("homed", _U8),
    )


class MissionProgress(Record):
    """How far the mission is: the stage in words, the leg of the route, the distance to its end, the score so far."""

    stage: bytes
    leg: int
    legs: int
    target_distance: float
    clearance: float
    collisions: int
    score: bytes
    _fields_ = (
        ("t", _F64),
        ("stage", ctypes.c_char * 48),
        ("leg", _U32),
        ("legs", _U32),
        ("target_distance", _F64),
        ("clearance", _F64),
        ("collisions", _U32),
        ("score", ctypes.c_char * SCORE_TEXT),
    )


class PointsLost(Record):
    """A moment in which a flight lost points, told when it has landed (`t` is that of the moment).

    Attributes:
        until: When it ended, s.
        points: Of the score's 100.
        position: Where the vehicle was, world, m.
        part: Of the score.
        text: What happened.
    """

    until: float
    points: float
    position: ctypes.Array[_F64]
    part: bytes
    text: bytes
    _fields_ = (
        ("t", _F64),
        ("until", _F64),
        ("points", _F64),
        ("position", _F64 * 3),
        ("part", ctypes.c_char * PART_TEXT),
        ("text", ctypes.c_char * EVENT_TEXT),
    )


class Heartbeat(Record):
    """A process is alive and its loop turns, 10 Hz."""

    role: bytes
    pid: int
    _fields_ = (("t", _F64), ("role", ctypes.c_char * 16), ("pid", _U32))


R = TypeVar("R", bound=Record)


@dataclass(frozen=True)
class Topic(Generic[R]):
    """A named stream of one kind of record.

    Attributes:
        depth: Records a subscriber may fall behind before it loses the oldest.
        history: Records a subscriber that comes late still gets.
        wakes: Sending one wakes who waits for it (`Bus.waker`), for what must not wait for a turn of a loop.
    """

    name: str
    record: type[R]
    depth: int = 64
    history: int = 1
    wakes: bool = False


# A recorder that begins to listen a little after the pilot still gets its first ticks, and what they were made from.
HANDLE = Topic("handle", Handle, depth=4096, history=1024)
TICK_INPUTS = Topic("tick_inputs", TickInputs, depth=512, history=64)
SETPOINT = Topic("setpoint", Setpoint, depth=256, wakes=True)
# Seconds of it at any rate up to the servo's own, should the recorder be held up.
PILOT_STATE = Topic("pilot_state", PilotState, depth=4096, history=64)
VEHICLE_STATE = Topic("vehicle_state", VehicleState, depth=1024, history=128)
ATTITUDE = Topic("attitude", Attitude, depth=1024)
VEHICLE_STATUS = Topic("vehicle_status", VehicleStatus, depth=256, history=64)
# A vehicle has a thousand or two, and they are read all at once.
PARAMETER = Topic("parameter", Parameter, depth=4096, history=0)
OBSTACLES = Topic("obstacles", Ranges, history=32)
COMMAND = Topic("command", Command, history=0)
COMMAND_ANSWER = Topic("command_answer", CommandAnswer, history=0)
INTERVENTION = Topic("intervention", Intervention, history=0)
INTERVENTION_ANSWER = Topic("intervention_answer", InterventionAnswer, depth=128, history=64)
EVENT = Topic("event", Event, depth=256, history=32)
SERVO_REPORT = Topic("servo_report", ServoReport)
DEVICE_REPORT = Topic("device_report", DeviceReport, history=16)
MISSION_PROGRESS = Topic("mission_progress", MissionProgress)
POINTS_LOST = Topic("points_lost", PointsLost, history=0)
HEARTBEAT = Topic("heartbeat", Heartbeat, history=0)


def fit(text: str, size: int) -> bytes:
    """Return text as UTF-8 that fits a field of `size` bytes, cut between characters."""
    return text.encode()[: size - 1].decode(errors="ignore").encode()
