"""The artificial horizon, with the heading above and the angles in figures below."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from groundstation.tui.canvas import Canvas, Floats
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, quantity, spread
from groundstation.tui.tape import heading_tape
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

# Dots a degree of pitch, and the steps of the ladder, degrees.
_DOTS_A_DEGREE = 1.1
_LADDER = (-20, -10, 10, 20)
_RUNG, _WINGS, _GAP = 9, 12, 4


class Attitude(Instrument):
    """Roll and pitch against the horizon; earth is hatched, sky is empty."""

    BORDER_TITLE = "attitude"
    EVERY = 3
    STALE_S = 0.5

    def data_age(self, frame: Frame) -> float:
        """Age of the vehicle's state."""
        return frame.age(frame.snapshot.vehicle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw tape, horizon and figures."""
        vehicle = frame.snapshot.vehicle
        nan = math.nan
        # Up is a positive pitch for a pilot; the vehicle's own axes have it turn the nose down.
        yaw, roll, pitch = (vehicle.position[3], vehicle.roll, -vehicle.pitch) if vehicle else (nan, nan, nan)
        turn = vehicle.velocity[3] if vehicle else nan
        canvas = Canvas(width, max(height - 2, 1))
        draw_horizon(canvas, roll, pitch)
        left: Row = [
            (" roll ", Tone.MUTED), (quantity(math.degrees(roll), "°", 1, 5, sign=True), Tone.STRONG),
            ("  pitch ", Tone.MUTED), (quantity(math.degrees(pitch), "°", 1, 5, sign=True), Tone.STRONG),
        ]  # fmt: skip
        right: Row = [
            ("turn ", Tone.MUTED),
            (f"{quantity(math.degrees(turn), '°/s', 0, 4, sign=True)} ", Tone.STRONG),
        ]
        return [heading_tape(yaw, width), *canvas.to_rows(), spread(left, right, width)][:height]


def draw_horizon(canvas: Canvas, roll: float, pitch: float) -> None:
    """Draw the horizon as it is seen from the vehicle.

    Args:
        canvas: Drawn on, all of it.
        roll: To the right, rad.
        pitch: Upward, rad.
    """
    x, y = (canvas.width - 1) / 2, (canvas.height - 1) / 2
    if math.isfinite(roll) and math.isfinite(pitch):
        c, s = math.cos(roll), math.sin(roll)
        # On the picture the horizon turns against the vehicle: right is (c, −s), up (−s, −c).
        down = math.degrees(math.remainder(pitch, math.tau)) * _DOTS_A_DEGREE
        columns, rows = _hatching(canvas.width, canvas.height)
        earth = (columns - x) * s + (rows - y) * c > down + 1.0
        canvas.plot(columns[earth], rows[earth], Tone.EARTH)
        reach = canvas.width + canvas.height
        _strokes(canvas, [(x + s * down, y + c * down)], (c, -s), reach, Tone.STRONG)
        rungs = [down - step * _DOTS_A_DEGREE for step in _LADDER]
        _strokes(canvas, [(x + s * at, y + c * at) for at in rungs], (c, -s), _RUNG, Tone.MUTED)
    across, under = np.meshgrid(np.arange(-_GAP - _WINGS - 1, _GAP + _WINGS + 2), np.arange(-1, 5))
    canvas.clear(x + across, y + under)
    for side in (-1, 1):
        near, far = x + side * _GAP, x + side * (_GAP + _WINGS)
        canvas.line([far, near, near], [y, y, y + 3], Tone.VEHICLE)
    canvas.plot([x, x, x - 1, x + 1], [y, y + 1, y, y], Tone.VEHICLE)


@lru_cache(maxsize=4)
def _hatching(width: int, height: int) -> tuple[Floats, Floats]:
    """Return the dots of a picture that is earth all over, from left and top."""
    columns, rows = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    hatched = (columns + 2.0 * rows) % 4.0 == 0.0
    return columns[hatched], rows[hatched]


def _strokes(
    canvas: Canvas, middles: list[tuple[float, float]], way: tuple[float, float], reach: float, tone: Tone
) -> None:
    """Draw lines of one direction through points, each so far to both sides, dots."""
    across, down = [], []
    for x, y in middles:
        # What is not a number ends a line.
        across += [x - reach * way[0], x + reach * way[0], math.nan]
        down += [y - reach * way[1], y + reach * way[1], math.nan]
    canvas.line(across, down, tone)
