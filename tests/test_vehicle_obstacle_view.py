"""What a vehicle's distance sensors say, through a real MAVSDK into records: placed, checked, told when wrong."""

import math
import queue

import pytest
from mavsdk_wire import NAN, Wire, beam, ring
from pymavlink.dialects.v20 import common as m

from groundstation.messages import Severity
from groundstation.vehicle.obstacle_view import ObstacleView
from groundstation.vehicle.round_trip import RoundTrip

DOWN, UP = m.MAV_SENSOR_ROTATION_PITCH_270, m.MAV_SENSOR_ROTATION_PITCH_90
RIGHT, LEFT = m.MAV_SENSOR_ROTATION_YAW_90, m.MAV_SENSOR_ROTATION_YAW_270
MARK = beam(123, LEFT, number=99)


@pytest.fixture(scope="module")
def wire():
    wire = Wire()
    yield wire
    wire.close()


class Clock:
    """Time that stands until it is moved."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class Watch:
    """An obstacle view of its own, and what it makes of messages said one after the other."""

    def __init__(self, wire, yaw=0.0):
        self.wire, self.clock, self.notes = wire, Clock(), queue.SimpleQueue()
        self.view = ObstacleView(wire.system, lambda: yaw, self.notes, self.clock)

    def records(self, *messages, **by):
        """Say messages and return what comes of them; a last message of our own tells that all have arrived."""
        for message in messages:
            self.wire.say(message, **by)
        self.wire.say(MARK)
        self.wire.until(
            lambda: self.view._heard and '"id":99' in self.view._heard[-1].fields, "the last message"
        )
        self.view._heard.pop()
        return list(self.view.records())


@pytest.fixture
def unheard_wire():
    """A wire on which nothing has been asked yet: MAVSDK sends by and by, and would mix in what came before."""
    wire = Wire()
    yield wire
    wire.close()


@pytest.fixture
def watch(wire):
    return Watch(wire)


def known(record):
    return {place: distance for place, distance in enumerate(record.ring) if not math.isnan(distance)}


def test_a_ring_becomes_a_record_of_its_arrival(watch):
    watch.clock.now = 123.5
    (record,) = watch.records(ring([300, 1201], offset=90.0))
    assert record.t == 123.5
    assert record.limit == 12.0
    assert known(record) == {54: 3.0, 53: math.inf}
    assert math.isnan(record.below)
    assert math.isnan(record.above)


def test_a_ring_from_north_is_placed_by_the_vehicles_yaw(wire):
    (record,) = Watch(wire, yaw=math.pi).records(ring([300], frame=m.MAV_FRAME_GLOBAL))
    # Heading west, north is on the right.
    assert known(record) == {54: 3.0}


def test_single_beams_go_into_the_ring_and_below_and_above(watch):
    (record,) = watch.records(beam(155, DOWN), beam(4000, UP), beam(210, RIGHT), ring([300]))[-1:]
    assert (record.below, record.above) == (1.55, math.inf)
    assert known(record) == {0: 3.0, 54: 2.1}
    assert record.limit == 40.0


def test_of_two_sensors_that_look_down_the_nearer_counts(watch):
    (record,) = watch.records(
        beam(300, DOWN), beam(155, DOWN, number=1), beam(90, DOWN, number=2, quality=1)
    )[-1:]
    assert record.below == 1.55


def test_without_a_ring_every_beam_is_a_record_and_with_one_none(watch):
    assert [known(record) for record in watch.records(beam(210, RIGHT), beam(220, LEFT))] == [
        {54: 2.1},
        {54: 2.1, 18: 2.2},
    ]
    assert len(watch.records(ring([300]), beam(230, RIGHT))) == 1
    watch.clock.now += 0.6
    assert len(watch.records(beam(240, RIGHT))) == 1


def test_a_beam_that_is_not_told_again_is_forgotten(watch):
    watch.records(beam(155, DOWN), beam(210, RIGHT))
    watch.clock.now += 0.2
    (record,) = watch.records(ring([300]))
    assert (record.below, known(record)) == (1.55, {0: 3.0, 54: 2.1})
    watch.clock.now += 0.1
    (record,) = watch.records(ring([300]))
    assert math.isnan(record.below)
    assert known(record) == {0: 3.0}


def test_a_companion_computer_of_the_vehicle_is_heard_and_another_vehicle_is_not(watch):
    assert len(watch.records(ring([300]), component=196)) == 1
    assert watch.records(ring([300]), system=9) == []


@pytest.mark.parametrize(
    "bad",
    [
        ring([300], increment_f=NAN),
        ring([300], offset=math.inf),
        ring([300], frame=20),
        ring([300], highest=0),
        ring([300], increment=0, increment_f=0.0),
        beam(155, DOWN, fov=NAN),
        beam(155, DOWN, fov=-1.0),
    ],
    ids=["nan", "inf", "frame", "limit", "increment", "beam nan", "beam width"],
)
def test_what_cannot_be_is_not_passed_on_and_told_once(watch, bad):
    assert watch.records(bad, bad) == []
    severity, words = watch.notes.get_nowait()
    assert severity is Severity.WARNING
    assert f"The vehicle's {bad.get_type()} is not used: " in words
    assert watch.notes.empty()
    # What is right after it is used.
    assert len(watch.records(ring([300]))) == 1


def test_a_beam_that_looks_askew_is_no_fault(watch):
    assert watch.records(beam(155, m.MAV_SENSOR_ROTATION_PITCH_180)) == []
    assert watch.notes.empty()


def test_the_vehicle_is_asked_for_ten_a_second_again_and_again_but_not_for_ever(unheard_wire):
    wire = unheard_wire
    watch = Watch(wire)

    def asked():
        return [x for x in wire.sent("COMMAND_LONG") if x.command == m.MAV_CMD_SET_MESSAGE_INTERVAL]

    list(watch.view.records())
    list(watch.view.records())
    wire.until(lambda: len(asked()) == 2, "both commands")
    for _ in range(20):
        watch.clock.now += 1.0
        list(watch.view.records())
    wire.until(lambda: len(asked()) == 10, "all commands")
    assert sorted({command.param1 for command in asked()}) == [132.0, 330.0]
    for command in asked():
        assert command.param2 == 100_000
        assert (command.target_system, command.target_component) == (wire.system.get_system_id(), 1)


def test_a_reader_that_stands_still_keeps_the_newest(watch):
    for centimetres in range(100, 200):
        watch.wire.say(ring([centimetres]))
    assert len(watch.records()) <= 64


def test_the_round_trip_is_asked_for_and_answered(wire):
    clock = Clock()
    trip = RoundTrip(wire.system, clock)
    before = len(wire.sent("TIMESYNC"))

    def questions():
        return [x for x in wire.sent("TIMESYNC")[before:] if x.tc1 == 0]

    trip.turn()
    wire.until(questions, "the question")
    assert math.isnan(trip.seconds)
    clock.now += 0.05
    trip.turn()
    assert len(questions()) == 1
    # The vehicle's own question, a stranger's answer, then ours, with all 64 bits of its stamp.
    (question,) = questions()
    for tc1, ts1 in ((0, question.ts1), (5, question.ts1 + 1), (5, -(2**62)), (5, question.ts1)):
        wire.say(m.MAVLink_timesync_message(tc1, ts1))
    wire.until(lambda: len(trip._heard) == 4, "four answers")
    clock.now += 0.01
    trip.turn()
    assert trip.seconds == pytest.approx(0.05)
