"""The docs show the weights and the numbers that scores are made with, and every measure."""

import re
from pathlib import Path

from groundstation.training.measures import Measures
from groundstation.training.score import ROOMY_M, UNHURRIED, YARDSTICKS, Yardstick, measure
from groundstation.training.smoothness import CUT_OFF_HZ, RATE_HZ, THRESHOLD
from groundstation.training.workload import SCALES

DOC = (Path(__file__).resolve().parents[1] / "docs" / "scoring.md").read_text(encoding="utf-8")
LIMITED = {"time", "precision", "landing", "clearance", "gates"}


def row(yard: Yardstick) -> str:
    def told(value: float) -> str:
        return f"{value:g} {yard.unit}" if yard.unit == "share" else measure(value, yard.unit)

    usual = "half the limit" if yard.part == "time" else told(yard.usual)
    poor = "limit" if yard.part in LIMITED else f"{yard.times:g}"
    by_way = "yes" if yard.flown else "no"
    return f"| {yard.part} | `{yard.measure}` | {yard.weight} | {usual} | {poor} | {told(yard.least)} | {by_way} |"


def test_the_table_is_that_of_the_code():
    rows = [line for line in DOC.splitlines() if re.match(r"\| \w+ \| `\w+` \| \d", line)]
    assert rows == [row(yard) for yard in YARDSTICKS]
    assert UNHURRIED == 0.5
    assert f"never beyond {ROOMY_M:g} m" in DOC


def test_every_measure_has_its_formula():
    shown = re.findall(r"^\| `(\w+)` \|", DOC, re.MULTILINE)
    assert shown == list(Measures.__struct_fields__)


def test_the_constants_of_the_spectral_arc_length_are_shown():
    assert f"up to 2π · {CUT_OFF_HZ:g} Hz at which V̂(ω) ≥ {THRESHOLD:g}" in DOC
    assert f"at an even {RATE_HZ:g} Hz" in DOC


def test_the_scales_of_the_workload_are_named():
    passage = DOC.partition("## How hard it was")[2]
    assert all(scale.name in passage for scale in SCALES)
