"""The same flight measured live and from its recording: the same numbers, over real processes."""

import json
from pathlib import Path

import msgspec
import pytest
from test_flight import headless

from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]


def test_live_and_from_its_log_a_flight_has_the_same_numbers(tmp_path):
    done = headless("--sim", "--headless", "--mission", "paper", "--json", "--logs", str(tmp_path))
    assert done.returncode == 0, done.stderr
    live = json.loads(done.stdout)
    path = Path(live["logs"]["rrd"])
    outcome = outcome_of(Flight(path))
    assert live["measures"] == msgspec.to_builtins(outcome.judgement.measures)
    assert live["measures"]["reached"] == 1.0
    assert live["score"]["points"] == outcome.score.points
    assert [part["points"] for part in live["score"]["parts"]] == [
        part.points for part in outcome.score.parts
    ]
    assert [each["lost"] for each in live["story"]] == [each.lost for each in outcome.judgement.story]
    assert repr(outcome_of(Flight(path)).judgement) == repr(outcome.judgement)
