"""`groundstation excite`: a headless flight whose hand excites the vehicle for identification."""

from __future__ import annotations

import argparse
import math
import sys
import time

import msgspec

from drivers.stick import StickSender
from groundstation import fly
from groundstation.bus import Bus
from groundstation.config import Mapping, Settings
from groundstation.console import Snapshot
from groundstation.errors import InputError
from groundstation.excite_options import AXES
from groundstation.frames import body_from_world
from groundstation.headless import HandleMover, fly_steps
from groundstation.identification.multisine import Excitation, excitation
from groundstation.pilot.mapping import Displacement, RateMapping
from groundstation.processes import Supervisor, running
from groundstation.run import Run
from groundstation.run_folder import sweep_dead_runs
from groundstation.training.director import Director
from groundstation.training.mission import Criteria, Fence, Mission

# What the excitation may take of the room: the rest is for the wind and for a vehicle that overshoots.
_ROOM_SHARE = 0.6
# Nothing is asked of the vehicle that takes it so near to the ground, m.
_FLOOR_M = 1.0
_SHORTEST_S = 8.0
_REST_S = 2.0
# Beside the excitation: taking off, coupling, landing.
_AROUND_S = 60.0


def run(asked: argparse.Namespace) -> int:
    """Fly the excitation and return the exit code.

    Raises:
        InputError: Something asked for cannot be, or there is no room for it.
    """
    if asked.connect and not asked.confirm_real:
        raise InputError(
            "excite --connect flies a real vehicle by itself; add --confirm-real if you mean it."
        )
    if asked.sim and asked.confirm_real:
        raise InputError("--confirm-real is for --connect; leave it out.")
    planned = fly.plan(asked)
    settings = _guarded(planned.settings)
    signal = _signal(asked, settings)
    mission = _mission(planned.mission, asked, signal)
    planned = msgspec.structs.replace(planned, settings=settings, mission=mission)
    _announce(signal, asked)
    sweep_dead_runs()
    fly.leave_when_told()
    with running(planned, "headless", fly.sim_options(asked)) as (bus, supervisor):
        return _fly(planned, bus, supervisor, signal)


def _guarded(settings: Settings) -> Settings:
    """Return the settings with the preset that has a guard.

    Raises:
        InputError: The guard is off in the settings, or the hand does not fly by rate.
    """
    if settings.shield.guard == "off":
        raise InputError(
            "shield.guard is off in the settings; the excitation is flown with the guard on only."
        )
    return msgspec.structs.replace(
        settings, control=msgspec.structs.replace(settings.control, preset="assisted")
    )


def _signal(asked: argparse.Namespace, settings: Settings) -> Excitation:
    """Return the excitation, so strong that it keeps to its share of the room.

    Raises:
        InputError: An axis, a time, a share or the room makes no sense.
    """
    names = [name.strip() for name in asked.axes.split(",")]
    if unknown := [name for name in names if name not in AXES]:
        raise InputError(
            f"--axes {asked.axes}: there is no {unknown[0] or 'axis without a name'}; give {', '.join(AXES)}."
        )
    if not 0.05 <= asked.share <= 1.0:
        raise InputError(f"--share {asked.share:g}: give 0.05 to 1.")
    if not _SHORTEST_S <= asked.seconds <= 300.0:
        raise InputError(f"--seconds {asked.seconds:g}: give {_SHORTEST_S:g} to 300.")
    height = asked.altitude - _FLOOR_M
    if not 1.0 <= asked.room <= 100.0 or height < 1.0:
        raise InputError(
            f"--room {asked.room:g}, --altitude {asked.altitude:g}: there must be 1 m around and 2 m below at least."
        )
    axes = sorted({AXES.index(name) for name in names})
    peaks = [asked.share * speed for speed in _fastest(settings)]
    reached = excitation(peaks, asked.seconds, axes).excursion()
    room = (asked.room / math.sqrt(2.0), asked.room / math.sqrt(2.0), height, math.inf)
    fits = [
        min(1.0, _ROOM_SHARE * free / far) if far > 0.0 else 1.0
        for free, far in zip(room, reached, strict=True)
    ]
    return excitation([peak * fit for peak, fit in zip(peaks, fits, strict=True)], asked.seconds, axes)


def _fastest(settings: Settings) -> tuple[float, float, float, float]:
    """Return what the hand can ask of each axis, m/s and rad/s."""
    forward, left, up, yaw = settings.mapping.speed
    limits = settings.limits
    horizontal = limits.horizontal_speed / math.sqrt(2.0)
    return (
        min(forward, horizontal),
        min(left, horizontal),
        min(up, limits.vertical_speed),
        min(yaw, limits.yaw_rate),
    )


def _mission(mission: Mission | None, asked: argparse.Namespace, signal: Excitation) -> Mission:
    """Return a mission without a target, with a fence around the start."""
    assert mission is not None
    height = asked.altitude - _FLOOR_M
    return msgspec.structs.replace(
        mission,
        name="excite",
        title="Excitation for identification",
        takeoff_altitude_m=asked.altitude,
        target=None,
        route=(),
        fence=Fence(radius=asked.room, ceiling=asked.altitude + height, floor=_FLOOR_M),
        criteria=Criteria(time_limit_s=signal.seconds + _AROUND_S),
    )


def _announce(signal: Excitation, asked: argparse.Namespace) -> None:
    """Say what will be done before it is."""
    _, velocities = signal.sampled()
    forward, left, up, yaw = abs(velocities).max(axis=0)
    x, y, z, turn = signal.excursion()
    around = f"{max(forward, left):.2f} m/s and {max(x, y):.1f} m around"
    upright = f"{up:.2f} m/s and {z:.1f} m up and down"
    turning = f"{math.degrees(yaw):.0f} °/s and {math.degrees(turn):.0f}°"
    sys.stderr.write(
        f"{signal.seconds:.0f} s of excitation at {asked.altitude:g} m: up to {around}, {upright}, {turning}; "
        f"fence {asked.room:g} m.\n"
    )


class Exciter(HandleMover):
    """The hand that excites: what it wants of the vehicle is turned back through the rate mapping.

    Args:
        signal: What is flown.
        mapping: The mapping the pilot flies with.
        sender: Takes the wish to the scripted hand.
    """

    def __init__(self, signal: Excitation, mapping: Mapping, sender: StickSender) -> None:
        super().__init__(mapping, sender, time.monotonic)
        self._signal = signal
        self._began: float | None = None
        self._elapsed = 0.0

    def wish(self, view: Snapshot, mapping: RateMapping) -> Displacement:
        """Return the displacement for what is excited now."""
        if self._began is None:
            self._began = view.t
        self._elapsed = view.t - self._began
        assert view.vehicle is not None
        yaw = view.vehicle.position[3]
        forward, left, up, rate = self._signal.at(self._elapsed)
        x, y, z = body_from_world((forward, left, up), -yaw)
        return mapping.displacement_for((x, y, z, rate), yaw)

    def flown(self, director: Director) -> bool:  # noqa: ARG002 - the time alone tells
        """Say whether all of it was flown, and the vehicle had time to rest."""
        return self._elapsed >= self._signal.seconds + _REST_S


def _fly(planned: Run, bus: Bus, supervisor: Supervisor, signal: Excitation) -> int:
    sender = StickSender(str(planned.hand))
    hand = Exciter(signal, planned.settings.mapping, sender)
    assert planned.mission is not None
    flown = fly_steps(planned.mission, bus, supervisor, hand)
    if flown.failure:
        sys.stderr.write(f"given up: {flown.failure}\n")
        return 1
    print(planned.recording)
    print(f"groundstation identify {planned.recording}", file=sys.stderr)
    return 0
