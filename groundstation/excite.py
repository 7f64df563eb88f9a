"""`groundstation excite`: flies sines through the handle, so that `groundstation identify` can learn the response.

Nothing new commands the vehicle: the scripted hand moves the handle, the pilot maps, guards, limits, the link sends.
What is planned is told, and refused where there is no room for it, before anything is started.
"""

from __future__ import annotations

import argparse
import datetime
import math
import sys
import time
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.excite_hand import ExcitingHand
from groundstation.fly import check_simulated, log_stem, plan, started
from groundstation.headless import Outing
from groundstation.identification import excitation
from groundstation.identification.excitation import Excitation, Foreseen
from groundstation.pilot.margin import USUAL_LAGS, Lags, lags_of
from groundstation.pilot.shield.barrier import Barrier
from groundstation.pilot.surroundings import Surroundings, surroundings_of
from groundstation.run import Run
from groundstation.training.mission import Criteria, Fence, Mission
from sim.environment.world import World

NAME = "excite"
# Where the simulated vehicle flies unless a mission is named.
_CALM = "calm"
AXES = ("forward", "left", "up", "yaw")
# The position loop's crossover stays below the band: it keeps the vehicle at its place and hardly answers the sines.
_K1 = 0.6
# A hand that gives way to no force: the handle is where the plan has it, N/m.
_STIFF = 20_000.0
_DELAY_S = 0.15
# Wind shifts the vehicle until the position loop holds against it: as fast as it may push, m/s.
_PUSH = 0.2
_SHIFT_M = math.atanh(_PUSH / _K1)
# Where the response is not known: the usual one, half and twice as slow, and one that overdoes what is asked of it.
_UNKNOWN = ((1.0, 0.3), (1.0, 0.65), (1.0, 1.3), (1.5, 1.0))
_HIGHEST_M = 50.0
# For taking off, engaging and landing, s.
_AROUND_S = 120.0


class Plan(NamedTuple):
    """What will be flown.

    Attributes:
        excitation: What the hand does.
        excursion: How far the vehicle comes from the start, m.
        room: What the guard must leave free around the start for that, level, and up and down, m.
        run: The run that flies it.
    """

    excitation: Excitation
    excursion: float
    room: tuple[float, float]
    run: Run


def run(asked: argparse.Namespace) -> int:
    """Fly what was asked for and return the exit code.

    Raises:
        InputError: It cannot be flown, or there is no room for it.
    """
    _check(asked)
    planned = planned_for(asked)
    _tell(planned)
    return _fly(planned, asked)


def planned_for(asked: argparse.Namespace) -> Plan:
    """Plan what was asked for.

    Raises:
        InputError: It cannot be flown, or there is no room for it.
    """
    if asked.sim and not asked.mission:
        asked.mission = _CALM
    base = plan(asked)
    settings = settings_for(base.settings)
    band = _band(asked.band)
    found = excitation.plan(_axes(asked.axes), asked.amplitude, asked.seconds, band, settings)
    known = surroundings_of(base)
    lags = lags_of(known.chi) if known.chi else USUAL_LAGS
    responses = [(lag.gain, lag.time) for lag in lags[:3]] if known.chi else _UNKNOWN
    ahead = excitation.foreseen(found, responses, _K1, _DELAY_S)
    excursion = _SHIFT_M + float(np.hypot(*ahead.distance.T).max())
    room = _room(ahead, settings, lags)
    fence = known.fence or Fence(settings.shield.fence, settings.shield.ceiling, settings.shield.floor)
    altitude = _altitude(asked.altitude, room[1], fence)
    _check_room(altitude, room, known, fence)
    mission = msgspec.structs.replace(
        base.mission or Mission(schema=1, name=NAME, title=""),
        name=NAME,
        title="An excitation for identification",
        teaches="",
        takeoff_altitude_m=altitude,
        route=(),
        target=None,
        criteria=Criteria(time_limit_s=found.duration + _AROUND_S),
        fence=_around(altitude, known.radius + room[0], room[1], fence),
    )
    log = log_stem(asked.logs, datetime.datetime.fromisoformat(base.started), NAME)
    flown = msgspec.structs.replace(base, settings=settings, mission=mission, log=str(log))
    return Plan(found, excursion, room, flown)


def settings_for(settings: Settings) -> Settings:
    """Return the settings that an excitation is flown with.

    Raises:
        InputError: The guard is off.
    """
    if settings.shield.guard == "off":
        raise InputError('shield.guard: is "off"; an excitation flies by itself, so only with the guard on.')
    replace = msgspec.structs.replace
    forward, left, up, yaw = (min(_K1, gain) for gain in settings.control.k1)
    control = replace(settings.control, preset="assisted", compensation=False, k1=(forward, left, up, yaw))
    devices = {**settings.devices, "scripted": {"stiffness": _STIFF}}
    return replace(settings, control=control, devices=devices)


def _check(asked: argparse.Namespace) -> None:
    """Refuse what means nothing, before anything is planned."""
    if not asked.sim and not asked.connect:
        raise InputError("excite flies a vehicle; say which, with --sim or --connect URL.")
    if asked.connect and not asked.confirm_real:
        raise InputError("--connect: flies a real vehicle by itself; add --confirm-real if you mean it.")
    check_simulated(asked)
    if not 0.05 <= asked.amplitude <= 1.0:
        raise InputError(f"--amplitude {asked.amplitude:g}: is a share of the full speed; give 0.05 to 1.")
    if not 5.0 <= asked.seconds <= 300.0:
        raise InputError(f"--seconds {asked.seconds:g}: is the time of one stretch; give 5 to 300.")
    if asked.altitude is not None and not 0.5 <= asked.altitude <= _HIGHEST_M:
        raise InputError(
            f"--altitude {asked.altitude:g}: is not a place to fly at; give 0.5 to {_HIGHEST_M:g} m."
        )


def _axes(text: str) -> list[int]:
    names = [name.strip() for name in text.split(",")]
    if unknown := [name for name in names if name not in AXES]:
        raise InputError(f"--axes: there is no {unknown[0]!r}; name some of {','.join(AXES)}.")
    return sorted({AXES.index(name) for name in names})


def _band(text: str) -> tuple[float, float]:
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(f"--band {text}: is not two numbers; give the band in Hz, such as 0.1,1.") from error
    if not 0.02 <= low < high <= 5.0:
        raise InputError(f"--band {text}: must rise, and lie within 0.02 and 5 Hz.")
    return low, high


def _room(ahead: Foreseen, settings: Settings, lags: Lags) -> tuple[float, float]:
    """Return from where on the guard would slow the vehicle, level and up or down, m from the start."""
    forward, left, up, yaw = lags
    responses = ((forward, left, forward, yaw), (up, up, up, yaw))
    guards = [Barrier(settings.shield, settings.limits, each) for each in responses]
    level, upright = (
        max(distance + guard.reach(speed + _PUSH) for distance, speed in zip(*rows, strict=True))
        for guard, rows in zip(
            guards, zip(ahead.distance.T.tolist(), ahead.speed.T.tolist(), strict=True), strict=True
        )
    )
    return level + _SHIFT_M, upright + _SHIFT_M


def _altitude(asked: float | None, room: float, fence: Fence) -> float:
    """Return the altitude asked for, or the lowest that leaves room above the floor, in half metres."""
    return asked if asked is not None else math.ceil(2.0 * (fence.floor + room)) / 2.0


def _check_room(altitude: float, room: tuple[float, float], known: Surroundings, fence: Fence) -> None:
    """Refuse where the guard would have to slow the vehicle, or worse.

    Raises:
        InputError: Something is too near.
    """
    level, upright = room
    distance, name = World(known.obstacles).clearance((0.0, 0.0, altitude))
    # Thing, how near it is, how much room is needed towards it.
    things = [("the floor", altitude - fence.floor, upright)]
    things += [("the ceiling", fence.ceiling - altitude, upright)] if fence.ceiling else []
    things += [("the fence", fence.radius - known.radius, level)] if fence.radius else []
    things += [(f"obstacle {name!r}", distance - known.radius, max(room))]
    thing, gap, needed = min(things, key=lambda each: each[1] - each[2])
    if gap < needed - 1e-9:
        raise InputError(
            f"{thing} is {max(gap, 0.0):.1f} m from the start at {altitude:g} m, and this excitation needs "
            f"{needed:.1f} m; lower --amplitude, raise --band's low end, or choose another place or --altitude."
        )


def _around(altitude: float, radius: float, room: float, fence: Fence) -> Fence:
    """Return the fence around the start, no wider than the one there is."""
    return Fence(
        radius=min(radius, fence.radius or radius),
        ceiling=min(altitude + room, fence.ceiling or altitude + room),
        floor=max(altitude - room, fence.floor),
    )


def _tell(planned: Plan) -> None:
    """Say what will be flown."""
    found, mission = planned.excitation, planned.run.mission
    assert mission is not None
    assert mission.fence is not None
    forward, left, up, yaw = found.fastest()
    where = "the simulated vehicle" if planned.run.simulated else f"the REAL vehicle at {planned.run.url}"
    rows = (
        ("flies", f"{where}, by itself, at {mission.takeoff_altitude_m:g} m"),
        ("for", f"{found.duration:.0f} s in {len(found.stretches)} stretches, after taking off"),
        ("fastest", f"{forward:.2f} m/s forward, {left:.2f} left, {up:.2f} up, {math.degrees(yaw):.0f} °/s"),
        ("furthest", f"{planned.excursion:.2f} m from its start, as predicted, with some wind"),
        (
            "shield",
            f"fence {mission.fence.radius:.1f} m, {mission.fence.floor:.1f} to {mission.fence.ceiling:.1f} m",
        ),
        ("stop it", "Ctrl-C: it holds and lands"),
    )
    for name, words in rows:
        sys.stderr.write(f"{name:<10} {words}\n")
    sys.stderr.flush()


def _fly(planned: Plan, asked: argparse.Namespace) -> int:
    """Fly the plan, say how it went, and return the exit code."""
    flown = planned.run
    assert flown.mission is not None
    stopped = False
    with started(flown, asked) as (bus, supervisor):
        outing = Outing(flown, flown.mission, bus, supervisor)
        limit = 0.5 * (planned.excursion + max(planned.room))
        hand = ExcitingHand(planned.excitation, flown.settings, outing.sender, limit, time.monotonic)
        flight = outing.flight(hand)
        try:
            outing.fly(flight, hand)
        except KeyboardInterrupt:
            stopped = True
            sys.stderr.write("Stopped: it lets go, holds and lands. Ctrl-C once more: it is left to hold.\n")
            flight.come_down("stopped by the operator")
            outing.fly(flight, hand)
        supervisor.stop()
    _tell_result(planned, flight.failure, hand.furthest)
    return 130 if stopped else int(bool(flight.failure))


def _tell_result(planned: Plan, failure: str, furthest: float) -> None:
    recording = planned.run.recording
    there = recording.exists()
    rows = [
        ("excitation", f"NOT flown to its end: {failure}" if failure else "flown"),
        ("furthest", f"{furthest:.2f} m from its start, {planned.excursion:.2f} m predicted"),
        ("recording", _shown(recording) if there else "none"),
    ]
    if there and not failure:
        rows.append(("next", f"groundstation identify {_shown(recording)}"))
    sys.stdout.write("".join(f"{name:<10} {words}\n" for name, words in rows))


def _shown(path: Path) -> str:
    """Return a path as one would type it here."""
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)
