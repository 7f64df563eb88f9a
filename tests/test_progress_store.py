"""The store of what pilots flew: kept whole, by several programs at once, whatever befalls the file."""

from __future__ import annotations

import sqlite3
import subprocess
import sys

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.errors import InputError
from groundstation.progress.company import flown_by
from groundstation.progress.flown import Flown
from groundstation.progress.opening import FILE, store_in
from groundstation.progress.store import Store
from groundstation.progress.tables import STEPS, VERSION
from groundstation.training.measures import Track
from groundstation.training.mission import find_mission, load_mission
from groundstation.training.reference import digest_of
from groundstation.training.workload import Workload

TRACK = Track(0.2, ((0.0, 0.0, 0.5), (0.1, -0.2, 1.0)))


def flown(
    pilot: str = "Ann", hour: int = 10, *, mission: str = "hover", points: float | None = 80.0, **other
) -> Flown:
    return Flown(pilot, mission, "d1", f"2026-11-26T{hour:02d}:00:00.000+01:00", points=points, **other)


@pytest.fixture
def path(tmp_path):
    return store_in(tmp_path)


def test_what_is_kept_comes_back(path):
    one = flown(
        seed=7,
        simulated=False,
        device="falcon:1",
        duration_s=31.5,
        passed=True,
        parts={"time": 0.9},
        measures={"time_s": 31.5, "collisions": 2.0},
        recording="a.rrd",
        program="0.1.0",
    )
    with Store(path) as store:
        number = store.add(one, TRACK)
        store.set_workload(number, Workload(10, 20, 30, 40, 50, 60))
    with Store(path) as store:
        (kept,) = store.flights()
        assert (kept.number, kept.collisions) == (number, 2)
        assert Flown(**{**_fields(kept), "number": 0}) == one
        assert store.track(number) == TRACK
        assert store.track(number + 1) is None
        assert store.workloads("ann") == {number: Workload(10, 20, 30, 40, 50, 60)}
        assert store.workloads("Ann")[number].raw == 35.0
        assert store.words == ""


def _fields(each: Flown):
    return {name: getattr(each, name) for name in Flown.__struct_fields__}


def test_a_flight_is_kept_once_and_as_it_was_first(path):
    with Store(path) as store:
        first = store.add(flown(points=80.0), TRACK)
        assert store.knows(flown())
        assert store.add(flown("ANN", points=10.0)) == first
        assert [each.points for each in store.flights()] == [80.0]
        assert store.pilots() == ["Ann"]
        assert store.add(flown(attempt=2)) != first
        assert not store.knows(flown(attempt=3))


def test_flights_come_in_the_order_of_their_moments(path):
    early = Flown("Ann", "hover", "d", "2026-10-25T02:30:00+02:00")
    late = Flown("Ann", "hover", "d", "2026-10-25T02:10:00+01:00")
    with Store(path) as store:
        store.add(late)
        store.add(early)
        assert [each.started for each in store.flights()] == [early.started, late.started]


def test_the_best_is_the_best_that_was_passed(path):
    with Store(path) as store:
        assert store.best("Ann", "hover") is None
        store.add(flown(hour=1, points=95.0, passed=False))
        store.add(flown(hour=2, points=70.0, passed=True))
        store.add(flown(hour=3, points=75.0, passed=True))
        store.add(flown("Bob", hour=4, points=99.0, passed=True))
        store.add(flown(hour=5, points=None))
        assert store.best("Ann", "hover").points == 75.0
        assert store.best("Ann", "hover", "d1").points == 75.0
        assert store.best("Ann", "hover", "another") is None


def test_who_is_forgotten_is_forgotten_to_the_last_byte(path, tmp_path):
    with Store(path) as store:
        store.set_workload(store.add(flown("Annabel Lee", recording="secret.rrd"), TRACK), Workload())
        store.add(flown("Bob"))
        assert store.forget("annabel lee") == 1
        assert store.forget("nobody") == 0
        assert store.pilots() == ["Bob"]
        assert store.track(1) is None
        assert store.workloads("Annabel Lee") == {}
    left = b"".join(file.read_bytes() for file in tmp_path.iterdir())
    assert b"Annabel" not in left
    assert b"secret.rrd" not in left
    assert b"Bob" in left


def test_a_form_for_a_flight_that_is_not_kept_is_refused(path):
    with Store(path) as store, pytest.raises(InputError, match="progress cannot be kept"):
        store.set_workload(99, Workload())


@pytest.mark.parametrize("damage", [b"this is no database, as anybody can see" * 20, "torn"])
def test_a_damaged_file_is_moved_aside_with_a_word_and_nothing_is_deleted(path, tmp_path, damage):
    with Store(path) as store:
        for hour in range(20):
            store.add(flown(hour=hour, parts={f"part{n}": 0.5 for n in range(100)}), TRACK)
    whole = path.read_bytes()
    path.write_bytes(damage if isinstance(damage, bytes) else whole[:8192] + b"\xff" * (len(whole) - 8192))
    damaged = path.read_bytes()
    with Store(path) as store:
        assert "was damaged and is now progress.sqlite.damaged-" in store.words
        assert "progress import" in store.words
        assert store.flights() == []
        store.add(flown())
    (aside,) = tmp_path.glob(f"{FILE}.damaged-*[0-9]")
    assert aside.read_bytes() == damaged
    with Store(path) as store:
        assert store.words == ""
        assert len(store.flights()) == 1


def test_a_file_of_a_later_version_is_left_alone(path):
    with Store(path) as store:
        store.add(flown())
    with sqlite3.connect(path) as later:
        later.execute(f"PRAGMA user_version = {VERSION + 1}")
    later.close()
    with pytest.raises(InputError, match="later version of this program"):
        Store(path)
    assert path.exists()


def test_an_empty_file_becomes_todays(path):
    path.touch()
    with Store(path) as store:
        store.add(flown())
        assert store.words == ""


def test_where_nothing_can_be_written_one_sentence_says_so(tmp_path):
    file = tmp_path / "file"
    file.touch()
    for wrong in (tmp_path / "no such folder", file):
        with pytest.raises(InputError, match="progress cannot be kept there"):
            Store(store_in(wrong))
    (tmp_path / FILE).mkdir()
    with pytest.raises(InputError, match="progress cannot be kept there"):
        Store(store_in(tmp_path))


def test_a_disk_that_takes_nothing_more_costs_a_sentence_and_what_was_kept_stays(path):
    with Store(path) as store:
        store.add(flown())
        store._connection.execute("PRAGMA query_only = ON")
        with pytest.raises(InputError, match="progress cannot be kept there"):
            store.add(flown(hour=11))
        assert len(store.flights()) == 1


_WRITER = """
import sys
from pathlib import Path
from groundstation.progress.company import flown_by
from groundstation.progress.flown import Flown
from groundstation.progress.store import Store
pilot, path = sys.argv[1], Path(sys.argv[2])
sys.stdin.readline()
for n in range(60):
    with Store(path) as store:
        store.add(Flown(pilot, "hover", "d", f"2026-11-26T10:00:{n % 60:02d}+00:00", points=float(n)))
        assert not store.words
"""


@pytest.mark.parametrize("begun", [False, True], ids=["new file", "file there"])
def test_two_programs_write_at_once_and_nothing_is_lost(path, begun):
    if begun:
        Store(path).__exit__(None, None, None)
    command = [sys.executable, "-c", _WRITER]
    names = ["Ann", "Bob"]
    both = [
        subprocess.Popen([*command, name, str(path)], stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        for name in names
    ]
    for each in both:
        each.stdin.write(b"go\n")
        each.stdin.flush()
    for each in both:
        _, said = each.communicate(timeout=60)
        assert (each.returncode, said) == (0, b"")
    with Store(path) as store:
        for name in names:
            assert sorted(each.points for each in store.flights(name)) == [float(n) for n in range(60)]


_names = st.text(st.characters(codec="utf-8", exclude_characters="\0"), min_size=1, max_size=20)
_shares = st.dictionaries(st.text(max_size=8), st.floats(0.0, 1.0), max_size=4)


@settings(max_examples=40)
@given(
    st.lists(
        st.builds(
            Flown,
            pilot=_names,
            mission=_names,
            digest=st.text(max_size=8),
            started=st.datetimes().map(lambda when: when.isoformat() + "+00:00"),
            attempt=st.integers(1, 9),
            seed=st.integers(-(2**60), 2**60),
            simulated=st.booleans(),
            duration_s=st.floats(0.0, 1e6),
            passed=st.none() | st.booleans(),
            points=st.none() | st.floats(0.0, 100.0),
            parts=_shares,
            measures=_shares,
        ),
        max_size=6,
        unique_by=lambda each: (each.pilot.casefold(), each.started, each.attempt),
    )
)
def test_whatever_was_flown_comes_back(flights):
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder, Store(store_in(Path(folder))) as store:
        numbers = [store.add(each) for each in flights]
        assert numbers == [store.add(each) for each in flights]
        kept = {each.number: each for each in store.flights()}
        assert len(kept) == len(flights)
        for number, each in zip(numbers, flights, strict=True):
            assert {**_fields(kept[number]), "number": 0} == _fields(each)


@pytest.mark.parametrize("wrong", ["damaged", "not to be opened"])
def test_what_is_wrong_with_the_store_is_told_and_no_reason_not_to_fly(path, tmp_path, wrong):
    if wrong == "damaged":
        path.write_bytes(b"no database" * 50)
    else:
        path.mkdir()
    told: list[str] = []
    mission = load_mission(find_mission("hover"))
    assert flown_by("Ann", mission, tmp_path, told.append) == ([], None)
    assert len(told) == 1
    assert flown_by("", mission, tmp_path, told.append) == ([], None)


def test_the_ghost_is_the_best_flight_of_the_mission_as_it_is(path, tmp_path):
    mission = load_mission(find_mission("hover"))
    told: list[str] = []
    with Store(path) as store:
        store.add(flown(points=90.0, passed=True), Track(0.2))
        now = msgspec.structs.replace(flown(hour=11, points=80.0, passed=True), digest=digest_of(mission))
        store.add(now, TRACK)
    flights, best = flown_by("ann", mission, tmp_path, told.append)
    assert (len(flights), best, told) == (2, TRACK, [])


def test_a_file_of_the_first_version_keeps_its_flights(path):
    """What was kept before an instructor's doing was known counts as flown alone."""
    first = sqlite3.connect(path, isolation_level=None)
    first.executescript(STEPS[0])
    first.execute("INSERT INTO pilots VALUES (1, 'Ann')")
    first.execute(
        "INSERT INTO flights VALUES (1, 1, '2026-11-01T10:00:00+00:00', 1, 'hover', 'd1', 0, 1, '', 20.0, 1, 80.0,"
        " '{}', '{}', 'a.rrd', '0.1.0')"
    )
    first.execute("PRAGMA user_version = 1")
    first.close()
    with Store(path) as store:
        (kept,) = store.flights()
        assert (kept.pilot, kept.points, kept.instructed) == ("Ann", 80.0, False)
        store.add(flown(instructed=True, points=99.0, passed=True))
        assert [each.instructed for each in store.flights()] == [False, True]
        assert store.best("Ann", "hover").points == 80.0
