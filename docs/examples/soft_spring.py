"""A controller of one's own: the hand's velocity, and a spring that grows softer, on a page.

    groundstation --sim --controller docs.examples.soft_spring:SoftSpring

It follows where equation (4) does, by a saturating pull of its own on the predicted error, so that a delay is not
felt as an error, and its force saturates as the pull does. Guard, limits, cues and passivity stay around it.
"""

from __future__ import annotations

from math import hypot
from typing import NamedTuple

from groundstation.config import Settings
from groundstation.frames import Vector3, wrap
from groundstation.pilot.controller import Law, View, vehicle_rates


class Learnt(NamedTuple):
    """What it keeps from tick to tick: the steady error that wind leaves, world, m."""

    steady: Vector3 = (0.0, 0.0, 0.0)


class SoftSpring:
    """Pulls with at most `k1`, and learns away what wind leaves of the error.

    Args:
        settings: All of them; a controller of one's own is called with these.
    """

    def __init__(self, settings: Settings) -> None:
        self._softest = settings.mapping.leash

    def start(self) -> Learnt:
        """Begin with nothing learnt."""
        return Learnt()

    def step(self, state: Learnt, view: View) -> tuple[Learnt, Law]:
        """Return ṗ_h and a pull on the error where the drone will be, and the force of the error that is seen."""
        error = [wanted - will_be for wanted, will_be in zip(view.p_h, view.predicted, strict=True)]
        reach = hypot(*error[:3]) + self._softest
        share = min(1.0, 0.2 * view.dt)
        x, y, z = (old + share * now for old, now in zip(state.steady, error, strict=False))
        pulls = [
            k1 * (now + learnt) / reach for k1, now, learnt in zip(view.k1, error, (x, y, z), strict=False)
        ]
        turn = view.k1[3] * wrap(error[3])
        rates = (*(a + b for a, b in zip(view.p_h_rate, pulls, strict=False)), view.p_h_rate[3] + turn)
        u, v, w = (-k * e / reach for k, e in zip(view.stiffness, view.error, strict=False))
        return Learnt((x, y, z)), Law(vehicle_rates(rates, view.p[3]), (u, v, w))
