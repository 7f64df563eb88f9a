"""How far the vehicle is from the hand: the error p̃ = p_h − p on each axis, and the gain K₁ that closes it."""

from __future__ import annotations

import math

from groundstation.frames import heading_from_yaw
from groundstation.tui.frame import Frame
from groundstation.tui.rows import UNKNOWN, Row, Span, bar, quantity, spread, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_AXES = ("east", "north", "up", "yaw")
_WITH_POSITIONS = 50
_UNKNOWN4 = (math.nan,) * 4
_PLACE, _ERROR, _GAIN = 10, 10, 6
# A gain that is lower by less is as set.
_LOWERED = 0.99


class Tracking(Instrument):
    """The error as bars against the leash; with room the hand's and the vehicle's position, and K₁ by axis."""

    BORDER_TITLE = "error p̃ = p_h − p"
    EVERY = 3
    STALE_S = 0.5

    def data_age(self, frame: Frame) -> float:
        """Age of the controller's record."""
        return frame.age(frame.snapshot.pilot)

    def footnote(self, frame: Frame) -> str:
        """Return the phase margin and for which delay; without room for the gains below each other, the plane's."""
        pilot = frame.pilot
        if pilot is None or not math.isfinite(pilot.phase_margin):
            return ""
        margin = f"phase margin {math.degrees(pilot.phase_margin):.0f}°"
        if self.size.width >= _WITH_POSITIONS:
            return f"{margin} at {quantity(1000 * pilot.delay, 'ms', 0)} of delay"
        mark = "↓" if _lowered(frame)[0] else ""
        return f"K₁ {mark}{quantity(pilot.k1[0], '1/s')}, {margin}"

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw a row an axis."""
        positions = width >= _WITH_POSITIONS
        rows: list[Row] = [_row(frame, axis, width, positions=positions) for axis in range(len(_AXES))]
        if positions and height > len(_AXES):
            head = f"{'hand p_h':>17}{'vehicle p':>{_PLACE}}{'error':>{_ERROR - 2}}"
            rows.insert(0, spread([(head, Tone.MUTED)], [("K₁ 1/s ", Tone.MUTED)], width))
        return rows[:height]


def _row(frame: Frame, index: int, width: int, *, positions: bool) -> Row:
    """Return an axis: hand and vehicle where there is room, error, bar, and the gain where there is room."""
    axis, pilot, vehicle = _AXES[index], frame.snapshot.pilot, frame.snapshot.vehicle
    error = pilot.error[index] if pilot else math.nan
    text = _angle(error) if axis == "yaw" else quantity(error, "m", 2, 6, sign=True)
    row: Row = [(f" {axis:<6}", Tone.MUTED)]
    if positions:
        row += [
            (f"{_place(pilot.p_h[index] if pilot else math.nan, axis):>{_PLACE}}", Tone.HAND),
            (f"{_place(vehicle.position[index] if vehicle else math.nan, axis):>{_PLACE}}", Tone.VEHICLE),
        ]
    room = width - width_of(row) - _ERROR - (_GAIN + 1 if positions else 2)
    mapping = frame.run.settings.mapping
    leash = mapping.leash_yaw if axis == "yaw" else mapping.leash
    row += [(f" {text} ".ljust(_ERROR), Tone.STRONG), *bar(error, leash, max(room, 7), Tone.HAND)]
    return [*row, _gain(frame, index)] if positions else row


def _gain(frame: Frame, index: int) -> Span:
    """Return the gain in effect on an axis, 1/s, marked where the delay has lowered it."""
    value = frame.pilot.k1[index] if frame.pilot else math.nan
    lowered = _lowered(frame)[index]
    text = f"{value:.2f}" if math.isfinite(value) else UNKNOWN
    return f"{'↓' if lowered else ''}{text}"[:_GAIN].rjust(_GAIN), Tone.WARN if lowered else Tone.TEXT


def _lowered(frame: Frame) -> tuple[bool, ...]:
    """Say for each axis whether the gain in effect is less than the one set."""
    used = tuple(frame.pilot.k1) if frame.pilot else _UNKNOWN4
    wanted = frame.run.settings.control.k1
    return tuple(value < _LOWERED * gain for value, gain in zip(used, wanted, strict=True))


def _place(value: float, axis: str) -> str:
    if axis != "yaw":
        return quantity(value, "m", 2, sign=True)
    return quantity(heading_from_yaw(value) if math.isfinite(value) else value, "°", 0).replace(" ", "") + " "


def _angle(value: float) -> str:
    return quantity(math.degrees(value), "°", 1, 6, sign=True)
