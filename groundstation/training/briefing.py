"""A mission in words: what it teaches, what it asks for, when it is passed, what happens on the way."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from pathlib import Path

from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    Event,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.mission import Mission
from groundstation.training.par import par_in
from groundstation.training.reference import load_reference, reference_fault
from sim.scenario import Air, Point

_HEAD = 9
# More obstacles than these are counted, not named.
_NAMED = 10


def briefing(mission: Mission, par: str, width: int) -> list[str]:
    """Return all that a trainee needs to know before the flight, in lines.

    Args:
        mission: What will be flown.
        par: What there is to be reached, in words, or "".
        width: Of the longest line, characters.
    """
    rows = [("teaches", [mission.teaches]), ("watch", list(mission.watch)), ("asks", list(_asked(mission)))]
    rows += [("passed", list(_criteria(mission)) if mission.judged else ["nothing is judged"])]
    rows += [("par", [par])]
    rows += [("happens", [event_words(event) for event in mission.event]), ("world", list(_world(mission)))]
    rows += [("trains", [", ".join(mission.skills)]), ("needs", [", ".join(mission.needs)])]
    lines = [mission.title, f"{mission.name}, level {mission.level}"]
    for head, sentences in rows:
        lines += _block(head, [sentence for sentence in sentences if sentence], width)
    return lines


def par_words(mission: Mission, path: Path) -> str:
    """Return what the reference operator reaches in a mission, or why that is not known, in words."""
    par, who = par_in(load_reference(mission, path), 0)
    if par is None:
        return reference_fault(mission, path) if mission.judged else ""
    reached = [f"{par.time_s:.0f} s", f"{par.rms_error_m:.2f} m RMS between hand and drone"]
    if math.isfinite(par.final_error_m):
        reached.append(f"{par.final_error_m:.2f} m off the target")
    if math.isfinite(par.landing_error_m):
        reached.append(f"{par.landing_error_m:.2f} m off the pad's middle")
    return f"{', '.join(reached)}: {who}"


def event_words(event: Event) -> str:
    """Return when something happens, and what, in words."""
    return f"{_when(event)}: {_what(event)}"


def _block(head: str, sentences: list[str], width: int) -> Iterator[str]:
    """Yield sentences beside their head, each begun on a line of its own."""
    for number, sentence in enumerate(sentences):
        start = f"{'' if number else head:<{_HEAD}}"
        yield from textwrap.wrap(sentence, width, initial_indent=start, subsequent_indent=" " * (_HEAD + 2))


def _asked(mission: Mission) -> Iterator[str]:
    if not mission.judged:
        return
    yield f"take off to {mission.takeoff_altitude_m:g} m"
    for number, point in enumerate(mission.waypoints, 1):
        yield f"{number}. {_place(point.at, point.radius, point.hold_s, point.yaw_deg)}. {point.say}".rstrip()
    if target := mission.target:
        yield f"then {_place(target.position, target.radius, target.hold_s, target.yaw_deg)}: the target."
    yield f"land on the pad {mission.landing.pad!r}" if mission.landing else "land anywhere"


def _place(at: Point, radius: float, hold_s: float, yaw_deg: float | None) -> str:
    words = f"{_coordinates(at)} within {radius:g} m"
    if yaw_deg is not None:
        words += f", nose to {_compass(yaw_deg)}"
    return f"{words}, stay {hold_s:g} s" if hold_s else words


def _criteria(mission: Mission) -> Iterator[str]:
    criteria, target, pad = mission.criteria, mission.target, mission.landing_pad
    yield f"within {criteria.time_limit_s:g} s from take-off to landing"
    if target:
        yield f"no more than {criteria.final_error_m:g} m off the target at the end of the hold"
    if pad:
        yield f"landed within {pad.radius:g} m of the middle of the pad"
    if mission.obstacle:
        forgiven = criteria.max_collisions
        yield f"{forgiven} collisions forgiven" if forgiven else "nothing touched"
    if criteria.min_clearance_m:
        yield f"never nearer than {criteria.min_clearance_m:g} m to an obstacle, measured from the hull"
    if criteria.min_points:
        yield f"at least {criteria.min_points:g} points"


def _world(mission: Mission) -> Iterator[str]:
    yield f"{mission.vehicle.airframe}, model {mission.vehicle.model}"
    if any(mission.wind.mean) or mission.wind.turbulence.intensity:
        yield f"wind {_air(mission.wind.mean)}{_turbulent(mission.wind.turbulence.intensity)}"
    for gust in mission.wind.gust:
        yield f"a gust of {_air(gust.velocity)}, {gust.start_s:g} s after take-off"
    if len(mission.obstacle) > _NAMED:
        yield f"{len(mission.obstacle)} obstacles"
    elif mission.obstacle:
        yield f"obstacles: {', '.join(obstacle.name for obstacle in mission.obstacle)}"
    if mission.fence and mission.fence.radius:
        yield f"a fence {mission.fence.radius:g} m around the start"


def _when(event: Event) -> str:
    if not event.leg:
        return f"{event.at_s:g} s after take-off" if event.at_s else "from take-off on"
    return f"{event.at_s:g} s after point {event.leg}" if event.at_s else f"at point {event.leg}"


def _what(event: Event) -> str:
    match event:
        case WindChange(velocity=velocity, turbulence=turbulence):
            return f"the wind is {_air(velocity)}{_turbulent(turbulence)}"
        case GustNow(velocity=velocity, duration_s=duration):
            return f"a gust of {_air(velocity)}, {duration:g} s long"
        case Delay(round_trip_s=delay, jitter_s=jitter):
            return f"the link is late by {delay:g} s, there and back" + (
                f", ± {jitter:g} s" if jitter else ""
            )
        case Loss(share=share):
            return f"the link loses {100.0 * share:.0f} % of its frames"
        case LinkLoss(duration_s=duration):
            return f"the link is silent for {duration:g} s"
        case DeviceLoss(duration_s=duration):
            return f"the haptic device is gone for {duration:g} s"
        case BatteryLeft(remaining=remaining):
            return f"the battery falls to {100.0 * remaining:.0f} %"
        case GpsLoss(duration_s=duration):
            return f"there is no GPS for {duration:g} s"


def _air(velocity: Air) -> str:
    """Say how fast the air moves, and from where it comes as people say it."""
    east, north, _ = velocity
    speed = math.hypot(*velocity)
    if not math.hypot(east, north):
        return f"{speed:.1f} m/s"
    return f"{speed:.1f} m/s from the {_compass(math.degrees(math.atan2(-north, -east)))}"


def _turbulent(intensity: float) -> str:
    return f", turbulent (σ_w {intensity:g} m/s)" if intensity else ""


def _compass(yaw_deg: float) -> str:
    names = ("east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east")
    return names[round(yaw_deg / 45.0) % 8]


def _coordinates(at: Point) -> str:
    return f"[{', '.join(f'{part:g}' for part in at)}]"
