"""Choosing in flight, and what the screen says of mapping, cues, guard and gains."""

from __future__ import annotations

import math
from dataclasses import replace

import msgspec
import pytest
from canned_flight import NOTHING
from cockpit import AIR, Cockpit, cockpit
from textual import events

from groundstation.config import Settings, Shield
from groundstation.messages import (
    RING_SECTORS,
    CommandKind,
    Cue,
    MappingMode,
    Preset,
    Ranges,
)
from groundstation.pilot.choices import ALL_CUES
from groundstation.tui.choices import CHOICES
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

FULL = (120, 40)
HIGH = (200, 60)


def chosen(scene: Cockpit) -> str:
    """Return the line of choices."""
    return " ".join(scene.text("#keys").splitlines()[0].split())


@pytest.mark.parametrize("simulated", [True, False])
async def test_every_key_chooses_at_once_and_builds_on_the_one_before(simulated):
    wanted = {
        "m": (CommandKind.MAPPING, MappingMode.POSITION),
        "M": (CommandKind.MAPPING, MappingMode.RATE),
        "f": (CommandKind.FINE, 1),
        "c": (CommandKind.CLUTCH, 1),
        "p": (CommandKind.PRESET, Preset.TRANSPARENT),
        "1": (CommandKind.CUES, Cue.ENVIRONMENT | Cue.MISMATCH | Cue.GUARD | Cue.DAMPING),
        "2": (CommandKind.CUES, Cue.MISMATCH | Cue.GUARD | Cue.DAMPING),
        "3": (CommandKind.CUES, Cue.GUARD | Cue.DAMPING),
        "4": (CommandKind.CUES, Cue.DAMPING),
        "5": (CommandKind.CUES, 0),
    }
    async with cockpit(simulated=simulated) as scene:
        await scene.press(*wanted)
        sent = list(zip(scene.reader.commands, scene.reader.values, strict=True))
        assert sent == list(wanted.values())


async def test_a_choice_is_taken_back_with_the_same_key():
    async with cockpit() as scene:
        scene.reader.shown.pilot.clutched = 1
        scene.reader.shown.pilot.mapping = MappingMode.POSITION
        await scene.see()
        await scene.press("c", "m")
        assert scene.reader.values == [0, MappingMode.RATE]


async def test_without_a_pilot_nothing_is_chosen_and_the_screen_says_why():
    async with cockpit() as scene:
        scene.reader.shown = replace(scene.reader.shown, pilot=None)
        await scene.see()
        await scene.press("m", "1")
        assert scene.reader.commands == []
        assert scene.notices() == [
            "Mapping: the pilot process does not answer.",
            "Position cue on/off: the pilot process does not answer.",
        ]
        assert scene.app.check_action("choose", ("mapping",)) is None


async def test_the_palette_has_every_choice_and_every_preset():
    async with cockpit() as scene:
        listed = {command.title: command for command in scene.app.get_system_commands(scene.app.screen)}
        assert {f"{choice.label} ({choice.key})" for choice in CHOICES} <= set(listed)
        listed["Guard cue on/off (4)"].callback()
        listed["Preset: paper"].callback()
        assert scene.reader.commands == [CommandKind.CUES, CommandKind.PRESET]
        assert scene.reader.values == [ALL_CUES - Cue.GUARD, Preset.PAPER]


async def test_a_click_on_a_choice_makes_it():
    async with cockpit() as scene:
        line = scene.text("#keys").splitlines()[0]
        for word in ("clutch", "dam"):
            await scene.pilot.click("#keys", offset=(line.index(word), 0))
        await scene.pilot.click("#keys", offset=(line.index("compensated"), 0))
        assert scene.reader.commands == [CommandKind.CLUTCH, CommandKind.CUES]


async def test_what_is_in_effect_stands_beside_the_keys():
    async with cockpit() as scene:
        assert (
            chosen(scene) == "m rate f coarse c clutch p assisted 1 POS 2 env 3 –mis 4 gua 5 dam compensated"
        )
        pilot = scene.reader.shown.pilot
        pilot.mapping, pilot.fine, pilot.clutched, pilot.compensated = 1, 1, 1, 0
        pilot.preset, pilot.cues = Preset.PAPER, ALL_CUES - Cue.POSITION
        await scene.see()
        assert chosen(scene) == "m position f FINE c CLUTCH p ▲paper 1 ○pos 2 –env 3 –mis 4 –gua 5 –dam"
        assert scene.tones("#keys")["CLUTCH"] is Tone.CAUTION


async def test_where_there_is_room_words_are_written_in_full():
    async with cockpit(size=FULL) as scene:
        scene.reader.shown.pilot.preset = Preset.PAPER
        await scene.see()
        line = scene.text("#keys").splitlines()[0]
        assert "p ▲paper, no guard" in line
        assert "2 –environment" in line


async def test_no_key_is_cut_off_whatever_is_chosen():
    async with cockpit() as scene:
        pilot = scene.reader.shown.pilot
        pilot.mapping, pilot.fine, pilot.clutched, pilot.preset = 1, 1, 1, Preset.TRANSPARENT
        for size in ((80, 24), FULL, HIGH):
            await scene.pilot.resize_terminal(*size)
            await scene.see()
            line = scene.text("#keys").splitlines()[0]
            assert [word for word in line.split() if len(word) == 1] == list("mfcp12345")


async def test_the_guard_is_a_sign_with_a_name_and_marks_the_obstacle():
    async with cockpit() as scene:
        assert "GUARD" not in scene.text("#status")
        pilot = scene.reader.shown.pilot
        pilot.guarding, pilot.guarded_by = 1, b"column"
        await scene.see()
        assert "▲ GUARD column" in scene.text("#status")
        assert "away from column" in scene.text("#banner")
        assert "column" in scene.text("#map")
        assert Tone.WARN in scene.tones("#map").values()
        assert "BAT" in scene.text("#status")


async def test_the_guard_names_what_is_no_obstacle_of_the_mission():
    words = {"floor": "the ground", "ceiling": "the ceiling", "fence": "the fence", "sensor": "its sensors"}
    async with cockpit() as scene:
        for name, said in words.items():
            pilot = scene.reader.shown.pilot
            pilot.guarding, pilot.guarded_by = 1, name.encode()
            await scene.see()
            assert f"GUARD {name}" in scene.text("#status")
            assert said in scene.text("#banner")


async def test_a_fence_is_drawn_and_stands_out_when_it_is_guarded():
    fenced = msgspec.structs.replace(Settings(), shield=Shield(fence=6.0))
    async with cockpit() as bare, cockpit(settings=fenced) as scene:
        assert bare.text("#map") != scene.text("#map")
        assert Tone.WARN not in scene.tones("#map").values()
        pilot = scene.reader.shown.pilot
        pilot.guarding, pilot.guarded_by = 1, b"fence"
        await scene.see()
        assert Tone.WARN in scene.tones("#map").values()


async def test_echoes_are_drawn_while_they_are_fresh():
    async with cockpit() as scene:
        bare = scene.text("#map")
        shown = scene.reader.shown
        for age, seen in ((0.1, True), (0.6, False)):
            ranges = Ranges(t=shown.t - age)
            ranges.ring[:] = [2.5] * RING_SECTORS
            scene.reader.shown = replace(shown, ranges=ranges)
            await scene.see()
            assert (scene.text("#map") != bare) is seen


async def test_clutch_and_an_open_hold_are_said():
    async with cockpit() as scene:
        scene.reader.shown.pilot.clutched = scene.reader.shown.pilot.waiting = 1
        await scene.see()
        assert " CLUTCH " in scene.text("#status")
        assert "c takes hold again" in scene.text("#banner")
        scene.reader.shown.pilot.clutched = 0
        await scene.see()
        assert " CENTRE HANDLE " in scene.text("#status")
        assert "Centre the handle to take hold." in scene.text("#banner")


async def test_a_hand_that_is_not_coupled_has_no_signs():
    async with cockpit(AIR) as scene:
        pilot = scene.reader.shown.pilot
        pilot.clutched = pilot.guarding = 1
        await scene.see()
        assert "CLUTCH" not in scene.text("#status")
        assert "GUARD" not in scene.text("#status")


@pytest.mark.parametrize("size", [(80, 24), FULL])
async def test_what_a_poor_link_leaves_is_said(size):
    async with cockpit(size=size, delay=0.5) as scene:
        link = scene.text("#status").splitlines()[1]
        assert "▲gains 70 % ▲speed 65 %" in link
        assert "SERVO 1000 Hz" in link
    async with cockpit(size=size) as scene:
        assert "gains" not in scene.text("#status")


async def test_gain_margin_and_delay_are_with_the_position_error():
    async with cockpit() as scene:
        assert scene.note("#tracking") == "K₁ 1.20 1/s, phase margin 57°"
    async with cockpit(delay=0.5) as scene:
        assert scene.note("#tracking") == "K₁ ↓0.80 1/s, phase margin 51°"
    async with cockpit(size=FULL, delay=0.5) as scene:
        assert scene.note("#tracking") == "phase margin 51° at 500 ms of delay"
        gains = [line.split()[-1] for line in scene.text("#tracking").splitlines()]
        assert gains == ["1/s", "↓0.80", "↓0.80", "↓0.80", "↓0.70"]
    async with cockpit(AIR) as scene:
        assert scene.note("#tracking") == "None"


async def test_the_parts_of_the_force_are_shown_with_room_for_them():
    async with cockpit(size=HIGH) as scene:
        lines = scene.text("#force").splitlines()
        assert [line.split()[:3] for line in lines[4:]] == [
            ["1", "●", "position"],
            ["2", "●", "environment"],
            ["3", "–", "mismatch"],
            ["4", "●", "guard"],
            ["5", "●", "damping"],
        ]
        assert "not in assisted" in lines[6]
        scene.reader.shown.pilot.cues = ALL_CUES - Cue.POSITION
        await scene.see()
        assert "○ position    off" in scene.text("#force")


async def test_a_small_screen_has_the_total_and_the_cues_that_act():
    async with cockpit() as scene:
        total, acting = scene.text("#force").splitlines()
        assert total.endswith(" N of 10 N ")
        pilot = scene.reader.shown.pilot
        assert acting.split() == ["POS", f"{math.hypot(*pilot.force):.1f}", "N"]
        pilot.force[:] = (0.0, 0.0, 0.0)
        await scene.see()
        assert "no cue acts" in scene.text("#force")


async def test_what_is_meant_is_shown_and_not_the_compensated_setpoint():
    async with cockpit(size=FULL) as scene:
        scene.reader.shown.pilot.v_c[:] = (1.11, 0.0, 0.0, 0.0)
        scene.reader.shown.setpoint.velocity[:] = (2.22, 0.0, 0.0, 0.0)
        await scene.see()
        assert "+1.11 m/s" in scene.text("#velocity")
        assert "2.22" not in scene.text("#velocity")
        assert scene.note("#velocity") == "response compensated"
        scene.reader.shown.setpoint.active = 0
        scene.reader.shown.pilot.compensated = 0
        await scene.see()
        assert "1.11" not in scene.text("#velocity")
        assert scene.note("#velocity") == ""


async def test_a_silent_pilot_leaves_nothing_that_looks_chosen():
    async with cockpit(size=FULL) as scene:
        scene.reader.shown.pilot.t -= 1.0
        await scene.see()
        assert (
            chosen(scene)
            == "m mapping f fine c clutch p preset 1 position 2 environment 3 mismatch 4 guard 5 damping"
        )
        assert set(scene.app._flight.query_one("#keys", Instrument)._rows[0][0][1:]) == {Tone.FAINT}


async def test_before_anything_came_there_is_nothing_to_say():
    async with cockpit(None, size=HIGH) as scene:
        assert scene.reader.shown == NOTHING
        assert "position" in scene.text("#keys")
        assert len([line for line in scene.text("#force").splitlines() if line.strip()]) == 4


# The on-screen stick in position mode.


async def moved(scene: Cockpit, **state: int) -> None:
    for name, value in state.items():
        setattr(scene.reader.shown.pilot, name, value)
    await scene.see()
    await scene.press("up", "up", "w", "a")
    scene.app.post_message(events.AppBlur())
    await scene.pilot.pause()


async def test_in_position_mode_the_stick_stays_where_it_is_let_go_and_stops_turning():
    async with cockpit() as scene:
        await moved(scene, mapping=MappingMode.POSITION)
        assert scene.app.hand.share == pytest.approx((0.4, 0.0, 0.2, 0.0))
        assert "c clutches to reach on" in scene.text("#banner")
        await scene.press("space")
        assert scene.app.hand.share == (0.0, 0.0, 0.0, 0.0)


async def test_where_its_centre_moves_nothing_the_stick_is_centred():
    states = (
        {"mapping": MappingMode.RATE},
        {"mapping": MappingMode.POSITION, "clutched": 1},
        {"mapping": MappingMode.POSITION, "clutched": 0, "phase": 0},
    )
    async with cockpit() as scene:
        for state in states:
            await moved(scene, **state)
            assert scene.app.hand.share == (0.0, 0.0, 0.0, 0.0)
