"""The haptic port, where force meets motion: what the hand has given and been given is f·Δx, exactly.

Between two ticks the device holds a force f while the handle moves by Δx, so the hand is given f·Δx, whatever the
model, the delay or the losses behind the force are. The account is kept in every mode, "off" too.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import NamedTuple

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.line import Line

# What the hand may be given on credit, J: too little to feel, enough for a force to begin from rest.
CREDIT = 9e-4
# Of the credit, what motion that is seen leaves for motion that is not seen yet, J.
RESERVE = 5e-4
# What the account holds at most, J. What a hand gave long ago must not come back at once.
STORE = 0.2


class Port(NamedTuple):
    """The account of the haptic port.

    Attributes:
        energy: What the hand has given and not been given back, J; at most `STORE`.
        position: Of the handle at the last tick, m.
        force: Held on the hand since, N.
        dissipated: What has been taken out of the force so far to keep the account, J.
        line: Where the energy is that wave variables sent.
        sampled: When the handle's newest sample was taken, s, as the device tells it.
        unseen: Since that sample was new, s: the handle has moved on since, nobody knows where to.
    """

    energy: float = 0.0
    position: Vector3 = ZERO3
    force: Vector3 = ZERO3
    dissipated: float = 0.0
    line: Line = Line()
    sampled: float = 0.0
    unseen: float = 0.0


def work(port: Port, position: Vector3) -> float:
    """Return what the hand was given, J, by the force held while the handle moved to `position`, m: f·Δx."""
    (x, y, z), (a, b, c), (u, v, w) = position, port.position, port.force
    return u * (x - a) + v * (y - b) + w * (z - c)


def booked(port: Port, position: Vector3, given: float) -> Port:
    """Return the port with the handle at `position`, m, and the work on its account; as it is if not finite."""
    if not isfinite(given):
        return port
    energy, _, force, dissipated, line, sampled, unseen = port
    return Port(min(energy - given, STORE), position, force, dissipated, line, sampled, unseen)


def looked(port: Port, sampled: float, dt: float) -> Port:
    """Return the port with how long the handle has not been seen, after a tick.

    Args:
        port: Of the tick before.
        sampled: When the handle's newest sample was taken, s; the same as before where none has come since.
        dt: Since the last tick, s.
    """
    energy, position, force, dissipated, line, before, unseen = port
    unseen = unseen + dt if sampled == before else 0.0
    return Port(energy, position, force, dissipated, line, sampled, unseen)


def with_line(port: Port, line: Line) -> Port:
    """Return the port with another line."""
    energy, position, force, dissipated, _, sampled, unseen = port
    return Port(energy, position, force, dissipated, line, sampled, unseen)


def held(port: Port, force: Vector3, wanted: Vector3, velocity: Vector3, dt: float) -> Port:
    """Return the port with the force to hold until the next tick, and what it gives less than the one wanted."""
    energy, position, _, dissipated, line, sampled, unseen = port
    if force is not wanted:
        (x, y, z), (a, b, c), (u, v, w) = wanted, force, velocity
        taken = ((x - a) * u + (y - b) * v + (z - c) * w) * dt
        if 0.0 < taken < inf:
            dissipated += taken
    return Port(energy, position, force, dissipated, line, sampled, unseen)
