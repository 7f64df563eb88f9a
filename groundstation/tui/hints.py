"""What the operator can do next, in one line, or why the vehicle does not do what the hand does."""

from __future__ import annotations

import math

from groundstation.messages import MappingMode, Phase
from groundstation.training.director import Stage
from groundstation.tui.acts import armed, in_air
from groundstation.tui.frame import Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import quantity

# What the guard keeps away from beside obstacles.
_BOUNDS = {
    "floor": "the ground",
    "ceiling": "the ceiling",
    "fence": "the fence",
    "sensor": "what its sensors see",
}


def next_step(frame: Frame) -> str:
    """Say what the operator can do next."""
    snapshot = frame.snapshot
    status, pilot = snapshot.status, frame.pilot
    if status is None or not status.connected:
        return f"Waiting for the vehicle at {frame.run.url} …"
    if not armed(snapshot):
        return "Ready on the ground. A arms."
    if not in_air(snapshot):
        return "Armed on the ground. T takes off."
    if pilot is None:
        return "In the air. Waiting for the pilot process …"
    if pilot.phase == Phase.ENGAGED:
        return _engaged_hint(frame)
    if pilot.phase == Phase.ENGAGING:
        return "Engaging: the vehicle is asked to follow …"
    reason = words(pilot.reason)
    uncoupled = f"Hand uncoupled ({reason})." if reason else "In the air, hand uncoupled."
    return f"{uncoupled} {'E engages.' if pilot.centred else 'Centre the handle, then E engages.'}"


def _engaged_hint(frame: Frame) -> str:
    if hampered := _hampered(frame):
        return hampered
    mission, still = frame.run.mission, _standstill(frame)
    progress, target = frame.snapshot.progress, distance_to_target(frame)
    if progress is not None and words(progress.stage) == Stage.RETURNING.value and math.isfinite(target):
        return f"Engaged. The target is held: mission flown. {still}, L lands."
    if mission is not None and mission.target is not None and math.isfinite(target):
        return f"Engaged. Target {quantity(target, 'm', 1)} away. {still}, X releases."
    return f"Engaged. {still}, X releases, H holds."


def _hampered(frame: Frame) -> str:
    """Say why the vehicle does not do what the hand does, or ""."""
    pilot = frame.pilot
    if pilot is None:
        return ""
    if pilot.clutched:
        return "Clutch: the handle moves nothing. C takes hold again."
    if pilot.waiting:
        return "Centre the handle to take hold."
    if frame.guarded_by:
        return f"Guard: it keeps the vehicle away from {_BOUNDS.get(frame.guarded_by, frame.guarded_by)}."
    return (
        "On the leash: the vehicle does not keep up, the force shows where it is." if pilot.on_leash else ""
    )


def _standstill(frame: Frame) -> str:
    """Say how the hand gets the vehicle to stand, or itself some way to go."""
    pilot = frame.pilot
    if pilot is not None and pilot.mapping == MappingMode.POSITION:
        return "C clutches to reach on"
    return "Space lets go of the stick" if frame.stick is not None else "The handle's centre is standstill"


def distance_to_target(frame: Frame) -> float:
    """Return the way to the mission's target, m; NaN where there is none."""
    mission, vehicle = frame.run.mission, frame.snapshot.vehicle
    if mission is None or mission.target is None or vehicle is None:
        return math.nan
    return math.dist(mission.target.position, tuple(vehicle.position)[:3])
