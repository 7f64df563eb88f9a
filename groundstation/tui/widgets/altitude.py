"""The altitude strip: ground, vehicle, hand and target on one upright scale."""

from __future__ import annotations

import math

from groundstation.messages import Phase
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, Span, quantity
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

# Ends of the scale and the steps of its figures, m.
_SCALES = ((4.0, 1.0), (8.0, 2.0), (20.0, 5.0), (40.0, 10.0), (80.0, 20.0), (200.0, 50.0), (1000.0, 200.0))
_HEADROOM = 1.2
_EIGHTHS = " ▁▂▃▄▅▆▇█"


class Altitude(Instrument):
    """A column filled to the vehicle's altitude, with marks beside it."""

    BORDER_TITLE = "alt"
    STALE_S = 0.5

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self._scale = _SCALES[0]

    def data_age(self, frame: Frame) -> float:
        """Age of the vehicle's state."""
        return frame.age(frame.snapshot.vehicle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw figures above, the column below."""
        del width
        vehicle, pilot, mission = frame.snapshot.vehicle, frame.pilot, frame.run.mission
        up = vehicle.position[2] if vehicle else math.nan
        climb = vehicle.velocity[2] if vehicle else math.nan
        hand = pilot.p_h[2] if pilot and pilot.phase == Phase.ENGAGED else math.nan
        target = mission.target.position[2] if mission and mission.target else math.nan
        head: list[Row] = [
            [(quantity(up, "m", 2, 8), Tone.VEHICLE)],
            [(f"{_arrow(climb)}{quantity(climb, 'm/s', 1, 7, sign=True)}", Tone.MUTED)],
        ]
        self._scale = scale_for(self._scale, [up, hand, target])
        lines = max(height - len(head), 1)
        marks: dict[int, list[Span]] = {}
        for value, mark in ((hand, ("□", Tone.HAND)), (target, ("◎", Tone.TARGET))):
            marks.setdefault(_line(value, self._scale[0], lines), []).append(mark)
        return [*head, *(self._level(index, lines, up, marks.get(index, [])) for index in range(lines))]

    def _level(self, index: int, lines: int, up: float, marks: list[Span]) -> Row:
        """Draw one line: the scale's figure, the column, the marks."""
        top, step = self._scale
        size = top / lines
        base = (lines - 1 - index) * size
        figure = math.ceil(base / step - 1e-9) * step
        label = f"{figure:4.0f} ┤" if figure < base + size - 1e-9 else "     │"
        share = (up - base) / size if math.isfinite(up) else 0.0
        fill = _EIGHTHS[max(0, min(8, round(8 * max(-1.0, min(share, 9.0)))))]
        surface = Tone.VEHICLE if share < 2.0 else Tone.TRAIL
        return [(label, Tone.MUTED), (fill * 2, surface), (" ", Tone.TEXT), *marks]


def scale_for(scale: tuple[float, float], altitudes: list[float]) -> tuple[float, float]:
    """Return end and step of a scale that shows all altitudes, m; the present one while it fits well."""
    highest = max((value for value in altitudes if math.isfinite(value)), default=0.0) * _HEADROOM
    needed = next((wider for wider in _SCALES if wider[0] >= highest), _SCALES[-1])
    fits = needed[0] <= scale[0] and highest > 0.3 * scale[0]
    return scale if fits else needed


def _line(altitude: float, top: float, lines: int) -> int:
    """Return the line, from the top, in which an altitude lies; −1 for none."""
    if not math.isfinite(altitude) or not 0 <= altitude <= top:
        return -1
    return lines - 1 - min(int(altitude / top * lines), lines - 1)


def _arrow(climb: float) -> str:
    if not math.isfinite(climb) or abs(climb) < 0.05:
        return " "
    return "↑" if climb > 0 else "↓"
