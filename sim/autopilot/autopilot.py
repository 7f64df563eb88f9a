"""Arming, modes and failsafes of a PX4-like autopilot, in virtual time: no sockets, no clock, no MAVLink.

Every act returns a `Verdict`; a refusal says why, and says it in a notice too, as PX4 does with STATUSTEXT. World
ENU, vehicle FLU, SI units. Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum
from math import inf
from typing import NamedTuple

from sim.airframe import Airframe
from sim.autopilot.guidance import Target
from sim.autopilot.navigator import Mode, Navigator
from sim.autopilot.parameters import Parameters
from sim.battery import Battery
from sim.kinematics import Vector3, Vector4
from sim.models.motion import Motion

# PX4 wants setpoints at 2 Hz or more before it enters Offboard.
STREAM_S = 0.5
_LANDED_AFTER_S = 1.0
_REFUSALS_EVERY_S = 1.0
_NOTICES_KEPT = 64


class Severity(IntEnum):
    """Of a notice, numbered like MAV_SEVERITY."""

    EMERGENCY = 0
    CRITICAL = 2
    WARNING = 4
    INFO = 6


class Notice(NamedTuple):
    """Something said to the operator."""

    severity: Severity
    text: str


class Verdict(NamedTuple):
    """Whether an act was accepted; `why` says what forbids it."""

    ok: bool
    why: str = ""


ACCEPTED = Verdict(ok=True)
_LOSS_ACTIONS = {3: Mode.RETURN, 4: Mode.LAND, 5: Mode.HOLD}
_LINK_LOSS_ACTIONS = {1: Mode.HOLD, 2: Mode.RETURN, 3: Mode.LAND}
_TERMINATE, _DISARM = 6, 7


class Autopilot:
    """The autopilot of one vehicle.

    Args:
        airframe: The vehicle's limits.
        motion: The model it steers by.
        battery: What it watches.
        start: Where the vehicle stands, and home.
    """

    def __init__(self, airframe: Airframe, motion: Motion, battery: Battery, start: Vector4) -> None:
        self.parameters = Parameters()
        self.battery = battery
        self.notices: deque[Notice] = deque(maxlen=_NOTICES_KEPT)
        self.navigator = Navigator(airframe, motion, self.parameters, start)
        self.t = 0.0
        self.armed = False
        self.landed = True
        self.failsafe = False
        self.terminated = False
        self.took_off_t: float | None = None
        self._p = start
        self._contact_s = _LANDED_AFTER_S
        self.armed_t = 0.0
        self._flown = False
        self._setpoint_t = self._refused_t = -inf
        self._ground_station_t: float | None = None
        self._warned = self._alarmed = False

    @property
    def mode(self) -> Mode:
        """Who or what steers."""
        return self.navigator.mode

    @property
    def home(self) -> Vector4:
        """Where the vehicle was last armed, world."""
        return self.navigator.home

    # Acts of the operator

    def arm(self, *, force: bool = False) -> Verdict:
        """Start the motors."""
        if self.armed:
            return ACCEPTED
        if (why := self.arming_obstacle()) and (self.terminated or not force):
            return self._denied("Arming", why)
        self.armed = True
        self.failsafe = self._flown = False
        self.armed_t = self.t
        self.navigator.home = self._p
        self.navigator.enter(self.mode)
        self.say(Severity.INFO, "Armed by external command")
        return ACCEPTED

    def arming_obstacle(self) -> str:
        """Return what forbids arming now, or ""."""
        if self.terminated:
            return "flight was terminated; restart the vehicle"
        if self.battery.remaining <= self.parameters["BAT_CRIT_THR"]:
            return f"battery at {self.battery.remaining:.0%}; charge it"
        if not self.landed:
            return "not on the ground"
        if self.mode is Mode.OFFBOARD and not self.streaming:
            return "Offboard without setpoints; switch to Hold"
        if self.mode in (Mode.LAND, Mode.RETURN):
            return f"{self.mode.value} cannot take off; switch to Hold"
        return ""

    def disarm(self, *, force: bool = False) -> Verdict:
        """Stop the motors; in the air only with force."""
        if self.armed and not self.landed and not force:
            return self._denied("Disarming", "not landed")
        self._stop_motors("Disarmed by external command")
        return ACCEPTED

    def kill(self) -> Verdict:
        """Stop the motors now, wherever the vehicle is."""
        self._stop_motors("Kill: motors stopped")
        return ACCEPTED

    def terminate(self) -> Verdict:
        """Stop the motors for good."""
        self.terminated = True
        self.say(Severity.EMERGENCY, "Flight termination active")
        self._stop_motors("Motors stopped")
        return ACCEPTED

    def set_mode(self, mode: Mode) -> Verdict:
        """Change who steers."""
        if mode is Mode.OFFBOARD and not self.streaming:
            return self._denied(
                "Offboard", "no setpoints are coming; stream them at 2 Hz or more before the switch"
            )
        self.failsafe = False
        if mode is not self.mode:
            self.navigator.enter(mode)
        return ACCEPTED

    def take_off(self, height: float | None = None) -> Verdict:
        """Climb to a height above home, m: MIS_TAKEOFF_ALT unless given. A disarmed vehicle does so once armed."""
        self.failsafe = False
        self.navigator.takeoff_height = height
        self.navigator.enter(Mode.TAKEOFF)
        return ACCEPTED

    def reposition(self, position: Vector3, yaw: float | None) -> Verdict:
        """Fly to a point, world m, and hold there."""
        if not self.armed or self.landed:
            return self._denied("Reposition", "not flying")
        self.failsafe = False
        self.navigator.go_to(position, yaw)
        return ACCEPTED

    def offboard(self, setpoint: Target) -> None:
        """Take an offboard setpoint, all of it finite; it steers while the mode is Offboard."""
        self.navigator.setpoint = setpoint
        self._setpoint_t = self.t

    def refuse_setpoint(self, why: str) -> None:
        """Say, but not too often, that a setpoint was not taken. It does not count as part of a stream."""
        if self.t - self._refused_t >= _REFUSALS_EVERY_S:
            self._refused_t = self.t
            self.say(Severity.CRITICAL, f"Setpoint refused: {why}")

    def hear_ground_station(self) -> None:
        """Note that a ground station's heartbeat came."""
        self._ground_station_t = self.t

    @property
    def streaming(self) -> bool:
        """Setpoints are coming at 2 Hz or more."""
        return self.t - self._setpoint_t < STREAM_S

    def say(self, severity: Severity, text: str) -> None:
        """Tell the operator something."""
        self.notices.append(Notice(severity, text))

    # One step

    def step(self, p: Vector4, v: Vector4, grounded: bool, dt: float) -> Vector4 | None:
        """Advance by `dt` seconds and return the vehicle's reference, or None while the motors are stopped.

        Args:
            p: Where the vehicle is.
            v: Its velocities.
            grounded: Something carries it.
            dt: The step, s.
        """
        self.t += dt
        self._p = p
        self.navigator.look(p, v)
        self._detect_landing(grounded, dt)
        if self.armed:
            self._watch_ground()
            self._watch_battery()
            self._watch_streams()
        if not self.armed:
            return None
        return self.navigator.steer(dt)

    def _detect_landing(self, grounded: bool, dt: float) -> None:
        self._contact_s = self._contact_s + dt if grounded else 0.0
        if self._contact_s >= _LANDED_AFTER_S:
            if not self.landed:
                self.say(Severity.INFO, "Landing detected")
            self.landed = True
        elif not grounded and self.landed:
            self.landed = False
            self.took_off_t = self.t
            self._flown = True
            self.say(Severity.INFO, "Takeoff detected")

    def _watch_ground(self) -> None:
        """Disarm after landing, or when armed without taking off."""
        if not self.landed:
            return
        if self._flown and self._contact_s >= _LANDED_AFTER_S + self.parameters["COM_DISARM_LAND"]:
            self._stop_motors("Disarmed by landing")
        elif not self._flown and self.t - self.armed_t >= self.parameters["COM_DISARM_PRFLT"]:
            self._stop_motors("Disarmed by auto preflight disarming")

    def _watch_battery(self) -> None:
        left = self.battery.remaining
        if left <= 0.0:
            self._stop_motors("Battery empty: motors stopped", Severity.EMERGENCY)
        elif left <= self.parameters["BAT_CRIT_THR"] and not self._alarmed:
            self._alarmed = True
            self.say(Severity.CRITICAL, "Critical battery, land now")
            if (action := self.parameters["COM_LOW_BAT_ACT"]) and not self.landed:
                self._fail_to(Mode.LAND if action == 2 else Mode.RETURN)
        elif left <= self.parameters["BAT_LOW_THR"] and not self._warned:
            self._warned = True
            self.say(Severity.WARNING, "Low battery, return advised")

    def _watch_streams(self) -> None:
        """Act on the loss of the offboard stream, and of the ground station where NAV_DLL_ACT asks for it."""
        if self.mode is Mode.OFFBOARD and self.t - self._setpoint_t > self.parameters["COM_OF_LOSS_T"]:
            self._lose_offboard(int(self.parameters["COM_OBL_RC_ACT"]))
        action = _LINK_LOSS_ACTIONS.get(int(self.parameters["NAV_DLL_ACT"]))
        if action is None or self.failsafe or self._ground_station_t is None:
            return
        if not self.landed and self.t - self._ground_station_t > self.parameters["COM_DL_LOSS_T"]:
            self.say(Severity.CRITICAL, f"Ground station lost: {action.value}")
            self._fail_to(action)

    def _lose_offboard(self, action: int) -> None:
        if action == _TERMINATE:
            self.terminate()
        elif action == _DISARM:
            self._stop_motors("Offboard setpoints lost: motors stopped", Severity.CRITICAL)
        else:
            mode = _LOSS_ACTIONS[action]
            self.say(Severity.CRITICAL, f"Offboard setpoints lost: {mode.value}")
            self._fail_to(mode)

    def _fail_to(self, mode: Mode) -> None:
        self.failsafe = True
        if mode is not self.mode:
            self.navigator.enter(mode)

    def _stop_motors(self, text: str, severity: Severity = Severity.INFO) -> None:
        """Disarm. The next flight begins in Hold, as in PX4 after a landing."""
        if self.armed:
            self.armed = False
            self.navigator.enter(Mode.HOLD)
            self.say(severity, text)

    def _denied(self, act: str, why: str) -> Verdict:
        self.say(Severity.CRITICAL, f"{act} denied: {why}")
        return Verdict(ok=False, why=why)
