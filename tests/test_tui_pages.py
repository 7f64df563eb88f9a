"""The screens beside the flight: urgent keys on every one of them, what they show, and what they do."""

from __future__ import annotations

import io
import math
from dataclasses import replace

import msgspec
import pytest
from canned_flight import canned_run
from cockpit import AIR, ENGAGED, Cockpit, cockpit
from rich.console import Console
from textual.command import CommandPalette
from textual.widgets import Input

from groundstation.config import Buttons
from groundstation.messages import Autopilot, CommandKind, Event, FlightMode, Health, Parameter, Phase
from groundstation.tui.acts import URGENT
from groundstation.tui.app import FlightApp
from groundstation.tui.checks_computer import judged
from groundstation.tui.lines import Lines
from groundstation.tui.pages import PAGES
from groundstation.tui.screens.dialog import Confirm, Typed
from groundstation.tui.screens.flight import FlightScreen
from groundstation.tui.screens.help import Help, help_table
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import styles_of
from groundstation.vehicle.px4 import JUDGED
from sim.autopilot.parameters import SPECS

GROUND = 0.3


@pytest.fixture(autouse=True)
def logs(tmp_path, monkeypatch):
    """The canned run records into a folder below where the program was started."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "logs").mkdir()


# How to get to every screen, dialog and text field there is, and what the screen is then.
EVERYWHERE = {
    "flight": ((), FlightScreen),
    "help": (("f1",), Help),
    "palette": (("ctrl+p",), CommandPalette),
    "palette, words typed": (("ctrl+p", "h", "o"), CommandPalette),
    "kill asked": (("k",), Confirm),
    "quit asked": (("q",), Confirm),
    **{page.name: ((page.key,), Page) for page in PAGES},
    "log, filter typed": (("f12", "slash", "h", "l"), Page),
    "parameters, search typed": (("f9", "slash", "h", "l"), Page),
    "settings, value typed": (("f10", "end", "enter", "1"), Typed),
    "help over a page": (("f7", "f1"), Help),
}


def lines(scene: Cockpit) -> str:
    """Return what the list of the page shows."""
    shown = scene.app.screen.query_one(Lines)
    return "\n".join(shown.render_line(y).text.rstrip() for y in range(shown.size.height))


@pytest.fixture(autouse=True)
def _mains(monkeypatch):
    """Whatever the battery of the computer that tests: it is not what is judged here."""
    monkeypatch.setattr("groundstation.tui.checks_computer.supply", lambda _: judged(math.nan))


def read(scene: Cockpit, **changes: float) -> None:
    """Let the vehicle's parameters have been read."""
    values = {name: spec.default for name, spec in SPECS.items()} | changes
    shown = scene.reader.shown
    parameters = {
        name: Parameter(
            t=shown.t, name=name.encode(), value=value, whole=SPECS[name].integer, count=len(values)
        )
        for name, value in values.items()
    }
    scene.reader.shown = replace(shown, parameters=parameters)


@pytest.mark.parametrize("where", EVERYWHERE)
async def test_what_makes_things_safer_is_one_key_away_everywhere(where):
    keys, screen = EVERYWHERE[where]
    async with cockpit(ENGAGED, simulated=False) as scene:
        read(scene)
        await scene.see()
        for act in URGENT:
            scene.app.action_fly()
            await scene.press(*keys)
            assert isinstance(scene.app.screen, screen)
            scene.reader.commands.clear()
            await scene.press(act.everywhere)
            if act.kind is CommandKind.KILL:
                assert scene.reader.commands == []
                assert isinstance(scene.app.screen, Confirm)
                await scene.press("y")
            assert scene.reader.commands == [act.kind]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
async def test_the_letters_work_on_pages_too(page):
    async with cockpit(ENGAGED) as scene:
        read(scene)
        await scene.press(page.key)
        scene.reader.commands.clear()
        for act in URGENT:
            await scene.press(act.key, *(["y"] if act.kind is CommandKind.KILL else []))
        assert scene.reader.commands == [act.kind for act in URGENT]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
async def test_a_page_has_the_mark_of_a_real_vehicle_and_goes_back_by_two_keys(page):
    async with cockpit(simulated=False) as scene:
        await scene.press(page.key)
        await scene.see()
        assert page.name == scene.app.screen.NAME
        status = scene.app.screen.query_one("#status")
        assert "■ REAL" in status.render_line(0).text
        await scene.press(page.key)
        assert isinstance(scene.app.screen, FlightScreen)
        await scene.press(page.key, "escape")
        assert isinstance(scene.app.screen, FlightScreen)


async def test_from_page_to_page_the_flight_stays_below():
    async with cockpit() as scene:
        for page in PAGES:
            await scene.press(page.key)
            assert page.name == scene.app.screen.NAME
            assert len(scene.app.screen_stack) == 2


async def test_opening_a_page_lets_go_of_the_stick():
    async with cockpit() as scene:
        await scene.press("w", "up", "f12")
        assert scene.app.hand.share == (0.0, 0.0, 0.0, 0.0)


async def test_the_palette_has_every_page():
    async with cockpit() as scene:
        listed = {command.title: command for command in scene.app.get_system_commands(scene.app.screen)}
        for page in PAGES:
            listed[f"{page.label} ({page.shown})"].callback()
            await scene.pilot.pause()
            assert page.name == scene.app.screen.NAME
        listed["Back to the flight (Esc)"].callback()
        assert isinstance(scene.app.screen, FlightScreen)


async def test_a_click_on_a_pages_footer_does_the_same_as_the_key():
    async with cockpit() as scene:
        await scene.press("f12")
        await scene.see()
        urgent, pages = (scene.app.screen.query_one("#keys").render_line(y).text for y in (0, 1))
        await scene.pilot.click("#keys", offset=(urgent.index("Hold"), 0))
        assert scene.reader.commands == [CommandKind.HOLD]
        await scene.pilot.click("#keys", offset=(pages.index("Preflight"), 1))
        await scene.pilot.pause()
        assert scene.app.screen.NAME == "preflight"


# Preflight.


async def test_preflight_says_of_every_check_how_it_is():
    async with cockpit(GROUND, size=(120, 60)) as scene:
        read(scene)
        await scene.press("f7")
        await scene.see()
        shown = lines(scene)
        assert "✓ may be flown   ▲ 3 to know of" in shown
        for words in (
            "haptic device", "handle", "servo", "link", "round trip, loss", "vehicle", "health", "transmitter",
            "since boot", "position", "home", "battery", "fence", "speed limits", "mission",
            "recording", "this computer", *(each.name for each in JUDGED),
        ):  # fmt: skip
            assert words in shown
        assert "COM_RC_OVERRIDE = 1" in shown
        assert "→ set 3; until then use the mode switch" in shown


@pytest.mark.parametrize(
    ("spoil", "state", "remedy"),
    [
        (lambda s: setattr(s.device, "present", 0), "is not there", "plug it in"),
        (lambda s: setattr(s.device, "homed", 0), "is not homed", "move the handle"),
        (lambda s: setattr(s.handle, "device_t", s.t - 3.0), "last heard 3.0 s ago", "connected"),
        (lambda s: setattr(s.servo, "t", s.t - 9.0), "no word from the pilot", "log"),
        (lambda s: setattr(s.status, "connected", 0), "no vehicle at", "switch it on"),
        (lambda s: setattr(s.vehicle, "valid", 0), "does not trust it", "GPS"),
        (lambda s: setattr(s.vehicle, "t", s.t - 2.0), "2.0 s old", "estimator"),
        (lambda s: setattr(s.status, "battery", 0.1), "10 %", "charge"),
        (lambda s: s.parameters.pop("COM_OF_LOSS_T"), "not read", "wait"),
        (lambda s: setattr(s.status, "health", 126), "not calibrated: gyroscopes", "calibrate"),
        (lambda s: setattr(s.status, "loss", 0.2), "20.0 % of frames lost", "antennas"),
        (lambda s: setattr(s.status, "rtt", 0.9), "900 ms", "antennas"),
        (lambda s: setattr(s.status, "speed_limits", (0.0, 3.0, 1.5)), "own is 0", "parameters below"),
        (lambda s: setattr(s.parameters["MPC_XY_VEL_MAX"], "value", 0.0), "no speed around", "set the speed"),
        (lambda s: setattr(s.parameters["GF_ACTION"], "value", 4.0), "Terminate", "set Hold"),
    ],
)
async def test_what_is_wrong_is_red_with_what_to_do(spoil, state, remedy):
    async with cockpit(GROUND, size=(200, 60)) as scene:
        read(scene)
        spoil(scene.reader.shown)
        await scene.press("f7")
        await scene.see()
        red = next(line for line in lines(scene).splitlines() if line.startswith("■ ") and state in line)
        assert remedy in red
        assert "■ 1 to mend" in lines(scene)


def in_land(snapshot) -> None:
    snapshot.status.mode, snapshot.status.health = FlightMode.LAND, 63


@pytest.mark.parametrize(
    ("spoil", "state", "remedy"),
    [
        (lambda s: setattr(s.status, "firmware", b""), "PX4 of unknown version", "wait"),
        (
            lambda s: setattr(s.status, "autopilot", Autopilot.ARDUPILOT),
            "ArduPilot 1.15.4, untested",
            "props off",
        ),
        (lambda s: setattr(s.status, "health", 63), "cannot be armed yet", "log (F12)"),
        (in_land, "cannot be armed in LAND", "Hold first"),
        (lambda s: setattr(s.status, "firmware", b"1.13.3"), "PX4 1.13.3, older than 1.14", "update"),
        (lambda s: setattr(s.status, "health", 111), "local only, without GPS", "Return"),
        (lambda s: setattr(s.vehicle, "boot_t", 4.0), "4.0 s", "settle"),
        (lambda s: setattr(s.status, "rtt", math.nan), "not measured yet", "TIMESYNC"),
        (
            lambda s: setattr(s.status, "speed_limits", (2.0, 3.0, 0.7)),
            "2 m/s around, 0.7 up, down",
            "kept",
        ),
    ],
)
async def test_what_is_to_be_known_is_yellow_with_what_to_do(spoil, state, remedy):
    async with cockpit(GROUND, size=(200, 70)) as scene:
        read(scene)
        spoil(scene.reader.shown)
        await scene.press("f7")
        await scene.see()
        yellow = next(line for line in lines(scene).splitlines() if line.startswith("▲ ") and state in line)
        assert remedy in yellow


async def test_why_it_cannot_be_armed_is_said_in_its_own_words():
    async with cockpit(GROUND, size=(200, 70)) as scene:
        read(scene)
        scene.reader.shown.status.health = 63
        told = Event(t=scene.reader.shown.t - 5.0, severity=1, source=b"link", text=b"Vehicle: no GPS")
        for age, words in (
            (5.0, "cannot be armed yet: no GPS  → mend"),
            (70.0, "cannot be armed yet  → wait"),
        ):
            told.t = scene.reader.shown.t - age
            scene.reader.shown = replace(scene.reader.shown, events=(told,))
            await scene.press("f7") if age < 60.0 else None
            await scene.see()
            assert words in lines(scene)


@pytest.mark.parametrize(
    ("health", "words"),
    [(127, "▲ transmitter             not heard"), (255, "✓ transmitter             heard")],
)
async def test_a_real_vehicle_without_a_transmitter_is_cautioned_about(health, words):
    async with cockpit(GROUND, size=(120, 70), simulated=False) as scene:
        read(scene)
        scene.reader.shown.status.health = health
        await scene.press("f7")
        await scene.see()
        assert words in lines(scene)


async def test_health_that_was_not_told_is_not_taken_for_sensors_that_are_not_calibrated():
    async with cockpit(GROUND, size=(120, 70)) as scene:
        read(scene)
        scene.reader.shown.status.health = Health.TRANSMITTER
        await scene.press("f7")
        await scene.see()
        assert "■ health                  not told yet" in lines(scene)


async def test_speeds_that_were_not_read_are_red_and_say_so():
    async with cockpit(GROUND, size=(120, 70)) as scene:
        scene.reader.shown.status.speed_limits = (0.0, 0.0, 0.0)
        await scene.press("f7")
        await scene.see()
        assert "■ speed limits            the vehicle's own are not read" in lines(scene)


async def test_an_autopilot_that_is_not_known_is_red():
    async with cockpit(GROUND, size=(200, 60)) as scene:
        scene.reader.shown.status.autopilot = 0
        await scene.press("f7")
        await scene.see()
        assert "■ vehicle                 system 1, component 1, unknown autopilot" in lines(scene)


async def test_a_recording_that_cannot_be_written_is_red_and_a_full_disk_is_cautioned_about(
    tmp_path, monkeypatch
):
    async with cockpit(GROUND, size=(120, 60)) as scene:
        read(scene)
        await scene.press("f7")
        for folder, words in ((tmp_path / "none", "■ recording"), (tmp_path, "✓ recording")):
            scene.app._flight_run = msgspec.structs.replace(scene.app._flight_run, log=str(folder / "flight"))
            await scene.see()
            assert words in lines(scene)
        monkeypatch.setattr("groundstation.tui.checks_here.shutil.disk_usage", lambda _: Disk())
        await scene.see()
        assert "▲ recording" in lines(scene)
        assert "0.5 GB free: 25 min of flight" in lines(scene)
        Disk.free = 0.2e9
        await scene.see()
        assert "■ recording               0.2 GB free: 10 min" in lines(scene)


class Disk:
    free = 0.5e9


async def test_a_recorder_that_ended_is_red():
    async with cockpit(GROUND, size=(120, 60), recorder="ended") as scene:
        read(scene)
        await scene.press("f7")
        await scene.see()
        assert "■ recording" in lines(scene)


async def test_preflight_maps_the_devices_buttons_and_shows_those_that_are_held():
    async with cockpit(GROUND, size=(120, 60)) as scene:
        read(scene)
        scene.reader.shown.handle.buttons = 0b100001
        await scene.press("f7")
        await scene.see()
        shown = [line.split("◀") for line in lines(scene).splitlines()]
        assert [line[0].split()[0] for line in shown if len(line) == 2] == ["0", "5"]
        assert "without a button: enable, panic, hold, land, return home" in lines(scene)


async def test_preflight_comes_by_itself_where_something_is_red_and_only_once():
    async with cockpit(GROUND) as scene:
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 1.0)
        await scene.see()
        assert isinstance(scene.app.screen, FlightScreen)
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 10.0)
        await scene.see()
        assert scene.app.screen.NAME == "preflight"
        await scene.press("escape")
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 10.0)
        await scene.see()
        assert isinstance(scene.app.screen, FlightScreen)


# A real vehicle.


@pytest.mark.parametrize("typed", ["REAL", "1"])
async def test_the_first_engagement_of_a_real_vehicle_is_typed_the_next_is_not(typed):
    async with cockpit(AIR, simulated=False) as scene:
        await scene.press("e", "y", "enter")
        assert isinstance(scene.app.screen, Typed)
        assert scene.reader.commands == []
        scene.app.screen.query_one(Input).value = ""
        await scene.press(*typed, "enter")
        assert scene.reader.commands == [CommandKind.ENGAGE]
        assert isinstance(scene.app.screen, FlightScreen)
        await scene.press("e")
        assert scene.reader.commands == [CommandKind.ENGAGE] * 2


async def test_engaging_a_real_vehicle_can_be_left():
    async with cockpit(AIR, simulated=False) as scene:
        await scene.press("e", "escape")
        assert isinstance(scene.app.screen, FlightScreen)
        await scene.press("e")
        assert isinstance(scene.app.screen, Typed)
        assert scene.reader.commands == []


async def test_who_took_over_is_said():
    async with cockpit(simulated=False) as scene:
        shown = scene.reader.shown
        shown.status.mode = FlightMode.POSITION
        shown.pilot.phase = Phase.DISENGAGED
        shown.pilot.reason = b"the vehicle went to POSITION by itself or by another"
        await scene.see()
        assert "POSITION" in scene.text("#status")
        assert "RELEASED" in scene.text("#status")
        assert "by another" in scene.text("#banner")
        assert scene.reader.commands == []


# Log.


async def test_the_log_has_all_events_and_is_filtered_by_words_and_level():
    async with cockpit(size=(120, 40)) as scene:
        await scene.press("f12")
        await scene.see()
        assert len(lines(scene).split("accepted")) == 3
        assert "Engage refused" in lines(scene)
        await scene.press("v")
        assert "accepted" not in lines(scene)
        assert "Engage refused" in lines(scene)
        await scene.press("v")
        assert "Nothing" in lines(scene)
        await scene.press("v", "slash", *"guSt")
        await scene.see()
        assert "A gust begins" in lines(scene)
        assert "accepted" not in lines(scene)
        await scene.press("escape")
        await scene.see()
        assert "accepted" in lines(scene)


# Parameters.


async def test_parameters_are_read_searched_and_set_after_asking_back():
    async with cockpit(GROUND, size=(120, 40)) as scene:
        await scene.press("f9")
        assert scene.reader.commands == [CommandKind.PARAMETERS]
        assert "None read yet" in lines(scene)
        read(scene)
        await scene.see()
        assert "BAT_LOW_THR" in lines(scene)
        await scene.press("slash", *"obl", "enter")
        await scene.see()
        assert lines(scene).split() == ["▸", "COM_OBL_RC_ACT", "0", "Position;", *lines(scene).split()[4:]]
        await scene.press("enter")
        assert isinstance(scene.app.screen, Typed)
        await scene.press("backspace", *"5.5", "enter")
        assert isinstance(scene.app.screen, Typed)
        await scene.press("backspace", "backspace", "enter")
        assert isinstance(scene.app.screen, Confirm)
        assert scene.reader.commands == [CommandKind.PARAMETERS]
        await scene.press("y")
        assert scene.reader.commands[-1] is CommandKind.SET_PARAMETER
        assert scene.reader.amounts[-1] == ("COM_OBL_RC_ACT", 5.0)


async def test_in_the_air_no_parameter_is_set():
    async with cockpit(AIR) as scene:
        read(scene)
        await scene.press("f9", "enter")
        assert isinstance(scene.app.screen, Page)
        assert "on the ground" in scene.notices()[-1]
        assert CommandKind.SET_PARAMETER not in scene.reader.commands


# Debrief.


async def test_without_a_mission_the_debrief_says_so_and_where_the_recording_is():
    async with cockpit(size=(120, 40)) as scene:
        await scene.press("f8")
        await scene.see()
        assert "nothing to be judged by" in lines(scene)
        assert str(canned_run().recording) in lines(scene)


async def test_after_landing_the_debrief_comes_and_in_the_air_no_viewer_is_opened():
    async with cockpit(AIR) as scene:
        scene.app._milestones.page(scene.reader.shown, 0)
        scene.app.action_review()
        await scene.pilot.pause()
        assert "Land first" in scene.notices()[-1]
        scene.reader.shown.status.armed = scene.reader.shown.status.in_air = 0
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 1.0)
        await scene.see()
        assert scene.app.screen.NAME == "debrief"


async def test_a_viewer_that_cannot_show_it_says_why(tmp_path):
    async with cockpit(GROUND) as scene:
        scene.app._flight_run = msgspec.structs.replace(scene.app._flight_run, log=str(tmp_path / "none"))
        scene.app.action_review()
        for _ in range(600):
            await scene.pilot.pause(0.05)
            scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 0.6)
            scene.app.pull()
            if any("none.rrd" in words for words in scene.notices()):
                break
        else:
            pytest.fail(f"not told: {scene.notices()}")


async def test_the_hand_is_coupled_from_preflight_and_alarms_are_taken_as_known_there():
    async with cockpit(AIR) as scene:
        await scene.press("f7", "o", "e")
        assert scene.reader.commands == [CommandKind.ENGAGE]
        assert any("wrong" in words for words in scene.notices())
        await scene.press("escape", "l", "f7")
        scene.reader.shown.status.in_air = 0
        await scene.see()
        await scene.press("e")
        assert scene.notices()[-1] == "Engage: take off first."


def test_the_help_has_every_key_that_is_bound():
    console = Console(width=100, record=True, file=io.StringIO())
    console.print(help_table(Buttons(), styles_of("dark")))
    written = console.export_text().lower()
    for binding in (*FlightApp.BINDINGS, *FlightScreen.BINDINGS):
        if binding.action not in {"centre", "quit", "app.quit"} and "release(" not in binding.action:
            words = binding.description.removeprefix("Stick ").removesuffix(" cue on/off").lower()
            assert words in written, binding
    assert "release the hand." in written
