"""Wave variables: the port is the near end of a transmission line of impedance b.

With F = −f the hand's force on the device and v the handle's velocity, the wave u = (b v + F)/√(2b) goes out,
w = (b v − F)/√(2b) comes back, and the hand's power is F·v = ½ (u² − w²) (Niemeyer and Slotine 2004, Telemanipulation
with time delays). So the device renders f = √(2b) w − b v: what the returning wave carries, and the line's damping.
The line is matched at its far end: √(2b) w is the force wanted, and nothing rings.

The far end is the vehicle, which has its own power, but none for the hand: what comes back beyond what goes out,
½ (w² − u²), is energy that left at least a round trip before. Where there is not enough, the returning wave is
weakened as a whole, so that f goes towards −b v, the matched impedance. The energy is counted as f·Δx, which is
½ (w² − u²) dt without the error of a finite tick.
"""

from __future__ import annotations

from math import isfinite, sqrt

from drivers.device import ZERO3, Vector3
from groundstation.pilot.passivity.bounds import STILL, affordable, covered, no_longer
from groundstation.pilot.passivity.line import carried, exchanged
from groundstation.pilot.passivity.port import CREDIT, RESERVE, STORE, Port, booked, held, with_line, work
from groundstation.pilot.passivity.scheme import Passivity


class Wave(Passivity):
    """The near end of the line.

    Args:
        impedance: b, N·s/m: the damping that is felt, so no more than the device renders passively.
    """

    def __init__(self, impedance: float) -> None:
        self._impedance = impedance

    def observed(self, port: Port, position: Vector3) -> Port:
        """Return the port and its line after the handle has moved to `position`, m; see `Passivity.observed`."""
        given = work(port, position)
        if not isfinite(given):
            return port
        port = booked(port, position, given)
        return with_line(port, exchanged(port.line, -given))

    def rendered(self, port: Port, wanted: Vector3, velocity: Vector3, dt: float, delay: float) -> Port:
        """Return the port with the force of the wave that comes back; see `Passivity.rendered`."""
        u, v, w = velocity
        speed = sqrt(u * u + v * v + w * w)
        line = carried(port.line, dt, delay, STORE)
        port = with_line(port, line)
        if not isfinite(speed):
            return held(port, ZERO3, wanted, velocity, dt)
        budget = CREDIT + min(port.energy, line.returned + line.packet)
        force = wanted if speed <= STILL else self._returning(budget, wanted, velocity, speed, dt)
        return held(port, covered(force, velocity, dt + port.unseen, budget), wanted, velocity, dt)

    def _returning(
        self, budget: float, wanted: Vector3, velocity: Vector3, speed: float, dt: float
    ) -> Vector3:
        """Return f = s √(2b) w − b v with the largest s ≤ 1 that the budget, J, affords.

        A force that brakes is damped no further than to what the line's damping alone would be.
        """
        (x, y, z), (u, v, w) = wanted, velocity
        along = (x * u + y * v + z * w) / speed
        most = self._impedance * speed
        share = 1.0
        if along > 0.0:
            allowed = max(0.0, affordable(budget - RESERVE, speed, dt) + most)
            share = min(1.0, allowed / along)
        damping = min(most, max(0.0, share * along + most)) / speed
        force = (share * x - damping * u, share * y - damping * v, share * z - damping * w)
        return no_longer(force, wanted, most)
