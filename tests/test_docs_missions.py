"""docs/missions.md is true: every key of the format with its default, and examples that can be flown."""

import math
import re
import textwrap
import tomllib
from pathlib import Path

import msgspec
import pytest

from groundstation.training import events, mission
from groundstation.training.checking import faults, misplaced
from groundstation.training.courses import GRADES, KINDS
from groundstation.training.curriculum import lessons
from groundstation.training.mission import load_mission
from sim import scenario
from sim.airframe import load_airframe

DOC = (Path(__file__).resolve().parents[1] / "docs" / "missions.md").read_text(encoding="utf-8")
REQUIRED, NONE = "*required*", "–"
# Where a struct's keys stand: heading, and the kind in the first column where the table has several.
PLACES = [
    (mission.Mission, "The file", ""),
    (mission.Waypoint, "`[[route]]`", ""),
    (mission.Target, "`[target]`", ""),
    (mission.Landing, "`[landing]`", ""),
    (mission.Criteria, "`[criteria]`", ""),
    (mission.Fence, "`[fence]`", ""),
    (scenario.VehicleChoice, "`[vehicle]`", ""),
    (scenario.Pad, "`[[pad]]`", ""),
    (scenario.Gust, "`[wind]`", ""),
    *((kind, "`[[obstacle]]`", kind.__struct_config__.tag) for kind in scenario.Obstacle.__args__),
    *((kind, "`[[event]]`", kind.__struct_config__.tag) for kind in events.Event.__args__),
    (scenario.Charge, "`[battery]`", "battery"),
    (scenario.Contact, "`[battery]`", "contact"),
    (scenario.EstimateChoice, "`[battery]`", "estimate"),
]
# These are said once for all kinds.
SHARED = {"`[[obstacle]]`": {"name"}, "`[[event]]`": {"at_s", "leg"}}


def section(heading: str) -> str:
    return re.search(rf"^### {re.escape(heading)}.*?(?=^##|\Z)", DOC, re.MULTILINE | re.DOTALL)[0]


def rows(heading: str, kind: str) -> dict[str, str]:
    """Return the keys that a section's tables show, with their defaults as written."""
    shown, current = {}, ""
    for line in section(heading).splitlines():
        cells = [cell.strip().strip("`") for cell in line.strip("|").split("|")]
        if not line.startswith("|") or set(line) <= set("|- "):
            continue
        if kind:
            current = cells[0] or current
            if current == kind:
                shown[cells[1]] = cells[2]
        else:
            shown[cells[0]] = cells[1]
    return shown


@pytest.mark.parametrize(
    ("struct", "heading", "kind"), PLACES, ids=lambda each: getattr(each, "__name__", str(each))
)
def test_every_key_is_there_with_its_default(struct, heading, kind):
    shown = rows(heading, kind)
    for field in msgspec.structs.fields(struct):
        if field.encode_name in SHARED.get(heading, ()):
            assert f"`{field.encode_name}`" in section(heading)
            continue
        if struct is mission.Mission and field.encode_name not in shown:
            assert re.search(rf"^### .*\[{field.encode_name}\]", DOC, re.MULTILINE), field.encode_name
            continue
        told = shown[field.encode_name]
        if field.required:
            assert told == REQUIRED
        elif field.default is None:
            assert told == NONE
        else:
            default = list(field.default) if isinstance(field.default, tuple) else field.default
            assert tomllib.loads(f"it = {told}")["it"] == default, field.encode_name


def test_the_wind_has_its_keys():
    shown = rows("`[wind]`", "")
    assert tomllib.loads(f"it = {shown['mean']}")["it"] == list(scenario.Wind().mean)
    assert tomllib.loads(f"it = {shown['model']}")["it"] == scenario.Turbulence().model
    assert tomllib.loads(f"it = {shown['intensity']}")["it"] == scenario.Wind().turbulence.intensity
    assert f"without it {scenario.Turbulence().intensity}" in section("`[wind]`")


@pytest.mark.parametrize(
    ("struct", "heading", "kind"), PLACES, ids=lambda each: getattr(each, "__name__", str(each))
)
def test_no_key_is_told_of_that_there_is_not(struct, heading, kind):
    if struct is not scenario.Gust:  # its table shares a heading with the wind's and the turbulence's
        known = {field.encode_name for field in msgspec.structs.fields(struct)}
        assert rows(heading, kind).keys() <= known | {"key"}


def test_every_example_loads_and_can_be_flown(tmp_path):
    blocks = re.findall(r"^( *)```toml\n(.*?)^ *```", DOC, re.MULTILINE | re.DOTALL)
    assert blocks
    known = {lesson.mission.name: lesson.mission for lesson in lessons()}
    for _, block in blocks:
        path = tmp_path / "example.toml"
        path.write_text(textwrap.dedent(block), encoding="utf-8")
        example = load_mission(path)
        assert faults(example, load_airframe(example.vehicle.airframe)) == []
        assert misplaced(example, known) == []


def test_the_school_is_the_one_there_is():
    table = re.search(r"\| level \| exercises \|.*?\n\n", DOC, re.DOTALL)[0]
    told = [
        re.findall(r"`([\w-]+)`", line)
        for line in table.splitlines()
        if line.startswith(("| 1", "| 2", "| 3", "| 4", "| 5"))
    ]
    there = [
        [each.mission.name for each in lessons() if each.mission.judged and each.mission.level == level]
        for level in range(1, 6)
    ]
    assert told == there


def test_skills_kinds_and_grades_are_those_there_are():
    skills = re.search(r"^\| `skills`.*$", DOC, re.MULTILINE)[0]
    assert set(re.findall(r"`(\w+)`", skills)) - {"skills"} == set(
        msgspec.inspect.type_info(mission.Skill).values
    )
    assert all(f"| `{kind}` |" in DOC for kind in KINDS)
    for level, grade in GRADES.items():
        row = f"| {level} | {grade.spare:g} m | {grade.things} | {math.degrees(grade.turn):.0f}° |"
        shown = next(line for line in DOC.splitlines() if line.replace("1.0 m", "1 m").startswith(row))
        assert f"{grade.wind:g} m/s" in shown if grade.wind else "none" in shown
