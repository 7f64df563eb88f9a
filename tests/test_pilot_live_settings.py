"""Settings taken by the running servo, and the handle's buttons that command."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
from test_pilot_servo import Bench

from groundstation.config import Buttons, Control, Limits, Settings
from groundstation.messages import CommandKind, Phase, Preset
from groundstation.pilot.chooser import after_settings, beginning, commanded
from groundstation.run import run_file, write_run


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path)
    yield bench
    bench.close()


def test_settings_are_taken_while_released_and_told(bench: Bench) -> None:
    bench.run(0.1)
    settings = bench.run_.settings
    settings = msgspec.structs.replace(settings, limits=Limits(horizontal_speed=1.0))
    write_run(msgspec.structs.replace(bench.run_, settings=settings))
    number = bench.world.command(CommandKind.SETTINGS, bench.now)
    bench.run(0.1)
    assert any(each.number == number and each.ok for each in bench.world.answers.drain())
    assert any(b"limits.horizontal_speed = 1.0" in each.text for each in bench.world.events.drain())
    assert bench.servo._settings.limits.horizontal_speed == 1.0


def test_settings_are_not_taken_while_engaged(bench: Bench) -> None:
    bench.engage()
    write_run(msgspec.structs.replace(bench.run_, settings=Settings(limits=Limits(horizontal_speed=1.0))))
    number = bench.world.command(CommandKind.SETTINGS, bench.now)
    bench.run(0.1)
    answer = next(each for each in bench.world.answers.drain() if each.number == number)
    assert not answer.ok
    assert b"release it first" in answer.text
    assert bench.servo._settings.limits.horizontal_speed == bench.run_.settings.limits.horizontal_speed


def test_a_run_file_that_is_gone_changes_nothing(bench: Bench) -> None:
    bench.run(0.1)
    run_file(bench.run_id).unlink()
    number = bench.world.command(CommandKind.SETTINGS, bench.now)
    bench.run(0.1)
    assert any(each.number == number and not each.ok for each in bench.world.answers.drain())
    bench.engage()


def test_settings_choose_mapping_and_preset_anew_only_where_those_changed() -> None:
    before = Settings()
    chosen = beginning(before)._replace(choices=beginning(before).choices._replace(preset=Preset.TRAINING))
    slower = msgspec.structs.replace(before, limits=Limits(jerk=5.0))
    assert after_settings(chosen, before, slower) == chosen
    paper = msgspec.structs.replace(before, control=Control(preset="paper"))
    assert after_settings(chosen, before, paper).choices.preset is Preset.PAPER


def test_the_release_button_uncouples_once_when_pressed(bench: Bench) -> None:
    bench.engage()
    bench.buttons = 1 << 5
    bench.run(0.2)
    assert bench.phase() is Phase.DISENGAGED
    bench.buttons = 0
    bench.run(0.1)


def test_buttons_command_what_the_settings_give_them() -> None:
    buttons = Buttons(release=5, hold=6, land=7, return_home=8)
    chosen = beginning(Settings())
    asked = {number: commanded(chosen, 1 << number, buttons) for number in range(10)}
    assert {number: kinds for number, kinds in asked.items() if kinds} == {
        5: (CommandKind.DISENGAGE,),
        6: (CommandKind.HOLD,),
        7: (CommandKind.LAND,),
        8: (CommandKind.RETURN,),
    }
    held = chosen._replace(buttons=1 << 6)
    assert commanded(held, 1 << 6, buttons) == ()
    assert commanded(chosen, 0xFFFF, Buttons(release=-1)) == ()
