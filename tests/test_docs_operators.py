"""The people that docs/operators.md shows are those there are."""

import dataclasses
import re
from pathlib import Path

from sim.people import PEOPLE

DOC = Path(__file__).resolve().parents[1] / "docs" / "operators.md"


def test_the_table_shows_in_what_people_differ() -> None:
    text = DOC.read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)`: [^|]+ \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$", text, re.MULTILINE)
    shown = {name: tuple(map(float, values)) for name, *values in rows}
    differ = {
        field.name: tuple(getattr(PEOPLE[name], field.name) for name in ("novice", "average", "expert"))
        for field in dataclasses.fields(PEOPLE["average"])
    }
    assert shown == {name: values for name, values in differ.items() if len(set(values)) > 1}
