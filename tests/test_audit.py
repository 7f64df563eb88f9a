"""The audit of dependencies by the reports that pip-audit gives; the looking up itself needs the network."""

import importlib.util
import json
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[1] / ".ci" / "audit.py"


@pytest.fixture
def judged():
    spec = importlib.util.spec_from_file_location("audit", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.judged


WELL = {"name": "numpy", "version": "2.3.0", "vulns": []}
BAD = {
    "name": "requests",
    "version": "2.19.0",
    "vulns": [{"id": "PYSEC-2018-28", "fix_versions": ["2.20.0"], "aliases": [], "description": "…"}],
}
UNKNOWN = {"name": "attrs", "skip_reason": "Dependency not found on PyPI and could not be audited"}


@pytest.mark.parametrize(
    ("dependencies", "code", "words"),
    [
        ([WELL], 0, "none of 1 packages"),
        ([WELL, UNKNOWN], 0, "1 could not be looked up"),
        ([WELL, BAD, UNKNOWN], 1, "requests 2.19.0: PYSEC-2018-28, mended in 2.20.0"),
        ([BAD | {"vulns": [BAD["vulns"][0] | {"fix_versions": []}]}], 1, "no version yet"),
        ([UNKNOWN], 0, "skipped"),
        ([], 0, "skipped"),
    ],
)
def test_a_known_vulnerability_fails_and_a_silent_database_does_not(judged, dependencies, code, words):
    told = judged(json.dumps({"dependencies": dependencies, "fixes": []}))
    assert told[0] == code
    assert any(words in line for line in told[1])


@pytest.mark.parametrize("text", ["", "no answer", "{}"])
def test_no_report_is_said(judged, text):
    assert judged(text) == (0, ["audit: skipped, the vulnerability database does not answer."])
