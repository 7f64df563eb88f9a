"""The flight screen's keys and instruments: views and zoom, pages, themes, alarms, attitude, mission, ages."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pytest
from canned_flight import CannedFlight, CannedFollower, canned_run
from cockpit import cockpit
from textual.geometry import Region

from groundstation.tui.canvas import Canvas
from groundstation.tui.rows import width_of
from groundstation.tui.screens.flight import FlightScreen
from groundstation.tui.tape import heading_tape
from groundstation.tui.theme import PALETTES, THEMES, Tone, styles_of
from groundstation.tui.widgets.attitude import draw_horizon
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.widgets.mission import Mission
from groundstation.tui.widgets.overview import Overview, Sight
from groundstation.tui.widgets.pages import NAMES


def seen(scene) -> set[str]:
    """Return the instruments that have a place on the screen."""
    screen = scene.app._flight
    return {
        instrument.id
        for instrument in screen.query(Instrument)
        if instrument.region.area and all(node.display for node in instrument.ancestors_with_self[:-2])
    }


def title(scene, selector: str) -> str:
    return str(scene.app._flight.query_one(selector, Instrument).border_title)


async def test_one_key_goes_round_the_views_and_the_title_says_which():
    async with cockpit(size=(120, 40)) as scene:
        drawn = []
        for sight in (*list(Sight)[1:], Sight.TOP):
            await scene.press("v")
            await scene.see()
            assert title(scene, "#map").startswith(sight.value)
            drawn.append(scene.text("#map"))
        assert len(set(drawn)) == len(Sight)


@pytest.mark.parametrize("views", range(len(Sight)))
async def test_plus_and_minus_zoom_every_view_and_come_back(views):
    async with cockpit(size=(120, 40)) as scene:
        await scene.press(*["v"] * views)
        await scene.press("plus")
        near = scene.text("#map")
        await scene.press("plus", "plus")
        nearer = scene.text("#map")
        assert nearer != near
        await scene.press("minus", "minus")
        assert scene.text("#map") == near


async def test_zooming_follows_and_g_shows_the_whole_mission_again():
    async with cockpit(size=(120, 40)) as scene:
        whole = scene.text("#map")
        overview = scene.app._flight.query_one(Overview)
        await scene.press("plus")
        assert overview.follows
        assert "follows" in scene.note("#map")
        await scene.press("g")
        assert not overview.follows
        assert scene.text("#map") == whole


async def test_tab_gives_the_body_to_one_instrument_after_the_other_essentials_stay():
    async with cockpit() as scene:
        essentials = {"status", "line", "banner", "pages", "keys"}
        everything = seen(scene)
        assert essentials | {"map", "stick", "force", "tracking"} <= everything
        for name in NAMES[1:]:
            await scene.press("tab")
            await scene.see()
            assert seen(scene) - {"altitude"} == essentials | {name}
            assert scene.tones("#pages")[name.upper()] == Tone.CHIP_HAND
            assert scene.text(f"#{name}").strip()
            assert scene.app._flight.query_one(f"#{name}").region.height == 17
        await scene.press("tab")
        assert seen(scene) == everything
        await scene.press("shift+tab")
        assert "events" in seen(scene)
        assert "map" not in seen(scene)


async def test_a_click_on_its_name_chooses_an_instrument():
    async with cockpit() as scene:
        await scene.see()
        column = scene.text("#pages").index("curves")
        await scene.pilot.click("#pages", offset=(column + 1, 0))
        await scene.see()
        assert "curves" in seen(scene)
        assert "map" not in seen(scene)


async def test_a_key_that_comes_before_the_instruments_are_there_is_not_lost_and_ends_nothing():
    """The application hears `tab` itself: on a slow machine before its screen is composed."""
    async with cockpit() as scene:
        early = FlightScreen(None)
        early.action_page(1)
        scene.app.push_screen(early)
        await scene.pilot.pause()
        assert early.has_class("-solo")
        assert early.query_one("#map").has_class("-here")
        assert not early.query_one("#curves").has_class("-here")


async def test_acts_are_one_key_away_on_every_page():
    async with cockpit() as scene:
        for name in NAMES:
            scene.app._flight.show_page(name)
            await scene.press("h")
        assert len(scene.reader.commands) == len(NAMES)


async def test_the_stick_still_takes_the_mouse_when_it_has_all_the_room():
    async with cockpit() as scene:
        scene.app._flight.show_page("stick")
        await scene.see()
        await scene.pilot.mouse_down("#stick", offset=(60, 3))
        await scene.pilot.pause()
        assert scene.app.hand.share[0] > 0.3
        await scene.pilot.mouse_up("#stick", offset=(60, 3))


async def test_a_key_goes_round_the_themes_and_what_is_painted_changes():
    async with cockpit() as scene:
        grounds = []
        for theme in (*THEMES[1:], THEMES[0]):
            await scene.press("ctrl+t")
            await scene.see()
            assert scene.app.theme == theme.name
            line = scene.app._flight.query_one("#map", Instrument).render_line(1)
            grounds.append(str(next(iter(line)).style.bgcolor))
        assert len(set(grounds)) == len(THEMES)


@pytest.mark.parametrize("theme", PALETTES)
def test_every_tone_can_be_read_on_its_ground(theme):
    def luminance(color: tuple[int, int, int]) -> float:
        linear = [v / 3294.6 if v <= 10 else ((v / 255 + 0.055) / 1.055) ** 2.4 for v in color]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    def contrast(one: str, other: str) -> float:
        lights = sorted(
            luminance(tuple(int(color[i : i + 2], 16) for i in (1, 3, 5))) for color in (one, other)
        )
        return (lights[1] + 0.05) / (lights[0] + 0.05)

    # WCAG 2.2: 4.5 for words, 3 for drawing and what only stands behind.
    drawing = {Tone.GRID, Tone.FAINT, Tone.FADED, Tone.OBSTACLE, Tone.EARTH, Tone.TRAIL}
    least = 7.0 if theme == "contrast" else 4.5
    for tone, style in styles_of(theme).items():
        ground = style.bgcolor.name if style.bgcolor else PALETTES[theme]["ink"]
        if tone not in drawing and tone is not Tone.CHIP:
            assert contrast(style.color.name, ground) >= least, tone.name


async def test_an_alarm_is_told_rung_seen_and_gone():
    async with cockpit(link="ended", pilot="running") as scene:
        said = "link has ended: nothing reaches the vehicle; its own failsafe holds it."
        assert scene.text("#banner").rstrip() == f" ■  {said}"
        await scene.press("o")
        await scene.see()
        assert scene.text("#banner").rstrip() == f" ■ seen  {said}"
        scene.app._supervisor.words = {"link": "running"}
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 0.15)
        await scene.see()
        assert scene.text("#banner").startswith(" › ")


async def test_the_bell_rings_once_for_an_alarm_and_not_while_it_is_muted(monkeypatch):
    async with cockpit() as scene:
        rung = []
        monkeypatch.setattr(scene.app, "bell", lambda: rung.append(scene.reader.shown.t))

        async def later(seconds: float, **states: str) -> None:
            scene.app._supervisor.words = states
            scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + seconds)
            await scene.see()

        await later(0.15, recorder="ended")
        assert len(rung) == 1
        await later(0.15, recorder="ended")
        assert len(rung) == 1
        await scene.press("b")
        await later(5.0, recorder="ended")
        assert len(rung) == 1
        assert "b bell off" in scene.text("#banner")
        await scene.press("b")
        await later(5.0, recorder="ended")
        assert len(rung) == 2


async def test_alarms_are_listed_above_the_events_with_their_priority_in_words():
    async with cockpit(size=(120, 40), recorder="ended") as scene:
        lines = scene.text("#events").splitlines()
        assert lines[0].startswith(" ■ ALARM  recorder has ended")
        assert any("Engaged" in line for line in lines)


async def test_every_instrument_says_how_old_its_data_is_and_what_is_stale_looks_it():
    async with cockpit(size=(200, 60)) as scene:
        dated = ("#map", "#altitude", "#attitude", "#numbers", "#stick", "#force", "#tracking", "#velocity")
        assert all(title(scene, name).endswith("<0.1 s") for name in dated)
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 0.35)
        await scene.see()
        assert "· 0.30 s" in title(scene, "#map")
        scene.reader.shown = replace(scene.reader.shown, t=scene.reader.shown.t + 2.0)
        await scene.see()
        for name in dated:
            instrument = scene.app._flight.query_one(name, Instrument)
            assert instrument.has_class("-stale")
            assert "old" in scene.note(name)
            assert all(segment.style.italic for segment in instrument.render_line(1) if segment.text.strip())


async def test_the_system_says_the_age_of_every_record():
    async with cockpit(size=(200, 60)) as scene:
        words = scene.text("#system")
        for name in ("handle", "state", "setpoint", "pilot", "link", "servo", "device"):
            assert f"{name} 0." in words
        assert "30 Hz, as often as is asked for" in words


def test_the_tape_has_where_it_heads_in_its_middle():
    words = "".join(text for text, _ in heading_tape(0.0, 41))
    assert width_of(heading_tape(0.0, 41)) == 41
    assert words[17:24].strip() == "▸090°◂"
    assert "060" in words[:17]
    assert "120" in words[24:]
    assert "–" in "".join(text for text, _ in heading_tape(math.nan, 41))


def test_the_horizon_sinks_when_the_nose_rises_and_leans_against_the_roll():
    def earth(roll: float, pitch: float) -> tuple[int, int]:
        canvas = Canvas(40, 12)
        draw_horizon(canvas, roll, pitch)
        rows = canvas._tones == Tone.EARTH
        return int(rows[:, :20].sum()), int(rows[:, 20:].sum())

    level, up, right = earth(0.0, 0.0), earth(0.0, 0.2), earth(0.5, 0.0)
    assert sum(up) < sum(level)
    # Rolled to the right, the right side is nearer to the ground.
    assert right[1] > right[0]


async def test_the_mission_shows_stage_way_clock_and_score():
    run = canned_run()
    async with cockpit(size=(200, 60)) as scene:
        follower = CannedFollower(run)
        flight = CannedFlight(run)
        while flight.elapsed < 17.0:
            flight.advance(0.1)
            follower.look(flight.snapshot())
        scene.app._follower = follower
        await scene.see()
        words = scene.text("#mission")
        assert "on the way" in words
        assert "of 5 points" in words
        assert "of 01:30 min" in words
        assert "of 100 points so far" in words
        assert [part.name for part in scene.app.score.parts if part.name not in words] == []
        rows = Mission().draw(scene.app._latest, 60, 20)
        assert any("comes when the target is held" in "".join(text for text, _ in row) for row in rows)


async def test_a_late_mission_clock_is_marked_not_only_coloured():
    run = canned_run()
    async with cockpit(size=(200, 60)) as scene:
        follower = CannedFollower(run)
        follower.director.figures.duration = run.mission.criteria.time_limit_s + 5.0
        scene.app._follower = follower
        follower.look = lambda view: None
        await scene.see()
        assert "▲ 01:35" in scene.text("#mission")


async def test_a_terminal_that_is_slow_is_said_to_be():
    async with cockpit(size=(200, 60)) as scene:
        scene.app._clock = itertools.count(2000.0, 0.1).__next__
        for _ in range(120):
            scene.app.pull()
        await scene.pilot.pause()
        assert "10 Hz, ▲ the terminal is slow" in scene.text("#system")


async def test_what_is_composed_line_by_line_is_what_textual_composes_of_the_whole():
    """Border, ground, styles of a stale instrument and of one that is not: none may differ."""
    async with cockpit(size=(200, 60)) as scene:
        flight = CannedFlight(canned_run())
        for seconds in (17.0, 0.1, 0.1, 3.0):
            flight.advance(seconds)
            scene.reader.shown = flight.snapshot()
            if seconds == 3.0:
                scene.reader.shown.vehicle.t -= 5.0
            await scene.see()
            for instrument in scene.app._flight._instruments:
                if instrument.outer_size and instrument in scene.app._flight._compositor.visible_widgets:
                    whole = instrument.outer_size.region
                    ours, theirs = instrument.render_lines(whole), instrument.render_part(whole)
                    assert [strip.simplify() for strip in ours] == [strip.simplify() for strip in theirs]


async def test_nothing_is_composed_again_that_has_not_changed():
    async with cockpit(size=(200, 60)) as scene:
        overview = scene.app._flight.query_one(Overview)
        whole = overview.outer_size.region
        before = overview.render_lines(whole)
        overview.refresh(Region(0, 3, 5, 1))
        after = overview.render_lines(whole)
        assert [y for y in range(whole.height) if before[y] is not after[y]] == [4]
