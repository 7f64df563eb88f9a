"""The map: the flight from above."""

from __future__ import annotations

import math

from groundstation.messages import Phase
from groundstation.tui import scene
from groundstation.tui.canvas import Canvas
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row
from groundstation.tui.widgets.instrument import Instrument

_NAMES_FROM = 60


class Overview(Instrument):
    """Mission, trail, vehicle, hand and leash. What stands still is drawn once and copied."""

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
        hand = None
        if pilot is not None and pilot.phase == Phase.ENGAGED:
            hand = (pilot.p_h[0], pilot.p_h[1])
        seen = [point for point in ((east, north), hand) if point and all(map(math.isfinite, point))]
        view = self._framed(frame, seen, 2 * width, 4 * height)
        canvas = self._standing(frame, view, altitude).copy()
        scene.draw_trail(canvas, view, frame.track.points())
        if hand and pilot is not None:
            leash = frame.run.settings.mapping.leash
            scene.draw_hand(canvas, view, (east, north), hand, leash, taut=bool(pilot.on_leash))
        scene.draw_vehicle(canvas, view, east, north, yaw)
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
            scene.draw_world(self._ground, view, mission, altitude)
            if self._ground.columns >= _NAMES_FROM:
                scene.label_obstacles(self._ground, view, mission)
            self._ground_of = (view, level)
        return self._ground
