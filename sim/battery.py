"""The battery: it drains with time, and its voltage tells how far."""

from __future__ import annotations

# A cell's voltage empty and charged, as PX4 takes it (BAT1_V_EMPTY, BAT1_V_CHARGED), and its drop under load.
CELL_EMPTY, CELL_CHARGED, CELL_LOAD_DROP = 3.6, 4.05, 0.1
IDLE_SHARE = 0.05


class Battery:
    """A battery that hovers the vehicle for so long.

    Args:
        endurance_s: Hovering time from full, s.
        cells: Cells in series.
    """

    def __init__(self, endurance_s: float, cells: int) -> None:
        self._endurance = endurance_s
        self.cells = cells
        self.remaining = 1.0
        self._loaded = False

    def drain(self, dt: float, *, flying: bool) -> None:
        """Use `dt` seconds: in flight what hovering takes, else a small share of it for the electronics."""
        self._loaded = flying
        used = dt / self._endurance * (1.0 if flying else IDLE_SHARE)
        self.remaining = max(0.0, self.remaining - used)

    @property
    def cell_voltage(self) -> float:
        """V, linear in what remains, and lower under load."""
        open_circuit = CELL_EMPTY + (CELL_CHARGED - CELL_EMPTY) * self.remaining
        return open_circuit - (CELL_LOAD_DROP if self._loaded else 0.0)
