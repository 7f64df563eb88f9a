"""Whole vehicles in virtual time: links, channel, restart, several at once, and the same bytes from the same seed."""

import hashlib

import pytest
from pymavlink.dialects.v20 import common as m

from sim.conditions import BothWays, parse_conditions
from sim.mavlink.wire import Inbox
from sim.process.framing import Splitter
from sim.process.transport import Url
from sim.process.vehicle import Vehicle
from sim.scenario import Scenario, VehicleChoice
from sim.simulator import build

DT = 0.004
HERE = (245, 190)


class Memory:
    """A transport whose other end is the test."""

    url = Url("udpout", "test", 1)

    def __init__(self, *, whole=True, heard=True):
        self.whole = whole
        self.heard = heard
        self.to_vehicle = []
        self.from_vehicle = []

    def receive(self):
        arrived, self.to_vehicle = self.to_vehicle, []
        yield from arrived

    def send(self, data):
        self.from_vehicle.append(data)

    def close(self):
        self.to_vehicle = None


class Flown:
    """A vehicle, and a ground station on each of its links."""

    def __init__(
        self, channel="", links=1, seed=0, system_id=1, model="kinematic", start=(0.0, 0.0, 0.0), **memory
    ):
        self.links = [Memory(**memory) for _ in range(links)]
        scenario = Scenario(vehicle=VehicleChoice(airframe="x500", model=model))
        self.vehicle = Vehicle(
            lambda: build(scenario, start=start, seed=seed),
            self.links,
            both=parse_conditions(channel) if channel else BothWays(),
            seed=seed,
            system_id=system_id,
            unix_time=1.6e9,
        )
        self.packer = m.MAVLink(None, srcSystem=HERE[0], srcComponent=HERE[1])
        self.inboxes = [Inbox() for _ in self.links]
        self.system_id = system_id

    def send(self, message, link=0):
        self.links[link].to_vehicle.append(bytes(message.pack(self.packer)))
        self.packer.seq = (self.packer.seq + 1) % 256

    def command(self, command, *params, link=0):
        params = [*params, *[0.0] * (7 - len(params))]
        self.send(m.MAVLink_command_long_message(self.system_id, 1, command, 0, *params), link)

    def set(self, name, value, link=0):
        kind = m.MAV_PARAM_TYPE_REAL32
        self.send(m.MAVLink_param_set_message(self.system_id, 1, name.encode(), value, kind), link)

    def run(self, seconds, link=0):
        """Advance, and return the messages that arrive on a link meanwhile, with the time of each."""
        heard = []
        for _ in range(round(seconds / DT)):
            self.vehicle.step(DT)
            arrived, self.links[link].from_vehicle = self.links[link].from_vehicle, []
            for data in arrived:
                heard += [
                    (self.vehicle.t, message) for message in self.inboxes[link].messages(data, whole=True)
                ]
        return heard

    def answer(self, kind, seconds=3.0, link=0):
        """Return the first answer of a kind and how long it took."""
        begun = self.vehicle.t
        return next(
            (message, t - begun) for t, message in self.run(seconds, link) if message.get_type() == kind
        )


def kinds(heard):
    return {message.get_type() for _, message in heard}


# Links and channel


def test_the_worst_that_parameters_do_to_the_channel_can_be_taken_back():
    flown = Flown()
    worst = {"LOSS": 0.95, "RATE": 0.001, "DELAY": 10.0, "JITTER": 10.0, "REORD": 1.0, "DUP": 1.0}
    for name, value in worst.items():
        for way in ("SIM_UP_", "SIM_DN_"):
            flown.set(way + name, value)
    flown.set("SIM_NET_BLACK", 60.0)
    flown.run(70.0)
    for _ in range(400):
        for name in worst:
            flown.set("SIM_UP_" + name, 0.0)
            flown.set("SIM_DN_" + name, 0.0)
        flown.run(0.2)
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert flown.answer("AUTOPILOT_VERSION")[1] == pytest.approx(DT)


def test_without_a_channel_an_answer_comes_in_the_same_step():
    flown = Flown()
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert flown.answer("AUTOPILOT_VERSION")[1] == pytest.approx(DT)


@pytest.mark.parametrize("whole", [True, False])
def test_a_delay_is_felt_both_ways(whole):
    flown = Flown("up.delay=0.1,down.delay=0.3", whole=whole)
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert flown.answer("AUTOPILOT_VERSION")[1] == pytest.approx(0.4, abs=2 * DT)


def test_through_a_bad_channel_frames_on_a_stream_stay_whole():
    """Cut anywhere, lost, doubled and reordered: every byte that comes out of the vehicle belongs to a good frame."""
    flown = Flown("loss=0.3,duplicate=0.2,reorder=0.3,delay=0.05,jitter=0.05", whole=False)
    flown.run(5.0)
    flown.links[0].from_vehicle.clear()
    for _ in range(250):
        flown.vehicle.step(DT)
    sent = b"".join(flown.links[0].from_vehicle)
    messages = list(Inbox().messages(sent, whole=True))
    assert len(messages) > 100
    assert sum(len(message.get_msgbuf()) for message in messages) == len(sent)


def test_commands_cut_in_pieces_arrive_through_the_channel():
    flown = Flown("delay=0.1", whole=False)
    request = m.MAVLink_command_long_message(1, 1, m.MAV_CMD_REQUEST_MESSAGE, 0, 148, *[0.0] * 6)
    data = bytes(request.pack(flown.packer))
    for piece in (data[:1], data[1:7], data[7:]):
        flown.links[0].to_vehicle.append(piece)
        flown.vehicle.step(DT)
    assert "AUTOPILOT_VERSION" in kinds(flown.run(0.5))


def test_the_channel_is_changed_in_flight_by_any_ground_station():
    flown = Flown()
    flown.set("SIM_UP_DELAY", 0.2)
    flown.run(0.1)
    flown.set("SIM_DN_DELAY", 0.3)
    flown.run(1.0)
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert flown.answer("AUTOPILOT_VERSION")[1] == pytest.approx(0.5, abs=2 * DT)
    flown.set("SIM_UP_DELAY", 0.0)
    flown.set("SIM_DN_DELAY", 0.0)
    flown.run(2.0)
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert flown.answer("AUTOPILOT_VERSION")[1] == pytest.approx(DT)


def test_the_parameters_say_what_the_command_line_asked_for():
    flown = Flown("up.loss=0.25,down.rate=8000")
    parameters = flown.vehicle.simulator.autopilot.parameters
    assert (parameters["SIM_UP_LOSS"], parameters["SIM_DN_LOSS"]) == (0.25, 0.0)
    assert (parameters["SIM_UP_RATE"], parameters["SIM_DN_RATE"]) == (0.0, 8000.0)


def test_a_blackout_is_answered_begins_and_ends_by_itself():
    flown = Flown(links=2)
    flown.run(0.5)
    flown.run(0.0, link=1)
    flown.links[1].from_vehicle.clear()
    flown.set("SIM_NET_BLACK", 2.0)
    answer, _ = flown.answer("PARAM_VALUE", DT)
    assert answer.param_value == 2.0
    flown.links[1].from_vehicle.clear()
    flown.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    assert flown.run(1.98) == []
    assert flown.links[1].from_vehicle == []
    assert not flown.vehicle.simulator.autopilot.armed
    assert "ATTITUDE" in kinds(flown.run(0.2))
    assert flown.links[1].from_vehicle
    assert flown.vehicle.simulator.autopilot.parameters["SIM_NET_BLACK"] == 0.0
    assert "ATTITUDE" in kinds(flown.run(3.0))


def test_a_blackout_ends_on_time_and_another_can_follow():
    flown = Flown()
    for _ in range(2):
        flown.set("SIM_NET_BLACK", 1.0)
        flown.run(DT)
        assert flown.run(0.9) == []
        assert flown.run(0.3) != []


def test_a_blackout_announced_on_the_command_line():
    flown = Flown("blackout=2+3")
    assert flown.run(1.9)
    flown.run(0.2)
    assert flown.run(2.8) == []
    assert flown.run(0.2)


def test_links_answer_for_themselves():
    flown = Flown(links=2)
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION, link=1)
    flown.vehicle.step(DT)
    on_first, on_second = (
        {message.get_type() for data in link.from_vehicle for message in inbox.messages(data, whole=True)}
        for link, inbox in zip(flown.links, flown.inboxes, strict=True)
    )
    assert "AUTOPILOT_VERSION" in on_second
    assert "AUTOPILOT_VERSION" not in on_first
    assert "HEARTBEAT" in on_first & on_second


def test_a_link_nobody_hears_carries_heartbeats_only():
    flown = Flown()
    flown.links[0].heard = False
    heard = flown.run(5.0)
    assert kinds(heard) == {"HEARTBEAT"}
    assert len(heard) in (5, 6)
    flown.links[0].heard = True
    assert {"ATTITUDE", "LOCAL_POSITION_NED", "HEARTBEAT"} <= kinds(flown.run(1.1))


# Restart


def test_a_restart_begins_anew_at_the_start_and_keeps_links_and_parameters():
    flown = Flown(start=(3.0, -2.0, 0.0))
    flown.set("MIS_TAKEOFF_ALT", 7.0)
    flown.set("SIM_DN_DELAY", 0.1)
    flown.run(2.5)
    before = flown.vehicle.simulator
    flown.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1)
    heard = flown.run(1.5)
    acks = [message for _, message in heard if message.get_type() == "COMMAND_ACK"]
    assert [(ack.command, ack.result) for ack in acks] == [(246, m.MAV_RESULT_ACCEPTED)]
    assert flown.vehicle.simulator is not before
    boot_ms = [message.time_boot_ms for _, message in heard if message.get_type() == "ATTITUDE"]
    assert max(boot_ms) > 2000
    assert boot_ms[-1] == pytest.approx(1500 - 100, abs=20)
    unix = [message.time_unix_usec for _, message in flown.run(1.1) if message.get_type() == "SYSTEM_TIME"]
    assert unix[0] / 1e6 == pytest.approx(1.6e9 + flown.vehicle.t, abs=1.2)
    assert flown.vehicle.simulator.p[:2] == (3.0, -2.0)
    assert flown.vehicle.simulator.autopilot.parameters["MIS_TAKEOFF_ALT"] == 7.0
    assert flown.vehicle.simulator.autopilot.parameters["SIM_DN_DELAY"] == pytest.approx(0.1)


def test_a_key_that_a_ground_station_set_is_kept_over_a_restart():
    flown = Flown()
    flown.send(m.MAVLink_setup_signing_message(1, 1, list(range(32)), 1))
    flown.run(0.1)
    flown.packer.signing.secret_key, flown.packer.signing.sign_outgoing = bytes(range(32)), True
    flown.packer.signing.timestamp = int((1.6e9 - 1_420_070_400) * 1e5)
    flown.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1)
    flown.run(0.1)
    flown.links[0].from_vehicle.clear()
    flown.vehicle.step(DT)
    assert all(
        frame[2] == 1 for data in flown.links[0].from_vehicle for frame in Splitter(whole=True).split(data)
    )
    flown.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    assert flown.answer("AUTOPILOT_VERSION")


def test_an_armed_vehicle_does_not_restart():
    flown = Flown()
    flown.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    flown.run(0.1)
    simulator = flown.vehicle.simulator
    assert simulator.autopilot.armed
    flown.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1)
    flown.run(0.5)
    assert flown.vehicle.simulator is simulator


# Several


def test_vehicles_are_told_apart_and_stand_apart():
    fleet = [Flown(system_id=number + 1, seed=number, start=(0.0, -3.0 * number, 0.0)) for number in range(3)]
    places = []
    for flown in fleet:
        heard = [message for _, message in flown.run(3.0)]
        assert {message.get_srcSystem() for message in heard} == {flown.system_id}
        places.append(next(each for each in reversed(heard) if each.get_type() == "HOME_POSITION"))
        flown.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    souths = [(places[0].latitude - place.latitude) * 1e-7 * 111_200 for place in places]
    assert souths == pytest.approx([0.0, 3.0, 6.0], abs=0.1)
    assert [place.y for place in places] == pytest.approx([0.0, 0.0, 0.0], abs=1e-5)
    for flown in fleet:
        flown.run(0.5)
        assert flown.vehicle.simulator.autopilot.armed
        assert flown.vehicle.simulator.autopilot.home[1] == pytest.approx(
            -3.0 * (flown.system_id - 1), abs=1.0
        )


def test_a_command_to_another_vehicle_is_not_heard():
    flown = Flown(system_id=2)
    message = m.MAVLink_command_long_message(1, 1, m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, *[0.0] * 6)
    flown.send(message)
    assert "COMMAND_ACK" not in kinds(flown.run(0.5))
    assert not flown.vehicle.simulator.autopilot.armed


# The same seed, the same bytes


def flight(seed, channel, model):
    """Fly a script through a channel and return all bytes that came out, and where the vehicle ended."""
    flown = Flown(channel, links=2, seed=seed, model=model)
    script = {
        0.5: lambda: flown.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1),
        1.0: lambda: flown.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, float("nan"), 0, 0, float("nan")),
        3.0: lambda: flown.send(m.MAVLink_param_request_list_message(1, 1), 1),
        4.0: lambda: flown.set("SIM_DN_LOSS", 0.2, 1),
        6.0: lambda: flown.command(m.MAV_CMD_NAV_RETURN_TO_LAUNCH),
    }
    digests = [hashlib.sha256() for _ in flown.links]
    for tick in range(round(12.0 / DT)):
        for t, act in script.items():
            if tick == round(t / DT):
                act()
        flown.vehicle.step(DT)
        for digest, link in zip(digests, flown.links, strict=True):
            for data in link.from_vehicle:
                digest.update(len(data).to_bytes(4, "little") + data)
            link.from_vehicle.clear()
    assert flown.vehicle.simulator.autopilot.took_off_t is not None
    return [digest.hexdigest() for digest in digests], flown.vehicle.simulator.p


BAD = "delay=0.1,jitter=0.05,loss=0.02,duplicate=0.1,reorder=0.1"


@pytest.mark.parametrize("model", ["kinematic", "dynamic", "rigid_body"])
@pytest.mark.parametrize("channel", ["", BAD])
def test_the_same_seed_gives_the_same_bytes(model, channel):
    assert flight(3, channel, model) == flight(3, channel, model)


def test_another_seed_gives_other_bytes():
    assert flight(3, "", "kinematic")[0] != flight(4, "", "kinematic")[0]
    assert flight(3, BAD, "kinematic")[0] != flight(4, BAD, "kinematic")[0]
