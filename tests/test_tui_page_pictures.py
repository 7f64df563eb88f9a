"""The screens beside the flight as a whole, compared with pictures somebody has looked at."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest
from canned_flight import (
    START,
    CannedFlight,
    CannedFollower,
    CannedReader,
    CannedStick,
    CannedSupervisor,
    canned_run,
)
from test_tui_pages import read

from groundstation.training.measures import Measures
from groundstation.tui.app import FlightApp
from groundstation.tui.checks_computer import judged
from groundstation.tui.pages import PAGES

SIZES = [(80, 24), (120, 40), (200, 60)]


# Of the simulated expert, more or less.
PAR = Measures(
    time_s=32.0,
    reached=1.0,
    rms_error_m=0.35,
    path_error_m=0.15,
    final_error_m=0.04,
    least_clearance_m=0.6,
    smoothness=-3.2,
    disagreement_mps=0.01,
    effort_n=0.9,
)


class Disk:
    """A disk that is the same on every machine."""

    free = 42e9


class Flown(CannedFollower):
    """A follower that has seen the canned flight land at its target."""

    def __init__(self, run) -> None:
        super().__init__(run)
        flight = CannedFlight(run)
        while flight.elapsed < 60.0:
            flight.advance(0.02)
            super().look(flight.snapshot())
        flight.advance(0.02)
        shown = flight.snapshot()
        shown.status.armed = shown.status.in_air = 0
        super().look(shown)

    def look(self, view) -> None:
        """It has seen it all."""


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
# The school has pictures of its own, with pilots and a day of theirs: see test_tui_school.
@pytest.mark.parametrize(
    "page", [page for page in PAGES if page.name != "school"], ids=lambda page: page.name
)
def test_a_page(snap_compare, page, size, monkeypatch):
    monkeypatch.setattr("groundstation.tui.checks_here.os.access", lambda *_: True)
    monkeypatch.setattr("groundstation.tui.checks_here.shutil.disk_usage", lambda _: Disk())
    monkeypatch.setattr("groundstation.tui.checks_computer.supply", lambda _: judged(80.0))
    run = msgspec.structs.replace(
        canned_run(simulated=size[0] != 120),
        config="/home/me/groundstation.toml",
        par=PAR,
        par_from="the expert operator on seed 0",
    )
    flight = CannedFlight(run)
    flight.advance(0.3 if page.name != "log" else 15.0)
    reader = CannedReader(flight.snapshot())
    app = FlightApp(run, reader, CannedSupervisor(), CannedStick(), follower=Flown(run), clock=lambda: START)

    async def look(pilot) -> None:
        scene = type("Scene", (), {"reader": reader})
        read(scene, GF_ACTION=4)
        reader.shown = replace(reader.shown, t=reader.shown.t)
        await pilot.press(page.key)
        await pilot.pause()
        for _ in range(15):
            app.pull()
        if page.name in {"parameters", "settings"}:
            await pilot.press("down", "down")
        await pilot.pause()

    assert snap_compare(app, terminal_size=size, run_before=look)
