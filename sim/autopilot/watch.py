"""What the autopilot keeps an eye on: ground, links, sticks, battery, fence, attitude.

Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf, radians

from sim.autopilot.arming import State
from sim.autopilot.failsafe import Level, Situation
from sim.autopilot.fence import breach
from sim.autopilot.mission import mission_fault
from sim.autopilot.modes import Mode
from sim.autopilot.navigator import Navigator
from sim.autopilot.notices import Severity
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Plan
from sim.autopilot.sticks import StickInput
from sim.battery import Battery
from sim.kinematics import Vector3, Vector4
from sim.models.motion import Attitude

# PX4 wants setpoints at 2 Hz or more before it enters Offboard.
STREAM_S = 0.5
_LANDED_AFTER_S = 1.0
_REFUSALS_EVERY_S = 1.0
_POSITIONED = frozenset(
    (Mode.HOLD, Mode.TAKEOFF, Mode.OFFBOARD, Mode.RETURN, Mode.LAND, Mode.MISSION, Mode.POSITION)
)
_BLIND = frozenset((Mode.ALTITUDE, Mode.DESCEND))


class Watch:
    """Keeps an eye on one vehicle.

    Args:
        navigator: Where it is and what is on board.
        parameters: Times and thresholds.
        battery: Its battery.
        attitude: How it leans.
        say: To tell of take-off, landing, and refused setpoints.

    Attributes:
        landed: Something has carried it for a second.
        took_off_t: When it last left the ground, s, or None.
        position_valid: It trusts its position.
        breach: How the fence is breached, or "".
        sticks: Where the sticks are.
    """

    def __init__(
        self,
        navigator: Navigator,
        parameters: Parameters,
        battery: Battery,
        attitude: Attitude,
        say: Callable[[Severity, str], None],
    ) -> None:
        self._navigator = navigator
        self._parameters = parameters
        self._battery = battery
        self._attitude = attitude
        self._say = say
        self._t = 0.0
        self.landed = True
        self.took_off_t: float | None = None
        self.position_valid = True
        self.breach = ""
        self.sticks = StickInput(parameters)
        self._contact_s = _LANDED_AFTER_S
        self._flown = False
        self._setpoint_t = self._refused_t = -inf
        self._ground_station_t: float | None = None
        self._sticks_needed = False
        self._battery_at_arming = Level.FINE
        self._roll_s = self._pitch_s = 0.0
        self._judged: tuple[Plan, Vector4, int] | None = None
        self._fault = ""

    def step(self, grounded: bool, position_valid: bool, dt: float) -> None:
        """Take in a step: landing and take-off are seen at once."""
        self._t += dt
        self.position_valid = position_valid
        self._contact_s = self._contact_s + dt if grounded else 0.0
        if self._contact_s >= _LANDED_AFTER_S:
            if not self.landed:
                self._say(Severity.INFO, "Landing detected")
                self._set_landed(landed=True)
        elif not grounded and self.landed:
            self._set_landed(landed=False)
            self.took_off_t = self._t
            self._flown = True
            self._say(Severity.INFO, "Takeoff detected")

    def look(self, dt: float) -> None:
        """Look at the rest: fence, attitude, sticks."""
        get, flight = self._parameters, self._navigator.flight
        x, y, z, _ = flight.p
        if get["GF_PREDICT"]:
            ahead_x, ahead_y = flight.ahead()
            x, y = x + ahead_x, y + ahead_y
        point: Vector3 = (x, y, z)
        self.breach = (
            breach(point, flight.home, self._navigator.plan.fence, get) if self.position_valid else ""
        )
        self._roll_s = self._leaning("FD_FAIL_R", self._attitude.roll, self._roll_s + dt)
        self._pitch_s = self._leaning("FD_FAIL_P", self._attitude.pitch, self._pitch_s + dt)
        if not self._sticks_needed:
            self._sticks_needed = self.has_sticks

    def arm(self) -> None:
        """Begin a flight: what is not there now will not be missed."""
        self._flown = False
        self._sticks_needed = self.has_sticks
        self._battery_at_arming = self._battery_level()
        self._roll_s = self._pitch_s = 0.0

    def hear_setpoint(self) -> None:
        """Note that a setpoint came."""
        self._setpoint_t = self._t

    def refuse_setpoint(self, why: str) -> None:
        """Say, but not too often, that a setpoint was not taken."""
        if self._t - self._refused_t >= _REFUSALS_EVERY_S:
            self._refused_t = self._t
            self._say(Severity.CRITICAL, f"Setpoint refused: {why}")

    def hear_ground_station(self) -> None:
        """Note that a ground station's heartbeat came."""
        self._ground_station_t = self._t

    @property
    def streaming(self) -> bool:
        """Setpoints are coming at 2 Hz or more."""
        return self._t - self._setpoint_t < STREAM_S

    @property
    def has_sticks(self) -> bool:
        """Fresh sticks are there."""
        return self.sticks.fresh(self._t)

    @property
    def sticks_moved(self) -> bool:
        """The operator reaches for the sticks."""
        return self.has_sticks and self.sticks.moved

    @property
    def battery_empty(self) -> bool:
        """Nothing is left."""
        return self._battery.remaining <= 0.0

    def disarms(self, armed_s: float) -> str:
        """Return why the motors stop by themselves: after a landing, or armed without taking off; or ""."""
        if not self.landed:
            return ""
        landing, waiting = self._parameters["COM_DISARM_LAND"], self._parameters["COM_DISARM_PRFLT"]
        if self._flown:
            over = landing > 0.0 and self._contact_s >= _LANDED_AFTER_S + landing
            return "Disarmed by landing" if over else ""
        return "Disarmed by auto preflight disarming" if 0.0 < waiting <= armed_s else ""

    def state(self, *, terminated: bool) -> State:
        """Return what arming and changing modes depend on."""
        return State(
            landed=self.landed,
            terminated=terminated,
            position=self.position_valid,
            streaming=self.streaming,
            sticks=self.has_sticks,
            throttle=self.sticks.now.up,
            remaining=self._battery.remaining,
            breach=self.breach,
            mission_fault=self._mission_fault(),
        )

    def situation(self, wanted: Mode, armed_s: float) -> Situation:
        """Return what the failsafes judge by."""
        get, sticks, t = self._parameters, self.has_sticks, self._t
        station, longest = self._ground_station_t, get["COM_FLT_TIME_MAX"]
        took_off = self.took_off_t
        return Situation(
            wanted,
            (_POSITIONED | _BLIND) if self.position_valid else _BLIND,
            sticks_lost=not sticks,
            sticks_needed=self._sticks_needed and get["COM_RC_IN_MODE"] != 4,
            station_lost=station is not None and t - station > get["COM_DL_LOSS_T"],
            stream_lost=t - self._setpoint_t > get["COM_OF_LOSS_T"],
            breach=self.breach,
            battery=self._battery_level(),
            battery_at_arming=self._battery_at_arming,
            overtime=longest > 0.0 and not self.landed and took_off is not None and t - took_off > longest,
            tilted=self._roll_s > get["FD_FAIL_R_TTRI"] or self._pitch_s > get["FD_FAIL_P_TTRI"],
            just_armed=armed_s < get["COM_LKDOWN_TKO"],
        )

    def _mission_fault(self) -> str:
        """Judge the mission anew only where something it depends on has changed: it may be long."""
        plan, home = self._navigator.plan, self._navigator.flight.home
        judged = (plan, home, self._parameters.changed)
        if self._judged is None or self._judged[0] is not plan or self._judged[1:] != judged[1:]:
            self._judged = judged
            self._fault = mission_fault(plan, home, self._parameters)
        return self._fault

    def _set_landed(self, *, landed: bool) -> None:
        self.landed = self._navigator.flight.landed = landed

    def _battery_level(self) -> Level:
        left, get = self._battery.remaining, self._parameters
        if left <= get["BAT_EMERGEN_THR"]:
            return Level.EMERGENCY
        if left <= get["BAT_CRIT_THR"]:
            return Level.CRITICAL
        return Level.LOW if left <= get["BAT_LOW_THR"] else Level.FINE

    def _leaning(self, name: str, angle: float, seconds: float) -> float:
        """Return for how long an angle, rad, has been beyond its parameter (0: no limit): `seconds`, or 0."""
        limit = self._parameters[name]
        return seconds if limit > 0.0 and abs(angle) > radians(limit) else 0.0
