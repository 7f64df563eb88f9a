"""The screens beside the flight as a whole, compared with pictures somebody has looked at."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest
from canned_flight import START, CannedFlight, CannedReader, CannedStick, CannedSupervisor, canned_run
from test_tui_pages import read

from groundstation.training.director import Director
from groundstation.tui.app import FlightApp
from groundstation.tui.pages import PAGES
from sim.environment.world import World

SIZES = [(80, 24), (120, 40), (200, 60)]


class Disk:
    """A disk that is the same on every machine."""

    free = 42e9


class Flown:
    """A follower that has seen the canned flight land at its target."""

    def __init__(self, run) -> None:
        self.director = Director(run.mission, World(run.mission.obstacle), 0.2)
        flight = CannedFlight(run)
        while flight.elapsed < 60.0:
            flight.advance(0.1)
            shown = flight.snapshot()
            x, y, z, _ = shown.vehicle.position
            self.director.vehicle(shown.t, (x, y, z, 0.0), in_air=True, armed=True)
            error = shown.pilot.error
            self.director.controller((error[0], error[1], error[2]), tuple(shown.handle.force))
        self.director.vehicle(shown.t, (x, y, z, 0.0), in_air=False, armed=False)

    def look(self, view) -> None:
        """It has seen it all."""


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page(snap_compare, page, size, monkeypatch):
    monkeypatch.setattr("groundstation.tui.checks_here.os.access", lambda *_: True)
    monkeypatch.setattr("groundstation.tui.checks_here.shutil.disk_usage", lambda _: Disk())
    run = msgspec.structs.replace(canned_run(simulated=size[0] != 120), config="/home/me/groundstation.toml")
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
