"""How a trainee is doing, in words: from a snapshot of their flight. Pure."""

from __future__ import annotations

import math

from groundstation.console import Snapshot
from groundstation.messages import (
    FlightMode,
    MissionProgress,
    Phase,
    PilotState,
    VehicleState,
    VehicleStatus,
)
from groundstation.run import Run
from groundstation.training.briefing import criteria

# What is older than this is said to be, s.
_OLD_S = 1.5
_MODES = {each.value: each.name.capitalize() for each in FlightMode}
_PHASES = {
    Phase.DISENGAGED.value: "released",
    Phase.ENGAGING.value: "engaging",
    Phase.ENGAGED.value: "engaged",
}


def status(run: Run, view: Snapshot, in_force: str) -> list[tuple[str, str]]:
    """Return how it is going, as names with words.

    Args:
        run: The flight.
        view: What is known of it now.
        in_force: What was let happen, in words.
    """
    return [
        ("flight", f"{'simulated' if run.simulated else 'REAL'} vehicle, mission {_mission(run)}"),
        ("trainee", f"{run.pilot or 'nobody by name'}, {_hand(view)}"),
        ("vehicle", _vehicle(view)),
        ("mission", _progress(view)),
        ("goal", _goal(run)),
        ("score", _score(view)),
        ("link", _link(view)),
        ("in force", in_force),
    ]


def line(view: Snapshot, in_force: str) -> str:
    """Return the same in one line."""
    return f"{_hand(view)} · {_vehicle(view)} · {_progress(view)} · {_link(view)} · in force: {in_force}"


def _mission(run: Run) -> str:
    return run.mission.title if run.mission else "free flight"


def _hand(view: Snapshot) -> str:
    """Return how the hand is coupled, and how hard the force on it is."""
    pilot = view.pilot
    if pilot is None or view.t - pilot.t > _OLD_S:
        return "the pilot process is silent"
    words = [_PHASES.get(pilot.phase, "?")]
    if pilot.phase == Phase.ENGAGED:
        words += _flying(view, pilot)
    elif pilot.reason:
        words.append(pilot.reason.decode(errors="replace"))
    if view.device is not None and not view.device.present:
        words.append("no haptic device")
    return ", ".join(words)


def _flying(view: Snapshot, pilot: PilotState) -> list[str]:
    words = [f"error {math.hypot(*pilot.error[:3]):.2f} m"]
    if view.handle is not None:
        words.append(f"force {math.hypot(*view.handle.force):.1f} N")
    if pilot.on_leash:
        words.append("on the leash")
    if pilot.guarding:
        words.append(f"guarded from {pilot.guarded_by.decode(errors='replace') or 'something'}")
    return words


def _vehicle(view: Snapshot) -> str:
    status = view.status
    if status is None or not status.heard_t:
        return "no vehicle"
    if not status.connected:
        return "not connected"
    words = [_MODES.get(status.mode, "?"), _armed(status)]
    if view.vehicle is not None:
        words += _moving(view.vehicle, view.t)
    if math.isfinite(status.battery):
        words.append(f"battery {100.0 * status.battery:.0f} %")
    return ", ".join(words)


def _armed(status: VehicleStatus) -> str:
    if not status.armed:
        return "disarmed"
    return "in the air" if status.in_air else "armed"


def _moving(state: VehicleState, t: float) -> list[str]:
    old = f" {t - state.t:.0f} s ago" if t - state.t > _OLD_S else ""
    speed = math.hypot(*state.velocity[:3])
    return [f"altitude {state.position[2]:.1f} m{old}", f"speed {speed:.1f} m/s{old}"]


def _progress(view: Snapshot) -> str:
    progress = view.progress
    if progress is None:
        return "no mission"
    words = [progress.stage.decode(errors="replace")]
    if progress.legs:
        words.append(f"point {min(progress.leg + 1, progress.legs)} of {progress.legs}")
    return ", ".join((*words, *_margins(progress)))


def _goal(run: Run) -> str:
    """Return what must hold for the mission to be passed."""
    return "; ".join(criteria(run.mission)) if run.mission and run.mission.judged else "nothing is judged"


def _score(view: Snapshot) -> str:
    return (view.progress.score.decode(errors="replace") if view.progress else "") or "none yet"


def _margins(progress: MissionProgress) -> list[str]:
    words: list[str] = []
    if math.isfinite(progress.target_distance):
        words.append(f"{progress.target_distance:.1f} m to the target")
    if math.isfinite(progress.clearance):
        words.append(f"clearance {progress.clearance:.1f} m")
    if progress.collisions:
        words.append(f"{progress.collisions} collision{'s' if progress.collisions > 1 else ''}")
    return words


def _link(view: Snapshot) -> str:
    status = view.status
    if status is None or not status.heard_t:
        return "nothing heard yet"
    words = [f"round trip {1e3 * status.rtt:.0f} ms"] if math.isfinite(status.rtt) else []
    words.append(f"{100.0 * status.loss:.0f} % lost")
    if (silent := view.t - status.heard_t) > _OLD_S:
        words.insert(0, f"silent for {silent:.0f} s")
    return ", ".join(words)
