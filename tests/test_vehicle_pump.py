"""Loss counting, the MAVLink log, and the pump with the real MAVSDK on one side and a socket on the other."""

import math
import os
import socket
import struct
import threading
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

from groundstation.vehicle.gate import Gate
from groundstation.vehicle.open_transport import open_transport
from groundstation.vehicle.pump import Losses, Pump
from groundstation.vehicle.signing import Signing
from groundstation.vehicle.tlog import TlogWriter
from groundstation.vehicle.transport import Url


def count(sequence):
    losses = Losses()
    for number in sequence:
        losses.count(1.0, 1, 1, number % 256)
    return losses


def test_no_gap_no_loss():
    assert count(range(600)).share(1.0) == 0.0


def test_gaps_are_lost_frames():
    assert math.isclose(count([0, 1, 3, 4, 5, 6, 9, 10]).share(1.0), 3 / 11)


def test_a_gap_over_the_wrap_is_counted():
    assert math.isclose(count([254, 1]).share(1.0), 2 / 4)


def test_a_repeated_or_late_frame_is_no_loss():
    assert count([5, 6, 6, 5]).share(1.0) == 0.0


def test_frames_that_overtake_each_other_are_no_loss():
    sequence = [pair for first in range(0, 600, 3) for pair in (first + 2, first, first + 1)]
    assert count(sequence).share(1.0) < 0.01


@given(st.lists(st.integers(0, 4), min_size=100, max_size=400), st.booleans())
def test_no_order_and_no_repetition_makes_a_loss(delays, twice):
    # A frame is at most four places late, as through a channel with jitter.
    arriving = sorted(range(len(delays)), key=lambda number: (number + delays[number], number))
    losses = count([number for number in arriving for _ in range(1 + twice)])
    # The last few may be missing only because what would tell has not come, the first because none was before.
    assert losses.share(1.0) <= 8 / len(delays)


def test_what_is_lost_for_good_among_what_is_late_is_lost():
    numbers = [each for each in range(500) if each % 10]
    swapped = [numbers[at ^ 1] if at ^ 1 < len(numbers) else numbers[at] for at in range(len(numbers))]
    assert math.isclose(count(swapped).share(1.0), 0.1, abs_tol=0.01)


def test_sources_are_counted_apart():
    losses = Losses()
    for number in range(10):
        losses.count(1.0, 1, 1, number)
        losses.count(1.0, 1, 100, number)
    assert losses.share(1.0) == 0.0


def test_old_losses_are_forgotten():
    losses = count([0, 9])
    assert losses.share(1.0) > 0.5
    assert losses.share(10.0) == 0.0


@given(st.lists(st.integers(0, 255), max_size=60))
def test_the_share_is_a_share(sequence):
    assert 0.0 <= count(sequence).share(1.0) <= 1.0


def test_the_log_is_read_by_pymavlink(tmp_path):
    told = []
    path = tmp_path / "flight.tlog"
    writer = TlogWriter(path, told.append)
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    for _ in range(300):
        writer.write(bytes(link.heartbeat_encode(2, 12, 0, 0, 4).pack(link)))
    writer.close()
    assert not told
    (stamp,) = struct.unpack(">Q", path.read_bytes()[:8])
    assert abs(stamp * 1e-6 - time.time()) < 60
    log = mavutil.mavlink_connection(str(path))
    messages = []
    while (message := log.recv_match()) is not None:
        messages.append(message)
    log.close()
    assert len(messages) == 300
    assert messages[0].get_type() == "HEARTBEAT"


def test_a_log_that_exists_is_not_overwritten(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"precious")
    with pytest.raises(FileExistsError):
        TlogWriter(path, lambda _: None)
    assert path.read_bytes() == b"precious"


def test_a_full_disk_is_told_once_and_stops_nothing():
    from pathlib import Path

    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("this system has no /dev/full")
    told = []

    class Full(type(full)):
        def open(self, _mode, **options):
            return super().open("wb", **options)

    writer = TlogWriter(Full(full), told.append)
    for _ in range(1000):
        writer.write(b"frame")
    writer.close()
    assert len(told) == 1
    assert "free the disk" in told[0]


def test_frames_that_a_slow_disk_does_not_take_are_told_once(tmp_path, monkeypatch):
    monkeypatch.setattr("groundstation.vehicle.tlog._QUEUE_FRAMES", 10)
    out, into = os.pipe()
    told = []

    class Slow(type(tmp_path)):
        """A file that takes no more than a pipe holds until somebody reads."""

        def open(self, _mode, **options):
            return os.fdopen(into, "wb", **options)

    monkeypatch.setattr(os, "fsync", lambda _: None)
    writer = TlogWriter(Slow(tmp_path / "flight.tlog"), told.append)
    for _ in range(100):
        writer.write(bytes(60_000))
    reader = threading.Thread(target=lambda: [None for _ in iter(lambda: os.read(out, 1 << 20), b"")])
    reader.start()
    writer.close()
    reader.join()
    os.close(out)
    assert len(told) == 1
    assert "misses frames" in told[0]


def test_mavsdk_is_heard_through_the_pump():
    from mavsdk import Configuration, Mavsdk

    vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    vehicle.bind(("127.0.0.1", 0))
    vehicle.settimeout(10)
    pump = Pump(
        open_transport(Url("udpout", "127.0.0.1", vehicle.getsockname()[1])),
        Gate(0.15, time.monotonic),
        None,
        time.monotonic,
    )
    mav = Mavsdk(Configuration.create_manual(255, 190, True))
    pump.start(mav)
    try:
        parser = mavlink.MAVLink(None)
        parser.robust_parsing = True
        data, peer = vehicle.recvfrom(1000)
        (heartbeat,) = parser.parse_buffer(data)
        assert (heartbeat.get_srcSystem(), heartbeat.get_srcComponent()) == (255, 190)
        link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        deadline = time.monotonic() + 20
        while not mav.get_systems() and time.monotonic() < deadline:
            vehicle.sendto(bytes(link.heartbeat_encode(2, 12, 209, 0, 4).pack(link)), peer)
            time.sleep(0.1)
        assert [system.has_autopilot() for system in mav.get_systems()] == [True]
        assert pump.heard_t > 0
        assert pump.loss() == 0.0
    finally:
        pump.stop()
        mav.destroy()
        vehicle.close()


class Station:
    """A way that brings what was put in, and takes everything."""

    def __init__(self, *datagrams):
        self.left = list(datagrams)

    def receive(self):
        time.sleep(0.001)
        return self.left.pop(0) if self.left else b""

    def send(self, data):
        pass

    def close(self):
        pass


def heartbeat(system: int, autopilot: int) -> bytes:
    sender = mavlink.MAVLink(None, srcSystem=system, srcComponent=1)
    return bytes(sender.heartbeat_encode(2, autopilot, 0, 0, 4).pack(sender))


class Mav:
    """Takes bytes, as MAVSDK does, and says nothing."""

    def subscribe_raw_bytes_to_be_sent(self, _):
        pass

    add_any_connection = pass_received_raw_bytes = subscribe_raw_bytes_to_be_sent


def heard(*datagrams: bytes):
    """Return a pump that watches system 1 and has heard these, its clock one further with each."""
    from groundstation.vehicle.gate import Gate
    from groundstation.vehicle.pump import Pump

    times = iter(range(1, 100))
    way = Station(*datagrams)
    pump = Pump(way, Gate(0.15, time.monotonic), None, lambda: next(times))
    pump.watch(1)
    pump.start(Mav())
    deadline = time.monotonic() + 5
    while way.left and time.monotonic() < deadline:
        time.sleep(0.005)
    pump.stop()
    assert not way.left
    return pump


def test_another_station_on_the_link_is_not_taken_for_the_vehicle():
    """Radios and routers pass on what other stations say: a vehicle that is silent stays silent for that."""
    pump = heard(
        heartbeat(1, mavlink.MAV_AUTOPILOT_PX4), *[heartbeat(254, mavlink.MAV_AUTOPILOT_INVALID)] * 5
    )
    assert pump.heard_t == 1
    assert not pump.others


def test_another_vehicle_is_told_once_and_the_silence_of_ours_with_its_end():
    from groundstation.config import Safety
    from groundstation.messages import Severity
    from groundstation.vehicle.hearing import Hearing

    pump = heard(heartbeat(1, mavlink.MAV_AUTOPILOT_PX4), heartbeat(2, mavlink.MAV_AUTOPILOT_PX4))
    assert pump.heard_t == 1
    hearing = Hearing(pump, Safety())
    assert [(severity, words[:27]) for severity, words in hearing.news(1.1)] == [
        (Severity.WARNING, "Another vehicle, system 2, ")
    ]
    assert not list(hearing.news(1.2))
    ((_, silent),) = hearing.news(1.6)
    assert "silent" in silent
    assert not list(hearing.news(2.0))
    pump.heard_t = 2.1
    assert list(hearing.news(2.2)) == [(Severity.INFO, "The vehicle is heard again.")]
    assert hearing.absences == 1


def test_a_heartbeat_that_calls_the_vehicle_another_autopilot_is_not_passed_on_and_told_once():
    from groundstation.config import Safety
    from groundstation.vehicle.hearing import Hearing

    ours, other = (
        heartbeat(1, mavlink.MAV_AUTOPILOT_PX4),
        heartbeat(1, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA),
    )
    pump = heard(ours, other, ours)
    assert pump.heard_t == 2
    hearing = Hearing(pump, Safety())
    ((_, words),) = hearing.news(2.1)
    assert "another autopilot" in words
    assert not list(hearing.news(2.2))


def test_a_vehicle_that_signs_while_there_is_no_key_is_told_once():
    from groundstation.config import Safety
    from groundstation.vehicle.hearing import Hearing

    signer = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    signer.signing.secret_key, signer.signing.sign_outgoing = KEY, True
    signed = bytes(signer.heartbeat_encode(2, mavlink.MAV_AUTOPILOT_PX4, 0, 0, 4).pack(signer))
    hearing = Hearing(heard(signed), Safety())
    ((_, words),) = hearing.news(1.1)
    assert "--signing-key" in words
    assert not list(hearing.news(1.2))
    assert not list(Hearing(heard(heartbeat(1, mavlink.MAV_AUTOPILOT_PX4)), Safety()).news(1.1))


KEY = bytes(range(32))


class Ears:
    """Stands where MAVSDK does, and keeps what it is passed."""

    def __init__(self):
        self.heard = []
        self.send = None

    def subscribe_raw_bytes_to_be_sent(self, send):
        self.send = send

    def add_any_connection(self, _url):
        pass

    def pass_received_raw_bytes(self, data):
        self.heard.append(mavlink.MAVLink(None).parse_buffer(bytearray(data))[0])


class Signed:
    """A pump with a key, a log and a real socket, and the vehicle at its other end."""

    def __init__(self, folder):
        self.vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.vehicle.bind(("127.0.0.1", 0))
        self.vehicle.settimeout(10)
        self.path = folder / "flight.tlog"
        self.log = TlogWriter(self.path, pytest.fail)
        self.ears = Ears()
        self.pump = Pump(
            open_transport(Url("udpout", "127.0.0.1", self.vehicle.getsockname()[1])),
            Gate(0.15, time.monotonic),
            self.log,
            time.monotonic,
            Signing(KEY, time.time),
        )
        self.pump.start(self.ears)
        self.signer = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self.signer.signing.secret_key, self.signer.signing.sign_outgoing = KEY, True
        self.signer.signing.timestamp = round((time.time() - 1_420_070_400) * 1e5)
        self.plain = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        station = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        self.ears.send(bytes(station.heartbeat_encode(6, 8, 0, 0, 4).pack(station)))
        self.said, self.peer = self.vehicle.recvfrom(1000)

    def say(self, message, signer):
        self.vehicle.sendto(bytes(message.pack(signer)), self.peer)

    def say_heartbeat(self):
        before = len(self.ears.heard)
        self.say(self.plain.heartbeat_encode(2, 12, 209, 0, 4), self.signer)
        deadline = time.monotonic() + 10
        while len(self.ears.heard) == before and time.monotonic() < deadline:
            time.sleep(0.002)
        assert self.ears.heard[-1].get_type() == "HEARTBEAT"

    def logged(self):
        self.pump.stop()
        self.log.close()
        self.vehicle.close()
        log = mavutil.mavlink_connection(str(self.path))
        messages = []
        while (message := log.recv_match()) is not None:
            messages.append(message)
        log.close()
        return messages


def test_whoever_asks_a_station_for_its_parameters_is_not_heard(tmp_path):
    signed = Signed(tmp_path)
    signed.say(signed.plain.param_request_list_encode(255, 190), signed.signer)
    signed.say_heartbeat()
    assert [each.get_type() for each in signed.ears.heard] == ["HEARTBEAT"]
    signed.logged()


def test_what_radios_tell_makes_no_silent_vehicle_alive(tmp_path):
    signed = Signed(tmp_path)
    signed.say_heartbeat()
    heard_t = signed.pump.heard_t
    # As if the vehicle itself had said so; nobody needs a key for it.
    radio = signed.plain.radio_status_encode(200, 190, 90, 50, 50, 0, 0)
    for _ in range(20):
        signed.say(radio, signed.plain)
    signed.say(signed.plain.sys_status_encode(*[0] * 13), signed.plain)
    deadline = time.monotonic() + 10
    while not signed.pump.refused and time.monotonic() < deadline:
        time.sleep(0.002)
    assert signed.pump.refused == 1
    assert signed.pump.heard_t == heard_t
    assert signed.pump.loss() == 0.0
    signed.logged()
    assert {message.get_type() for message in signed.ears.heard} == {"HEARTBEAT"}


def test_no_signature_and_no_key_is_in_the_log(tmp_path):
    signed = Signed(tmp_path)
    assert signed.said[2] == mavlink.MAVLINK_IFLAG_SIGNED
    signed.say_heartbeat()
    signed.say(signed.plain.setup_signing_encode(255, 190, b"secret" * 5 + b"..", 1), signed.signer)
    signed.say_heartbeat()
    messages = signed.logged()
    assert b"secret" not in signed.path.read_bytes()
    assert [message.get_type() for message in messages] == ["HEARTBEAT"] * 3
    assert [message.get_srcSystem() for message in messages] == [255, 1, 1]
    assert {message.get_header().incompat_flags for message in messages} == {0}
