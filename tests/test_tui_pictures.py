"""The screen as a whole, compared with pictures somebody has looked at (`--snapshot-update` makes them anew)."""

from __future__ import annotations

from dataclasses import replace

import pytest
from canned_flight import (
    NOTHING,
    START,
    CannedFlight,
    CannedFollower,
    CannedReader,
    CannedStick,
    CannedSupervisor,
    canned_run,
)

from groundstation.tui.app import FlightApp
from groundstation.tui.theme import THEMES
from groundstation.tui.widgets.pages import NAMES

FLOWN_S = 15.0
SIZES = [(80, 24), (120, 40), (200, 60)]


def flown(app: FlightApp, reader: CannedReader, flight: CannedFlight):
    """Return what flies the canned flight through the app, to be run before the picture is taken."""

    async def fly(pilot) -> None:
        while flight.elapsed < FLOWN_S:
            flight.advance(0.25)
            reader.shown = flight.snapshot()
            app.pull()
        for _ in range(15):
            app.pull()
        await pilot.pause()

    return fly


def engaged(snap_compare, size, *keys: str, theme: str = "") -> bool:
    """Compare the picture of an engaged flight after keys have been pressed."""
    run = canned_run()
    flight = CannedFlight(run)
    reader = CannedReader(flight.snapshot())
    app = FlightApp(
        run, reader, CannedSupervisor(), CannedStick(), follower=CannedFollower(run), clock=lambda: START
    )
    fly = flown(app, reader, flight)

    async def fly_and_press(pilot) -> None:
        if theme:
            app.theme = theme
        await fly(pilot)
        for key in keys:
            await pilot.press(key)
        await pilot.pause()
        for _ in range(15):
            app.pull()
        await pilot.pause()

    return snap_compare(app, terminal_size=size, run_before=fly_and_press)


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_an_engaged_flight(snap_compare, size):
    assert engaged(snap_compare, size)


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("views", [1, 2, 3], ids=("side", "chase", "first-person"))
def test_each_view_of_the_flight(snap_compare, views, size):
    assert engaged(snap_compare, size, *["v"] * views)


@pytest.mark.parametrize("page", NAMES[1:])
def test_each_instrument_with_all_the_room_of_a_small_terminal(snap_compare, page):
    assert engaged(snap_compare, (80, 24), *["tab"] * NAMES.index(page))


@pytest.mark.parametrize("theme", [theme.name for theme in THEMES[1:]])
def test_the_other_themes(snap_compare, theme):
    assert engaged(snap_compare, (120, 40), theme=theme)


def test_a_flight_with_half_a_second_of_delay(snap_compare):
    run = canned_run()
    flight = CannedFlight(run, delay=0.5)
    reader = CannedReader(flight.snapshot())
    app = FlightApp(run, reader, CannedSupervisor(), CannedStick(), clock=lambda: START)
    assert snap_compare(app, terminal_size=(120, 40), run_before=flown(app, reader, flight))


def test_a_real_vehicle_with_a_question_and_a_lost_link(snap_compare):
    run = canned_run(simulated=False)
    flight = CannedFlight(canned_run())
    reader = CannedReader(flight.snapshot())
    app = FlightApp(run, reader, CannedSupervisor(), None, clock=lambda: START)
    fly = flown(app, reader, flight)

    async def lose_the_link(pilot) -> None:
        await fly(pilot)
        reader.shown = replace(reader.shown, t=reader.shown.t + 3.0)
        await pilot.press("k")
        for _ in range(15):
            app.pull()
        await pilot.pause()

    assert snap_compare(app, terminal_size=(80, 24), run_before=lose_the_link)


def test_before_anything_came(snap_compare):
    app = FlightApp(
        canned_run(), CannedReader(NOTHING), CannedSupervisor(), CannedStick(), clock=lambda: START
    )
    assert snap_compare(app, terminal_size=(80, 24))


def test_the_help(snap_compare):
    run = canned_run()
    flight = CannedFlight(run)
    flight.advance(FLOWN_S)
    app = FlightApp(
        run, CannedReader(flight.snapshot()), CannedSupervisor(), CannedStick(), clock=lambda: START
    )
    assert snap_compare(app, press=("question_mark",), terminal_size=(120, 40))
