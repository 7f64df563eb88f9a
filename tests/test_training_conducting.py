"""A mission's timetable in a live flight: what is asked for on the bus, and when."""

import pytest
from recording_support import a_run

from groundstation.bus import Bus
from groundstation.messages import EVENT, INTERVENTION, INTERVENTION_ANSWER
from groundstation.run_folder import Stay, new_run_id, sweep
from groundstation.training.answering import REAL, answer_to
from groundstation.training.conducting import Conductor
from groundstation.training.director import Director
from groundstation.training.events import Loss, WindChange
from groundstation.training.happening import Calm, unpacked
from groundstation.training.mission import Mission, Target
from sim.environment.world import World

WIND, LOSS = WindChange(velocity=(3.0, 0.0, 0.0), at_s=2.0), Loss(share=0.1, at_s=5.0)
MISSION = Mission(
    schema=1, name="busy", title="Busy", target=Target(position=(0.0, 0.0, 2.0)), event=(LOSS, WIND)
)


class Bench:
    def __init__(self, mission):
        self.run_id = new_run_id()
        self.stay = Stay(self.run_id)
        self.bus, self.link = Bus(self.run_id, "screen"), Bus(self.run_id, "link")
        self.asked, self.events = self.link.subscriber(INTERVENTION), self.link.subscriber(EVENT)
        self.answers = self.link.publisher(INTERVENTION_ANSWER)
        self.conductor = Conductor(mission, self.bus)
        self.mission = mission

    def fly(self, director, times, z=2.0):
        """Fly on; return what was asked for, by the time."""
        found = []
        for t in times:
            director.vehicle(t, (0.0, 0.0, z, 0.0), in_air=z > 0.1, armed=z > 0.0)
            self.conductor.look(director, t)
            found += [(t, unpacked(each.happening)) for each in self.asked.drain()]
        return found

    def director(self):
        return Director(self.mission, World(()), 0.3)

    def close(self):
        self.bus.close()
        self.link.close()
        self.stay.end()
        sweep(self.run_id)


@pytest.fixture
def bench():
    bench = Bench(MISSION)
    yield bench
    bench.close()


def test_each_is_asked_for_once_at_its_time_after_take_off(bench):
    director = bench.director()
    assert bench.fly(director, range(100, 110), z=0.0) == [], "on the ground nothing is due"
    assert bench.fly(director, range(110, 120)) == [(112, WIND), (115, LOSS)]


def test_another_flight_in_the_same_run_begins_as_the_first_did(bench):
    first, second = bench.director(), bench.director()
    bench.fly(first, range(10, 20))
    assert bench.fly(first, range(20, 25), z=0.0) == []
    assert bench.fly(second, range(30, 40)) == [(30, Calm()), (32, WIND), (35, LOSS)]


def test_what_was_refused_is_told_once_with_its_reason(bench):
    director = bench.director()
    bench.fly(director, (10.0,))
    director.vehicle(12.0, (0.0, 0.0, 2.0, 0.0), in_air=True, armed=True)
    bench.conductor.look(director, 12.0)
    (asked,) = bench.asked.drain()
    assert asked.source == b"mission"
    bench.answers.send(answer_to(asked, REAL, 12.1))
    bench.fly(director, (12.2, 12.3))
    told = [event.text.decode() for event in bench.events.drain()]
    assert told == [f"The mission's timetable is not kept: wind 3.0 m/s from the west: {REAL}."]


def test_a_mission_without_a_timetable_asks_for_nothing(tmp_path):
    bench = Bench(a_run(tmp_path / "flight").mission)
    try:
        assert bench.fly(bench.director(), range(10, 20)) == []
        assert bench.fly(bench.director(), range(20, 30)) == []
    finally:
        bench.close()
