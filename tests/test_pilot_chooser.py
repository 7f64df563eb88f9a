import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.config import Buttons, Control, Mapping, Settings
from groundstation.messages import Command, CommandKind, Cue, MappingMode, Preset
from groundstation.pilot.choices import ALL_CUES, GUIDED_CUES
from groundstation.pilot.chooser import CHOOSING, Chosen, at_tick, beginning, obeyed, pressed

BUTTONS = Buttons(clutch=0, fine=1, turn_left=2, turn_right=3, mapping=4)
START = beginning(Settings())


def told(kind: CommandKind, value: int = 0, chosen: Chosen = START) -> Chosen:
    after, refusal = obeyed(chosen, Command(kind=kind, value=value))
    assert not refusal
    return after


def test_it_begins_as_the_settings_say() -> None:
    begun = beginning(Settings(mapping=Mapping(mode="position"), control=Control(preset="training"))).choices
    assert (begun.mapping, begun.preset, begun.cues) == (MappingMode.POSITION, Preset.TRAINING, ALL_CUES)
    assert not begun.fine
    assert not begun.clutched


def test_commands_choose() -> None:
    assert told(CommandKind.MAPPING, MappingMode.POSITION).choices.mapping is MappingMode.POSITION
    assert told(CommandKind.FINE, 1).choices.fine
    assert told(CommandKind.CLUTCH, 1).choices.clutched
    assert told(CommandKind.PRESET, Preset.PAPER).choices.preset is Preset.PAPER
    assert told(CommandKind.CUES, Cue.POSITION | Cue.GUARD).choices.cues == 9


@pytest.mark.parametrize(
    ("kind", "words"),
    [(CommandKind.MAPPING, "there is no mapping 9"), (CommandKind.PRESET, "there is no preset 9")],
)
def test_what_does_not_exist_is_refused_and_changes_nothing(kind: CommandKind, words: str) -> None:
    assert obeyed(START, Command(kind=kind, value=9)) == (START, words)


def test_buttons_act_while_they_are_held_and_the_mapping_s_when_it_is_pressed() -> None:
    held = pressed(START, 0b10111, BUTTONS)
    choices = at_tick(held, BUTTONS)
    assert (choices.clutched, choices.fine, choices.turn) == (True, True, 1)
    assert choices.mapping is MappingMode.POSITION
    still = pressed(held, 0b10111, BUTTONS)
    assert still is held
    let_go = pressed(held, 0, BUTTONS)
    assert at_tick(let_go, BUTTONS)._replace(mapping=MappingMode.RATE) == START.choices
    assert at_tick(pressed(let_go, 0b10000, BUTTONS), BUTTONS).mapping is MappingMode.RATE
    assert at_tick(pressed(START, 0b1000, BUTTONS), BUTTONS).turn == -1
    assert at_tick(pressed(START, 0b1100, BUTTONS), BUTTONS).turn == 0


def test_a_button_that_is_not_mapped_does_nothing() -> None:
    none = Buttons(clutch=-1, fine=-1, turn_left=-1, turn_right=-1, mapping=-1)
    assert at_tick(pressed(START, 0xFFFFFFFF, none), none) == START.choices


@given(st.lists(st.tuples(st.sampled_from(sorted(CHOOSING)), st.integers(0, 255), st.integers(0, 2**32 - 1))))
def test_whatever_is_told_and_pressed_the_choices_are_ones_that_exist(acts: list) -> None:
    chosen = START
    for kind, value, buttons in acts:
        chosen, _ = obeyed(chosen, Command(kind=kind, value=value))
        chosen = pressed(chosen, buttons, BUTTONS)
        choices = at_tick(chosen, BUTTONS)
        assert choices.mapping in MappingMode
        assert choices.preset in Preset
        assert choices.cues & ~GUIDED_CUES == 0
        assert choices.turn in {-1, 0, 1}
