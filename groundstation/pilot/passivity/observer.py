"""Time-domain passivity: what the port's account does not cover is taken out of the force along the motion.

Observer and controller after Hannaford and Ryu 2002, Time-domain passivity control of haptic interfaces. A hand at
rest feels the whole force; one that is pushed along without having given anything feels it fade while it moves.
"""

from __future__ import annotations

from math import isfinite, sqrt

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.bounds import STILL, affordable, covered, lowered, no_longer
from groundstation.pilot.passivity.port import CREDIT, RESERVE, Port, held
from groundstation.pilot.passivity.scheme import Passivity


class Observer(Passivity):
    """Passivity observer and controller.

    Args:
        damping_limit: Largest damping it adds, N·s/m.
    """

    def __init__(self, damping_limit: float) -> None:
        self._damping_limit = damping_limit

    def rendered(self, port: Port, wanted: Vector3, velocity: Vector3, dt: float, delay: float) -> Port:  # noqa: ARG002 - any delay
        """Return the port with the force that its account covers; see `Passivity.rendered`.

        The part along the motion is brought down to what the next tick may give, and, where the account is
        overdrawn, on to damping, as strong as the device renders it; the whole is then no longer than the one
        wanted or the damping. As the credit runs out, so does the force across the motion.
        """
        u, v, w = velocity
        speed = sqrt(u * u + v * v + w * w)
        if not isfinite(speed):
            return held(port, ZERO3, wanted, velocity, dt)
        budget = port.energy + CREDIT
        force = wanted
        if speed > STILL:
            most = self._damping_limit * speed
            allowed = max(affordable(budget - RESERVE, speed, dt), -most)
            force = no_longer(lowered(wanted, velocity, speed, allowed), wanted, most)
        return held(port, covered(force, velocity, dt + port.unseen, budget), wanted, velocity, dt)
