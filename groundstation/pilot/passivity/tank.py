"""A two-layer energy tank: above it the force wanted, below it a tank that the hand's work fills and a push drains.

Franken, Stramigioli, Misra, Secchi and Macchelli 2011, Bilateral telemanipulation with time delays: a two-layer
approach combining passivity and transparency. The upper layer is the force wanted. The lower one keeps the tank's
level H: while that is low, the hand is damped by α (H_d − H), which fills it, and no force is held that could draw
more than there is. The vehicle at the other end has its own power, so there is one tank only, at the hand.
"""

from __future__ import annotations

from math import isfinite, sqrt

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.bounds import STILL, affordable, covered, lowered, no_longer
from groundstation.pilot.passivity.port import CREDIT, RESERVE, Port, held
from groundstation.pilot.passivity.scheme import Passivity

# H_d, J: a push of 4 N over half a centimetre.
DESIRED = 0.02


def level(port: Port) -> float:
    """Return H, J: what the account holds and the credit, or nothing where that is overdrawn."""
    return max(0.0, port.energy + CREDIT)


class Tank(Passivity):
    """The lower layer.

    Args:
        damping_limit: Largest damping it adds, N·s/m: that of an empty tank, so α is this over H_d.
    """

    def __init__(self, damping_limit: float) -> None:
        self._damping_limit = damping_limit

    def rendered(self, port: Port, wanted: Vector3, velocity: Vector3, dt: float, delay: float) -> Port:  # noqa: ARG002 - any delay
        """Return the port with the force that the tank covers; see `Passivity.rendered`."""
        u, v, w = velocity
        speed = sqrt(u * u + v * v + w * w)
        if not isfinite(speed):
            return held(port, ZERO3, wanted, velocity, dt)
        tank = level(port)
        force = wanted if speed <= STILL else self._damped(tank, wanted, velocity, speed, dt)
        return held(port, covered(force, velocity, dt + port.unseen, tank), wanted, velocity, dt)

    def _damped(self, tank: float, wanted: Vector3, velocity: Vector3, speed: float, dt: float) -> Vector3:
        """Return the force wanted, less the damping that fills the tank, and no more than there is for the motion."""
        (x, y, z), (u, v, w) = wanted, velocity
        most = self._damping_limit * speed
        filling = most * max(0.0, 1.0 - tank / DESIRED)
        along = (x * u + y * v + z * w) / speed - filling
        allowed = max(-most, min(along, affordable(tank - RESERVE, speed, dt)))
        return no_longer(lowered(wanted, velocity, speed, allowed), wanted, most)
