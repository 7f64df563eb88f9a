"""The map: the flight from above, from the side, from behind the vehicle, or as the vehicle itself sees it."""

from __future__ import annotations

import math
from enum import Enum

from textual import events

from groundstation.messages import Phase, PilotState
from groundstation.run import Run
from groundstation.training.guide import Guide
from groundstation.training.mission import Fence
from groundstation.tui import goals, moving, scene
from groundstation.tui.camera import Solids
from groundstation.tui.canvas import Canvas
from groundstation.tui.directions import title, way_of
from groundstation.tui.frame import Frame
from groundstation.tui.ghosts import draw_ghost
from groundstation.tui.inside import camera, draw_inside
from groundstation.tui.rows import Row, Span, quantity, wrapped
from groundstation.tui.theme import Tone
from groundstation.tui.view import TOP, Plane, View, framing, side_of, zoomed
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.wireframe import solids

_NAMES_FROM = 60
# What the first line leaves at its end, cells.
_NORTH = 6
_INSIDE_EVERY = 2
# Older echoes may have gone, s. As the pilot calls them where it guards.
_ECHOES_S = 0.5
_SENSOR = "sensor"
# A step of zooming, on the ladder of scales of the flat maps and as a factor in the others.
_LADDER_STEPS, _ZOOM_STEP, _ZOOM_ENDS = 2, 1.25, (0.3, 6.0)
# What a map that follows shows across at first, m.
_FOLLOWED_M = 12.0
# A push that a hand would not notice, m/s².
_CALM = 0.05
_ARROWS = "→↗↑↖←↙↓↘"


class Sight(Enum):
    """From where the flight is seen."""

    TOP = "map"
    SIDE = "side view"
    CHASE = "chase view"
    FIRST = "first person"

    @property
    def flat(self) -> bool:
        """It is a flat map."""
        return self in (Sight.TOP, Sight.SIDE)


class Overview(Instrument):
    """Mission, trail, vehicle and where it will be, hand and leash. What stands still is drawn once and copied.

    Attributes:
        sight: From where the flight is seen.
        follows: A flat map follows the vehicle; else it shows the whole mission.
    """

    BORDER_TITLE = "map"
    STALE_S = 0.5

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self.sight = Sight.TOP
        self.follows = False
        self._zoom = 1.0
        self._scale = math.nan
        self._view: View | None = None
        self._ground: Canvas | None = None
        self._ground_of: tuple[object, ...] = ()
        self._solids: Solids | None = None

    def next_sight(self) -> None:
        """See the flight from the next place."""
        order = list(Sight)
        self.sight = order[(order.index(self.sight) + 1) % len(order)]
        self.title = self.sight.value
        self._again()

    def follow_or_whole(self) -> None:
        """Follow the vehicle, or show the whole mission again."""
        self.follows = not self.follows
        self._again()

    def zoom(self, steps: int) -> None:
        """Go nearer, or further away where negative; a flat map then follows the vehicle."""
        if not self.sight.flat:
            least, most = _ZOOM_ENDS
            self._zoom = max(least, min(self._zoom * _ZOOM_STEP**steps, most))
        elif self._view is not None:
            self._scale = zoomed(self._view.scale, _LADDER_STEPS * steps)
            self.follows = True
        self._again()

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Zoom in."""
        self.zoom(1)
        event.stop()

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Zoom out."""
        self.zoom(-1)
        event.stop()

    def every(self) -> int:
        """Draw a flat map in every frame, the others in every second: there nearly every line changes."""
        return self.EVERY if self.sight.flat else _INSIDE_EVERY

    def data_age(self, frame: Frame) -> float:
        """Age of the vehicle's state."""
        return frame.age(frame.snapshot.vehicle)

    def footnote(self, frame: Frame) -> str:
        """Return the keys of the map, and whether it follows."""
        del frame
        if not self.sight.flat:
            return f"v view  +/− {self._zoom:.1f}×"
        return f"v view  g {'follows' if self.follows else 'whole'}  +/− zoom"

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw one frame."""
        if self.sight.flat:
            return self._flat(frame, width, height)
        canvas = Canvas(width, height)
        chase = self.sight is Sight.CHASE
        eye = camera(frame, width, height, self._zoom, chase=chase)
        if eye is None:
            canvas.letters(max(width // 2 - 12, 0), height // 2, "no position of the vehicle", Tone.MUTED)
            return canvas.to_rows()
        self._solids = self._solids or solids(frame.run.mission)
        draw_inside(canvas, frame, eye, self._solids, fence_of(frame.run), chase=chase)
        return canvas.to_rows()

    def _again(self) -> None:
        """Draw anew at once."""
        self._view = None
        if self._frame is not None and self.is_mounted and self.size:
            self._paint(self._frame)

    def _flat(self, frame: Frame, width: int, height: int) -> list[Row]:
        plane = TOP if self.sight is Sight.TOP else side_of(frame.run.mission)
        vehicle, pilot = frame.snapshot.vehicle, frame.pilot
        east, north, up, yaw = tuple(vehicle.position) if vehicle else (math.nan,) * 4
        seen = (east, north, up, yaw)
        if pilot is not None and pilot.phase != Phase.ENGAGED:
            pilot = None
        points = [plane.flat(seen), *([plane.flat(tuple(pilot.p_h))] if pilot else [])]
        points = [point for point in points if all(map(math.isfinite, point))]
        view = self._framed(frame, points, 2 * width, 4 * height, plane)
        canvas = self._standing(frame, view, seen[plane.depth]).copy()
        if frame.guide is not None and (way := way_of(frame)) is not None:
            goals.draw_goal(canvas, view, frame.guide, way.distance)
        moving.draw_trail(canvas, view, frame.track.points(), frame.now)
        draw_ghost(canvas, view, frame, named=canvas.columns >= _NAMES_FROM)
        _draw_echoes(canvas, view, frame, seen)
        if pilot is not None:
            _draw_led(canvas, view, frame, pilot, seen)
        moving.draw_vehicle(canvas, view, seen)
        scene.draw_legend(canvas, view)
        told = _told(frame, canvas.columns)
        _write(canvas, [*told, *(_air(frame) if plane is TOP else [])])
        return canvas.to_rows()

    def _framed(
        self, frame: Frame, points: list[tuple[float, float]], width: int, height: int, plane: Plane
    ) -> View:
        """Keep the view as long as it shows what it should: a map that moves is not read."""
        view = self._view
        same = view is not None and (view.width, view.height, view.plane) == (width, height, plane)
        if self.follows and points:
            if view is None or not same or not view.calm(points[0]):
                scale = self._scale if math.isfinite(self._scale) else zoomed(_FOLLOWED_M / width, 0)
                self._view = view = View(*points[0], scale, width, height, plane)
        elif view is None or not same or not view.holds(points):
            self._view = view = framing(frame.run.mission, points, width, height, plane)
        return view

    def _standing(self, frame: Frame, view: View, depth: float) -> Canvas:
        mission = frame.run.mission
        guide = frame.guide or Guide()
        state = view, scene.levels(mission, depth, view), guide.reached, guide.passed
        if self._ground is None or self._ground_of != state:
            self._ground = Canvas(view.width // 2, view.height // 4)
            scene.draw_world(self._ground, view, mission, depth, fence_of(frame.run))
            goals.draw_ways(self._ground, view, mission, guide)
            if self._ground.columns >= _NAMES_FROM:
                scene.label_obstacles(self._ground, view, mission)
            self._ground_of = state
        return self._ground


def fence_of(run: Run) -> Fence:
    """Return where the pilot keeps the vehicle: the mission's fence, or the settings' own."""
    shield = run.settings.shield
    if run.mission is not None and run.mission.fence is not None:
        return run.mission.fence
    return Fence(shield.fence, shield.ceiling, shield.floor)


def _draw_echoes(canvas: Canvas, view: View, frame: Frame, seen: moving.Pose) -> None:
    ranges = frame.snapshot.ranges
    if ranges is not None and frame.age(ranges) <= _ECHOES_S:
        tone = Tone.WARN if frame.guarded_by == _SENSOR else Tone.TEXT
        moving.draw_echoes(canvas, view, seen, tuple(ranges.ring), tone)


def _draw_led(canvas: Canvas, view: View, frame: Frame, pilot: PilotState, seen: moving.Pose) -> None:
    """Draw the hand, what the guard keeps away from, and where the vehicle will be."""
    wanted, leash = (pilot.p_h[0], pilot.p_h[1], pilot.p_h[2]), frame.run.settings.mapping.leash
    moving.draw_hand(canvas, view, seen[:3], wanted, leash, taut=bool(pilot.on_leash))
    if frame.guarded_by:
        scene.draw_guarded(canvas, view, frame.run.mission, frame.guarded_by, fence_of(frame.run))
    east, north, up, yaw = pilot.predicted
    stop = (pilot.stop[0], pilot.stop[1], pilot.stop[2])
    moving.draw_predicted(canvas, view, seen, (east, north, up, yaw), stop)


def _told(frame: Frame, columns: int) -> list[Span]:
    """Return in up to two lines which goal is next, beside where north is."""
    if frame.guide is None or frame.guide.goal is None:
        return []
    return [(line, Tone.TARGET) for line in wrapped(title(frame.guide), columns - _NORTH)[:2]]


def _write(canvas: Canvas, lines: list[Span]) -> None:
    """Write lines into the upper left corner."""
    for row, (text, tone) in enumerate(lines):
        canvas.letters(1, row, text[: canvas.columns - _NORTH], tone)


def _air(frame: Frame) -> list[Span]:
    """Return what pushes the vehicle: the mission's mean wind where it is simulated, and what the model finds."""
    words: list[str] = []
    mission, pilot = frame.run.mission, frame.pilot
    if frame.run.simulated and mission is not None and math.hypot(*mission.wind.mean) > 0.0:
        east, north, _ = mission.wind.mean
        words.append(f"mean wind {_arrow(east, north)} {quantity(math.hypot(*mission.wind.mean), 'm/s', 1)}")
    if pilot is not None and math.hypot(*pilot.push) > _CALM:
        east, north, _ = pilot.push
        words.append(f"push felt {_arrow(east, north)} {quantity(math.hypot(*pilot.push), 'm/s²', 1)}")
    return [(text, Tone.MUTED) for text in words]


def _arrow(east: float, north: float) -> str:
    if not (math.isfinite(east) and math.isfinite(north)):
        return "?"
    return _ARROWS[round(math.atan2(north, east) / (math.tau / 8)) % 8]
