"""What a way of keeping the port's account is: two pure functions around a tick."""

from __future__ import annotations

from abc import abstractmethod
from typing import Protocol

from drivers.device import Vector3
from groundstation.pilot.passivity.port import Port, booked, work


class Passivity(Protocol):
    """What keeps the hand from being given more energy than it gave. All its memory is the port."""

    def observed(self, port: Port, position: Vector3) -> Port:
        """Return the port at the start of a tick, after the handle has moved to `position`, m.

        Where the work would not be finite, the port stays as it is.
        """
        return booked(port, position, work(port, position))

    @abstractmethod
    def rendered(self, port: Port, wanted: Vector3, velocity: Vector3, dt: float, delay: float) -> Port:
        """Return the port at the end of a tick, with the force to hold, nearest to the one wanted.

        Args:
            port: As observed at this tick.
            wanted: Force, N, handle frame, finite.
            velocity: Of the handle, m/s; where it is not finite nothing is rendered.
            dt: Until the next tick, s.
            delay: Measured round trip, s; NaN while it is not known.
        """
        ...
