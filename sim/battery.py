"""The battery: it drains with the power that flying takes, and its voltage tells how far."""

from __future__ import annotations

from sim.scenario import Charge

# A cell's voltage empty and charged, as PX4 takes it (BAT1_V_EMPTY, BAT1_V_CHARGED), and its drop while hovering.
CELL_EMPTY, CELL_CHARGED, CELL_LOAD_DROP = 3.6, 4.05, 0.1
# Power of the electronics, as a share of that of hovering.
IDLE_SHARE = 0.05
# Usual rotors lift no more than twice the weight.
_MOST_THRUST = 2.0
# What a failed battery tells: less than any threshold of a failsafe, more than nothing.
_FAILED = 0.03


class Battery:
    """A battery that hovers the vehicle for so long.

    Args:
        endurance_s: Hovering time from full, s.
        cells: Cells in series.
        charge: How full it is at the start, and how fast it drains.

    Attributes:
        failed: It tells that it is nearly empty, whatever is in it.
    """

    def __init__(self, endurance_s: float, cells: int, charge: Charge) -> None:
        self._use = charge.drain / endurance_s
        self.cells = cells
        self.failed = False
        self._left = charge.remaining
        self._load = 0.0

    @property
    def remaining(self) -> float:
        """What is left, 0 to 1."""
        return min(self._left, _FAILED) if self.failed else self._left

    @remaining.setter
    def remaining(self, share: float) -> None:
        self._left = share

    def drain(self, thrust: float, dt: float) -> None:
        """Use `dt` seconds of power.

        A rotor's power grows with its thrust to the power of 3/2, by momentum theory (Leishman 2006, Principles of
        helicopter aerodynamics, section 2.3).

        Args:
            thrust: As a share of the weight; 0 while the motors stand.
            dt: s.
        """
        self._load = min(thrust, _MOST_THRUST) ** 1.5
        self._left = max(0.0, self._left - self._use * max(self._load, IDLE_SHARE) * dt)

    @property
    def cell_voltage(self) -> float:
        """V, linear in what remains, and lower under load."""
        return CELL_EMPTY + (CELL_CHARGED - CELL_EMPTY) * self.remaining - CELL_LOAD_DROP * self._load
