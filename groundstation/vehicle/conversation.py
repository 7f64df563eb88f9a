"""A conversation with one vehicle: what is on the bus is said to it, and what it tells goes onto the bus.

bus ──setpoint──► OffboardStream ──► MAVSDK ──► gate ──► transport ──► vehicle
bus ◄──state, obstacles, status, answers, events── VehicleView, ObstacleView, Replies ◄── MAVSDK ◄──┘
"""

from __future__ import annotations

import math
import time

from mavsdk import Mavsdk, System

from groundstation.bus import Bus
from groundstation.frames import Vector4
from groundstation.messages import (
    ATTITUDE,
    COMMAND,
    FIRMWARE_TEXT,
    OBSTACLES,
    REASON_TEXT,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Command,
    CommandKind,
    Severity,
    Stream,
    VehicleStatus,
    fit,
)
from groundstation.run import Run
from groundstation.vehicle.asleep import Sleep
from groundstation.vehicle.commander import STEERING, Commander
from groundstation.vehicle.gate import Gate
from groundstation.vehicle.hearing import Hearing
from groundstation.vehicle.identity import Identity
from groundstation.vehicle.interventions import Interventions
from groundstation.vehicle.obstacle_view import ObstacleView
from groundstation.vehicle.offboard import Act, OffboardStream, Seen
from groundstation.vehicle.parameter_desk import PARAMETER_COMMANDS, ParameterDesk
from groundstation.vehicle.profiles import LEFT_BY_LANDING, profile_of
from groundstation.vehicle.pump import Pump
from groundstation.vehicle.replies import Replies
from groundstation.vehicle.round_trip import RoundTrip
from groundstation.vehicle.takeoff_altitude import TakeoffAltitude
from groundstation.vehicle.telemetry import Notes, VehicleView

_TURN_S = 0.001
_STATUS_S = 0.1
_DISCOVERY_S = 0.05
_DEFAULT_TAKEOFF_M = 2.0
_LEAVE_S = 0.2
# A command that has waited for longer, while this process stood still, is nobody's wish any more.
_LATE_S = 2.0
# Three heartbeats: a vehicle whose heartbeats tell no autopilot that is known has none.
_INTRODUCTION_S = 3.0

# Commands that are the pilot's to follow and to answer.
_PILOTS = frozenset(
    {
        CommandKind.ENGAGE,
        CommandKind.DISENGAGE,
        CommandKind.MAPPING,
        CommandKind.FINE,
        CommandKind.CLUTCH,
        CommandKind.PRESET,
        CommandKind.CUES,
        CommandKind.SETTINGS,
    }
)


class Conversation:
    """What is said to one vehicle and heard of it; `turn` is one pass, to be made again and again.

    Args:
        run: The run it belongs to.
        bus: Where records come from and go to.
        mav: MAVSDK with the pump connected.
        pump: Moves the bytes.
        gate: Keeps stale setpoints back.
        notes: What other threads want told as events.
        sleep: Whether the computer slept; the gate goes by its clock.
    """

    def __init__(
        self, run: Run, bus: Bus, mav: Mavsdk, pump: Pump, gate: Gate, *, notes: Notes, sleep: Sleep
    ) -> None:
        self._run, self._bus, self._mav, self._pump, self._gate = run, bus, mav, pump, gate
        self._notes, self._sleep = notes, sleep
        self._setpoints = bus.subscriber(SETPOINT, depth=1)
        self._waker = bus.waker(SETPOINT)
        self._commands = bus.subscriber(COMMAND)
        self._states = bus.publisher(VEHICLE_STATE)
        self._attitudes = bus.publisher(ATTITUDE)
        self._ranges = bus.publisher(OBSTACLES)
        self._statuses = bus.publisher(VEHICLE_STATUS)
        self._replies = Replies(bus, notes)
        self._status = VehicleStatus(rtt=math.nan, battery=math.nan, voltage=math.nan)
        self._view = VehicleView(notes, time.monotonic)
        self._stream = OffboardStream(run.settings.safety)
        self._commander: Commander | None = None
        self._round_trip: RoundTrip | None = None
        self._obstacles: ObstacleView | None = None
        self._desk: ParameterDesk | None = None
        self._identity: Identity | None = None
        self._met_t = 0.0
        self._interventions = Interventions(bus, simulated=run.simulated)
        self._given = 0
        self._next_status = 0.0
        self._next_discovery = 0.0
        self._hearing = Hearing(pump, run.settings.safety)

    def turn(self) -> None:
        """Pass records once around; never waits."""
        now = time.monotonic()
        self._wake()
        if self._commander is None:
            self._discover(now)
        else:
            self._fly(now)
            self._commander.turn()
            self._collect_answers(now)
        if self._round_trip:
            self._round_trip.turn()
        if self._identity:
            self._identity.turn()
        for command in self._commands.drain():
            self._obey(command, now)
        self._interventions.turn(now)
        self._pass_on_sights()
        if self._desk:
            for answer in self._desk.pass_on(now, self._view.boots, self._hearing.absences):
                self._replies.tell(answer, now)
        self._replies.pass_on_notes(now)
        if now >= self._next_status or self._changed():
            self._next_status = now + _STATUS_S
            self._publish_status(now)

    def wait(self) -> None:
        """Wait for the next setpoint, or for the time of a turn."""
        self._waker.wait(_TURN_S)

    def leave(self) -> None:
        """End the stream if there is one, and give the vehicle the word to hold before the link goes."""
        if self._stream.state in {Stream.STARTING, Stream.FLYING} and self._commander:
            self._gate.close()
            self._commander.do(CommandKind.HOLD)
            time.sleep(_LEAVE_S)

    def close(self) -> bool:
        """End what waits for the vehicle; say whether MAVSDK may be taken away now."""
        freed = self._interventions.close()
        return (self._desk is None or self._desk.close()) and freed

    def _wake(self) -> None:
        """After a sleep nothing that was being flown goes on, however young the monotonic clock says it is."""
        if slept := self._sleep.news():
            words = f"this computer slept for {slept:.1f} s"
            act, why = self._stream.interrupted(f"{words}; the vehicle holds")
            self._do(act, why)
            if not why:
                self._bus.event(Severity.WARNING, f"{words[0].upper()}{words[1:]}.")

    def _discover(self, now: float) -> None:
        if now < self._next_discovery:
            return
        self._next_discovery = now + _DISCOVERY_S
        system = next((system for system in self._mav.get_systems() if system.has_autopilot()), None)
        if system is None:
            return
        # Another message may come first; what the autopilot is, only its heartbeat tells.
        self._met_t = self._met_t or now
        if profile_of(system.autopilot_type()) or now - self._met_t > _INTRODUCTION_S:
            self._attach(system)

    def _attach(self, system: System) -> None:
        mission = self._run.mission
        metres = mission.takeoff_altitude_m if mission else _DEFAULT_TAKEOFF_M
        profile = profile_of(system.autopilot_type())
        parameter = profile.takeoff_altitude if profile else ""
        altitude = (
            TakeoffAltitude(system, self._gate, parameter, metres, time.monotonic) if parameter else None
        )
        self._gate.address(system.get_system_id(), profile.modes if profile else frozenset())
        self._commander = Commander(system, self._gate, metres, altitude)
        self._round_trip = RoundTrip(system, time.monotonic)
        self._obstacles = ObstacleView(system, self._view.yaw, self._notes, time.monotonic)
        self._desk = ParameterDesk(self._bus, system, self._gate, profile)
        self._identity = Identity(system, time.monotonic)
        self._interventions.attach(system, self._gate, lambda: time.monotonic() - self._pump.heard_t)
        self._view.attach(system, self._run.settings.rates.telemetry)
        self._pump.watch(system.get_system_id())
        self._status.system_id, self._status.autopilot = system.get_system_id(), system.autopilot_type()
        kind = profile.label if profile else "unknown autopilot"
        words = f"Vehicle {self._status.system_id}, {kind}, found on {self._run.url}."
        self._bus.event(Severity.INFO if profile and profile.tested else Severity.WARNING, words)

    def _fly(self, now: float) -> None:
        """Stream the newest setpoint, or end the stream."""
        setpoint = self._setpoints.newest()
        if setpoint is None:
            return
        seen = Seen(now, bool(setpoint.active), now - setpoint.t, self._view.mode, self._view.mode_t)
        act, why = self._stream.step(seen)
        self._do(act, why)
        streaming = self._stream.state in {Stream.STARTING, Stream.FLYING}
        if streaming and setpoint.number != self._given:
            self._given = setpoint.number
            self._give(tuple(setpoint.velocity), setpoint.t)
        if act is Act.START and self._commander:
            self._commander.start_offboard()

    def _give(self, velocity: Vector4, made_t: float) -> None:
        if self._commander and self._gate.authorise(velocity, made_t + self._sleep.seconds()):
            self._commander.fly(velocity)

    def _do(self, act: Act, why: str) -> None:
        if act in {Act.CLOSE, Act.CLOSE_AND_HOLD}:
            self._gate.close()
        if act is Act.CLOSE_AND_HOLD and self._commander:
            self._commander.do(CommandKind.HOLD)
        if why:
            self._bus.event(Severity.ALARM, f"{why[0].upper()}{why[1:]}.")

    def _obey(self, command: Command, now: float) -> None:
        number, kind = command.number, CommandKind(command.kind)
        if kind in _PILOTS:
            return
        if self._commander is None or self._desk is None:
            self._replies.refuse(number, kind, "no vehicle is connected", now)
            return
        if (late := now - command.t) > _LATE_S and kind is not CommandKind.HOLD:
            text = f"the link stood still for {late:.0f} s since; ask again"
            self._replies.refuse(number, kind, text, now)
            return
        if kind in PARAMETER_COMMANDS:
            if why := self._desk.obey(command, armed=self._view.armed or self._view.in_air):
                self._replies.refuse(number, kind, why, now)
            return
        if kind in STEERING:
            self._stream.end()
            self._gate.close()
        if kind is CommandKind.ARM and self._view.mode in LEFT_BY_LANDING and not self._view.in_air:
            self._commander.arm_from_hold(number)
        else:
            self._commander.do(kind, number)

    def _collect_answers(self, now: float) -> None:
        commander = self._commander
        while commander and not commander.answers.empty():
            answer = commander.answers.get()
            if answer.number:
                self._replies.tell(answer, now)
            elif not answer.ok:
                self._bus.event(
                    Severity.ALARM,
                    f"The vehicle was told to hold, but {answer.why}; its own failsafe remains.",
                )
        while commander and not commander.offboard_answers.empty():
            ok, heard, why = commander.offboard_answers.get()
            if ok:
                self._stream.accepted(now)
            elif self._stream.state is Stream.STARTING:
                stream = self._stream
                self._do(
                    *(stream.refused(self._replies.with_reason(why, now)) if heard else stream.unanswered())
                )

    def _pass_on_sights(self) -> None:
        """Send where the vehicle is and what it sees, as soon as it has told."""
        while self._view.attitudes:
            self._attitudes.send(self._view.attitudes.popleft())
        if self._view.fresh:
            self._states.send(self._view.take_state())
        if self._obstacles:
            for record in self._obstacles.records():
                self._ranges.send(record)

    def _changed(self) -> bool:
        status, view = self._status, self._view
        return (status.armed, status.in_air, status.mode, status.streaming) != (
            int(view.armed),
            int(view.in_air),
            int(view.mode),
            int(self._stream.state),
        )

    def _publish_status(self, now: float) -> None:
        status, view = self._status, self._view
        status.t = now
        status.heard_t = self._pump.heard_t
        status.loss = self._pump.loss()
        if self._round_trip:
            status.rtt = self._round_trip.seconds
        status.battery, status.voltage = view.battery, view.voltage
        status.sent, status.dropped = self._gate.sent, self._gate.dropped
        status.health = int(view.health)
        status.connected = int(view.connected())
        status.armed, status.in_air = int(view.armed), int(view.in_air)
        status.mode, status.streaming = int(view.mode), int(self._stream.state)
        if self._desk:
            status.unsafe = fit(self._desk.unsafe, REASON_TEXT)
            status.speed_limits[:] = self._desk.speed_limits
        if self._identity:
            status.component = self._identity.component
            status.firmware = fit(self._identity.firmware, FIRMWARE_TEXT)
        self._statuses.send(status)
        for severity, words in self._hearing.news(now):
            self._bus.event(severity, words)
