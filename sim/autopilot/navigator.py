"""The flight modes: what each does on entry and at every step; one target at a time.

World ENU, vehicle FLU, SI units. Names in capitals are PX4's parameters.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from sim.airframe import Airframe
from sim.autopilot.flight import Flight
from sim.autopilot.guidance import FREE, Guidance, Target
from sim.autopilot.mission import Mission
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters
from sim.autopilot.plan import Plan
from sim.autopilot.returning import stages_home
from sim.autopilot.stages import Climb, GoTo, Stage, Touchdown
from sim.autopilot.sticks import ByHand
from sim.kinematics import ZERO4, Vector3, Vector4
from sim.models.motion import Motion

_MOVED = (Mode.TAKEOFF, Mode.MISSION, Mode.OFFBOARD, Mode.POSITION, Mode.ALTITUDE)


class Navigator:
    """Steers in every mode.

    Args:
        airframe: The vehicle's limits.
        motion: The model it steers by.
        parameters: Gains, speeds and heights.
        start: Where the vehicle stands, and home until it is armed.

    Attributes:
        mode: The one flown.
        flight: The vehicle as the modes see it.
        mission: Its legs and how far it has come.
        by_hand: Flies by the sticks.
        plan: All that is on board.
        setpoint: Of Offboard.
        takeoff_height: Above home, m; None: MIS_TAKEOFF_ALT.
        ended: The mode has done what it is for.
    """

    def __init__(self, airframe: Airframe, motion: Motion, parameters: Parameters, start: Vector4) -> None:
        self._guidance = Guidance(motion, airframe, parameters)
        self._parameters = parameters
        self.flight = Flight(self._guidance, parameters, start)
        self.mission = Mission(self.flight)
        self.by_hand = ByHand(self.flight)
        self.plan = Plan()
        self.mode = Mode.HOLD
        self.setpoint = Target()
        self.takeoff_height: float | None = None
        self.ended = False
        self._stages: deque[Stage] = deque()
        self._enter: dict[Mode, Callable[[], None]] = {
            Mode.TAKEOFF: self._enter_takeoff,
            Mode.RETURN: self._enter_return,
            Mode.LAND: self._enter_land,
            Mode.MISSION: self.mission.begin,
            Mode.POSITION: self.by_hand.begin,
            Mode.ALTITUDE: self.by_hand.begin,
        }
        self._steer: dict[Mode, Callable[[float], Vector4]] = {
            Mode.OFFBOARD: self._follow,
            Mode.MISSION: self._fly_mission,
            Mode.POSITION: self.by_hand.position,
            Mode.ALTITUDE: self.by_hand.altitude,
            Mode.DESCEND: self._sink,
        }
        self._steer_now = self._along

    def refresh(self) -> None:
        """Take in changed parameters."""
        self._guidance.refresh()

    def enter(self, mode: Mode) -> None:
        """Begin a mode from here."""
        self._begin(mode)
        self.flight.hold()
        if mode in self._enter:
            self._enter[mode]()

    def stay(self) -> None:
        """Go over to Hold at the present target."""
        self._begin(Mode.HOLD)
        self.flight.aim(self.flight.target.position)
        if None in self.flight.target.position:
            self.flight.hold()

    def go_to(self, position: Vector3, yaw: float | None) -> None:
        """Hold at another point."""
        self.enter(Mode.HOLD)
        self._stages.append(GoTo(position, yaw=yaw))

    def steer(self, dt: float) -> Vector4:
        """Return the reference for the vehicle; none moves one that stands, in a mode that is not to take off."""
        if self.flight.landed and self.mode not in _MOVED:
            return ZERO4
        return self._steer_now(dt)

    def _begin(self, mode: Mode) -> None:
        self.mode = mode
        self.ended = False
        self._stages.clear()
        self._steer_now = self._steer.get(mode, self._along)

    def _enter_takeoff(self) -> None:
        """Climb to a height above home; no lower than now."""
        above = self._parameters["MIS_TAKEOFF_ALT"] if self.takeoff_height is None else self.takeoff_height
        self._stages.append(Climb(max(self.flight.p[2], self.flight.above_home(above))))

    def _enter_land(self) -> None:
        self._stages.append(Touchdown(self.flight.home[2]))

    def _enter_return(self) -> None:
        self._stages.extend(stages_home(self.flight, self.plan))

    def _along(self, dt: float) -> Vector4:
        """Fly on along the stages, then stay at the target."""
        if self._stages and self._stages[0].update(self.flight, dt):
            self._stages.popleft()
            self.ended = not self._stages
        return self.flight.steer(dt)

    def _fly_mission(self, dt: float) -> Vector4:
        self.mission.update(dt)
        self.ended = self.mission.finished or self.mission.wants_return
        if self.ended and self.flight.landed:
            return ZERO4
        return self.flight.steer(dt)

    def _follow(self, dt: float) -> Vector4:
        """Follow the setpoint; without a position its velocities go to the vehicle as they are."""
        flight, guidance, setpoint = self.flight, self._guidance, self.setpoint
        if setpoint.position == FREE:
            wanted = guidance.accelerated(flight.p, flight.v, setpoint, dt)
            return guidance.velocity(flight.p, wanted, setpoint, guidance.full)
        return guidance.track(flight.p, flight.v, setpoint, dt, guidance.full)

    def _sink(self, _: float) -> Vector4:
        """Sink level with MPC_LAND_SPEED: all that can be done without a position."""
        flight = self.flight
        down = (0.0, 0.0, -self._parameters["MPC_LAND_SPEED"])
        return self._guidance.velocity(flight.p, down, flight.target, self._guidance.full)
