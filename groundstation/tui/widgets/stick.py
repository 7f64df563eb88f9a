"""The stick: two pads as on a transmitter, drawn from the handle, moved with the mouse where it is ours.

Left pad: up and down, turning. Right pad: forward and back, sideways. Pressing and dragging moves the handle,
letting go centres it; whatever takes the mouse or the eyes away centres it, too. In position mode the vehicle would
follow it back: there it stays where it is, and only its turning, a rate in both modes, ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from textual import events

from groundstation.messages import MappingMode, Phase
from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.hand import CENTRED, Hand, Share4
from groundstation.tui.rows import Row
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

FORWARD, LEFT, UP, YAW = range(4)
_GAP = 4
_FELT = 0.005
_APART = 0.08
_KNOB = 3
# Shares are told apart in so many steps, finer than the dots of any pad: what moves by less is not drawn anew.
_FINE = 128
_CAPTIONS = ("up · turn", "forward · side")


class Stick(Instrument):
    """Draws the handle and the force on it; sets `hand` from the mouse.

    Args:
        hand: The on-screen stick's deflection, or None where another device is in use.
    """

    STALE_S = 0.2

    def __init__(self, hand: Hand | None, *, id: str | None = None) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self.title = "stick" if hand is not None else "handle"
        self._hand = hand
        self._held: int | None = None
        self._empty: Canvas | None = None
        self._empty_of: tuple[int, int, int | None] = (0, 0, None)
        self._drawn: list[Row] = []
        self._drawn_of: tuple[object, ...] = ()

    def data_age(self, frame: Frame) -> float:
        """Age of the handle's record."""
        return frame.age(frame.snapshot.handle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw both pads and, under them, what they do."""
        empty = self._pads(width, height)
        handle, force, wanted = (
            _steps(shares(frame)),
            _steps(_force_shares(frame)),
            _steps(frame.stick or CENTRED),
        )
        state = (empty, handle, force, wanted, frame.stick is None)
        if state != self._drawn_of:
            canvas = empty.copy()
            for index, pad in enumerate(pads(width, height)):
                across, upward = (LEFT, FORWARD) if index else (YAW, UP)
                pull = (-force[LEFT], force[FORWARD]) if index else (0.0, force[UP])
                at = (-handle[across], handle[upward])
                asked = (-wanted[across], wanted[upward])
                if frame.stick is not None and math.dist(asked, at) > _APART:
                    pad.ring(canvas, asked)
                pad.arrow(canvas, at, pull)
                pad.knob(canvas, at)
            self._drawn, self._drawn_of = canvas.to_rows(), state
        return self._drawn

    def _pads(self, width: int, height: int) -> Canvas:
        """Return the pads without a handle; drawn once, and again for another size or a hand that takes hold."""
        if self._empty is None or self._empty_of != (width, height, self._held):
            self._empty = Canvas(width, height)
            self._empty_of = (width, height, self._held)
            for index, pad in enumerate(pads(width, height)):
                pad.draw(self._empty, held=index == self._held)
                caption = _CAPTIONS[index]
                if len(caption) < 2 * pad.columns:
                    column = pad.column + (pad.columns - len(caption)) // 2
                    self._empty.letters(column, pad.rows, caption, Tone.MUTED)
        return self._empty

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Take hold of the pad under the pointer."""
        if self._hand is None:
            return
        x, y = self._content_point(event)
        middle = self.size.width / 2
        self._held = 0 if x < middle else 1
        self.capture_mouse()
        self._drag(x, y)
        event.stop()

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Drag the handle while it is held."""
        if self._held is not None:
            self._drag(*self._content_point(event))

    def on_mouse_up(self, event: events.MouseUp) -> None:
        """Let go."""
        if self._held is not None:
            self.let_go()
            event.stop()

    def on_mouse_release(self) -> None:
        """Something else took the mouse: let go."""
        self.let_go()

    def let_go(self) -> None:
        """Give the mouse back, and have the handle move nothing: centred, or in position mode left where it is."""
        self._held = None
        if self._hand is not None:
            if self._frame is not None and stays(self._frame):
                self._hand.place(YAW, 0.0)
            else:
                self._hand.centre()
        self.release_mouse()

    def centre(self) -> None:
        """Put the handle into its centre, wherever that takes the vehicle, and give the mouse back."""
        self.let_go()
        if self._hand is not None:
            self._hand.centre()

    def _content_point(self, event: events.MouseEvent) -> tuple[float, float]:
        """Return where the pointer is within the content, in cells, fractional where the terminal tells."""
        left, top = self.gutter.top_left
        x, y = event.pointer_x - left, event.pointer_y - top
        # A terminal that only knows cells means the middle of the cell.
        return x + 0.5 * (x == int(x)), y + 0.5 * (y == int(y))

    def _drag(self, x: float, y: float) -> None:
        if self._hand is None or self._held is None:
            return
        across, upward = pads(*self.size)[self._held].share(x, y)
        axes = ((YAW, UP), (LEFT, FORWARD))[self._held]
        self._hand.place(axes[0], -across)
        self._hand.place(axes[1], upward)


class Pad:
    """One square of the stick, in cells of the content.

    Args:
        column: Where it begins.
        columns: Its width; half as many rows make it square.
        rows: Its height.
    """

    def __init__(self, column: int, columns: int, rows: int) -> None:
        self.column, self.columns, self.rows = column, columns, rows
        self._x, self._y = 2 * column + columns - 0.5, 2 * rows - 0.5
        self._reach = min(columns, 2 * rows) - 2.5

    def share(self, x: float, y: float) -> tuple[float, float]:
        """Return where a point is, as shares to the right and upward, bounded to the pad."""
        half = max(self._reach / 2, 1.0)
        across = (x - (self.column + self.columns / 2)) / half
        upward = -(y - self.rows / 2) / (half / 2)
        return max(-1.0, min(1.0, across)), max(-1.0, min(1.0, upward))

    def draw(self, canvas: Canvas, *, held: bool) -> None:
        """Draw frame and cross hairs."""
        tone = Tone.HAND if held else Tone.FAINT
        x0, x1 = self._x - self._reach - 1, self._x + self._reach + 1
        y0, y1 = self._y - self._reach - 1, self._y + self._reach + 1
        canvas.line([self._x, self._x], [y0, y1], Tone.GRID, gap=3)
        canvas.line([x0, x1], [self._y, self._y], Tone.GRID, gap=3)
        canvas.line([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], tone)

    def knob(self, canvas: Canvas, at: tuple[float, float]) -> None:
        """Draw the handle."""
        x, y = self._place(at)
        steps = [(i, j) for i in range(-2, 3) for j in range(-2, 3) if abs(i) + abs(j) < 4]
        canvas.plot([x + i for i, _ in steps], [y + j for _, j in steps], Tone.HAND)

    def ring(self, canvas: Canvas, at: tuple[float, float]) -> None:
        """Draw where the handle is asked to be."""
        x, y = self._place(at)
        angles = [index * math.tau / 16 for index in range(16)]
        canvas.plot([x + 4 * math.cos(a) for a in angles], [y + 4 * math.sin(a) for a in angles], Tone.MUTED)

    def arrow(self, canvas: Canvas, at: tuple[float, float], pull: tuple[float, float]) -> None:
        """Draw the force as an arrow from the knob's edge; the pad's reach is the device's limit."""
        length = math.hypot(*pull)
        if not length > _FELT:
            return
        x, y = self._place(at)
        reach = length * self._reach + _KNOB
        end_x, end_y = x + pull[0] / length * reach, y - pull[1] / length * reach
        angle = math.atan2(pull[1], pull[0])
        barbs = [
            (end_x + 3 * math.cos(angle + side), end_y - 3 * math.sin(angle + side)) for side in (2.6, -2.6)
        ]
        points = [(x, y), (end_x, end_y), barbs[0], (end_x, end_y), barbs[1]]
        canvas.line([point[0] for point in points], [point[1] for point in points], Tone.FORCE)

    def _place(self, at: tuple[float, float]) -> tuple[float, float]:
        across, upward = (max(-1.0, min(1.0, share)) if math.isfinite(share) else 0.0 for share in at)
        return round(self._x + across * self._reach), round(self._y - upward * self._reach)


def pads(width: int, height: int) -> tuple[Pad, Pad]:
    """Return the two pads that fit a content area, side by side in its middle, a row left for words."""
    rows = max(min(height - 1, (width - _GAP) // 4), 2)
    columns = 2 * rows
    start = max((width - 2 * columns - _GAP) // 2, 0)
    return Pad(start, columns, rows), Pad(start + columns + _GAP, columns, rows)


def stays(frame: Frame) -> bool:
    """Say whether the handle stays where it is let go: in position mode its centre is a place, not a standstill."""
    pilot = frame.pilot
    if pilot is None or pilot.phase != Phase.ENGAGED or pilot.clutched:
        return False
    return pilot.mapping == MappingMode.POSITION


def shares(frame: Frame) -> Share4:
    """Return the handle as shares of its travel: forward, left, up, yaw; 0 where it is not known."""
    handle = frame.snapshot.handle
    if handle is None:
        return CENTRED
    forward, left, up = (_share(value, frame.workspace) for value in handle.position)
    return forward, left, up, _share(handle.yaw, frame.run.settings.mapping.yaw_range)


def _steps(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(round(_FINE * value) / _FINE for value in values)


def _share(value: float, full: float) -> float:
    return max(-1.0, min(1.0, value / full)) if math.isfinite(value) else 0.0


def _force_shares(frame: Frame) -> tuple[float, float, float]:
    handle = frame.snapshot.handle
    if handle is None:
        return 0.0, 0.0, 0.0
    forward, left, up = (_share(value, frame.force_limit) for value in handle.force)
    return forward, left, up
