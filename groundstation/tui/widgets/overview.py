"""The map: the flight from above."""

from __future__ import annotations

import math

from groundstation.messages import Phase, PilotState
from groundstation.run import Run
from groundstation.tui import moving, scene
from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_NAMES_FROM = 60
# Older echoes may have gone, s. As the pilot calls them where it guards.
_ECHOES_S = 0.5
_SENSOR = "sensor"


class Overview(Instrument):
    """Mission, trail, vehicle and where it will be, hand and leash. What stands still is drawn once and copied."""

    BORDER_TITLE = "map"
    STALE_S = 0.5

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self._view: scene.View | None = None
        self._ground: Canvas | None = None
        self._ground_of: tuple[object, ...] = ()

    def data_age(self, frame: Frame) -> float:
        """Age of the vehicle's state."""
        return frame.age(frame.snapshot.vehicle)

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw one frame of the map."""
        vehicle, pilot = frame.snapshot.vehicle, frame.pilot
        east, north, altitude, yaw = tuple(vehicle.position) if vehicle else (math.nan,) * 4
        if pilot is not None and pilot.phase != Phase.ENGAGED:
            pilot = None
        seen = [(east, north), (pilot.p_h[0], pilot.p_h[1])] if pilot else [(east, north)]
        seen = [point for point in seen if all(map(math.isfinite, point))]
        view = self._framed(frame, seen, 2 * width, 4 * height)
        canvas = self._standing(frame, view, altitude).copy()
        moving.draw_trail(canvas, view, frame.track.points())
        _draw_echoes(canvas, view, frame, (east, north, yaw))
        if pilot is not None:
            _draw_led(canvas, view, frame, pilot, (east, north, yaw))
        moving.draw_vehicle(canvas, view, east, north, yaw)
        scene.draw_legend(canvas, view)
        return canvas.to_rows()

    def _framed(self, frame: Frame, seen: list[tuple[float, float]], width: int, height: int) -> scene.View:
        """Keep the view as long as it shows everything: a map that moves is not read."""
        view = self._view
        if view is None or (view.width, view.height) != (width, height) or not view.holds(seen):
            self._view = view = scene.framing(frame.run.mission, seen, width, height)
        return view

    def _standing(self, frame: Frame, view: scene.View, altitude: float) -> Canvas:
        mission = frame.run.mission
        level = scene.levels(mission, altitude)
        if self._ground is None or self._ground_of != (view, level):
            self._ground = Canvas(view.width // 2, view.height // 4)
            scene.draw_world(self._ground, view, mission, altitude, _fence(frame.run))
            if self._ground.columns >= _NAMES_FROM:
                scene.label_obstacles(self._ground, view, mission)
            self._ground_of = (view, level)
        return self._ground


def _fence(run: Run) -> float:
    """Return the radius of the fence that the pilot keeps, m; 0 for none."""
    fence = run.mission.fence if run.mission else None
    return run.settings.shield.fence if fence is None else fence.radius


def _draw_echoes(canvas: Canvas, view: scene.View, frame: Frame, seen: moving.Pose) -> None:
    ranges = frame.snapshot.ranges
    if ranges is not None and frame.age(ranges) <= _ECHOES_S:
        tone = Tone.WARN if frame.guarded_by == _SENSOR else Tone.TEXT
        moving.draw_echoes(canvas, view, seen, tuple(ranges.ring), tone)


def _draw_led(canvas: Canvas, view: scene.View, frame: Frame, pilot: PilotState, seen: moving.Pose) -> None:
    """Draw the hand, what the guard keeps away from, and where the vehicle will be."""
    hand, leash = (pilot.p_h[0], pilot.p_h[1]), frame.run.settings.mapping.leash
    moving.draw_hand(canvas, view, seen[:2], hand, leash, taut=bool(pilot.on_leash))
    if frame.guarded_by:
        scene.draw_guarded(canvas, view, frame.run.mission, frame.guarded_by, _fence(frame.run))
    east, north, _, yaw = pilot.predicted
    moving.draw_predicted(canvas, view, seen, (east, north, yaw), (pilot.stop[0], pilot.stop[1]))
