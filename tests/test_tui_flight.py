"""The flight screen under the hands of an operator: keys, mouse, dialogs, sizes."""

from __future__ import annotations

import ctypes
import math
from dataclasses import replace

import pytest
from canned_flight import NOTHING, canned_run
from cockpit import AIR, ENGAGED, Cockpit, cockpit
from textual import events
from textual.widget import Widget

from groundstation.messages import CommandAnswer, CommandKind, FlightMode, Record
from groundstation.tui.hand import CENTRED
from groundstation.tui.screens.dialog import Confirm
from groundstation.tui.screens.flight import FlightScreen
from groundstation.tui.screens.help import Help
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.widgets.overview import Overview
from groundstation.tui.widgets.stick import Stick, pads


@pytest.mark.parametrize(
    ("key", "seconds", "kind"),
    [
        ("A", 0.3, CommandKind.ARM),
        ("D", 0.8, CommandKind.DISARM),
        ("t", 0.8, CommandKind.TAKEOFF),
        ("T", 0.8, CommandKind.TAKEOFF),
        ("e", AIR, CommandKind.ENGAGE),
        ("x", ENGAGED, CommandKind.DISENGAGE),
        ("h", ENGAGED, CommandKind.HOLD),
        ("r", ENGAGED, CommandKind.RETURN),
        ("l", ENGAGED, CommandKind.LAND),
    ],
)
async def test_a_key_does_its_act_at_once_on_the_simulated_vehicle(key, seconds, kind):
    async with cockpit(seconds) as scene:
        await scene.press(key)
        assert scene.reader.commands == [kind]


@pytest.mark.parametrize(
    ("key", "seconds", "kind"), [("A", 0.3, CommandKind.ARM), ("t", 0.8, CommandKind.TAKEOFF)]
)
async def test_a_real_vehicle_is_asked_about_first(key, seconds, kind):
    async with cockpit(seconds, simulated=False) as scene:
        await scene.press(key)
        assert isinstance(scene.app.screen, Confirm)
        await scene.press("n")
        assert scene.reader.commands == []
        await scene.press(key, "y")
        assert scene.reader.commands == [kind]
        assert isinstance(scene.app.screen, FlightScreen)


@pytest.mark.parametrize("key", ["h", "x", "r", "l"])
async def test_what_makes_things_safer_is_never_asked_about(key):
    async with cockpit(ENGAGED, simulated=False) as scene:
        await scene.press(key)
        assert len(scene.reader.commands) == 1


@pytest.mark.parametrize("key", ["k", "f6"])
async def test_kill_takes_a_second_other_key_and_escape_takes_it_back(key):
    async with cockpit() as scene:
        await scene.press(key, "escape", "y")
        await scene.press(key, "k", "f6", key, "n")
        assert scene.reader.commands == []
        await scene.press(key, "y")
        assert scene.reader.commands == [CommandKind.KILL]


async def test_a_kill_that_is_not_confirmed_runs_out_and_says_so(monkeypatch):
    monkeypatch.setattr("groundstation.tui.commanding._KILL_S", 0.05)
    async with cockpit() as scene:
        await scene.press("k")
        while isinstance(scene.app.screen, Confirm):
            await scene.pilot.pause(0.01)
        await scene.press("y")
        assert scene.reader.commands == []
        assert any("Not confirmed" in words for words in scene.notices())


@pytest.mark.parametrize("way", ["k", "question_mark"])
async def test_an_urgent_act_works_from_within_a_dialog_and_ends_it(way):
    async with cockpit() as scene:
        await scene.press(way)
        await scene.press("h")
        assert scene.reader.commands == [CommandKind.HOLD]
        assert isinstance(scene.app.screen, FlightScreen)


async def test_an_act_that_cannot_be_done_says_why_and_sends_nothing():
    async with cockpit(AIR) as scene:
        await scene.press("t")
        assert scene.reader.commands == []
        assert scene.notices() == ["Take off: it is in the air already."]


async def test_a_confirmed_act_is_looked_at_again():
    async with cockpit() as scene:
        await scene.press("k")
        scene.reader.shown = NOTHING
        await scene.see()
        await scene.press("k")
        assert scene.reader.commands == []


async def test_acts_are_greyed_by_check_action():
    async with cockpit(AIR) as scene:
        assert scene.app.check_action("act", ("engage",)) is True
        assert scene.app.check_action("act", ("takeoff",)) is None


async def test_the_palette_has_every_act_and_says_why_not():
    async with cockpit(AIR) as scene:
        commands = {
            command.title: command.help for command in scene.app.get_system_commands(scene.app.screen)
        }
        assert commands["Take off (t)"] == "Not now: it is in the air already."
        assert commands["Hold (h)"] == "Stop and stay there."
        hold = next(c for c in scene.app.get_system_commands(scene.app.screen) if c.title == "Hold (h)")
        hold.callback()
        assert scene.reader.commands == [CommandKind.HOLD]


async def test_a_click_on_the_footer_does_the_same_as_the_key():
    async with cockpit() as scene:
        column = scene.text("#keys").splitlines()[1].index("Hold")
        await scene.pilot.click("#keys", offset=(column, 1))
        assert scene.reader.commands == [CommandKind.HOLD]


async def test_a_refusal_is_shown_with_its_reason():
    async with cockpit(0.3) as scene:
        await scene.press("A")
        scene.reader.answers = [
            CommandAnswer(number=1, kind=CommandKind.ARM, ok=0, text=b"Arm refused: no GPS.")
        ]
        await scene.see()
        assert scene.notices() == ["Arm refused: no GPS."]
        assert "no GPS" in scene.text("#events")


async def test_quitting_on_the_ground_is_immediate():
    async with cockpit(0.3) as scene:
        await scene.press("q")
        assert scene.app.return_code == 0
        assert scene.reader.commands == []


async def test_quitting_in_the_air_asks_and_leaves_a_coupled_vehicle_holding():
    async with cockpit() as scene:
        await scene.press("q", "n")
        assert isinstance(scene.app.screen, FlightScreen)
        await scene.press("q", "y")
        assert scene.app.return_code == 0
        assert scene.reader.commands == [CommandKind.HOLD]


async def test_quitting_does_not_disturb_a_vehicle_that_lands():
    async with cockpit(AIR) as scene:
        scene.reader.shown.status.mode = FlightMode.LAND
        await scene.see()
        await scene.press("ctrl+c", "y")
        assert scene.app.return_code == 0
        assert scene.reader.commands == []


# The stick.


@pytest.mark.parametrize(
    ("key", "axis", "sign"),
    [("up", 0, 1), ("down", 0, -1), ("left", 1, 1), ("right", 1, -1), ("w", 2, 1), ("s", 2, -1)],
)
async def test_a_key_moves_the_stick_by_a_step_that_stays(key, axis, sign):
    async with cockpit() as scene:
        await scene.press(key, key)
        position, yaw, _, _ = scene.sent()
        expected = [0.0, 0.0, 0.0]
        expected[axis] = sign * 0.4 * 0.1
        assert position == pytest.approx(tuple(expected))
        assert yaw == 0.0


@pytest.mark.parametrize(("key", "sign"), [("a", 1), ("d", -1)])
async def test_keys_turn_the_stick(key, sign):
    async with cockpit() as scene:
        await scene.press(key)
        assert scene.sent()[1] == pytest.approx(sign * 0.2 * canned_run().settings.mapping.yaw_range)


@pytest.mark.parametrize("key", ["space", "0"])
async def test_one_key_centres_all_axes(key):
    async with cockpit() as scene:
        await scene.press("up", "left", "w", "a", key)
        assert scene.sent()[:3] == ((0.0, 0.0, 0.0), 0.0, 0)


async def test_the_stick_is_sent_all_the_time_also_while_it_rests_and_under_a_dialog():
    async with cockpit() as scene:
        scene.stick.sent.clear()
        await scene.pilot.pause(0.5)
        resting = len(scene.stick.sent)
        await scene.press("k")
        scene.stick.sent.clear()
        await scene.pilot.pause(0.5)
        # 30 a second is the least; the machine may be busy, so only a third of that is asked for here.
        assert resting >= 5
        assert len(scene.stick.sent) >= 5
        assert {sample[0] for sample in scene.stick.sent} == {(0.0, 0.0, 0.0)}


async def drag(scene: Cockpit, pad: int, cells_right: int, cells_up: int) -> Stick:
    """Press in the middle of a pad and drag by cells."""
    stick = scene.app._flight.query_one(Stick)
    area = pads(*stick.size)[pad]
    left, top = stick.gutter.top_left
    x, y = left + area.column + area.columns // 2, top + area.rows // 2
    await scene.pilot.mouse_down("#stick", offset=(x, y))
    await scene.pilot.hover("#stick", offset=(x + cells_right, y - cells_up))
    return stick


async def test_dragging_the_right_pad_moves_forward_and_sideways():
    async with cockpit() as scene:
        stick = await drag(scene, 1, 2, 1)
        assert scene.app.mouse_captured is stick
        (forward, left, up), yaw, _, _ = scene.sent()
        assert 0.01 < forward < 0.06
        assert -0.09 < left < -0.04
        assert (up, yaw) == (0.0, 0.0)


async def test_dragging_the_left_pad_climbs_and_turns():
    async with cockpit(size=(120, 40)) as scene:
        await drag(scene, 0, -3, -2)
        (forward, left, up), yaw, _, _ = scene.sent()
        assert (forward, left) == (0.0, 0.0)
        assert -0.1 < up < -0.03
        assert 0.2 < yaw < 0.9


async def test_dragging_past_the_edge_gives_the_full_deflection():
    async with cockpit() as scene:
        await drag(scene, 1, 0, -14)
        (forward, left, _), _, _, _ = scene.sent()
        assert math.hypot(forward, left) == pytest.approx(0.1, abs=0.002)
        assert forward < -0.095


async def centred(scene: Cockpit) -> None:
    await scene.pilot.pause()
    assert scene.app.hand.share == CENTRED
    assert scene.sent()[:2] == ((0.0, 0.0, 0.0), 0.0)
    assert scene.app.mouse_captured is None


async def test_letting_the_mouse_go_centres():
    async with cockpit() as scene:
        await drag(scene, 1, 3, 1)
        await scene.pilot.mouse_up("#map", offset=(3, 3))
        await centred(scene)


async def test_losing_the_mouse_centres():
    async with cockpit() as scene:
        await drag(scene, 1, 3, 1)
        scene.app.capture_mouse(None)
        await centred(scene)


async def test_looking_elsewhere_centres_what_mouse_and_keys_did():
    async with cockpit() as scene:
        await scene.press("w", "a")
        await drag(scene, 1, 3, 1)
        scene.app.post_message(events.AppBlur())
        await centred(scene)


@pytest.mark.parametrize("key", ["k", "question_mark", "ctrl+p"])
async def test_opening_a_dialog_centres(key):
    async with cockpit() as scene:
        await scene.press("w")
        await drag(scene, 1, 3, 1)
        await scene.press(key)
        await centred(scene)


async def test_moving_the_mouse_without_pressing_moves_nothing():
    async with cockpit() as scene:
        await scene.pilot.hover("#stick", offset=(26, 2))
        await centred(scene)


async def test_with_another_device_the_handle_is_drawn_and_nothing_is_sent():
    async with cockpit(stick=False) as scene:
        await scene.press("up", "w", "space")
        stick = scene.app._flight.query_one(Stick)
        await scene.pilot.mouse_down("#stick", offset=(26, 2))
        await scene.pilot.pause()
        assert str(stick.border_title).startswith("handle")
        assert scene.app.hand.share == CENTRED
        assert scene.app.mouse_captured is None
        assert scene.stick.sent == []


# What is shown.


async def test_the_essentials_are_on_the_smallest_screen():
    async with cockpit() as scene:
        status = scene.text("#status")
        for word in (
            "SIM",
            "OFFBOARD",
            "ARMED",
            "ENGAGED",
            "BAT 84 %",
            "LINK 0.02 s",
            "loss 0.4 %",
            "RTT 12 ms",
        ):
            assert word in status
        for word in ("SERVO 1000 Hz", "p99 0.12 ms", "lost 3 ticks", "On-screen stick"):
            assert word in status
        assert "ALT 2." in scene.text("#line")
        assert " N" in scene.text("#force")
        assert "Hold" in scene.text("#keys")


async def test_a_real_vehicle_is_called_real():
    async with cockpit(simulated=False) as scene:
        assert "■ REAL" in scene.text("#status")
        assert "SIM" not in scene.text("#status")


@pytest.mark.parametrize("simulated", [True, False])
async def test_essentials_stay_in_sight_under_every_dialog(simulated):
    async with cockpit(simulated=simulated) as scene:
        for key in ("k", "question_mark", "ctrl+p"):
            await scene.press(key)
            await scene.pilot.pause(0.3)
            parts = scene.app.screen.walk_children(Widget)
            top = scene.app.screen
            dialog = [
                top.find_widget(part).visible_region for part in parts if part.visible and part.region.area
            ]
            assert any(dialog)
            for essential in ("#status", "#line", "#banner", "#force", "#tracking", "#keys"):
                region = scene.app._flight.query_one(essential).region
                assert not any(region.overlaps(covering) for covering in dialog if covering), (key, essential)
            await scene.press("escape")


async def test_instruments_go_on_under_a_dialog():
    async with cockpit() as scene:
        await scene.press("question_mark")
        assert isinstance(scene.app.screen, Help)
        scene.reader.shown.status.rtt = 0.321
        await scene.see()
        assert "321 ms" in scene.text("#status")
        assert "321&#160;ms" in scene.app.export_screenshot()


async def test_old_data_is_called_old():
    async with cockpit() as scene:
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 3.0)
        await scene.see()
        assert scene.app._flight.query_one("#map").has_class("-stale")
        assert "3.0 s old" in str(scene.app._flight.query_one("#force").border_subtitle)
        assert "▲ 3.0 s old" in scene.text("#status")
        assert "■ ALARM  Link lost" in scene.text("#banner")
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t - 3.0)
        await scene.see()
        assert not scene.app._flight.query_one("#map").has_class("-stale")


async def test_a_dead_process_is_an_alarm_in_words():
    async with cockpit(pilot="ended", link="running") as scene:
        assert "■ ALARM  pilot has ended" in scene.text("#banner")


async def test_a_dead_pilot_does_not_look_engaged():
    async with cockpit() as scene:
        assert "ENGAGED" in scene.text("#status")
        before = scene.app._flight.query_one("#map", Instrument)._rows
        scene.reader.shown.pilot.t -= 1.0
        await scene.see()
        assert "ENGAGED" not in scene.text("#status")
        assert "■ NO PILOT" in scene.text("#status")
        tones = {tone for row in scene.app._flight.query_one("#map", Instrument)._rows for _, tone in row}
        assert Tone.HAND in {tone for row in before for _, tone in row}
        assert Tone.HAND not in tones


async def test_nothing_arrived_yet_is_drawn_at_every_size():
    async with cockpit(None) as scene:
        for size in ((80, 24), (120, 40), (200, 60)):
            await scene.pilot.resize_terminal(*size)
            await scene.see()
        assert "NO VEHICLE" in scene.text("#status")
        assert scene.app._flight.query_one("#map").border_subtitle == "no data yet"


def spoil(record: Record | None, value: float) -> None:
    """Put a value into every floating-point field but the time."""
    for name, kind, *_ in record._fields_ if record is not None else ():
        if kind is ctypes.c_double and name not in {"t", "heard_t"}:
            setattr(record, name, value)
        elif isinstance(getattr(record, name), ctypes.Array):
            getattr(record, name)[:] = [value] * len(getattr(record, name))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300, -1e300])
@pytest.mark.parametrize("size", [(80, 24), (200, 60)])
async def test_numbers_that_cannot_be_do_not_stop_the_screen(value, size):
    async with cockpit(size=size) as scene:
        shown = scene.reader.shown
        for record in (shown.handle, shown.setpoint, shown.pilot, shown.vehicle, shown.status, shown.servo):
            spoil(record, value)
        spoil(shown.device, value)
        await scene.see()
        assert "ENGAGED" in scene.text("#status")
        position, yaw, _, _ = scene.sent()
        assert math.isfinite(math.hypot(*position, yaw))


@pytest.mark.parametrize(
    ("size", "shown", "hidden"),
    [
        (
            (80, 24),
            {"line", "map", "stick", "force", "tracking", "events"},
            {"numbers", "velocity", "altitude", "curves"},
        ),
        ((120, 40), {"numbers", "velocity", "altitude"}, {"line", "curves", "system"}),
        ((200, 60), {"numbers", "velocity", "altitude", "curves", "system"}, {"line"}),
        ((60, 16), {"status", "banner", "map", "keys"}, {"curves"}),
    ],
)
async def test_the_layout_follows_the_terminal(size, shown, hidden):
    async with cockpit() as scene:
        await scene.pilot.resize_terminal(*size)
        await scene.pilot.pause()
        regions = {w.id: w.region for w in scene.app._flight.query(Instrument) if w.display and w.region.area}
        assert shown <= set(regions)
        assert not hidden & set(regions)
        screen = scene.app.screen.region
        assert all(region.overlaps(screen) for name, region in regions.items() if name in shown)


async def test_what_was_resized_is_drawn_for_its_new_size():
    async with cockpit(size=(200, 60)) as scene:
        await scene.pilot.resize_terminal(80, 24)
        await scene.pilot.pause()
        overview = scene.app._flight.query_one(Overview)
        assert overview.size.width < 50
        assert overview.render_line(0).cell_length == overview.size.width
        assert any("⠄" <= letter <= "⣿" for letter in scene.text("#map"))


async def test_only_rows_that_changed_are_painted():
    async with cockpit() as scene:
        status = scene.app._flight.query_one("#status", Instrument)
        painted: list[tuple] = []
        status.refresh = lambda *regions, **_: painted.append(regions)
        await scene.see()
        assert painted == []
        scene.reader.shown.status.rtt = 0.2
        await scene.see()
        assert [region.y for regions in painted for region in regions] == [1]


async def test_the_footer_greys_what_cannot_be_done():
    async with cockpit(AIR) as scene:
        keys = scene.app._flight.query_one("#keys", Instrument)
        faint = " ".join(text for text, tone in keys._rows[1] if tone is Tone.FAINT)
        assert "Take off" in faint
        assert "Release" in faint
        assert "Engage" not in faint


@pytest.mark.parametrize("seconds", [None, ENGAGED])
async def test_without_colour_severities_are_still_told(monkeypatch, seconds):
    monkeypatch.setenv("NO_COLOR", "1")
    async with cockpit(seconds, simulated=False) as scene:
        assert scene.app.no_color
        if seconds:
            scene.reader.shown.status.rtt, scene.reader.shown.status.loss = 0.4, 0.3
        await scene.see()
        picture = scene.app.export_screenshot().replace("&#160;", " ")
        assert "■ REAL" in picture
        assert "▲" in picture
        if seconds:
            assert "■loss 30.0 %" in picture
        await scene.press("question_mark")
        scene.app.export_screenshot()
