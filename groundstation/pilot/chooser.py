"""What the operator has chosen, by commands and by the handle's buttons: pure, a state at a time."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.config import Buttons, Settings
from groundstation.messages import Command, CommandKind, MappingMode, Preset
from groundstation.pilot.choices import ALL_CUES, GUIDED_CUES, Choices

CHOOSING = frozenset(
    {
        CommandKind.MAPPING,
        CommandKind.FINE,
        CommandKind.CLUTCH,
        CommandKind.PRESET,
        CommandKind.CUES,
    }
)


# What a button commands when it is pressed, by its name in the settings.
_COMMANDING = {
    "release": CommandKind.DISENGAGE,
    "hold": CommandKind.HOLD,
    "land": CommandKind.LAND,
    "return_home": CommandKind.RETURN,
}


class Chosen(NamedTuple):
    """What stands between ticks.

    Attributes:
        choices: As commands have set them; buttons that are held come on top, in `at_tick`.
        buttons: As they were, one bit each.
    """

    choices: Choices
    buttons: int = 0


def beginning(settings: Settings, *, guided: bool = False) -> Chosen:
    """Return what the settings choose; where the hand is guided, with that cue."""
    return Chosen(
        Choices(
            mapping=MappingMode[settings.mapping.mode.upper()],
            preset=Preset[settings.control.preset.upper()],
            cues=GUIDED_CUES if guided else ALL_CUES,
        )
    )


def after_settings(chosen: Chosen, before: Settings, now: Settings) -> Chosen:
    """Return what is chosen after the settings have changed: what they choose anew, else as it was."""
    begun, fresh = beginning(before).choices, beginning(now).choices
    if begun == fresh:
        return chosen
    return chosen._replace(choices=chosen.choices._replace(mapping=fresh.mapping, preset=fresh.preset))


def obeyed(chosen: Chosen, command: Command) -> tuple[Chosen, str]:
    """Return what is chosen after a command, and why it was refused, or ""."""
    kind, value, choices = CommandKind(command.kind), int(command.value), chosen.choices
    if kind is CommandKind.FINE:
        choices = choices._replace(fine=bool(value))
    elif kind is CommandKind.CLUTCH:
        choices = choices._replace(clutched=bool(value))
    elif kind is CommandKind.CUES:
        choices = choices._replace(cues=value & GUIDED_CUES)
    elif kind is CommandKind.MAPPING and value in set(MappingMode):
        choices = choices._replace(mapping=MappingMode(value))
    elif kind is CommandKind.PRESET and value in set(Preset):
        choices = choices._replace(preset=Preset(value))
    else:
        return chosen, f"there is no {kind.name.lower()} {value}"
    return chosen._replace(choices=choices), ""


def pressed(chosen: Chosen, buttons: int, settings: Buttons) -> Chosen:
    """Return what is chosen after the buttons have come to be as they are: the mapping's button acts when pressed."""
    if buttons == chosen.buttons:
        return chosen
    choices = chosen.choices
    if _held(buttons & ~chosen.buttons, settings.mapping):
        other = MappingMode.POSITION if choices.mapping is MappingMode.RATE else MappingMode.RATE
        choices = choices._replace(mapping=other)
    return Chosen(choices, buttons)


def commanded(chosen: Chosen, buttons: int, settings: Buttons) -> tuple[CommandKind, ...]:
    """Return what the buttons that have just been pressed command."""
    new = buttons & ~chosen.buttons
    if not new:
        return ()
    return tuple(kind for name, kind in _COMMANDING.items() if _held(new, getattr(settings, name)))


def enabled(buttons: int, settings: Buttons) -> bool:
    """Say whether the enable control is held, where there is one."""
    return settings.enable < 0 or _held(buttons, settings.enable)


def squeezed(buttons: int, settings: Buttons) -> bool:
    """Say whether the enable control is squeezed through."""
    return _held(buttons, settings.panic)


def at_tick(chosen: Chosen, settings: Buttons) -> Choices:
    """Return the choices at a tick, with what the buttons add while they are held."""
    choices, buttons = chosen
    if not buttons:
        return choices
    return choices._replace(
        fine=choices.fine or _held(buttons, settings.fine),
        clutched=choices.clutched or _held(buttons, settings.clutch),
        turn=_held(buttons, settings.turn_left) - _held(buttons, settings.turn_right),
    )


def _held(buttons: int, number: int) -> bool:
    return number >= 0 and bool(buttons >> number & 1)
