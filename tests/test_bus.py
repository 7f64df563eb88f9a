"""The bus between real processes: newest, drained, late, overflowing, killed."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from groundstation.bus import Bus
from groundstation.messages import (
    EVENT,
    HANDLE,
    SETPOINT,
    VEHICLE_STATE,
    Event,
    Handle,
    Setpoint,
    Severity,
    VehicleState,
    fit,
)
from groundstation.run_folder import new_run_id, run_folder, sweep


@pytest.fixture
def run_id():
    name = new_run_id()
    yield name
    sweep(name)


@pytest.fixture
def bus(run_id):
    it = Bus(run_id, "test")
    yield it
    it.close()


def left_behind(run_id: str) -> list[Path]:
    return [
        *Path("/dev/shm").glob(f"groundstation-{run_id}_*"),
        *Path(run_folder(run_id)).glob("*"),
    ]


def test_records_arrive_in_order_and_whole(bus):
    subscriber, publisher = bus.subscriber(HANDLE), bus.publisher(HANDLE)
    record = Handle()
    for tick in range(100):
        record.t, record.tick = tick * 0.001, tick
        record.position[:] = (tick, -tick, 0.5)
        publisher.send(record)
    got = list(subscriber.drain())
    assert [handle.tick for handle in got] == list(range(100))
    assert tuple(got[7].position) == (7.0, -7.0, 0.5)


def test_the_newest_stays_known_after_it_was_read(bus):
    subscriber, publisher = bus.subscriber(VEHICLE_STATE, depth=1), bus.publisher(VEHICLE_STATE)
    assert subscriber.newest() is None
    for t in (1.0, 2.0, 3.0):
        publisher.send(VehicleState(t=t))
    assert subscriber.newest().t == 3.0
    assert subscriber.newest().t == 3.0


def test_a_slow_reader_loses_the_oldest_and_blocks_nobody(bus):
    subscriber, publisher = bus.subscriber(HANDLE, depth=8), bus.publisher(HANDLE)
    for tick in range(100):
        publisher.send(Handle(tick=tick))
    assert [handle.tick for handle in subscriber.drain()] == list(range(92, 100))


def test_a_late_reader_still_gets_the_last_events(bus):
    bus.event(Severity.WARNING, "something happened")
    late = bus.subscriber(EVENT)
    bus.event(Severity.INFO, "and more")
    assert [event.text.decode() for event in late.drain()] == ["something happened", "and more"]


def test_who_comes_late_need_not_wait_for_another_event(bus):
    bus.event(Severity.WARNING, "something happened")
    late = bus.subscriber(EVENT)
    bus.heartbeat()
    assert [event.text.decode() for event in late.drain()] == ["something happened"]
    bus.heartbeat()
    bus.event(Severity.INFO, "and more")
    assert [event.text.decode() for event in late.drain()] == ["and more"]


def test_long_texts_are_cut_between_characters():
    assert fit("ä" * 300, 240).decode() == "ä" * 119
    assert len(fit("x" * 300, 240)) == 239


def test_two_runs_do_not_mix(bus):
    other_id = new_run_id()
    other = Bus(other_id, "other")
    try:
        subscriber = bus.subscriber(EVENT)
        other.event(Severity.INFO, "not for you")
        assert not list(subscriber.drain())
    finally:
        other.close()
        sweep(other_id)


PUBLISH_FOREVER = """
import sys, time
from groundstation.bus import Bus
from groundstation.messages import HANDLE, Handle
bus = Bus(sys.argv[1], "child")
publisher = bus.publisher(HANDLE)
while True:
    publisher.send(Handle(t=time.monotonic()))
    time.sleep(0.001)
"""


def test_a_killed_publisher_leaves_nothing_behind(run_id):
    bus = Bus(run_id, "test")
    subscriber = bus.subscriber(HANDLE)
    child = subprocess.Popen([sys.executable, "-c", PUBLISH_FOREVER, run_id])
    try:
        deadline = time.monotonic() + 20
        while subscriber.newest() is None and time.monotonic() < deadline:
            time.sleep(0.01)
        assert subscriber.newest() is not None
    finally:
        child.send_signal(signal.SIGKILL)
        child.wait()
    bus.close()
    sweep(run_id)
    assert not left_behind(run_id)


def test_events_carry_who_and_how_bad(bus):
    subscriber = bus.subscriber(EVENT)
    bus.event(Severity.ALARM, "link lost")
    (event,) = subscriber.drain()
    assert isinstance(event, Event)
    assert (event.source, event.severity, event.text) == (b"test", Severity.ALARM, b"link lost")


def test_who_waits_for_a_setpoint_is_woken_by_it(bus):
    import threading

    waker, subscriber, publisher = bus.waker(SETPOINT), bus.subscriber(SETPOINT), bus.publisher(SETPOINT)
    started = time.monotonic()
    threading.Timer(0.2, publisher.send, (Setpoint(number=7),)).start()
    waker.wait(20.0)
    assert time.monotonic() - started < 10.0
    assert [setpoint.number for setpoint in subscriber.drain()] == [7]


def test_waiting_ends_when_nothing_comes(bus):
    bus.waker(SETPOINT).wait(0.01)


def test_a_setpoint_nobody_waits_for_is_sent_all_the_same(bus):
    subscriber, publisher = bus.subscriber(SETPOINT), bus.publisher(SETPOINT)
    for number in range(2000):
        publisher.send(Setpoint(number=number))
    assert [setpoint.number for setpoint in subscriber.drain()][-1] == 1999


def test_a_signal_ends_the_wait_and_not_the_process(bus):
    import signal

    came = []
    before = signal.signal(signal.SIGALRM, lambda *_: came.append(True))
    signal.setitimer(signal.ITIMER_REAL, 0.05)
    try:
        bus.waker(SETPOINT).wait(20.0)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert came == [True]
