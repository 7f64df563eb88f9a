"""The coach: of the known wrong things that a trainee does it says one at a time, seldom, and then no more."""

from __future__ import annotations

import math
from collections.abc import Callable

from groundstation.console import Snapshot
from groundstation.frames import Vector3, body_from_world
from groundstation.messages import MappingMode, Phase
from groundstation.run import Run
from groundstation.training.guide import Guide, way_to
from groundstation.training.habits import Habit, Seen, Watch

# A hint stands for so long, s; once it is followed only until it can have been read.
SHOWN_S, LEAST_S = 6.0, 2.5
# After any hint there is quiet, and after one the same waits longer each time, s; then it has been said.
QUIET_S, AGAIN_S, TIMES = 10.0, 30.0, 3
# Who can do all is left in quiet so many times as long: advice after every mistake is leant on (Winstein and Schmidt
# 1990, Reduced frequency of knowledge of results enhances motor skill learning).
_FADE = 3.0
# From this level of a mission, or share of what is to be learnt, on nobody is told the basics.
_ADVANCED_LEVEL, _SKILLED = 3, 0.7
# The clearance's rate is filtered over about so long, s.
_RATE_S = 0.25
# Without records for so long the hand is not seen, s.
_STALE_S = 0.5


class Coach:
    """Decides what is said, pure: fed with moments.

    Args:
        level: Of the mission, 1 to 5.
        skill: Of who flies, 0 to 1.
    """

    def __init__(self, level: int = 1, skill: float = 0.0) -> None:
        self._basics = level < _ADVANCED_LEVEL and skill < _SKILLED
        self._quiet_s = QUIET_S * (1.0 + (_FADE - 1.0) * skill)
        self._watch = Watch()
        self._said: dict[str, tuple[int, float]] = {}
        self._hint, self._hint_t = "", -math.inf

    def clear(self) -> None:
        """The hand is not coupled: nothing it does is wrong, and nothing stands."""
        self._watch.clear()
        self._hint = ""

    def look(self, seen: Seen, *, quiet: bool = False) -> tuple[str, Habit | None]:
        """Return the hint that stands now, or "", and the habit where it has just been said.

        Args:
            seen: This moment.
            quiet: Something more important is being said: nothing new now.
        """
        found = self._watch.look(seen)
        stood = seen.t - self._hint_t
        mended = stood >= LEAST_S and all(each.words != self._hint for each in found)
        if stood >= SHOWN_S or mended or quiet:
            self._hint = ""
        if quiet or seen.t - self._hint_t < self._quiet_s:
            return self._hint, None
        habit = next((each for each in found if self._worth_saying(each, seen.t)), None)
        if habit is None:
            return self._hint, None
        times, _ = self._said.get(habit.name, (0, 0.0))
        self._said[habit.name] = times + 1, seen.t
        self._hint, self._hint_t = habit.words, seen.t
        return self._hint, habit

    def _worth_saying(self, habit: Habit, t: float) -> bool:
        if habit.basic and not self._basics:
            return False
        times, last = self._said.get(habit.name, (0, -math.inf))
        return times < TIMES and t - last >= AGAIN_S * 2 ** max(times - 1, 0)


class LiveCoach:
    """Feeds a coach from snapshots, and tells everybody what it says.

    Args:
        run: What is flown and how well its pilot can; its mission's level and the handle's axes.
        tell: Makes an event of a hint.
    """

    def __init__(self, run: Run, tell: Callable[[str], None]) -> None:
        self._coach = Coach(run.mission.level if run.mission else 1, run.skill)
        self._heading = run.settings.mapping.frame == "heading"
        self._yaw_range = run.settings.mapping.yaw_range
        self._tell = tell
        self._t = -math.inf
        self._clearance, self._closing = math.inf, 0.0

    def look(self, view: Snapshot, guide: Guide, clearance: float, *, quiet: bool = False) -> str:
        """Return the hint that stands now, or "".

        Args:
            view: The newest of everything.
            guide: How far the mission is.
            clearance: From the hull to the nearest obstacle, m.
            quiet: Something more important is being said.
        """
        seen = self._seen(view, guide, clearance)
        if seen is None:
            self._coach.clear()
            return ""
        hint, said = self._coach.look(seen, quiet=quiet)
        if said is not None:
            self._tell(f"Hint: {said.words}")
        return hint

    def _seen(self, view: Snapshot, guide: Guide, clearance: float) -> Seen | None:
        handle, pilot, vehicle, device = view.handle, view.pilot, view.vehicle, view.device
        if handle is None or pilot is None or vehicle is None or device is None or not device.workspace > 0.0:
            return None
        if pilot.phase != Phase.ENGAGED or pilot.clutched or pilot.waiting or view.t - pilot.t > _STALE_S:
            return None
        self._rate(view.t, clearance)
        x, y, z, yaw = vehicle.position
        goal = guide.goal
        way = way_to(goal, (x, y, z, yaw)) if goal is not None else None
        there = goal is None or way is None or way.distance <= goal.radius
        east, north, up, _ = vehicle.velocity
        along = body_from_world((east, north, up), yaw if self._heading else 0.0)
        return Seen(
            t=view.t,
            handle=_share((handle.position[0], handle.position[1], handle.position[2]), device.workspace),
            yaw=handle.yaw / self._yaw_range,
            force=(handle.force[0], handle.force[1], handle.force[2]),
            velocity=along,
            clearance=clearance,
            closing=self._closing,
            on_leash=bool(pilot.on_leash),
            by_position=pilot.mapping == MappingMode.POSITION,
            way=None if there else way,
            heading=goal is not None and math.isfinite(goal.yaw),
        )

    def _rate(self, t: float, clearance: float) -> None:
        """Filter how fast the clearance shrinks."""
        dt = t - self._t
        if math.isfinite(clearance) and math.isfinite(self._clearance) and 0.0 < dt < _STALE_S:
            rate = (self._clearance - clearance) / dt
            self._closing += min(dt / _RATE_S, 1.0) * (rate - self._closing)
        elif dt > 0.0:
            self._closing = 0.0
        self._t, self._clearance = t, clearance


def _share(position: Vector3, workspace: float) -> Vector3:
    return position[0] / workspace, position[1] / workspace, position[2] / workspace
