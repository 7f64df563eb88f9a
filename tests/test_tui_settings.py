"""Settings on the screen: the list, a change by the settings' own rules, the one line in the file."""

from __future__ import annotations

import msgspec
import pytest
from cockpit import ENGAGED, cockpit

from groundstation.config import Settings, differences, load_settings
from groundstation.errors import InputError
from groundstation.messages import CommandKind
from groundstation.run import read_run, run_file
from groundstation.run_folder import sweep
from groundstation.tui.screens.dialog import Typed
from groundstation.tui.setting_list import changed, entries, save, with_line

GROUND = 0.3


def test_every_setting_is_listed_as_the_file_would_have_it():
    for entry in entries(Settings()):
        assert changed(Settings(), entry.section, entry.key, entry.value) == Settings()
        assert entry.usual
    assert not [
        entry
        for entry in entries(Settings())
        if not entry.explains and entry.section not in {"rates", "limits"}
    ]
    listed = {(entry.section, entry.key) for entry in entries(Settings())}
    assert ("control", "k1") in listed
    assert ("rates", "screen") in listed


@pytest.mark.parametrize(
    ("section", "key", "text", "words"),
    [
        ("limits", "horizontal_speed", "-1", "horizontal_speed"),
        ("control", "k1", "[1.0, 2.0]", "k1"),
        ("control", "preset", "assisted", "quotes"),
        ("control", "preset", '"none"', "preset"),
        ("link", "good_delay_s", "2.0", "must rise"),
        ("mapping", "fine", "0.5\nmode = 3", "more than one"),
    ],
)
def test_what_the_settings_do_not_allow_is_refused_with_its_reason(section, key, text, words):
    with pytest.raises(InputError, match=words):
        changed(Settings(), section, key, text)


def test_only_the_line_of_the_key_changes_and_notes_stay(tmp_path):
    file = tmp_path / "groundstation.toml"
    file.write_text('# mine\n[limits]\nyaw_rate = 0.5  # slow\njerk = 9.0\n\n[control]\npreset = "paper"\n')
    save(file, "limits", "yaw_rate", "0.7")
    save(file, "control", "damping", "1.0")
    save(file, "cues", "reach", "2.0")
    assert file.read_text() == (
        '# mine\n[limits]\nyaw_rate = 0.7  # slow\njerk = 9.0\n\n[control]\ndamping = 1.0\npreset = "paper"\n'
        "\n[cues]\nreach = 2.0\n"
    )
    read = load_settings(file)
    assert (read.limits.yaw_rate, read.control.damping, read.cues.reach) == (0.7, 1.0, 2.0)
    assert list(tmp_path.iterdir()) == [file]


def test_a_new_file_is_made_with_its_folder(tmp_path):
    file = tmp_path / "new" / "groundstation.toml"
    save(file, "rates", "screen", "20.0")
    assert load_settings(file).rates.screen == 20.0


def test_a_file_that_has_it_in_another_way_is_left_alone(tmp_path):
    file = tmp_path / "groundstation.toml"
    file.write_text("limits.yaw_rate = 0.5\n")
    with pytest.raises(InputError):
        save(file, "limits", "yaw_rate", "0.7")
    assert file.read_text() == "limits.yaw_rate = 0.5\n"
    assert list(tmp_path.iterdir()) == [file]


def test_a_value_over_several_lines_is_left_to_people(tmp_path):
    file = tmp_path / "groundstation.toml"
    before = "[mapping]\nspeed = [\n  2.0, 2.0,\n  1.0, 0.8,\n]\n"
    file.write_text(before)
    with pytest.raises(InputError):
        save(file, "mapping", "speed", "[1.0, 1.0, 1.0, 1.0]")
    assert file.read_text() == before


def test_the_last_line_needs_no_end():
    assert with_line("[limits]\njerk = 9.0", "limits", "jerk", "8.0") == "[limits]\njerk = 8.0\n"


def test_differences_are_said_with_their_new_values():
    other = changed(changed(Settings(), "limits", "jerk", "8.0"), "control", "preset", '"paper"')
    assert differences(Settings(), other) == "control.preset = paper, limits.jerk = 8.0"
    assert differences(other, other) == ""


async def change(scene, name: str, text: str) -> None:
    """Go to a setting on the page and type a value."""
    await scene.press("f10")
    await scene.see()
    places = [f"{entry.section}.{entry.key}" for entry in entries(scene.app.settings)]
    scene.app.screen.lines.move(places.index(name))
    await scene.press("enter")


async def test_a_setting_is_checked_saved_and_taken_by_the_pilot_at_once(tmp_path):
    async with cockpit(GROUND, size=(120, 40)) as scene:
        file = tmp_path / "groundstation.toml"
        scene.app._flight_run = msgspec.structs.replace(scene.app._flight_run, config=str(file))
        try:
            await change(scene, "limits.horizontal_speed", "")
            await scene.press(*["backspace"] * 3, *"-1", "enter")
            assert isinstance(scene.app.screen, Typed)
            await scene.press(*["backspace"] * 2, *"2.5", "enter")
            assert load_settings(file).limits.horizontal_speed == 2.5
            assert scene.reader.commands == [CommandKind.SETTINGS]
            run = read_run(run_file(scene.app._flight_run.run_id))
            assert run.settings.limits.horizontal_speed == 2.5
            assert "sent to the pilot" in scene.notices()[-1]
        finally:
            sweep(scene.app._flight_run.run_id)


async def test_what_is_not_live_says_so_and_sends_nothing(tmp_path):
    async with cockpit(ENGAGED, size=(120, 40)) as scene:
        file = tmp_path / "groundstation.toml"
        scene.app._flight_run = msgspec.structs.replace(scene.app._flight_run, config=str(file))
        await change(scene, "rates.screen", "")
        await scene.press(*["backspace"] * 4, *"20.0", "enter")
        assert load_settings(file).rates.screen == 20.0
        assert scene.reader.commands == []
        assert "next start" in scene.notices()[-1]


async def test_while_engaged_nothing_that_flies_is_changed():
    async with cockpit(ENGAGED, size=(120, 40)) as scene:
        await change(scene, "control.k1", "")
        assert not isinstance(scene.app.screen, Typed)
        assert "Release the hand first" in scene.notices()[-1]
