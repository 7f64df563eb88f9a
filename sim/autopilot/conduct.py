"""What the autopilot does by itself at every step: steer, look, end modes, act on failsafes, stop the motors.

World ENU, vehicle FLU, SI units. Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from sim.airframe import Airframe
from sim.autopilot.arming import mode_obstacle
from sim.autopilot.failsafe import Act
from sim.autopilot.guard import Decision
from sim.autopilot.instruments import Instruments
from sim.autopilot.modes import Mode
from sim.autopilot.navigator import Navigator
from sim.autopilot.notices import ACCEPTED, Severity, Verdict
from sim.autopilot.parameters import Parameters
from sim.battery import Battery
from sim.kinematics import Vector4
from sim.models.motion import Motion

# What needs no eye at every step is looked at this often: batteries, links, fence, failsafes.
WATCH_S = 0.02
_NEARLY = 1e-9
_TAKEN_OVER = "Pilot took over using sticks"
_AUTO = (Mode.HOLD, Mode.TAKEOFF, Mode.RETURN, Mode.LAND, Mode.MISSION, Mode.DESCEND)


class Conduct(Instruments):
    """The conduct of one vehicle.

    Args:
        airframe: The vehicle's limits.
        motion: The model it steers by.
        battery: What it watches.
        start: Where the vehicle stands, and home.

    Attributes:
        armed: The motors run.
        armed_t: Since when, s.
        wanted: The mode the operator asked for; a failsafe may fly another, `mode`.
        terminated: The motors are stopped for good.
        failsafe_reason: Why a failsafe acts, or "".
    """

    def __init__(self, airframe: Airframe, motion: Motion, battery: Battery, start: Vector4) -> None:
        parameters = Parameters()
        navigator = Navigator(airframe, motion, parameters, start)
        super().__init__(parameters, navigator, battery, motion.attitude)
        self.t = 0.0
        self.armed = False
        self.armed_t = 0.0
        self.wanted = Mode.HOLD
        self.terminated = False
        self.failsafe_reason = ""
        self._watched_t = 0.0
        self._home_set = False

    def step(
        self, p: Vector4, v: Vector4, grounded: bool, dt: float, *, position_valid: bool = True
    ) -> Vector4 | None:
        """Advance by `dt` seconds and return the vehicle's reference, or None while the motors are stopped.

        Args:
            p: Where the vehicle is, as it believes.
            v: Its velocities, likewise.
            grounded: Something carries it.
            dt: The step, s.
            position_valid: It trusts p and v.
        """
        self.t += dt
        navigator = self._navigator
        flight = navigator.flight
        flight.p, flight.v = p, v
        self._watch.step(grounded, position_valid, dt)
        if self.t - self._watched_t >= WATCH_S - _NEARLY:
            self._look(self.t - self._watched_t)
        if not self.armed:
            return None
        reference = navigator.steer(dt)
        if navigator.ended:
            self._end_mode()
        return reference

    def terminate(self) -> Verdict:
        """Stop the motors for good."""
        if not self.terminated:
            self.terminated = True
            self.say(Severity.EMERGENCY, "Flight termination active")
            self._stop_motors("Motors stopped")
        return ACCEPTED

    def crash(self, name: str, speed: float) -> None:
        """Stop the motors: the vehicle has run into something with a speed, m/s, that breaks it."""
        self._stop_motors(f"Crashed into {name} at {speed:.1f} m/s: motors stopped", Severity.CRITICAL)

    def _look(self, dt: float) -> None:
        """Look at what needs no eye at every step."""
        self._watched_t = self.t
        self._watch.look(dt)
        self._navigator.refresh()
        if not self.armed:
            return
        if why := self._watch.disarms(self.t - self.armed_t):
            self._stop_motors(why)
        elif self._watch.battery_empty:
            self._stop_motors("Battery empty: motors stopped", Severity.EMERGENCY)
        else:
            moved = self._sticks_moved()
            if moved and not self.failsafe:
                self._take_over()
            self._decide(dt, sticks_moved=moved)

    def _sticks_moved(self) -> bool:
        """Say whether the operator reaches for the sticks where COM_RC_OVERRIDE heeds that."""
        bit = 1 if self.mode in _AUTO else 2 if self.mode is Mode.OFFBOARD else 0
        return bool(int(self.parameters["COM_RC_OVERRIDE"]) & bit) and self._watch.sticks_moved

    def _take_over(self) -> None:
        self.say(Severity.INFO, _TAKEN_OVER)
        self._want(Mode.POSITION if self.position_valid else Mode.ALTITUDE)

    def _end_mode(self) -> None:
        """Go on after a mode that has done what it is for."""
        navigator = self._navigator
        navigator.ended = False
        if self.mode is Mode.TAKEOFF and self.wanted is Mode.TAKEOFF:
            navigator.takeoff_height = None
            if self.parameters["COM_TAKEOFF_ACT"] == 1 and not self._obstacle(Mode.MISSION):
                self._want(Mode.MISSION)
            else:
                self._stay()
        elif self.mode is Mode.MISSION and navigator.mission.wants_return:
            self._want(Mode.RETURN)
        elif self.mode is Mode.MISSION:
            self.say(Severity.INFO, "Mission finished")
            self._stay()

    def _stay(self) -> None:
        """Go over to Hold where the vehicle is told to be."""
        self._navigator.stay()
        self.wanted = Mode.HOLD
        self._watch.sticks.rest()

    def _want(self, mode: Mode, *, again: bool = False) -> None:
        """Fly a mode, as far as the failsafes let it; `again`: begin it anew where it is flown already."""
        self.wanted = mode
        already = self.mode is mode
        if self.armed:
            self._decide(0.0, switched=True)
        elif not already:
            self._enter(mode)
        if again and already and self.mode is mode:
            self._enter(mode)

    def _decide(self, dt: float, *, switched: bool = False, sticks_moved: bool = False) -> None:
        """Do what the failsafes decide."""
        situation = self._watch.situation(self.wanted, self.t - self.armed_t)
        acted = self.failsafe
        decision = self._guard.update(situation, dt, switched=switched, sticks_moved=sticks_moved)
        if decision.wanted is not self.wanted:
            self.wanted = decision.wanted
            self.say(Severity.INFO, _TAKEN_OVER)
        self.failsafe_reason = decision.cause if decision.act > Act.WARN else ""
        if decision.news:
            self._tell(decision)
        elif acted and not self.failsafe and not switched:
            self.say(Severity.INFO, f"Failsafe over: {decision.mode.value}")
        if decision.act is Act.TERMINATE:
            self.terminate()
        elif decision.act is Act.DISARM:
            self._stop_motors(f"{decision.cause}: motors stopped", Severity.CRITICAL)
        elif decision.mode is not self.mode:
            self._enter(decision.mode)

    def _enter(self, mode: Mode) -> None:
        self._navigator.enter(mode)
        self._watch.sticks.rest()

    def _tell(self, decision: Decision) -> None:
        if decision.act is Act.WARN:
            self.say(Severity.WARNING, decision.cause)
        elif decision.then:
            delay = self.parameters["COM_FAIL_ACT_T"]
            then = decision.then.name.capitalize()
            self.say(Severity.CRITICAL, f"{decision.cause}: Hold for {delay:g} s, then {then}")
        else:
            self.say(Severity.CRITICAL, f"{decision.cause}: {decision.act.name.capitalize()}")

    def _obstacle(self, mode: Mode) -> str:
        state = self._watch.state(terminated=self.terminated)
        return mode_obstacle(mode, state if self.armed else state._replace(position=True))

    def _stop_motors(self, text: str, severity: Severity = Severity.INFO) -> None:
        """Disarm. The next flight begins in Hold, as in PX4 after a landing, or by the sticks if this one was."""
        if not self.armed:
            return
        self.armed = False
        self._guard.reset()
        self.failsafe_reason = ""
        self._navigator.flight.cruise = None
        if self.wanted not in (Mode.POSITION, Mode.ALTITUDE):
            self.wanted = Mode.HOLD
        self._enter(self.wanted)
        self.say(severity, text)
