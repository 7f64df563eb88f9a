"""The school in a pseudo-terminal, by keys alone: choose, fly, be told what comes next, go on, come back."""

from __future__ import annotations

import time

import pytest
from test_flight_screen import F3, press, shows

from bench.rig import Program, hovers
from groundstation.progress.opening import store_in
from groundstation.progress.store import Store
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of

pytestmark = [pytest.mark.flight, pytest.mark.timeout(240)]


class Schooling(Program):
    """The program while the course is shown: there is no bus to join before a mission is chosen."""

    def _join(self):
        shows(self, "learn to fly by feel", 30.0)
        shows(self, "the first of all", 30.0)
        self.type("\r")
        return super()._join()


def appears(folder, pattern: str, count: int, within_s: float = 40.0) -> None:
    """Wait for files."""
    end = time.monotonic() + within_s
    while len(list(folder.glob(pattern))) < count:
        assert time.monotonic() < end, f"{count} {pattern} in {sorted(folder.iterdir())}"
        time.sleep(0.05)


def test_a_trainee_flies_is_told_what_comes_next_goes_on_and_comes_back_to_the_course(tmp_path):
    program = Schooling("school", "--pilot", "Zoe", "--logs", str(tmp_path), columns=80, rows=24)
    try:
        program.until(lambda view: view.status and view.status.health & 64 and view.servo, 40, "ready")
        press(program, "A", lambda view: view.status.armed, "armed")
        press(program, "t", lambda view: view.status.in_air, "in the air")
        program.until(hovers, 30, "hovering")
        # In the air the school shows, and leads nowhere.
        program.type("\x0e")
        shows(program, "0 of 23 passed")
        program.type("\r")
        shows(program, "Land and disarm first.")
        program.type(F3)
        program.until(lambda view: not view.status.armed, 40, "landed and disarmed")
        program.type("\x1b[19~")
        shows(program, "not passed yet: fly it again", 20.0)
        program.type("n")
        appears(tmp_path, "*_spring*.tlog", 2)
        shows(program, "being closed; then spring begins.", 30.0)
        shows(program, "DISARMED", 40.0)
        program.type("q")
        shows(program, "learn to fly by feel", 40.0)
        shows(program, "1 flight", 10.0)
        program.type("q")
        assert program.process.wait(30) == 0
    finally:
        program.close()
    with Store(store_in(tmp_path)) as store:
        (kept,) = store.flights("Zoe")
    assert (kept.mission, kept.passed, kept.device) == ("spring", False, "virtual")
    outcome = outcome_of(Flight(tmp_path / kept.recording))
    assert outcome.score.points == kept.points
    assert outcome.completed is False
