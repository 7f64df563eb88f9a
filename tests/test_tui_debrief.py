"""The debrief after a flight: its story by keys, the viewer at a moment, and how hard it was."""

from __future__ import annotations

from contextlib import asynccontextmanager

import msgspec
from canned_flight import START, CannedFlight, CannedReader, CannedStick, CannedSupervisor, canned_run
from cockpit import Cockpit
from test_tui_page_pictures import PAR, Flown

from groundstation.training.score import Score, score_of
from groundstation.training.workload import SCALES, Workload, moved
from groundstation.tui.app import FlightApp
from groundstation.tui.screens.workload import WorkloadForm


class Watched:
    """A viewer that only notes what it is asked to open."""

    def __init__(self) -> None:
        self.opened: list[float | None] = []

    def open(self, recording, at=None) -> None:
        """Note it."""
        self.opened.append(at)

    def failure(self) -> str:
        """It never fails."""
        return ""


@asynccontextmanager
async def debrief(size=(120, 40), best: Score | None = None, guidance: float = 0.0):
    """Show the debrief of the canned flight, landed."""
    run = msgspec.structs.replace(
        canned_run(), par=PAR, par_from="the expert operator on seed 0", guidance=guidance
    )
    flight, kept = CannedFlight(run), []
    flight.advance(0.3)
    reader, follower = CannedReader(flight.snapshot()), Flown(run)
    app = FlightApp(
        run, reader, CannedSupervisor(), CannedStick(), follower=follower, on_workload=kept.append,
        clock=lambda: START,
    )  # fmt: skip
    app.best = best
    app._viewer = Watched()
    async with app.run_test(size=size, notifications=True) as pilot:
        scene = Cockpit(app, pilot, reader, None)
        scene.follower, scene.kept, scene.watched = follower, kept, app._viewer
        await scene.press("f8")
        await scene.see()
        yield scene


def shown(scene, name: str) -> str:
    pane = scene.app.screen.query_one(name)
    return "\n".join(pane.render_line(y).text for y in range(pane.size.height))


async def test_it_tells_the_verdict_the_parts_and_what_they_were_held_against():
    async with debrief() as scene:
        outcome = shown(scene, "#outcome")
        score = scene.follower.judgement.score
        assert "▲ final error" in outcome
        assert f"{score.points:.1f} of 100" in outcome
        for part in score.parts:
            row = next(line for line in outcome.splitlines() if line.lstrip().startswith(f"{part.name} "))
            assert f"{part.points:4.1f} of {part.weight:4.1f}" in row
        assert "par 32 s" in outcome
        assert "the expert operator on seed 0" in outcome


async def test_what_was_flown_with_help_says_so():
    async with debrief(guidance=0.6) as scene:
        assert "60% of the force that leads to the way" in shown(scene, "#outcome")
    async with debrief() as scene:
        assert "guidance" not in shown(scene, "#outcome")


async def test_a_moment_is_chosen_and_looked_at_in_the_viewer():
    async with debrief() as scene:
        story = scene.follower.judgement.story
        first, second = shown(scene, "#lost").splitlines()[:2]
        assert story[0].words in first
        assert first.lstrip().startswith("▸")
        assert story[1].words in second
        await scene.press("down", "enter")
        await scene.press("v")
        assert scene.watched.opened == [story[1].t - scene.app._start, None]


async def test_it_is_compared_with_the_pilots_own_best():
    async with debrief() as scene:
        score = scene.follower.judgement.score
    mission = canned_run().mission
    better = score_of(mission, PAR, PAR)
    async with debrief(best=better) as scene:
        outcome = shown(scene, "#outcome")
        assert f"your best is {better.points:.1f}" in outcome
        lost = score.parts[0].points - better.parts[0].points
        assert f"{lost:+.1f}" in outcome
    worse = score_of(mission, msgspec.structs.replace(PAR, reached=0.0), PAR)
    async with debrief(best=worse) as scene:
        assert f"your best so far, by {score.points - worse.points:.1f}" in shown(scene, "#outcome")


async def test_pages_scroll_the_outcome_at_any_size():
    async with debrief((80, 24)) as scene:
        assert "mission" in shown(scene, "#outcome").splitlines()[0]
        await scene.press("pagedown")
        assert "mission" not in shown(scene, "#outcome").splitlines()[0]
        assert "▸" in shown(scene, "#lost").splitlines()[0]


async def test_how_hard_it_was_is_answered_in_a_few_keys():
    async with debrief((80, 24)) as scene:
        await scene.press("w")
        assert isinstance(scene.app.screen, WorkloadForm)
        await scene.press("right", "right", "down", "left", "up", "up", "pagedown", "enter")
        assert scene.kept == [Workload(mental=60, physical=45, frustration=70)]
        assert "workload 54 of 100" in scene.notices()[-1]


async def test_nobody_has_to_say_how_hard_it_was():
    async with debrief((80, 24)) as scene:
        await scene.press("w", "right", "escape")
        assert not isinstance(scene.app.screen, WorkloadForm)
        assert scene.kept == []


def test_the_raw_index_is_the_mean_of_six():
    workload = Workload(100, 0, 50, 25, 75, 50)
    assert workload.raw == 50.0
    assert len(SCALES) == 6
    assert workload.words.startswith("Workload (raw NASA-TLX) 50 of 100: mental 100, physical 0,")
    assert (moved(0, -1), moved(100, 3), moved(50, 1)) == (0, 100, 55)
