"""What the operator can do next, in one line, or why the vehicle does not do what the hand does."""

from __future__ import annotations

import math

from groundstation.messages import MappingMode, Phase
from groundstation.training.director import Stage
from groundstation.tui.acts import armed, in_air
from groundstation.tui.directions import steering, title, way_of
from groundstation.tui.frame import Frame
from groundstation.tui.hand import CENTRED
from groundstation.tui.notes import words
from groundstation.tui.rows import quantity
from groundstation.tui.ways import begun

# What the guard keeps away from beside obstacles.
_BOUNDS = {
    "floor": "the ground",
    "ceiling": "the ceiling",
    "fence": "the fence",
    "sensor": "what its sensors see",
}
_ENDED = frozenset({Stage.RETURNING.value, Stage.FREE.value})
# What the pilot says of a handle that is not where engaging is possible.
_OFF_CENTRE = "not in its centre"


def next_step(frame: Frame) -> str:
    """Say what the operator can do next."""
    snapshot = frame.snapshot
    status, pilot, ways = snapshot.status, frame.pilot, frame.ways
    if frame.seeking:
        return "Looking for the haptic device …"
    if status is None or not status.connected:
        return f"Waiting for the vehicle at {frame.run.url} …"
    if not armed(snapshot):
        moved = frame.stick is not None and frame.stick != CENTRED
        centre = f"; the stick is off centre, {ways.centre} centres it" * moved
        return f"Ready on the ground. {ways.arm} arms{centre}."
    if not in_air(snapshot):
        return f"Armed on the ground. {ways.takeoff} takes off."
    if pilot is None:
        return "In the air. Waiting for the pilot process …"
    if pilot.phase == Phase.ENGAGED:
        return _engaged_hint(frame)
    if pilot.phase == Phase.ENGAGING:
        return "Engaging: the vehicle is asked to follow …"
    return _uncoupled_hint(frame, words(pilot.reason), centred=bool(pilot.centred))


def as_told(text: str, frame: Frame) -> str:
    """Return what the pilot tells with the remedy that the hand in use has, which it does not know."""
    return _centre_it(frame) if frame.stick is not None and _OFF_CENTRE in text else text


def _centre_it(frame: Frame) -> str:
    return f"Off centre: {frame.ways.centre} centres the stick, then {frame.ways.engage} engages."


def _uncoupled_hint(frame: Frame, reason: str, *, centred: bool) -> str:
    """Say why the hand is uncoupled, for another may have the vehicle, then how it is coupled."""
    told, engages = bool(reason) and _OFF_CENTRE not in reason, f"{frame.ways.engage} engages."
    if centred:
        return f"Uncoupled: {reason}. {engages}" if told else f"In the air, hand uncoupled. {engages}"
    if told:
        remedy = f"{begun(frame.ways.centre)} centres" if frame.stick is not None else "Centre it"
        return f"Uncoupled: {reason}. {remedy}, {engages}"
    return _centre_it(frame) if frame.stick is not None else f"Centre the handle, then {engages}"


def _engaged_hint(frame: Frame) -> str:
    """What hampers comes first, unless there is better to be said of what the trainee does; then the way."""
    if hampered := _holding_nothing(frame) or frame.coaching or _hampered(frame):
        return hampered
    mission, still, ways = frame.run.mission, _standstill(frame), frame.ways
    progress, target = frame.snapshot.progress, distance_to_target(frame)
    guide, way = frame.guide, way_of(frame)
    if guide is not None and way is not None:
        return f"{guide.number} {steering(frame, guide, way)} {_said(frame)}".rstrip()
    if mission is not None and mission.judged and progress is not None and words(progress.stage) in _ENDED:
        return f"All points reached: mission flown. {still}, {ways.land} lands."
    if mission is not None and mission.target is not None and math.isfinite(target):
        return f"Engaged. Target {quantity(target, 'm', 1)} away. {still}, {ways.disengage} releases."
    return f"Engaged. {still}, {ways.disengage} releases, {ways.hold} holds."


def _said(frame: Frame) -> str:
    """Return what the mission says of the goal, without its number."""
    assert frame.guide is not None
    goal = frame.guide.goal
    return title(frame.guide).partition(" ")[2] if goal is not None and goal.say else ""


def _holding_nothing(frame: Frame) -> str:
    """Say why the handle moves nothing, or ""."""
    pilot = frame.pilot
    if pilot is not None and pilot.clutched:
        return f"Clutch: the handle moves nothing. {frame.ways.clutch} takes hold again."
    return "Centre the handle to take hold." if pilot is not None and pilot.waiting else ""


def _hampered(frame: Frame) -> str:
    """Say why the vehicle does not do what the hand does, or ""."""
    if frame.guarded_by:
        return f"Guard: it keeps the vehicle away from {_BOUNDS.get(frame.guarded_by, frame.guarded_by)}."
    on_leash = frame.pilot is not None and frame.pilot.on_leash
    return "On the leash: the vehicle does not keep up, the force shows where it is." if on_leash else ""


def _standstill(frame: Frame) -> str:
    """Say how the hand gets the vehicle to stand, or itself some way to go."""
    pilot = frame.pilot
    if pilot is not None and pilot.mapping == MappingMode.POSITION:
        return f"{frame.ways.clutch} clutches to reach on"
    stick = frame.stick is not None
    return (
        f"{begun(frame.ways.centre)} lets go of the stick" if stick else "The handle's centre is standstill"
    )


def distance_to_target(frame: Frame) -> float:
    """Return the way to the mission's target, m; NaN where there is none."""
    mission, vehicle = frame.run.mission, frame.snapshot.vehicle
    if mission is None or mission.target is None or vehicle is None:
        return math.nan
    return math.dist(mission.target.position, tuple(vehicle.position)[:3])
