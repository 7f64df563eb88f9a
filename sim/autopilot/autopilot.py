"""Arming, modes and failsafes of a PX4-like autopilot, in virtual time: no sockets, no clock, no MAVLink.

Every act returns a `Verdict`; a refusal says why, and says it in a notice too, as PX4 does with STATUSTEXT. World
ENU, vehicle FLU, SI units. Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from sim.autopilot.arming import arming_obstacles
from sim.autopilot.conduct import Conduct
from sim.autopilot.fence import zone_fault
from sim.autopilot.guidance import Target
from sim.autopilot.mission import first_waypoint_distance, jump_fault
from sim.autopilot.modes import Mode
from sim.autopilot.notices import ACCEPTED, Severity, Verdict
from sim.autopilot.plan import Leg, Zone
from sim.autopilot.sticks import Sticks
from sim.kinematics import Vector3, Vector4


class Autopilot(Conduct):
    """The autopilot of one vehicle: what may be asked of it.

    Args:
        airframe: The vehicle's limits.
        motion: The model it steers by.
        battery: What it watches.
        start: Where the vehicle stands, and home.
    """

    def arm(self, *, force: bool = False) -> Verdict:
        """Start the motors."""
        if self.armed:
            return ACCEPTED
        if (why := self.arming_obstacle()) and (self.terminated or not force):
            return self._notices.denied("Arming", why)
        self.armed = True
        self.armed_t = self.t
        self._guard.reset()
        self._watch.arm()
        if not self._home_set:
            self._navigator.flight.home = self._navigator.flight.p
        self._navigator.enter(self.mode)
        self.say(Severity.INFO, "Armed by external command")
        return ACCEPTED

    def arming_obstacles(self) -> list[str]:
        """Return all that forbids arming now."""
        return arming_obstacles(self.wanted, self._watch.state(terminated=self.terminated), self.parameters)

    def arming_obstacle(self) -> str:
        """Return what forbids arming now, or ""."""
        return next(iter(self.arming_obstacles()), "")

    def disarm(self, *, force: bool = False) -> Verdict:
        """Stop the motors; in the air only with force."""
        if self.armed and not self.landed and not force:
            return self._notices.denied("Disarming", "not landed")
        self._stop_motors("Disarmed by external command")
        return ACCEPTED

    def kill(self) -> Verdict:
        """Stop the motors now, wherever the vehicle is."""
        self._stop_motors("Kill: motors stopped")
        return ACCEPTED

    def set_mode(self, mode: Mode) -> Verdict:
        """Change who steers. While disarmed, a mode that needs a position may be chosen without one."""
        if mode is Mode.TAKEOFF:
            return self.take_off()
        if mode is Mode.DESCEND:
            return self._notices.denied(mode.value, "only failsafes choose it")
        if why := self._obstacle(mode):
            return self._notices.denied(mode.value, why)
        if mode is Mode.MISSION:
            self._warn_of_far_mission()
        self._want(mode)
        return ACCEPTED

    def take_off(self, height: float | None = None) -> Verdict:
        """Climb to a height above home, m: MIS_TAKEOFF_ALT unless given. A disarmed vehicle does so once armed."""
        if why := self._obstacle(Mode.TAKEOFF):
            return self._notices.denied(Mode.TAKEOFF.value, why)
        self._navigator.takeoff_height = height
        self._want(Mode.TAKEOFF, again=True)
        return ACCEPTED

    def reposition(self, position: Vector3, yaw: float | None) -> Verdict:
        """Fly to a point, world m, and hold there."""
        if not self.armed or self.landed:
            return self._notices.denied("Reposition", "not flying")
        if why := self._obstacle(Mode.HOLD):
            return self._notices.denied("Reposition", why)
        self._want(Mode.HOLD)
        if self.mode is Mode.HOLD:
            self._navigator.go_to(position, yaw)
        return ACCEPTED

    def change_speed(self, speed: float) -> Verdict:
        """Fly automatic modes with another horizontal speed, m/s, until the motors stop; −1: MPC_XY_CRUISE."""
        if speed != -1.0 and not 0.0 < speed <= self.parameters["MPC_XY_VEL_MAX"]:
            return self._notices.denied("Speed", "out of range")
        self._navigator.flight.cruise = None if speed == -1.0 else speed
        return ACCEPTED

    def set_home(self, position: Vector4) -> Verdict:
        """Set home, world; arming leaves it there."""
        self._navigator.flight.home = position
        self._home_set = True
        return ACCEPTED

    def offboard(self, setpoint: Target) -> None:
        """Take an offboard setpoint, all of it finite; it steers while the mode is Offboard."""
        self._navigator.setpoint = setpoint
        self._watch.hear_setpoint()

    def refuse_setpoint(self, why: str) -> None:
        """Say, but not too often, that a setpoint was not taken. It does not count as part of a stream."""
        self._watch.refuse_setpoint(why)

    def hear_ground_station(self) -> None:
        """Note that a ground station's heartbeat came."""
        self._watch.hear_ground_station()

    def sticks(self, sticks: Sticks, *, joystick: bool = True) -> None:
        """Take stick positions, from a joystick or a radio; COM_RC_IN_MODE says which count."""
        self._watch.sticks.take(sticks, self.t, joystick=joystick)
        self._navigator.by_hand.sticks = self._watch.sticks.now

    # Plans

    def load_mission(self, legs: tuple[Leg, ...]) -> Verdict:
        """Take another mission; one that is being flown begins anew."""
        if why := jump_fault(legs):
            return self._notices.denied("Mission", why)
        self._navigator.plan = self.plan._replace(mission=legs)
        self._navigator.mission.load(legs)
        if self.wanted is Mode.MISSION and (why := self._obstacle(Mode.MISSION)):
            self.say(Severity.WARNING, f"Mission ended: {why}")
            self._want(Mode.HOLD)
        return ACCEPTED

    def load_fence(self, zones: tuple[Zone, ...]) -> Verdict:
        """Take another fence."""
        if why := zone_fault(zones):
            return self._notices.denied("Fence", why)
        self._navigator.plan = self.plan._replace(fence=zones)
        return ACCEPTED

    def load_rally(self, points: tuple[Vector3, ...]) -> Verdict:
        """Take other rally points."""
        self._navigator.plan = self.plan._replace(rally=points)
        return ACCEPTED

    def set_mission_index(self, index: int) -> Verdict:
        """Go on, or begin, with another item."""
        if not 0 <= index < len(self.plan.mission):
            return self._notices.denied("Mission item", f"there is no item {index}")
        self._navigator.mission.go_to(index)
        return ACCEPTED

    def _warn_of_far_mission(self) -> None:
        limit = self.parameters["MIS_DIST_1WP"]
        if 0.0 < limit < (far := first_waypoint_distance(self.plan.mission, self.home)):
            self.say(Severity.WARNING, f"First waypoint is far away: {far:.0f} m")
