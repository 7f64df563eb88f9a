"""What can be chosen, from what value to which, and what is told of cues and guard."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pytest
from canned_flight import NOTHING, START, CannedFlight, canned_run

from groundstation.messages import CommandKind, Cue, MappingMode, PilotState, Preset
from groundstation.pilot.choices import ALL_CUES
from groundstation.tui.choices import CHOICES, CHOICES_BY_NAME, PRESETS_EXPLAINED, Wishes, in_effect
from groundstation.tui.cues import parts
from groundstation.tui.guarding import SHOWN_S, GuardWatch


def after(name: str, value: int) -> int:
    return CHOICES_BY_NAME[name].after(value)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mapping", [MappingMode.RATE, MappingMode.POSITION, MappingMode.RATE]),
        ("fine", [0, 1, 0]),
        ("clutch", [0, 1, 0]),
        ("preset", [Preset.PAPER, Preset.ASSISTED, Preset.TRANSPARENT, Preset.TRAINING, Preset.ASSISTED]),
        ("position", [ALL_CUES, ALL_CUES - Cue.POSITION, ALL_CUES]),
        ("guard", [Cue.DAMPING, Cue.DAMPING + Cue.GUARD]),
    ],
)
def test_a_choice_goes_on_from_what_is_in_effect(name, values):
    for value, wanted in itertools.pairwise(values):
        assert after(name, int(value)) == wanted


def test_every_cue_and_every_preset_can_be_chosen():
    assert {name.upper() for name in CHOICES_BY_NAME} >= {str(cue.name) for cue in Cue}
    assert set(PRESETS_EXPLAINED) == set(Preset)


def test_nothing_is_chosen_while_the_pilot_does_not_answer():
    flight = CannedFlight(canned_run())
    flight.advance(3.0)
    snapshot = flight.snapshot()
    for choice in CHOICES:
        assert choice.hindrance(snapshot) == ""
        for silent in (NOTHING, replace(snapshot, pilot=None), replace(snapshot, t=snapshot.t + 1.0)):
            assert choice.hindrance(silent) == "the pilot process does not answer"


def test_what_is_in_effect_is_read_from_the_pilot():
    pilot = PilotState(mapping=1, fine=1, clutched=0, preset=Preset.TRAINING, cues=5)
    values = [in_effect(choice.kind, pilot) for choice in CHOICES if choice.kind is not CommandKind.CUES]
    assert values == [1, 1, 0, Preset.TRAINING]
    assert in_effect(CommandKind.CUES, pilot) == 5


def test_a_wish_is_gone_on_from_until_the_pilot_can_have_obeyed():
    wishes = Wishes()
    before = PilotState(t=START, cues=ALL_CUES)
    assert wishes.present(CommandKind.CUES, before) == ALL_CUES
    wishes.sent(CommandKind.CUES, 3, START)
    assert wishes.present(CommandKind.CUES, before) == 3
    assert wishes.present(CommandKind.FINE, before) == 0
    assert wishes.present(CommandKind.CUES, PilotState(t=START + 0.2, cues=7)) == 7


def test_the_guard_is_told_long_enough_to_be_seen_and_no_longer():
    flight = CannedFlight(canned_run())
    flight.advance(3.0)
    quiet = flight.snapshot()
    quiet.pilot.guarding = 0
    acting = flight.snapshot()
    acting.pilot.guarding, acting.pilot.guarded_by = 1, b"wall"
    watch = GuardWatch()
    assert watch.look(quiet) == ""
    assert watch.look(acting) == "wall"

    def later(seconds: float):
        quiet.pilot.t = acting.t + seconds
        return replace(quiet, t=acting.t + seconds)

    assert watch.look(later(0.9 * SHOWN_S)) == "wall"
    assert watch.look(later(1.1 * SHOWN_S)) == ""
    watch.look(acting)
    assert watch.look(replace(acting, pilot=None)) == ""


def told(preset: Preset, cues: int = ALL_CUES) -> PilotState:
    three = (0.0, 3.0, 4.0)
    return PilotState(
        preset=preset, cues=cues, force=three, environment=three, mismatch=three, guard=three, damping=three
    )


def test_a_part_of_the_force_is_the_norm_of_its_cue():
    for part in parts(told(Preset.TRAINING)):
        assert part.norm == pytest.approx(5.0 if part.weighted else 0.0)
        assert part.acts is part.weighted


@pytest.mark.parametrize(
    ("preset", "weighted"),
    [
        (Preset.PAPER, {Cue.POSITION}),
        (Preset.ASSISTED, {Cue.POSITION, Cue.ENVIRONMENT, Cue.GUARD, Cue.DAMPING}),
        (Preset.TRANSPARENT, {Cue.POSITION, Cue.MISMATCH}),
    ],
)
def test_a_cue_that_the_preset_does_not_have_is_marked(preset, weighted):
    shown = parts(told(preset))
    assert {part.cue for part in shown if part.weighted} == weighted
    assert {part.mark for part in shown if not part.weighted} == {"–"}
    assert [part.key for part in shown] == ["1", "2", "3", "4", "5"]


def test_a_cue_that_is_off_acts_no_more():
    shown = parts(told(Preset.PAPER, ALL_CUES - Cue.POSITION))
    assert (shown[0].mark, shown[0].norm, shown[0].acts) == ("○", 0.0, False)


def test_a_force_that_is_no_number_is_not_felt():
    pilot = told(Preset.PAPER)
    pilot.force[0] = math.nan
    assert not parts(pilot)[0].acts
