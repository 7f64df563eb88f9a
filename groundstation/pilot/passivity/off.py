"""No passivity: every force as it is wanted, to see what happens without, and where no force is rendered anyway."""

from __future__ import annotations

from drivers.device import Vector3
from groundstation.pilot.passivity.port import Port, held
from groundstation.pilot.passivity.scheme import Passivity


class Off(Passivity):
    """Only the account is kept."""

    def rendered(self, port: Port, wanted: Vector3, velocity: Vector3, dt: float, delay: float) -> Port:  # noqa: ARG002 - any motion
        """Return the port with the force wanted; see `Passivity.rendered`."""
        return held(port, wanted, wanted, velocity, dt)
