"""Mission files and settings: what is right loads, whatever is wrong gets one sentence with file and key."""

import math
import re
from pathlib import Path

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from groundstation.config import ConfigError, Settings, load_settings
from groundstation.training.events import Delay
from groundstation.training.mission import MISSIONS_FOLDER, MissionError, Waypoint, find_mission, load_mission
from sim.scenario import Scenario, ScenarioError, load_scenario

MINIMAL = 'schema = 1\nname = "m"\ntitle = "t"\n'


def written(folder: Path, text: str) -> Path:
    path = folder / "mission.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("path", sorted(MISSIONS_FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_every_mission_that_comes_with_the_program_is_right(path):
    mission = load_mission(path)
    assert mission.name == path.stem
    assert load_scenario(path).obstacle == mission.obstacle


WORLD = """
[vehicle]
model = "rigid_body"
[wind]
mean = [2.0, -1.0, 0.0]
[wind.turbulence]
model = "von_karman"
intensity = 0.8
[contact]
restitution = 0.3
crash_speed = 2.0
[battery]
remaining = 0.35
drain = 2.0
[estimate]
quality = "gps"
[[obstacle]]
shape = "wall"
name = "wall"
from = [3.0, -2.0]
to = [3.0, 2.0]
height = 2.5
[[obstacle]]
shape = "gate"
name = "first gate"
center = [6.0, 0.0, 2.0]
yaw_deg = 30.0
width = 1.6
height = 1.4
sill = false
[[pad]]
name = "roof"
position = [9.0, 1.0, 3.0]
radius = 0.6
"""


def test_every_table_of_the_world_reaches_the_simulator(tmp_path):
    path = written(tmp_path, MINIMAL + WORLD)
    mission, scenario = load_mission(path), load_scenario(path)
    for field in ("vehicle", "wind", "obstacle", "pad", "contact", "battery", "estimate"):
        assert getattr(scenario, field) == getattr(mission, field) != getattr(Scenario(), field)
    wall, gate = scenario.obstacle
    assert (wall.start, wall.end, wall.thickness) == ((3.0, -2.0), (3.0, 2.0), 0.1)
    assert not gate.sill


def test_missions_are_found_by_name_and_by_path():
    assert find_mission("paper") == MISSIONS_FOLDER / "paper.toml"
    assert find_mission("some/where.toml") == Path("some/where.toml")
    with pytest.raises(MissionError, match="hover"):
        find_mission("nonsense")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "schema"),
        ("schema = 2\nname = 'm'\ntitle = 't'", "schema"),
        (MINIMAL + "colour = 'red'", "colour"),
        (MINIMAL + "takeoff_altitude_m = 0.1", "takeoff_altitude_m"),
        (MINIMAL + "takeoff_altitude_m = 'high'", "takeoff_altitude_m"),
        (MINIMAL + "takeoff_altitude_m = nan", "not a finite number"),
        (MINIMAL + "route = [[1.0, 2.0]]", "route"),
        (MINIMAL + "route = [[1.0, 2.0, inf]]", "route[0][2]"),
        (MINIMAL + "[target]\nradius = 1.0", "position"),
        (MINIMAL + "[[obstacle]]\nshape = 'pyramid'\nname = 'p'", "obstacle[0].shape"),
        (MINIMAL + "[[obstacle]]\nshape='sphere'\nname='s'\ncenter=[0,0,1]\nradius=-1", "obstacle[0].radius"),
        (MINIMAL + "[[obstacle]]\nshape='sphere'\nname='s'\ncenter=[0,0,1]\nradius=1\n" * 2, "two are named"),
        (MINIMAL + "[[obstacle]]\nshape='wall'\nname='w'\nfrom=[0,1]\nto=[0,1]\nheight=2", "same point"),
        (
            MINIMAL + "[[obstacle]]\nshape='wall'\nname='w'\nfrom=[0,1,0]\nto=[0,2,0]\nheight=2",
            "obstacle[0].from",
        ),
        (
            MINIMAL + "[[obstacle]]\nshape='gate'\nname='g'\ncenter=[5,0,1]\nwidth=2\nheight=3",
            "below the ground",
        ),
        (MINIMAL + "[[obstacle]]\nshape='gate'\nname='g'\ncenter=[5,0,2]\nwidth=2\nheight=3\nsill=1", "sill"),
        (MINIMAL + "[[pad]]\nname='p'\nposition=[0,0,0]\n" * 2, "two are named"),
        (MINIMAL + "[wind]\nmean=[90.0,0.0,0.0]", "wind.mean[0]"),
        (MINIMAL + "[wind.turbulence]\nmodel='storm'", "wind.turbulence.model"),
        (MINIMAL + "[wind.turbulence]\nintensity=-1.0", "wind.turbulence.intensity"),
        (MINIMAL + "[battery]\nremaining=0.0", "battery.remaining"),
        (MINIMAL + "[estimate]\nquality='perfect'", "estimate.quality"),
        (MINIMAL + "[contact]\nrestitution=1.5", "contact.restitution"),
        ("not toml at all", "not valid TOML"),
        ("x = " + "[" * 5000, "not valid TOML"),
    ],
)
def test_what_is_wrong_is_told_in_one_sentence_with_file_and_key(tmp_path, text, words):
    path = written(tmp_path, text)
    with pytest.raises(MissionError) as caught:
        load_mission(path)
    message = str(caught.value)
    assert words in message
    assert message.startswith(str(path))
    assert message.endswith(".")
    assert "Traceback" not in message


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"\x00" * 10])
def test_bytes_that_are_not_text_are_told(tmp_path, content):
    path = tmp_path / "mission.toml"
    path.write_bytes(content)
    with pytest.raises(MissionError, match=r"TOML"):
        load_mission(path)


def test_a_missing_file_and_a_folder_are_told(tmp_path):
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(MissionError, match="cannot be read"):
            load_mission(path)


scalars = st.one_of(
    st.none().map(lambda _: ""),
    st.booleans(),
    st.integers(-(2**62), 2**62),
    st.floats(),
    st.text(max_size=20),
)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=12,
)
KEYS = [
    "schema",
    "name",
    "title",
    "route",
    "target",
    "criteria",
    "vehicle",
    "wind",
    "obstacle",
    "pad",
    "contact",
    "battery",
    "estimate",
    "takeoff_altitude_m",
]


@given(st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=8), values, max_size=8))
def test_any_toml_loads_or_is_told(tmp_path_factory, tables):
    path = tmp_path_factory.mktemp("missions") / "any.toml"
    path.write_text(tomli_w.dumps(tables), encoding="utf-8")
    for load, error in ((load_mission, MissionError), (load_scenario, ScenarioError)):
        try:
            load(path)
        except error as caught:
            assert str(path) in str(caught)


@given(st.binary(max_size=200))
def test_any_bytes_load_or_are_told(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("missions") / "any.toml"
    path.write_bytes(content)
    with pytest.raises(MissionError):
        load_mission(path)


def test_settings_come_from_the_file_that_was_asked_for(tmp_path):
    path = tmp_path / "groundstation.toml"
    path.write_text('[mapping]\nframe = "world"\n[control]\nk1 = [0.5, 0.5, 0.5, 0.5]\n')
    settings = load_settings(path)
    assert settings.mapping.frame == "world"
    assert settings.control.k1 == (0.5, 0.5, 0.5, 0.5)
    assert settings.limits == Settings().limits


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[mapping]\nfram = 'world'", "fram"),
        ("[control]\nk1 = [1.0, 1.0, 1.0, -1.0]", "control.k1[3]"),
        ("[control]\nk1 = [1.0, 1.0, 1.0]", "control.k1"),
        ("[safety]\nsetpoint_stale_s = 0.2", "safety.setpoint_stale_s"),
        ("[limits]\njerk = inf", "limits.jerk"),
        ("[", "not valid TOML"),
    ],
)
def test_wrong_settings_are_told(tmp_path, text, words):
    path = tmp_path / "groundstation.toml"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_settings(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


def test_no_settings_file_means_defaults(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert load_settings(None) == Settings()
    with pytest.raises(ConfigError, match="cannot be read"):
        load_settings(tmp_path / "none.toml")


def test_defaults_are_within_their_own_bounds():
    safety = Settings().safety
    assert safety.setpoint_stale_s <= 0.15
    assert safety.force_stale_s <= safety.state_stale_s
    assert all(math.isfinite(gain) and gain > 0 for gain in Settings().control.k1)


SCHOOLED = """
[[route]]
at = [1, 2, 3]
hold_s = 2
yaw_deg = 90
say = "Look north."
[landing]
pad = "north"
[[pad]]
name = "north"
position = [4, 0, 0]
[[event]]
kind = "delay"
leg = 1
round_trip_s = 0.3
"""


def test_a_route_takes_points_and_whole_waypoints_and_leads_to_the_pad(tmp_path):
    mission = load_mission(written(tmp_path, MINIMAL + SCHOOLED))
    assert mission.waypoints == (Waypoint((1, 2, 3), hold_s=2, yaw_deg=90, say="Look north."),)
    assert mission.way == ((1, 2, 3), (4, 0, 2))
    assert mission.event == (Delay(leg=1, round_trip_s=0.3),)
    bare = load_mission(written(tmp_path, MINIMAL + "route = [[1, 2, 3]]\n"))
    assert bare.waypoints == (Waypoint((1, 2, 3)),)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (SCHOOLED.replace('pad = "north"', 'pad = "south"'), "no [[pad]] named 'south'"),
        (SCHOOLED.replace("leg = 1", "leg = 2"), "leg = 2 never comes"),
        (SCHOOLED.replace('"delay"', '"magic"'), "kind"),
    ],
)
def test_what_a_mission_names_must_exist(tmp_path, wrong, said):
    with pytest.raises(MissionError, match=re.escape(said)):
        load_mission(written(tmp_path, MINIMAL + wrong))
