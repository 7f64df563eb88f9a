"""No net energy for the hand: time-domain passivity at the haptic port, and the bounds of a sampled spring.

The port is where force meets motion: between two ticks the device holds a force f while the handle moves by Δx, so
the hand is given exactly f·Δx, whatever the model, the delay or the losses behind the force are. The observer keeps
the account; the controller takes from the force, along the motion, what the account does not cover (Hannaford and
Ryu 2002, Time-domain passivity control of haptic interfaces). A hand at rest feels the whole force.

A spring of stiffness K with a damper B, sampled every T, is passive on a device of physical damping b only while
b > K T/2 + |B| (Colgate and Schenkel 1997, Passivity of a class of sampled-data systems).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from drivers.device import ZERO3, DeviceInfo, Vector3
from drivers.vectors import within
from groundstation.config import Settings

# What the hand may be given on credit, J: too little to feel, enough for a force to begin from rest.
CREDIT = 9e-4
# Of that, what the motion that is seen may use; the rest is for motion that is not seen yet, because hand or handle
# accelerate within the tick: by no more than this, m/s² (a force of 10 N on 0.1 kg).
_SEEN = 4e-4
_ACCELERATION = 100.0
# What the account holds at most, J. What a hand gave long ago must not come back at once.
STORE = 0.2
_STILL = 1e-9


class Port(NamedTuple):
    """The account of the haptic port.

    Attributes:
        energy: What the hand has given and not been given back, J; at most `STORE`.
        position: Of the handle at the last tick, m.
        force: Held on the hand since, N.
        dissipated: What the controller has taken out so far, J.
    """

    energy: float = 0.0
    position: Vector3 = ZERO3
    force: Vector3 = ZERO3
    dissipated: float = 0.0


def observed(port: Port, position: Vector3) -> Port:
    """Return the account after the handle has moved to `position`, m, under the force held since the last tick."""
    (x, y, z), (a, b, c), (u, v, w) = position, port.position, port.force
    given = u * (x - a) + v * (y - b) + w * (z - c)
    return port._replace(energy=min(port.energy - given, STORE), position=position)


def passive(port: Port, wanted: Vector3, velocity: Vector3, dt: float, damping_limit: float) -> Port:
    """Return the account with the force that it covers, nearest to the one wanted.

    The part along the motion is brought down to what the next tick may give, and, where the account is overdrawn, on
    to damping, as strong as the device renders it. As the credit runs out, so does the force across the motion.

    Args:
        port: As observed at this tick.
        wanted: Force, N, handle frame.
        velocity: Of the handle, m/s.
        dt: Until the next tick, s.
        damping_limit: Largest damping, N·s/m.
    """
    force = _along_covered(port.energy, wanted, velocity, dt, damping_limit)
    force = within(force, max(0.0, port.energy + CREDIT) / (0.5 * _ACCELERATION * dt * dt))
    if force is wanted:
        return port._replace(force=wanted)
    (x, y, z), (a, b, c), (u, v, w) = wanted, force, velocity
    taken = ((x - a) * u + (y - b) * v + (z - c) * w) * dt
    return port._replace(force=force, dissipated=port.dissipated + max(0.0, taken))


def _along_covered(
    energy: float, wanted: Vector3, velocity: Vector3, dt: float, damping_limit: float
) -> Vector3:
    u, v, w = velocity
    speed = sqrt(u * u + v * v + w * w)
    if speed < _STILL:
        return wanted
    x, y, z = wanted
    along = (x * u + y * v + z * w) / speed
    covered = (energy + _SEEN) / (speed * dt)
    allowed = max(covered, -damping_limit * speed)
    if along <= allowed:
        return wanted
    less = (along - allowed) / speed
    return x - less * u, y - less * v, z - less * w


class Gains(NamedTuple):
    """Gains a device renders passively: stiffness of equation (5), N/m of position error, and damping, N·s/m."""

    stiffness: Vector3
    damping: float


def passive_gains(settings: Settings, device: DeviceInfo) -> Gains:
    """Return the gains as set, or less where the device does not render so much passively at its rate.

    In rate control a displacement Δx of the handle moves p_h by Δx · speed/workspace · T within a tick: a spring of
    k · speed/workspace · T at the handle. The spring has precedence over the damper. A force that is only drawn, or
    rumbled, needs no bound.
    """
    control, speed = settings.control, settings.mapping.speed
    if device.renders != "force":
        return Gains(control.stiffness, control.damping)
    felt = max(
        k * rate / (device.workspace * device.rate) for k, rate in zip(control.stiffness, speed, strict=False)
    )
    share = min(1.0, largest_stiffness(device, device.rate, 0.0) / felt)
    x, y, z = control.stiffness
    damping = min(control.damping, largest_damping(device, device.rate, share * felt))
    return Gains((share * x, share * y, share * z), damping)


def physical_damping(device: DeviceInfo) -> float:
    """Return b, N·s/m, for which the device's stiffness limit holds at its rate: b = K T/2."""
    return 0.5 * device.stiffness_limit / device.rate


def largest_stiffness(device: DeviceInfo, rate: float, damping: float) -> float:
    """Return the largest K, N/m, that is passive at a servo rate, Hz, beside a damper `damping`, N·s/m; 0 if none."""
    return max(0.0, 2.0 * rate * (physical_damping(device) - abs(damping)))


def largest_damping(device: DeviceInfo, rate: float, stiffness: float) -> float:
    """Return the largest |B|, N·s/m, that is passive at a servo rate, Hz, beside a spring, N/m; 0 if none."""
    return max(0.0, physical_damping(device) - 0.5 * stiffness / rate)
