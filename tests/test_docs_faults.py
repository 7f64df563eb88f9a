"""The table of faults in the documents names tests that are there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TESTS = ROOT / "tests"
# What the table must have a row for, by words of its first column.
FAULTS = (
    "frozen", "killed", "unplugged, hand released", "link cut", "delay, jitter", "NaN", "serial port", "wall clock",
    "disk full", "viewer absent", "takes the vehicle", "changes a parameter", "is denied",
    "reboots in flight", "sleeps", "stranger",
)  # fmt: skip


def rows() -> list[list[str]]:
    text = (ROOT / "docs" / "operating.md").read_text()
    section = text.partition("## Faults that end well")[2].partition("\n## ")[0]
    return [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in section.splitlines()
        if line[:1] == "|"
    ][2:]


def named_in(name: str) -> set[str]:
    tree = ast.parse((TESTS / name).read_text())
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_has_its_row(fault):
    assert [row for row in rows() if fault in row[0]]


def test_every_test_that_the_table_names_is_there():
    for fault, _, tried in rows():
        found = re.findall(r"`(test_\w+\.py)`: ((?:`test_\w+`(?:, )?)+)", tried)
        assert found, fault
        assert len(re.findall(r"`test_\w+`", tried)) == sum(each.count("`test_") for _, each in found), fault
        for file, names in found:
            assert set(re.findall(r"`(test_\w+)`", names)) <= named_in(file), fault
