"""A simulated operator flies a mission of the school live: through everything its timetable does, down to the pad."""

import json

import pytest
from flight_support import headless

pytestmark = [pytest.mark.flight, pytest.mark.timeout(240)]


def test_the_expert_passes_the_check_ride_over_real_processes(tmp_path):
    done = headless(
        *("--sim", "--headless", "--mission", "check-ride", "--operator", "expert"),
        *("--json", "--logs", str(tmp_path)),
    )
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    measures = summary["measures"]
    assert (measures["reached"], measures["gates_missed"], summary["collisions"]) == (1.0, 0.0, 0)
    assert measures["landing_error_m"] < 0.7
    # The handle that the timetable took away was lost, waited for, and coupled again.
    told = done.stderr.splitlines()
    lost = next(number for number, line in enumerate(told) if "The haptic device is gone" in line)
    assert [line for line in told[lost:] if line in {"holding", "flying", "landing"}] == [
        *("holding", "flying", "landing")
    ]
