"""How far the vehicle is from the hand: the error p̃ = p_h − p on each axis, and the gain that closes it."""

from __future__ import annotations

import math

from groundstation.frames import heading_from_yaw
from groundstation.messages import PilotState
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, bar, quantity
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_AXES = ("east", "north", "up", "yaw")
_WITH_POSITIONS = 50


class Tracking(Instrument):
    """The error as bars against the leash; with room the hand's and the vehicle's position, and K₁ by axis."""

    BORDER_TITLE = "position error  p̃ = p_h − p"
    EVERY = 3
    STALE_S = 0.5

    def data_age(self, frame: Frame) -> float:
        """Age of the controller's record."""
        return frame.age(frame.snapshot.pilot)

    def footnote(self, frame: Frame) -> str:
        """Return the gain in effect, the phase margin it leaves, and for which delay."""
        pilot, width = frame.pilot, self.size.width
        if pilot is None or not all(map(math.isfinite, (pilot.k1[0], pilot.phase_margin, pilot.delay))):
            return ""
        margin = f"margin {quantity(math.degrees(pilot.phase_margin), '°', 0)}".replace(" °", "°")
        if width < _WITH_POSITIONS:
            return f"K₁ {_gain(pilot, frame.run.settings.control.k1[0])}, {margin}"
        return f"K₁ {_gain(pilot, frame.run.settings.control.k1[0])}, {margin} at {quantity(1000 * pilot.delay, 'ms', 0)} delay"

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw a row an axis."""
        pilot, vehicle = frame.snapshot.pilot, frame.snapshot.vehicle
        unknown = (math.nan,) * 4
        error = tuple(pilot.error) if pilot else unknown
        wanted = tuple(pilot.p_h) if pilot else unknown
        flown = tuple(vehicle.position) if vehicle else unknown
        mapping = frame.run.settings.mapping
        leashes = (mapping.leash, mapping.leash, mapping.leash, mapping.leash_yaw)
        rows: list[Row] = []
        positions = width >= _WITH_POSITIONS
        if positions and height > len(_AXES):
            rows.append([("          hand p_h  vehicle p     error", Tone.MUTED)])
        for index, axis in enumerate(_AXES):
            text = _angle(error[index]) if axis == "yaw" else quantity(error[index], "m", 2, 6, sign=True)
            row: Row = [(f" {axis:<6}", Tone.MUTED)]
            if positions:
                hand, place = wanted[index], flown[index]
                row += [
                    (f"{_place(hand, axis):>11}", Tone.HAND),
                    (f"{_place(place, axis):>11}", Tone.VEHICLE),
                ]
            row += [
                (f" {text}  ", Tone.STRONG),
                *bar(error[index], leashes[index], _bar_width(width, row), Tone.HAND),
            ]
            rows.append(row)
        return rows[:height]


def _bar_width(width: int, row: Row) -> int:
    return max(width - sum(len(text) for text, _ in row) - 12, 7)


def _place(value: float, axis: str) -> str:
    if axis != "yaw":
        return quantity(value, "m", 2, sign=True)
    return quantity(heading_from_yaw(value) if math.isfinite(value) else value, "°", 0).replace(" ", "") + " "


def _angle(value: float) -> str:
    return quantity(math.degrees(value), "°", 1, 6, sign=True)
