"""Sticks: where they come from, when they count, and flying by them (Position and Altitude mode).

World ENU, vehicle FLU, SI units. Source: PX4 user guide, "Position Mode" and "Altitude Mode"; names in capitals are
PX4's parameters.
"""

from __future__ import annotations

from math import cos, hypot, inf, sin
from typing import NamedTuple

from sim.autopilot.flight import Flight
from sim.autopilot.guidance import Target
from sim.autopilot.parameters import Parameters
from sim.kinematics import ZERO3, ZERO4, Vector3, Vector4

# How fast a vertical velocity asked for by the sticks changes, m/s²: PX4's MPC_ACC_UP_MAX and MPC_ACC_DOWN_MAX are
# 4 and 3.
_VERTICAL_ACCELERATION = 3.0
_STILL = 1e-3
_RADIO, _JOYSTICK, _FALLBACK, _FIRST = 0, 1, 2, 3


class Sticks(NamedTuple):
    """Stick positions, each −1..1 and 0 in the middle.

    Attributes:
        forward: Pitch stick.
        left: Roll stick; positive is to the left.
        up: Throttle stick; the middle holds the height.
        yaw: Yaw stick; positive turns counter-clockwise.
    """

    forward: float = 0.0
    left: float = 0.0
    up: float = 0.0
    yaw: float = 0.0


CENTRED = Sticks()


class StickInput:
    """Takes sticks from the source that COM_RC_IN_MODE admits, and notices when they are moved.

    Args:
        parameters: What governs it.

    Attributes:
        now: The newest sticks.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self._t = -inf
        self._joystick: bool | None = None
        self._rest = CENTRED
        self.now = CENTRED

    def take(self, sticks: Sticks, t: float, *, joystick: bool) -> None:
        """Take stick positions at time `t`, s, from a joystick or a radio; those not admitted are passed over."""
        if not self._admits(joystick, t):
            return
        if self._joystick is None or not self.fresh(t):
            self._rest = sticks
        self._joystick = joystick
        self._t = t
        self.now = sticks

    def fresh(self, t: float) -> bool:
        """Say whether the sticks are there, COM_RC_LOSS_T after the last word from them at most."""
        return (
            t - self._t <= self._parameters["COM_RC_LOSS_T"] and self._parameters["COM_RC_IN_MODE"] <= _FIRST
        )

    def rest(self) -> None:
        """Count movement from where the sticks are now."""
        self._rest = self.now

    @property
    def moved(self) -> bool:
        """A stick is COM_RC_STICK_OV percent away from where it rested."""
        far = max(abs(now - rest) for now, rest in zip(self.now, self._rest, strict=True))
        return 100.0 * far > self._parameters["COM_RC_STICK_OV"]

    def _admits(self, joystick: bool, t: float) -> bool:
        mode = self._parameters["COM_RC_IN_MODE"]
        if mode in (_RADIO, _JOYSTICK):
            return joystick == (mode == _JOYSTICK)
        if mode > _FIRST:
            return False
        same = self._joystick is None or joystick == self._joystick
        return same or (mode == _FALLBACK and not self.fresh(t))


class ByHand:
    """Flies by the sticks: they ask for velocities on the heading's axes; let go, the vehicle stops and stays.

    Velocities asked for change with MPC_ACC_HOR; speeds are MPC_VEL_MANUAL, MPC_Z_VEL_MAX_UP, MPC_Z_VEL_MAX_DN and
    MPC_MAN_Y_MAX at most, reached along the curves MPC_XY_MAN_EXPO, MPC_Z_MAN_EXPO, MPC_YAW_EXPO.

    Args:
        flight: The vehicle.
    """

    def __init__(self, flight: Flight) -> None:
        self._flight = flight
        self._asked: Vector3 = ZERO3
        self.sticks = CENTRED

    def begin(self) -> None:
        """Begin from here."""
        flight = self._flight
        flight.hold()
        c, s = cos(flight.p[3]), sin(flight.p[3])
        forward, left, up, _ = flight.v
        self._asked = (c * forward - s * left, s * forward + c * left, up)

    def position(self, dt: float) -> Vector4:
        """Return the reference in Position mode."""
        if not self._aim(dt):
            return ZERO4
        flight = self._flight
        return flight.guidance.track(flight.p, flight.v, flight.target, dt, flight.guidance.manual)

    def altitude(self, dt: float) -> Vector4:
        """Return the reference in Altitude mode: height is held, the horizontal velocity is not corrected."""
        if not self._aim(dt):
            return ZERO4
        flight = self._flight
        guidance, target = flight.guidance, flight.target
        forward, left, _, turn = guidance.velocity(flight.p, self._asked, target, guidance.manual)
        up = guidance.track(flight.p, flight.v, target, dt, guidance.manual)[2]
        return forward, left, up, turn

    def _aim(self, dt: float) -> bool:
        """Set the target by the sticks; False while the vehicle stands and is not asked to rise."""
        flight, get = self._flight, self._flight.parameters
        dead = get["MPC_HOLD_DZ"]
        forward, left, up, turn = self.sticks
        up = shaped(up, dead, get["MPC_Z_MAN_EXPO"])
        if flight.landed and up <= 0.0:
            flight.hold()
            self._asked = ZERO3
            return False
        fastest = flight.guidance.manual
        size = hypot(forward, left)
        pace = fastest.horizontal * shaped(min(size, 1.0), dead, get["MPC_XY_MAN_EXPO"]) / (size or 1.0)
        c, s = cos(flight.p[3]), sin(flight.p[3])
        self._asked = _toward(
            self._asked,
            (
                pace * (c * forward - s * left),
                pace * (s * forward + c * left),
                up * (fastest.up if up > 0.0 else fastest.down),
            ),
            get["MPC_ACC_HOR"] * dt,
            _VERTICAL_ACCELERATION * dt,
        )
        rate = fastest.turn * shaped(turn, dead, get["MPC_YAW_EXPO"])
        self._lock(rate)
        return True

    def _lock(self, yaw_rate: float) -> None:
        """Free the axes that are moved; lock those let go where the vehicle comes to rest."""
        flight = self._flight
        x, y, z = flight.target.position
        vx, vy, vz = self._asked
        if hypot(vx, vy) > _STILL:
            x = y = None
        elif x is None or y is None:
            ahead_x, ahead_y = flight.ahead()
            x, y = flight.p[0] + ahead_x, flight.p[1] + ahead_y
        if abs(vz) > _STILL:
            z = None
        elif z is None:
            z = flight.p[2]
        yaw = flight.target.yaw
        if yaw_rate != 0.0:
            yaw = None
        elif yaw is None:
            yaw = flight.p[3]
        flight.target = Target((x, y, z), self._asked, yaw, yaw_rate)


def shaped(stick: float, dead: float, expo: float) -> float:
    """Return a stick's effect: nothing within the dead zone, then (1 − e) s + e s³, ±1 at the ends."""
    size = abs(stick)
    if size <= dead:
        return 0.0
    s = (size - dead) / (1.0 - dead)
    s = (1.0 - expo) * s + expo * s * s * s
    return s if stick > 0.0 else -s


def _toward(now: Vector3, wanted: Vector3, step: float, step_z: float) -> Vector3:
    """Move a velocity toward another by at most `step` horizontally (norm) and `step_z` vertically."""
    dx, dy, dz = wanted[0] - now[0], wanted[1] - now[1], wanted[2] - now[2]
    size = hypot(dx, dy)
    share = 1.0 if size <= step else step / size
    return now[0] + share * dx, now[1] + share * dy, now[2] + max(-step_z, min(step_z, dz))
