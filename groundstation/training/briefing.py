"""A mission in words: what it teaches, what it asks for, when it is passed, what happens on the way."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from pathlib import Path

from groundstation.training.events import Event, GustNow, WindChange
from groundstation.training.happening import words
from groundstation.training.mission import Mission
from groundstation.training.par import par_in
from groundstation.training.reference import load_reference, reference_fault
from sim.scenario import Point

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
    rows += [("passed", list(criteria(mission)) if mission.judged else ["nothing is judged"])]
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
    return f"{_when(event)}: {words(event)}"


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
    place = f"{_coordinates(at)} within {radius:g} m"
    if yaw_deg is not None:
        place += f", nose to {_compass(yaw_deg)}"
    return f"{place}, stay {hold_s:g} s" if hold_s else place


def criteria(mission: Mission) -> Iterator[str]:
    """Yield what must hold for a mission to be passed."""
    asked, target, pad = mission.criteria, mission.target, mission.landing_pad
    yield f"within {asked.time_limit_s:g} s from take-off to landing"
    if target:
        yield f"no more than {asked.final_error_m:g} m off the target at the end of the hold"
    if pad:
        yield f"landed within {pad.radius:g} m of the middle of the pad"
    if mission.obstacle:
        forgiven = asked.max_collisions
        yield f"{forgiven} collisions forgiven" if forgiven else "nothing touched"
    if asked.min_clearance_m:
        yield f"never nearer than {asked.min_clearance_m:g} m to an obstacle, measured from the hull"
    if asked.min_points:
        yield f"at least {asked.min_points:g} points"


def _world(mission: Mission) -> Iterator[str]:
    yield f"{mission.vehicle.airframe}, model {mission.vehicle.model}"
    if any(mission.wind.mean) or mission.wind.turbulence.intensity:
        yield words(WindChange(velocity=mission.wind.mean, turbulence=mission.wind.turbulence.intensity))
    for gust in mission.wind.gust:
        yield event_words(GustNow(at_s=gust.start_s, velocity=gust.velocity, duration_s=gust.duration_s))
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


def _compass(yaw_deg: float) -> str:
    names = ("east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east")
    return names[round(yaw_deg / 45.0) % 8]


def _coordinates(at: Point) -> str:
    return f"[{', '.join(f'{part:g}' for part in at)}]"
