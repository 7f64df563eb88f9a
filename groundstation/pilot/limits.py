"""What no setpoint and no force exceeds: speed, acceleration and jerk of the setpoint; slew of the force.

The horizontal plane is limited as a whole, by length: forward + i·left is one complex number, so that a limit
shortens a vector and keeps its direction, and the same lines serve the single axes, whose numbers have no
imaginary part.
"""

from __future__ import annotations

from math import cos, isfinite, sin
from typing import NamedTuple

import msgspec

from groundstation import config
from groundstation.frames import Vector3, Vector4

# Closer than this to the target nothing is worth a push, m/s or rad/s.
_THERE = 1e-12
_NONE = float("inf")


class Bounds(NamedTuple):
    """Largest speed, acceleration and jerk, in m or rad and s."""

    speed: float
    acceleration: float
    jerk: float


class Motion(NamedTuple):
    """A velocity and its rate, along one axis (real) or in the plane (complex)."""

    velocity: complex = 0.0
    acceleration: complex = 0.0


class SetpointMotion(NamedTuple):
    """How the setpoint moves: forward + i·left, up, and yaw; m/s, rad/s and their rates."""

    plane: Motion = Motion()
    up: Motion = Motion()
    yaw: Motion = Motion()


def bounded(limits: config.Limits, vehicle: Vector3) -> config.Limits:
    """Return limits with speeds that are no larger than the vehicle's own.

    Args:
        limits: As set.
        vehicle: Its largest speeds around, up and down, m/s; what is not a positive number is not known. The smaller
            of up and down holds both ways.
    """
    around, up, down = (speed if speed > 0.0 else _NONE for speed in vehicle)
    horizontal = min(limits.horizontal_speed, around)
    vertical = min(limits.vertical_speed, up, down)
    if (horizontal, vertical) == (limits.horizontal_speed, limits.vertical_speed):
        return limits
    return msgspec.structs.replace(limits, horizontal_speed=horizontal, vertical_speed=vertical)


class SetpointLimiter:
    """Brings the setpoint to the commanded velocity as fast as the limits allow, and never past it.

    Args:
        limits: Speeds, accelerations, jerks.
    """

    def __init__(self, limits: config.Limits) -> None:
        self._plane = Bounds(limits.horizontal_speed, limits.acceleration, limits.jerk)
        self._up = Bounds(limits.vertical_speed, limits.acceleration, limits.jerk)
        self._yaw = Bounds(limits.yaw_rate, limits.yaw_acceleration, limits.yaw_jerk)

    def step(
        self, motion: SetpointMotion, v_ref: Vector4, dt: float, share: float = 1.0
    ) -> tuple[SetpointMotion, Vector4]:
        """Move the setpoint towards `v_ref` for `dt` s.

        Args:
            motion: Of the setpoint so far.
            v_ref: Commanded velocity on the vehicle's axes, m/s and rad/s.
            dt: s.
            share: Of the speeds that may be asked for, 0 to 1; what is faster slows down within the limits.

        Returns:
            The setpoint's motion, and its velocity on the vehicle's axes.

        Raises:
            ValueError: `v_ref` is not finite.
        """
        forward, left, up, yaw = v_ref
        if not isfinite(forward + left + up + yaw):
            raise ValueError(f"The velocity reference {v_ref} is not finite; nothing may follow it.")
        motion = SetpointMotion(
            approach(motion.plane, complex(forward, left), self._plane, dt, share),
            approach(motion.up, up, self._up, dt, share),
            approach(motion.yaw, yaw, self._yaw, dt, share),
        )
        plane = motion.plane.velocity
        return motion, (plane.real, plane.imag, motion.up.velocity.real, motion.yaw.velocity.real)

    @staticmethod
    def turned(motion: SetpointMotion, angle: float) -> SetpointMotion:
        """Return the same motion in space on the axes of a vehicle that has turned by an angle, rad."""
        velocity, acceleration = motion.plane
        if not (velocity or acceleration):
            return motion
        turn = complex(cos(angle), -sin(angle))
        return SetpointMotion(Motion(velocity * turn, acceleration * turn), motion.up, motion.yaw)

    def capped(self, v_ref: Vector4) -> Vector4:
        """Return a velocity shortened to the largest speeds; vehicle's axes, m/s and rad/s."""
        plane = _shortened(complex(v_ref[0], v_ref[1]), self._plane.speed)
        up, yaw = self._up.speed, self._yaw.speed
        return plane.real, plane.imag, max(-up, min(up, v_ref[2])), max(-yaw, min(yaw, v_ref[3]))


def approach(motion: Motion, target: complex, bounds: Bounds, dt: float, share: float = 1.0) -> Motion:
    """Move a velocity towards a target within bounds, for `dt` s.

    Braking now, at full jerk, would take the velocity v with its acceleration a to `reach` = v + a|a|/2j. The
    rule: push from there towards the target, but only as far as `reach` neither passes it, nor moves away
    from it, nor leaves the allowed speeds; else brake. Braking leaves `reach` where it is, so it is always
    open, and what was within bounds stays so. The last push is weighed: it meets the target, never passes.

    Args:
        motion: Velocity and acceleration now, within bounds.
        target: Commanded velocity; shortened to `share` of the largest speed.
        bounds: Largest speed, acceleration, jerk.
        dt: s.
        share: 0 to 1.
    """
    (v, a), (top, most, jerk) = motion, bounds
    size, allowed = abs(target), top * share
    if size > allowed:
        target *= allowed / size
    if v == target and not a:
        return motion
    brake = 0.5 / jerk
    gap = target - v - a * (abs(a) * brake)
    distance = abs(gap)
    if distance < _THERE:
        return Motion(*_braked(v, a, jerk, dt))
    faster = a + gap * (jerk * dt / distance)
    size = abs(faster)
    if size > most:
        faster *= most / size
    after = v + (a + faster) * (0.5 * dt)
    reach = after + faster * (abs(faster) * brake)
    over = reach - target
    beyond = (over.real * gap.real + over.imag * gap.imag) / distance
    if beyond > 0.0:
        # `reach` grows faster than in proportion to the push, so this share of it never passes.
        rest, rest_a = _braked(v, a, jerk, dt)
        part = distance / (distance + beyond)
        after = rest + part * (after - rest)
        faster = rest_a + part * (faster - rest_a)
        reach = after + faster * (abs(faster) * brake)
    safe = abs(after) <= top and abs(reach) <= top and abs(target - reach) <= distance
    return Motion(after, faster) if safe else Motion(*_braked(v, a, jerk, dt))


def _braked(v: complex, a: complex, jerk: float, dt: float) -> tuple[complex, complex]:
    """Take the acceleration towards zero at full jerk; where it gets there within the tick, it stays."""
    size = abs(a)
    if size <= jerk * dt:
        return v + a * (size / (2.0 * jerk)), 0.0
    slower = a * (1.0 - jerk * dt / size)
    return v + (a + slower) * (0.5 * dt), slower


def _shortened(value: complex, length: float) -> complex:
    size = abs(value)
    return value if size <= length else value * (length / size)
