"""The school on the screen: before a flight and beside one."""

from __future__ import annotations

import argparse
import datetime
from dataclasses import replace
from pathlib import Path

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
from textual.widgets import OptionList, Static

from groundstation import connecting
from groundstation.progress.desk import Desk
from groundstation.progress.flown import Flown
from groundstation.progress.keeper import Keeper
from groundstation.progress.opening import store_in
from groundstation.progress.store import Store
from groundstation.training.curriculum import lessons
from groundstation.training.workload import Workload
from groundstation.tui.app import FlightApp
from groundstation.tui.school import School
from groundstation.tui.school_view import SchoolView
from groundstation.tui.wish import Wish

TODAY = datetime.date(2026, 11, 26)
SIZES = [(80, 24), (120, 40), (200, 60)]
# Without pars: they are measured anew from time to time, and pictures are to stay.
COURSE = lessons()
ANN = (
    ("spring", 12, 61.0, True), ("spring", 12, 88.0, True), ("hover", 12, 40.0, False), ("hover", 11, 72.0, True),
    ("axes", 9, 81.0, True), ("yaw", 9, 35.0, False), ("yaw", 9, 66.0, True), ("box", 3, 90.0, True),
    ("hover", 3, 86.0, True), ("landing", 1, 31.0, False),
)  # fmt: skip


@pytest.fixture
def desk(tmp_path) -> Desk:
    with Store(store_in(tmp_path)) as store:
        for hour, (mission, ago, points, passed) in enumerate(ANN):
            day = TODAY - datetime.timedelta(days=ago)
            started = f"{day}T{hour:02d}:00:00+00:00"
            store.add(Flown("Ann", mission, "d", started, passed=passed, points=points, duration_s=95.0))
        store.add(Flown("Bob", "spring", "d", f"{TODAY}T10:00:00+00:00", passed=True, points=77.0))
    return at(tmp_path)


def at(folder) -> Desk:
    return Desk(
        folder, [lesson._replace(path=Path("course") / lesson.path.name) for lesson in COURSE], lambda: TODAY
    )


def lines(app) -> list[str]:
    course = app.screen.query_one("#course", OptionList)
    return [str(course.get_option_at_index(n).prompt) for n in range(course.option_count)]


def standing(app) -> str:
    return str(app.screen.query_one("#standing", Static).render())


async def chosen(desk, *keys: str, pilot: str = "Ann") -> Wish | None:
    app = School(desk, pilot)
    async with app.run_test(size=(80, 24)) as session:
        await session.pause()
        await session.press(*keys)
        await session.pause()
    return app.return_value


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        (("enter",), Wish("landing", "Ann")),
        (("home", "enter"), Wish("spring", "Ann")),
        (("end", "enter"), Wish("check-ride", "Ann")),
        (("p", "enter"), Wish("hover", "Bob")),
        (("p", "p", "enter"), Wish("landing", "Ann")),
        (("a", "ctrl+u", *"Cid", "enter", "enter"), Wish("spring", "Cid")),
        (("a", "ctrl+u", *"bob", "enter", "enter"), Wish("hover", "Bob")),
        (("a", "ctrl+u", "enter", "escape", "enter"), Wish("landing", "Ann")),
        (("q",), None),
        (("escape",), None),
        (("ctrl+c",), None),
    ],
)
async def test_enter_flies_what_comes_next_and_anything_else_may_be_chosen(desk, keys, expected):
    assert await chosen(desk, *keys) == expected


async def test_who_has_never_flown_begins_with_the_first(tmp_path):
    assert await chosen(at(tmp_path), "enter", pilot="") == Wish("spring", "")
    assert list(tmp_path.iterdir()) == []


async def test_states_are_told_by_signs_and_words(desk):
    app = School(desk, "Ann")
    async with app.run_test(size=(80, 24)) as session:
        await session.pause()
        shown = {line.split()[1]: line for line in lines(app)}
        assert shown["spring"].startswith(" ✓ ")
        assert shown["landing"].startswith(" ▸ ")
        assert shown["slalom"].startswith(" · ")
        assert "needs eight" in shown["slalom"]
        assert shown["spring"].rstrip().endswith("due")
        assert "in 1 day" not in shown["hover"]
        assert "5 of 23 passed" in standing(app)
        assert "not passed yet: fly it again" in standing(app)


async def test_a_store_that_cannot_be_read_is_told_of_and_stops_nobody(tmp_path):
    store_in(tmp_path).mkdir()
    app = School(at(tmp_path), "Ann")
    async with app.run_test(size=(80, 24), notifications=True) as session:
        await session.pause()
        assert "progress cannot be kept there" in next(iter(app._notifications)).message
        await session.press("enter")
    assert app.return_value == Wish("spring", "Ann")


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_the_picture(snap_compare, desk, size):
    async def look(session) -> None:
        await session.pause()
        if size[0] == 120:
            await session.press("ctrl+t")
        await session.pause()

    assert snap_compare(School(desk, "Ann"), terminal_size=size, run_before=look)


# Beside a flight.


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_the_page(snap_compare, desk, size):
    app = flight_app(desk)

    async def look(session) -> None:
        await opened(app, session)
        await session.press("down")
        await session.pause()

    assert snap_compare(app, terminal_size=size, run_before=look)


def flight_app(desk, seconds=0.3, *, simulated=True) -> FlightApp:
    run = msgspec.structs.replace(canned_run(simulated=simulated), pilot="Ann")
    flight = CannedFlight(run)
    flight.advance(seconds)
    reader = CannedReader(flight.snapshot())
    follower = CannedFollower(run)
    return FlightApp(
        run,
        reader,
        CannedSupervisor(),
        CannedStick(),
        follower=follower,
        desk=desk,
        clock=lambda: START,
    )


async def opened(app, session) -> None:
    await session.press("ctrl+n")
    await session.pause()
    app.pull()
    await session.pause()


async def test_on_the_ground_another_mission_ends_the_run_and_says_which_comes_next(desk):
    app = flight_app(desk)
    async with app.run_test(size=(80, 24)) as session:
        await opened(app, session)
        assert isinstance(app.screen.query_one(SchoolView), SchoolView)
        await session.press("enter")
        await session.pause()
    assert (app.wish, app.return_code) == (Wish("landing", "Ann"), 0)


async def test_the_mission_that_waits_to_be_flown_is_gone_back_to(desk):
    app = flight_app(desk)
    async with app.run_test(size=(80, 24)) as session:
        await opened(app, session)
        app.fly_next(Wish(app.director.mission.name, "Ann"))
        await session.pause()
        assert app.screen is app._flight
        assert app.wish is None


@pytest.mark.parametrize(
    ("seconds", "simulated", "words"),
    [(17.0, True, "Land and disarm first."), (0.3, False, "A real vehicle is flown as it was connected")],
    ids=["in the air", "real"],
)
async def test_in_the_air_and_with_a_real_vehicle_nothing_is_left(desk, seconds, simulated, words):
    app = flight_app(desk, seconds, simulated=simulated)
    async with app.run_test(size=(80, 24), notifications=True) as session:
        await opened(app, session)
        await session.press("enter")
        await session.pause()
        assert any(words in each.message for each in app._notifications)
        assert app.wish is None
        assert app.is_running


async def test_a_flight_that_landed_is_kept_and_the_debrief_says_what_comes_next(tmp_path):
    run = msgspec.structs.replace(canned_run(), pilot="Ann", log=str(tmp_path / "flight"))
    flight, follower = CannedFlight(run), CannedFollower(run)
    reader = CannedReader(flight.snapshot())
    keeper = Keeper(run, follower.attempts)
    app = FlightApp(
        run,
        reader,
        CannedSupervisor(),
        CannedStick(),
        follower=follower,
        desk=at(tmp_path),
        keeper=keeper,
        on_workload=keeper.keep_workload,
        clock=lambda: START,
    )
    async with app.run_test(size=(120, 40)) as session:
        while flight.elapsed < 60.0:
            flight.advance(0.02)
            follower.look(flight.snapshot())
        flight.advance(0.02)
        shown = flight.snapshot()
        shown.status.armed = shown.status.in_air = 0
        shown.pilot.phase = 0
        reader.shown = replace(shown)
        app.pull()
        keeper.close()
        app.pull()
        assert app.advice.mission == "spring"
        app.take_workload(Workload(mental=80))
        await session.press("f8")
        await session.pause()
        await session.press("n")
        await session.pause()
    assert app.wish == Wish("spring", "Ann")
    with Store(store_in(tmp_path)) as store:
        (kept,) = store.flights("Ann")
        assert kept.mission == run.mission.name
        assert kept.points == follower.judgement.score.points
        assert kept.recording == "flight.rrd"
        assert store.workloads("Ann")[kept.number].mental == 80
        track = store.track(kept.number)
        assert len(track.points) == pytest.approx(kept.duration_s / track.every_s, abs=2)


async def test_the_best_flight_so_far_is_what_the_debrief_compares_with(tmp_path):
    run = msgspec.structs.replace(canned_run(), pilot="Ann", log=str(tmp_path / "flight"))
    follower = CannedFollower(run)
    flight = CannedFlight(run)
    assert at(tmp_path).best("Ann", run.mission, None) is None
    while flight.elapsed < 60.0:
        flight.advance(0.02)
        follower.look(flight.snapshot())
    flight.advance(0.02)
    shown = flight.snapshot()
    shown.status.armed = shown.status.in_air = 0
    follower.look(shown)
    keeper = Keeper(run, follower.attempts)
    assert keeper.close() == []
    judgement = follower.judgement
    best = at(tmp_path).best("Ann", run.mission, None)
    assert best == (judgement.score if judgement.passed else None)


def test_flights_of_nobody_are_kept_for_nobody(tmp_path):
    run = msgspec.structs.replace(canned_run(), pilot="", log=str(tmp_path / "flight"))
    follower = CannedFollower(run)
    follower.attempts.landed.append(follower.attempts.current)
    assert Keeper(run, follower.attempts).close() == []
    assert list(tmp_path.iterdir()) == []


def test_a_store_that_cannot_be_written_costs_a_sentence_and_no_flight(tmp_path):
    run = msgspec.structs.replace(canned_run(), pilot="Ann", log=str(tmp_path / "nowhere" / "flight"))
    follower = CannedFollower(run)
    follower.attempts.landed.append(follower.attempts.current)
    (words,) = Keeper(run, follower.attempts).close()
    assert "progress cannot be kept there" in words
    assert "progress import" in words


def test_where_a_flight_is_chosen_what_comes_next_stands_first(tmp_path):
    # What is to be repeated hangs on the day, and here nobody is told another than it is.
    now = datetime.datetime.now().astimezone().isoformat()
    with Store(store_in(tmp_path)) as store:
        store.add(Flown("Bob", "spring", "d", now, passed=True, points=77.0))
    asked = argparse.Namespace(pilot="Bob", logs=tmp_path)
    (name, title), *others = connecting._missions(asked)
    assert (name, title) == ("hover", "Hover: to a point, keep it there, land  ▸ next for you")
    assert others[0][0] == "spring"
    assert len(others) == len(COURSE) - 1
