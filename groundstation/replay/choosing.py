"""What the operator of a recorded flight chose, and when: by commands and by the handle's buttons."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.config import Settings
from groundstation.messages import Command, CommandKind
from groundstation.pilot.choices import Choices
from groundstation.pilot.chooser import CHOOSING, Chosen, at_tick, beginning, obeyed, pressed
from groundstation.recording import schema
from groundstation.review.flight import Flight


class Change(NamedTuple):
    """From when on (s) what is chosen."""

    t: float
    choices: Choices


def chosen_over(flight: Flight, settings: Settings) -> list[Change]:
    """Return the choices of a recorded flight as they changed, the first at its beginning.

    Args:
        flight: The recording.
        settings: To replay with. Where they begin with another mapping or preset than the recorded ones, it stays so:
            that is what was asked for.
    """
    chosen, kept = beginning(settings), _kept(flight.settings, settings)
    changes = [Change(0.0, at_tick(chosen, settings.buttons))]
    for t, command, buttons in sorted([*_commands(flight), *_presses(flight)], key=lambda each: each[0]):
        if command is not None and command.kind not in kept:
            chosen, _ = obeyed(chosen, command)
        elif command is None:
            held = pressed(chosen, buttons, settings.buttons)
            mapping = chosen.choices.mapping if CommandKind.MAPPING in kept else held.choices.mapping
            chosen = Chosen(held.choices._replace(mapping=mapping), buttons)
        changes.append(Change(t, at_tick(chosen, settings.buttons)))
    return changes


def _kept(recorded: Settings, settings: Settings) -> set[CommandKind]:
    """Return what the replay begins with another of."""
    before, now = beginning(recorded).choices, beginning(settings).choices
    pairs = (
        (CommandKind.MAPPING, before.mapping, now.mapping),
        (CommandKind.PRESET, before.preset, now.preset),
    )
    return {kind for kind, one, other in pairs if one != other}


def _commands(flight: Flight) -> list[tuple[float, Command | None, int]]:
    """Return the choosing commands that were obeyed; recordings of schema 2 and before hold none as numbers."""
    answers = flight.series(schema.ANSWERED).values
    done = {number for number, _, ok in answers.astype(int).tolist() if ok}
    t, rows = flight.series(schema.COMMANDED)
    return [
        (at, Command(t=at, number=number, kind=kind, value=value), 0)
        for at, (number, kind, value) in zip(t.tolist(), rows.astype(int).tolist(), strict=True)
        if number in done and kind in CHOOSING
    ]


def _presses(flight: Flight) -> list[tuple[float, Command | None, int]]:
    t, rows = flight.series(schema.HANDLE_BUTTONS)
    return [(at, None, int(buttons)) for at, buttons in zip(t.tolist(), rows[:, 0].tolist(), strict=True)]
