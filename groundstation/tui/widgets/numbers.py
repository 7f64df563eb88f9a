"""Where it is and how fast: one line on a small screen, large figures on a big one."""

from __future__ import annotations

import math
from typing import NamedTuple

from groundstation.frames import heading_from_yaw
from groundstation.tui.frame import Frame
from groundstation.tui.hints import distance_to_target
from groundstation.tui.rows import UNKNOWN, Row, quantity, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

# Light box-drawing figures, three by three cells.
_LARGE = {
    "0": ("╭─╮", "│ │", "╰─╯"),
    "1": (" ╷ ", " │ ", " ╵ "),
    "2": ("╶─╮", "╭─╯", "╰─╴"),
    "3": ("╶─╮", " ─┤", "╶─╯"),
    "4": ("╷ ╷", "╰─┤", "  ╵"),
    "5": ("╭─╴", "╰─╮", "╶─╯"),
    "6": ("╭─╴", "├─╮", "╰─╯"),
    "7": ("╶─╮", "  │", "  ╵"),
    "8": ("╭─╮", "├─┤", "╰─╯"),
    "9": ("╭─╮", "╰─┤", "╶─╯"),
    ".": (" ", " ", "."),
    "−": ("   ", " ─ ", "   "),
    "+": ("   ", " ┼ ", "   "),
    UNKNOWN: ("   ", " ─ ", "   "),
    " ": ("   ", "   ", "   "),
}
_POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
_LARGE_ROWS, _LARGE_COLUMNS = 6, 48


class Figure(NamedTuple):
    """A number to show: its label, value, unit, decimals, and whether a plus is written."""

    label: str
    value: float
    unit: str
    decimals: int
    sign: bool = False

    def written(self) -> str:
        """Return value and unit."""
        if not math.isfinite(self.value):
            return UNKNOWN
        return quantity(self.value, self.unit, self.decimals, sign=self.sign).replace(" °", "°")


class FlightLine(Instrument):
    """All figures in one line, the most important first."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw as many figures as there is room for."""
        del height
        row: Row = []
        old = frame.age(frame.snapshot.vehicle) > frame.run.settings.safety.state_stale_s
        for figure in _figures(frame):
            item: Row = [(f" {figure.label} ", Tone.MUTED), (f"{figure.written()} ", Tone.STRONG)]
            if width_of(row) + width_of(item) <= width:
                row.extend(item)
        return [[(text, Tone.STALE) for text, _ in row] if old else row]


class Numbers(Instrument):
    """The same figures with room around them."""

    BORDER_TITLE = "flight"
    EVERY = 3
    STALE_S = 0.5

    def data_age(self, frame: Frame) -> float:
        """Age of the vehicle's state."""
        return frame.age(frame.snapshot.vehicle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw altitude, speed and heading large where the height allows, the rest below."""
        figures = _figures(frame)
        if height < _LARGE_ROWS or width < _LARGE_COLUMNS:
            return _table(figures, width)
        large = [figures[2], figures[3], figures[5]]
        return [*_large(large, width), *_table([figures[0], figures[1], figures[4], *figures[6:]], width)]


def _figures(frame: Frame) -> list[Figure]:
    """Return all figures; what is not known is NaN."""
    vehicle = frame.snapshot.vehicle
    nan = math.nan
    east, north, up, yaw = tuple(vehicle.position) if vehicle else (nan, nan, nan, nan)
    v_east, v_north, climb, _ = tuple(vehicle.velocity) if vehicle else (nan, nan, nan, nan)
    heading = heading_from_yaw(yaw) if math.isfinite(yaw) else nan
    figures = [
        Figure("EAST", east, "m", 2, sign=True),
        Figure("NORTH", north, "m", 2, sign=True),
        Figure("ALT", up, "m", 2),
        Figure("SPEED", math.hypot(v_east, v_north), "m/s", 2),
        Figure("CLIMB", climb, "m/s", 2, sign=True),
        Figure("HDG", heading, f"° {compass_point(heading)}", 0),
    ]
    if math.isfinite(target := distance_to_target(frame)):
        figures.append(Figure("TARGET", target, "m", 2))
    return figures


def compass_point(heading: float) -> str:
    """Return the nearest of eight points of the compass for a heading in degrees."""
    return _POINTS[round(heading / 45.0) % 8] if math.isfinite(heading) else UNKNOWN


def _table(figures: list[Figure], width: int) -> list[Row]:
    """Two figures a row."""
    rows: list[Row] = []
    column = max(width // 2, 20)
    for index in range(0, len(figures), 2):
        row: Row = []
        for figure in figures[index : index + 2]:
            row += [(f" {figure.label:<7}", Tone.MUTED), (f"{figure.written():<{column - 8}}", Tone.STRONG)]
        rows.append(row)
    return rows


def _large(figures: list[Figure], width: int) -> list[Row]:
    """Figures three rows high, side by side, with labels above and units behind."""
    column = width // len(figures)
    labels: Row = []
    rows: list[Row] = [[], [], []]
    for figure in figures:
        digits, _, unit = quantity(figure.value, figure.unit, min(figure.decimals, 1)).partition(" ")
        labels.append((f" {figure.label}".ljust(column), Tone.MUTED))
        for line in range(3):
            drawn = " " + "".join(_LARGE[digit][line] for digit in digits)
            unit_here = f" {unit}" if line == 2 else ""
            rows[line] += [(drawn, Tone.VEHICLE), (unit_here.ljust(column - len(drawn)), Tone.MUTED)]
    return [labels, *rows]
