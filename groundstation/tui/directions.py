"""The way to the next goal in words: how far and where, and what to do with the stick, as one tells a beginner."""

from __future__ import annotations

import math

from groundstation.frames import body_from_world
from groundstation.messages import MappingMode
from groundstation.training.director import Goal
from groundstation.training.guide import Guide, Way, way_to
from groundstation.tui.frame import Frame
from groundstation.tui.rows import quantity
from groundstation.tui.ways import begun

# Nearer to the nose than this the goal is ahead, nearer to the tail behind, rad.
_AHEAD, _BEHIND = math.radians(15.0), math.radians(165.0)
# A part of the way that is less than this share of the whole is not worth a word.
_WORTH = 0.3
# Slower than this it stands, m/s. From reading the words to standing still takes about so long at its speed, s.
_FLYING, _STOPPING_S = 0.15, 1.0
# Along forward, left, up, turned left: the words for more and for less, with the on-screen stick's keys.
_PUSHES = ((("forward", "↑"), ("back", "↓")), (("left", "←"), ("right", "→")), (("up", "w"), ("down", "s")))


def way_of(frame: Frame) -> Way | None:
    """Return the way to the goal of a frame, or None where there is none or the vehicle's place is not known."""
    guide, vehicle = frame.guide, frame.snapshot.vehicle
    if guide is None or guide.goal is None or vehicle is None:
        return None
    x, y, z, yaw = vehicle.position
    way = way_to(guide.goal, (x, y, z, yaw))
    return way if math.isfinite(way.distance) else None


def title(guide: Guide) -> str:
    """Say which goal it is: 2/5 Look north."""
    say = guide.goal.say if guide.goal is not None else ""
    words = say or ("Land on the pad." if guide.landing else "Fly there.")
    return f"{guide.number} {words}"


def whereabouts(guide: Guide, way: Way) -> str:
    """Say how far the goal is and where: 3.2 m, 40° left, 1.0 m up."""
    assert guide.goal is not None
    words = [quantity(math.hypot(way.ahead, way.left) if guide.landing else way.distance, "m", 1)]
    if math.isfinite(way.bearing):
        words.append(_bearing(way.bearing))
    if not guide.landing and abs(way.up) > 0.5 * guide.goal.radius:
        words.append(f"{quantity(abs(way.up), 'm', 1)} {'up' if way.up > 0.0 else 'down'}")
    return ", ".join(words)


def steering(frame: Frame, guide: Guide, way: Way) -> str:
    """Say what to do now to get to the goal, or to stay there."""
    goal = guide.goal
    assert goal is not None
    if guide.landing and math.hypot(way.ahead, way.left) <= goal.radius:
        lower = "s" if _pushed(frame) else "lower the handle"
        return f"Over the pad: {lower} brings it down, {frame.ways.land} lands."
    if guide.hold_s and not guide.landing and _arriving(frame, goal):
        stops = f"{frame.ways.centre} stops it" if frame.stick is not None else "at the centre it stops"
        return f"Now let go: {stops}, then stay {guide.hold_s:g} s."
    if way.distance > goal.radius or guide.landing:
        # What comes later stands last: where there is little room it is cut.
        then = f" Then stay {guide.hold_s:g} s." if guide.hold_s else ""
        return f"{whereabouts(guide, way)}. {_push(frame, guide, way)}{then}"
    if way.turn:
        side, key = ("left", " with a") if way.turn > 0.0 else ("right", " with d")
        return f"There. Turn {abs(math.degrees(way.turn)):.0f}° {side}{key if _pushed(frame) else ''}."
    return f"Stay: {guide.held_s:.1f} of {guide.hold_s:g} s. {_stand(frame)}"


def _arriving(frame: Frame, goal: Goal) -> bool:
    """Say whether a hand that lets go now comes to rest about at the goal: the reaction and the way to stop."""
    vehicle = frame.snapshot.vehicle
    if vehicle is None or (frame.pilot is not None and frame.pilot.mapping == MappingMode.POSITION):
        return False
    way = [to - at for to, at in zip(goal.at, vehicle.position[:3], strict=True)]
    distance = math.hypot(*way)
    closing = sum(d * v for d, v in zip(way, vehicle.velocity[:3], strict=True)) / max(distance, 1e-9)
    return closing > _FLYING and distance < _STOPPING_S * closing


def _bearing(bearing: float) -> str:
    if abs(bearing) < _AHEAD:
        return "ahead"
    if abs(bearing) > _BEHIND:
        return "behind"
    return f"{abs(math.degrees(bearing)):.0f}° {'left' if bearing > 0.0 else 'right'}"


def _push(frame: Frame, guide: Guide, way: Way) -> str:
    """Say where the handle must go, along its own axes: the vehicle's, or the world's."""
    along = (way.ahead, way.left, 0.0 if guide.landing else way.up)
    if frame.run.settings.mapping.frame == "world" and frame.snapshot.vehicle is not None:
        along = body_from_world(along, -frame.snapshot.vehicle.position[3])
    least = _WORTH * math.hypot(*along)
    words = [
        f"{key} {word}" if _pushed(frame) else word
        for part, ends in zip(along, _PUSHES, strict=True)
        if abs(part) > least
        for word, key in (ends[part < 0.0],)
    ]
    return f"Push {', '.join(words) if _pushed(frame) else ' and '.join(words)}."


def _stand(frame: Frame) -> str:
    if frame.pilot is not None and frame.pilot.mapping == MappingMode.POSITION:
        return "Keep the handle still."
    return f"{begun(frame.ways.centre) if frame.stick is not None else 'The centre'} is standstill."


def _pushed(frame: Frame) -> bool:
    """Say whether the handle is pushed with keys."""
    return frame.stick is not None and frame.ways.pushed
