"""What others see of a rigid body's state: the vectors of four, its tilt, and what its accelerometer measures."""

from __future__ import annotations

from math import asin, atan2, cos, sin, sqrt

from sim.kinematics import Vector3, Vector4
from sim.models.motion import GRAVITY
from sim.models.rigid.dynamics import Body, Rotors, State, derivative, pulls

# Where the nose points straight up or down there is no heading; its rate stays finite there.
_LEAST_LEVEL = 1e-6


def shadow(state: State) -> tuple[Vector4, Vector4]:
    """Return p and v: yaw is the heading of the body's forward axis, and v is on that heading's level axes."""
    px, py, pz, vx, vy, vz, w, x, y, z, _p, q, r = state[:13]
    fx, fy = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
    level = max(fx * fx + fy * fy, _LEAST_LEVEL)
    scale = 1.0 / sqrt(level)
    c, s = fx * scale, fy * scale
    heading_rate = (q * 2.0 * (y * z + w * x) + r * (1.0 - 2.0 * (x * x + y * y))) / level
    return (px, py, pz, atan2(fy, fx)), (c * vx + s * vy, c * vy - s * vx, vz, heading_rate)


def taken(state: State, p: Vector4, v: Vector4, turn: float, spin: float) -> State:
    """Return the state of a body that something else has put to p, as fast as v; its tilt and the rest are its own.

    Args:
        state: Before.
        p: Where it is now.
        v: Its velocities now.
        turn: How much its heading has changed by that, rad.
        spin: How much its heading's rate has changed, a rate about the world's up, rad/s.
    """
    _px, _py, _pz, _vx, _vy, _vz, w, x, y, z, p_rate, q_rate, r_rate, n1, n2, n3, n4 = state
    c, s = cos(0.5 * turn), sin(0.5 * turn)
    w, x, y, z = c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w
    c, s = cos(p[3]), sin(p[3])
    return (
        p[0], p[1], p[2],
        c * v[0] - s * v[1], s * v[0] + c * v[1], v[2],
        w, x, y, z,
        p_rate + spin * 2.0 * (x * z - w * y),
        q_rate + spin * 2.0 * (y * z + w * x),
        r_rate + spin * (1.0 - 2.0 * (x * x + y * y)),
        n1, n2, n3, n4,
    )  # fmt: skip


class Posture:
    """How the rigid body leans, told by its state when asked for.

    Args:
        body: Constants.
    """

    def __init__(self, body: Body) -> None:
        self._body = body
        self.resting = False
        self._quaternion: Vector4 = (1.0, 0.0, 0.0, 0.0)
        self._force: Vector3 | None = (0.0, 0.0, GRAVITY)
        self.roll_rate = self.pitch_rate = 0.0

    def rest(self) -> None:
        """Stand level; what carries the vehicle holds against gravity."""
        self.resting = True
        self._quaternion, self._force = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, GRAVITY)
        self.roll_rate = self.pitch_rate = 0.0

    def follow(self, state: State, wind: Vector3, rotors: Rotors) -> None:
        """Lean as a state does in this wind."""
        self.resting = False
        self._state, self._wind, self._rotors = state, wind, rotors
        self._quaternion = state[6:10]
        self._force = None
        self.roll_rate, self.pitch_rate = state[10], state[11]

    @property
    def roll(self) -> float:
        """About forward, rad."""
        w, x, y, z = self._quaternion
        return atan2(2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))

    @property
    def pitch(self) -> float:
        """About left, rad; positive is nose down (FLU)."""
        w, x, y, z = self._quaternion
        return asin(max(-1.0, min(1.0, 2.0 * (w * y - x * z))))

    def specific_force(self) -> Vector3:
        """Return what an ideal accelerometer measures: a + g ẑ on the body's axes (FLU), m/s²."""
        if self._force is None:
            self._force = self._felt()
        return self._force

    def onto_axes(self, vector: Vector3) -> Vector3:
        """Turn a vector on the heading's level axes onto the body's (both FLU)."""
        w, x, y, z = self._quaternion
        fx, fy = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
        scale = 1.0 / sqrt(max(fx * fx + fy * fy, _LEAST_LEVEL))
        c, s = fx * scale, fy * scale
        forward, left, up = vector
        return _onto_body((c * forward - s * left, s * forward + c * left, up), self._quaternion)

    def _felt(self) -> Vector3:
        _px, _py, height, vx, vy, vz, w, x, y, z, p, q, r, n1, n2, n3, n4 = self._state
        wx, wy, wz = self._wind
        moving = (vx - wx, vy - wy, vz - wz, w, x, y, z, p, q, r)
        rates = derivative(height, moving, pulls((n1, n2, n3, n4), self._rotors), self._body)
        return _onto_body((rates[0], rates[1], rates[2] + GRAVITY), self._quaternion)


def _onto_body(vector: Vector3, quaternion: Vector4) -> Vector3:
    a, b, c = vector
    w, x, y, z = quaternion
    return (
        a * (1.0 - 2.0 * (y * y + z * z)) + b * 2.0 * (x * y + w * z) + c * 2.0 * (x * z - w * y),
        a * 2.0 * (x * y - w * z) + b * (1.0 - 2.0 * (x * x + z * z)) + c * 2.0 * (y * z + w * x),
        a * 2.0 * (x * z + w * y) + b * 2.0 * (y * z - w * x) + c * (1.0 - 2.0 * (x * x + y * y)),
    )
