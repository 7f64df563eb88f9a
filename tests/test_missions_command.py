"""`groundstation missions`: listed, shown, checked and made, as a user meets it."""

import json
import lzma
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from msgspec.structs import replace

from groundstation.cli import main
from groundstation.training.courses import GRADES, KINDS, USUAL_AIRFRAME, course
from groundstation.training.curriculum import lessons
from groundstation.training.flown import mission_from, thinned
from groundstation.training.mission import Fence, Mission, load_mission
from groundstation.training.options import fill
from groundstation.training.writing import toml_of
from sim.scenario import Wall

RECORDING = Path(__file__).with_name("recordings") / "flight_v1.rrd.xz"


def missions(*words) -> int:
    with pytest.raises(SystemExit) as left:
        main(["missions", *map(str, words)])
    return left.value.code or 0


def test_the_list_is_the_curriculum(capsys):
    assert missions("list") == 0
    out = capsys.readouterr().out
    order = [out.index(f"  {lesson.mission.name} ") for lesson in lessons()]
    assert order == sorted(order)
    assert "level 1: first steps" in out
    assert max(map(len, out.splitlines())) <= 80


def test_the_list_for_programs_has_all_of_it(capsys):
    assert missions("list", "--json") == 0
    listed = json.loads(capsys.readouterr().out)
    assert [each["name"] for each in listed] == [lesson.mission.name for lesson in lessons()]
    assert {"title", "teaches", "level", "skills", "needs", "judged", "par_s", "file"} <= listed[0].keys()


@pytest.mark.parametrize("name", [lesson.mission.name for lesson in lessons()])
def test_every_mission_is_shown_whole_in_eighty_columns(capsys, monkeypatch, name):
    monkeypatch.setenv("COLUMNS", "80")
    assert missions("show", name) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    assert "\x1b" not in out
    mission = next(lesson.mission for lesson in lessons() if lesson.mission.name == name)
    flat = " ".join(out.split())
    for words in (
        mission.title,
        mission.teaches,
        *mission.watch,
        *(point.say for point in mission.waypoints),
    ):
        assert words in flat
    assert f"--sim --mission {name}" in out
    assert any(0x2801 <= ord(letter) <= 0x28FF for letter in out)


def test_every_event_is_told_in_words(capsys, tmp_path):
    path = tmp_path / "trouble.toml"
    path.write_text(
        'schema = 1\nname = "trouble"\ntitle = "t"\nroute = [[3, 0, 2], [6, 0, 2]]\n'
        '[[event]]\nkind = "wind"\nvelocity = [0, -3, 0]\nturbulence = 0.5\n'
        '[[event]]\nkind = "gust"\nat_s = 4\nvelocity = [2, 0, 0]\nduration_s = 3\n'
        '[[event]]\nkind = "delay"\nleg = 1\nround_trip_s = 0.3\njitter_s = 0.05\n'
        '[[event]]\nkind = "loss"\nleg = 1\nat_s = 2\nshare = 0.25\n'
        '[[event]]\nkind = "link_loss"\nduration_s = 4\n'
        '[[event]]\nkind = "device_loss"\nduration_s = 5\n'
        '[[event]]\nkind = "battery"\nremaining = 0.15\n'
        '[[event]]\nkind = "gps_loss"\nduration_s = 6\n'
    )
    assert missions("show", path) == 0
    out = " ".join(capsys.readouterr().out.split())
    for words in (
        "from take-off on: wind 3.0 m/s from the north, turbulence 0.5 m/s",
        "4 s after take-off: gust 2.0 m/s from the west, 3 s long",
        "at point 1: round trip 300 ms ± 50 ms",
        "2 s after point 1: 25 % of frames lost",
        "link lost for 4 s",
        "haptic device lost for 5 s",
        "battery down to 15 %",
        "GPS lost for 6 s",
    ):
        assert words in out


def test_check_tells_right_wrong_and_unreadable_by_its_exit_code(capsys, tmp_path):
    right, wrong, broken = (tmp_path / f"{name}.toml" for name in ("right", "wrong", "broken"))
    start = 'schema = 1\nname = "m"\ntitle = "t"\n'
    right.write_text(f"{start}[target]\nposition = [3, 0, 2]\n")
    wrong.write_text(f'{start}needs = ["nothing"]\n[target]\nposition = [0, 0, 2]\n')
    broken.write_text("colour = 'red'")
    assert missions("check", right) == 0
    assert "right (m: 1 point, 0 obstacles, 0 events)" in capsys.readouterr().out
    assert missions("check", right, wrong) == 1
    out = capsys.readouterr().out
    assert "does nothing" in out
    assert "no mission 'nothing'" in out
    assert missions("check", wrong, broken) == 2
    assert "broken.toml" in capsys.readouterr().err
    wrong.write_text(f'{start}[vehicle]\nairframe = "zeppelin"\n')
    assert missions("check", wrong) == 2
    assert "zeppelin" in capsys.readouterr().err


def test_a_mission_may_need_one_that_is_checked_with_it(capsys, tmp_path):
    first, second = tmp_path / "first.toml", tmp_path / "second.toml"
    target = "[target]\nposition = [3, 0, 2]\n"
    first.write_text(f'schema = 1\nname = "first"\ntitle = "t"\n{target}')
    second.write_text(f'schema = 1\nname = "second"\ntitle = "t"\nneeds = ["first", "hover"]\n{target}')
    assert missions("check", second) == 1
    assert missions("check", second, first) == 0


def test_what_is_shipped_passes_its_own_check(capsys):
    assert missions("check", *(lesson.path for lesson in lessons())) == 0


def test_a_course_is_written_checked_and_not_overwritten(capsys, tmp_path):
    path = tmp_path / "wood.toml"
    asked = ("new", "--kind", "forest", "--seed", "7", "--level", "2", "--out", path)
    assert missions(*asked) == 0
    assert "right (wood:" in capsys.readouterr().err
    assert load_mission(path) == course("forest", 7, 2, name="wood")
    assert missions(*asked) == 2
    assert "--force" in capsys.readouterr().err
    assert missions(*asked[:-2], "--force", "--level", "3", "--out", path) == 0
    assert load_mission(path).level == 3


def test_a_course_goes_to_the_terminal_too(capsys, tmp_path):
    assert missions("new", "--kind", "gates", "--seed", "3", "--out", "-") == 0
    path = tmp_path / "printed.toml"
    path.write_text(capsys.readouterr().out)
    assert load_mission(path) == course("gates", 3, 3)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--kind", "gates", "--airframe", "zeppelin", "--out", "-"), "zeppelin"),
        (("--kind", "gates", "--name", "a/b", "--out", "-"), "a/b: is no name"),
        (("--kind", "gates", "--level", "6", "--out", "-"), "--level"),
        (("--kind", "gates", "--out", "/nowhere/m.toml"), "no folder"),
        (("--kind", "gates", "--from", "last", "--out", "-"), "not allowed with"),
        (("--out", "-"), "required"),
        (("--from", "last", "--logs", "/nowhere", "--out", "-"), "no recorded flights"),
        (("--from", "README.md", "--out", "-"), "not a Rerun recording"),
        (("--from", "last", "--tolerance", "nan", "--out", "-"), "--tolerance"),
    ],
)
def test_what_cannot_be_made_is_told_in_a_sentence(capsys, words, said):
    assert missions("new", *words) == 2
    err = capsys.readouterr().err
    assert said in err
    assert "Traceback" not in err


def test_the_options_name_what_courses_there_are():
    import argparse

    parser = argparse.ArgumentParser()
    fill(parser)
    for kind in KINDS:
        for level in GRADES:
            asked = parser.parse_args(["new", "--kind", kind, "--level", f"{level}", "--out", "-"])
            assert asked.airframe == USUAL_AIRFRAME


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("flown") / "flight.rrd"
    path.write_bytes(lzma.decompress(RECORDING.read_bytes()))
    return path


def test_a_recorded_flight_becomes_a_mission_in_the_same_world(recording, tmp_path, capsys):
    path = tmp_path / "again.toml"
    assert missions("new", "--from", recording, "--out", path) == 0
    assert "right (again:" in capsys.readouterr().err
    mission = load_mission(path)
    paper = next(lesson.mission for lesson in lessons() if lesson.mission.name == "paper")
    assert mission.obstacle == paper.obstacle
    assert mission.wind == paper.wind
    # The recording's vehicle is at 1, 2, 3 while the hand flies it.
    assert mission.way[-1] == (1.0, 2.0, 3.0)
    assert mission.needs == mission.event == ()


def test_the_floor_is_kept(recording, monkeypatch):
    high = Mission(schema=1, name="h", title="t", fence=Fence(floor=5.0, ceiling=9.0))
    monkeypatch.setattr("groundstation.review.flight.Flight.mission", high)
    assert all(z >= 5.0 for _, _, z in mission_from(recording, "m", 0.3).way)


lines = arrays(float, st.tuples(st.integers(2, 60), st.just(3)), elements=st.floats(-50, 50))


@given(lines, st.floats(0.05, 5.0))
def test_a_thinned_line_stays_within_its_tolerance_and_keeps_its_ends(way, tolerance):
    kept = thinned(way, tolerance)
    assert (kept[[0, -1]] == way[[0, -1]]).all()
    for point in way:
        assert min(_distance(point, a, b) for a, b in pairwise(kept)) <= tolerance + 1e-9


def test_a_straight_line_is_its_two_ends():
    way = np.linspace((0.0, 0.0, 2.0), (9.0, 3.0, 2.0), 500)
    assert len(thinned(way, 0.05)) == 2


def _distance(point, a, b) -> float:
    along = b - a
    square = along @ along
    share = min(max((point - a) @ along / square, 0.0), 1.0) if square else 0.0
    return math.dist(point, a + share * along)


@pytest.mark.parametrize(
    "mission", [lesson.mission for lesson in lessons()], ids=lambda mission: mission.name
)
def test_a_written_mission_loads_as_the_same(mission, tmp_path):
    path = tmp_path / "m.toml"
    path.write_text(toml_of(mission), encoding="utf-8")
    assert load_mission(path) == mission


COURSE = course("slalom", 0, 1)


# Control characters but line ends and tabs are refused: a terminal would obey them.
WORDS = st.characters(exclude_categories=("Cs", "Cc"), include_characters="\n\t")


@given(st.text(WORDS, max_size=40), st.text(WORDS, max_size=200))
def test_any_words_survive_writing(tmp_path_factory, title, teaches):
    wall = Wall("w", (50.0, 50.0), (50.0, 60.0), 2.0)
    whole = replace(COURSE, title=title, teaches=teaches, watch=(title, teaches), obstacle=(wall,))
    path = tmp_path_factory.mktemp("written") / "m.toml"
    path.write_text(toml_of(whole), encoding="utf-8", newline="")
    assert load_mission(path) == whole
