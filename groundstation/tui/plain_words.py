"""What a flight without a screen says: its line of status, and its help."""

from __future__ import annotations

import math

from groundstation.messages import Phase, Severity
from groundstation.tui import judge
from groundstation.tui.acts import ACTS, armed, in_air
from groundstation.tui.alerts import conditions
from groundstation.tui.choices import CHOICES
from groundstation.tui.frame import Frame
from groundstation.tui.hints import next_step
from groundstation.tui.rows import clock, quantity, span_of_time

HELP = "\n".join(
    (
        "commands, a line each:",
        *(f"  {act.label.lower():<10} {act.explains}" for act in ACTS),
        *(f"  {choice.name:<10} {choice.explains}" for choice in CHOICES),
        "  preset NAME, mapping NAME  That one: paper, assisted, transparent, training; rate, position.",
        "  stick F L U T  On-screen stick, per cent forward, left, up, turned left; it stays there.",
        "  centre     The stick to its centre.",
        "  checks     Every check before flying, and what to do.",
        "  quit       Asks first in the air; a coupled vehicle holds.",
    )
)


def line(frame: Frame) -> str:
    """Return the flight as one line: clock, kind and state of the vehicle, figures, what is wrong or what is next."""
    kind = "SIM" if frame.run.simulated else "REAL"
    severity, words = _worst(frame)
    sign = "" if severity is Severity.INFO else f"{severity.name}: "
    return f"{clock(frame.now - frame.started)} {kind} {', '.join((*_state(frame), *_figures(frame)))}. {sign}{words}"


def _worst(frame: Frame) -> tuple[Severity, str]:
    """Return the most urgent that is wrong, the first of its kind, else what can be done next."""
    wrong = [each for each in conditions(frame) if each.severity is not Severity.INFO]
    found = max(wrong, key=lambda condition: condition.severity, default=None)
    return (found.severity, found.text) if found is not None else (Severity.INFO, next_step(frame))


def _state(frame: Frame) -> list[str]:
    snapshot = frame.snapshot
    status = snapshot.status
    if status is None or not status.connected:
        return ["no vehicle"]
    where = "in the air" if in_air(snapshot) else "on the ground"
    words = [judge.mode_word(status.mode), "armed" if armed(snapshot) else "disarmed", where]
    if frame.pilot is None:
        return [*words, "NO PILOT"]
    return [*words, "released" if frame.pilot.phase == Phase.DISENGAGED else Phase(frame.pilot.phase).name]


def _figures(frame: Frame) -> list[str]:
    snapshot, words = frame.snapshot, list[str]()
    vehicle, status, pilot = snapshot.vehicle, snapshot.status, frame.pilot
    if vehicle is not None:
        old = frame.age(vehicle) > frame.run.settings.safety.state_stale_s
        age = f" {span_of_time(frame.age(vehicle))} ago" if old else ""
        words.append(f"altitude {quantity(vehicle.position[2], 'm', 1)}{age}")
        words.append(f"speed {quantity(math.hypot(*vehicle.velocity[:3]), 'm/s', 1)}{age}")
    if pilot is not None and pilot.phase == Phase.ENGAGED:
        words.append(f"error {quantity(math.hypot(*pilot.error[:3]), 'm', 2)}")
        if snapshot.handle is not None:
            words.append(f"force {quantity(math.hypot(*snapshot.handle.force), 'N', 1)}")
    if status is not None and math.isfinite(status.battery):
        words.append(f"battery {quantity(100 * status.battery, '%', 0)}")
    return words
