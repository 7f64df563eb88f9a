"""What it is meant to fly, v_c of equation (4) after guard and limits, and what it flies, on the vehicle's axes."""

from __future__ import annotations

import math

from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, bar, quantity
from groundstation.tui.theme import Tone
from groundstation.tui.track import meant_velocity, velocity_on_vehicle
from groundstation.tui.widgets.instrument import Instrument

_AXES = (("fwd", "m/s"), ("left", "m/s"), ("up", "m/s"), ("yaw", "°/s"))


class Velocity(Instrument):
    """A bar for what is flown, a line for what is meant."""

    BORDER_TITLE = "velocity  ┃ v_c  █ flown"
    EVERY = 3
    STALE_S = 0.5

    def data_age(self, frame: Frame) -> float:
        """Age of the vehicle's state."""
        return frame.age(frame.snapshot.vehicle)

    def footnote(self, frame: Frame) -> str:
        """Say that the setpoint is more than v_c, so that the vehicle has it."""
        return "response compensated" if frame.pilot is not None and frame.pilot.compensated else ""

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw a row an axis."""
        vehicle = frame.snapshot.vehicle
        flown = velocity_on_vehicle(vehicle) if vehicle else (math.nan,) * 4
        asked = meant_velocity(frame.snapshot, frame.run.settings.safety.setpoint_stale_s)
        limits = frame.run.settings.limits
        ranges = (limits.horizontal_speed, limits.horizontal_speed, limits.vertical_speed, limits.yaw_rate)
        rows: list[Row] = []
        for index, (axis, unit) in enumerate(_AXES):
            factor = math.degrees(1.0) if axis == "yaw" else 1.0
            decimals = 0 if axis == "yaw" else 2
            rows.append(
                [
                    (f" {axis:<5}", Tone.MUTED),
                    (quantity(factor * asked[index], unit, decimals, 6, sign=True), Tone.HAND),
                    (quantity(factor * flown[index], unit, decimals, 7, sign=True), Tone.VEHICLE),
                    ("  ", Tone.TEXT),
                    *bar(flown[index], ranges[index], max(width - 30, 7), Tone.VEHICLE, mark=asked[index]),
                ]
            )
        return rows[:height]
