"""Several links to one vehicle, its system id, and signed frames."""

import hashlib
from collections import Counter

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import DT, US, Wire

from sim.mavlink.endpoint import Endpoint
from sim.mavlink.signing import Signing
from sim.mavlink.streams import GROUND_STATION_RATES
from sim.mavlink.wire import Inbox
from sim.scenario import Scenario
from sim.simulator import build

KEY, OTHER = hashlib.sha256(b"ours").digest(), hashlib.sha256(b"theirs").digest()
NOW = 1.6e9


class Links(Wire):
    """Two links to a vehicle."""

    def __init__(self, **endpoint):
        super().__init__(endpoint={"links": 2, **endpoint})
        self.inboxes = (Inbox(), Inbox())

    def both(self, seconds):
        """Advance and return what was heard on each link."""
        heard = ([], [])
        for _ in range(max(1, round(seconds / DT))):
            self.sim.step(DT)
            self.endpoint.step()
            for link in (0, 1):
                for datagram in self.endpoint.outgoing(link):
                    heard[link].extend(self.inboxes[link].messages(datagram, whole=True))
        return heard

    def kinds(self, seconds):
        return [Counter(message.get_type() for message in heard) for heard in self.both(seconds)]


def test_an_answer_goes_to_who_asked_texts_and_changes_go_to_all():
    links = Links()
    links.send(m.MAVLink_param_request_read_message(1, 1, b"MIS_TAKEOFF_ALT", -1), 1)
    api, station = links.kinds(DT)
    assert (api["PARAM_VALUE"], station["PARAM_VALUE"]) == (0, 1)
    links.send(m.MAVLink_param_set_message(1, 1, b"MIS_TAKEOFF_ALT", 3.0, m.MAV_PARAM_TYPE_REAL32), 1)
    links.send(m.MAVLink_command_long_message(1, 1, 400, 0, 1, *[0] * 6), 0)
    api, station = links.kinds(DT)
    assert (api["PARAM_VALUE"], station["PARAM_VALUE"]) == (1, 1)
    assert (api["STATUSTEXT"], station["STATUSTEXT"]) == (1, 1)
    assert (api["COMMAND_ACK"], station["COMMAND_ACK"]) == (1, 0)


def test_each_link_has_its_own_numbers_streams_and_intervals():
    links = Links()
    links.send(m.MAVLink_command_long_message(1, 1, 511, 0, 32, 100_000, *[0] * 5), 1)
    api, station = links.both(4.0)
    for heard in (api, station):
        numbers = [message.get_seq() for message in heard]
        assert len(set(numbers)) == 256
    counts = [Counter(message.get_msgId() for message in heard) for heard in (api, station)]
    assert counts[0][32] == pytest.approx(120, abs=1)
    assert counts[1][32] == pytest.approx(40, abs=1)
    assert counts[1][30] == pytest.approx(4 * GROUND_STATION_RATES[30], abs=1)
    assert counts[1][m.MAVLINK_MSG_ID_HIGHRES_IMU] == 0


def test_where_nobody_listens_only_the_heart_beats_and_texts_are_not_kept():
    links = Links()
    links.endpoint.links[1].heard = False
    links.send(m.MAVLink_command_long_message(1, 1, 400, 0, 1, *[0] * 6))
    api, station = links.kinds(2.9)
    assert station == {"HEARTBEAT": 3}
    assert api["ATTITUDE"] > 200
    links.endpoint.links[1].heard = True
    _, station = links.kinds(1.0)
    assert station["ATTITUDE"] == pytest.approx(50, abs=1)
    assert station["STATUSTEXT"] == 0


def test_another_system_id_is_heard_and_told():
    wire = Wire(endpoint={"system_id": 7})
    wire.send(m.MAVLink_command_long_message(1, 1, 400, 0, 1, *[0] * 6))
    assert not any(message.get_type() == "COMMAND_ACK" for message in wire.run(0.1))
    assert wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0, target=(7, 1)) == m.MAV_RESULT_ACCEPTED
    assert wire.command(m.MAV_CMD_REQUEST_MESSAGE, 148, target=(7, 1)) == m.MAV_RESULT_ACCEPTED
    assert {message.get_srcSystem() for message in wire.heard} == {7}
    assert wire.newest("AUTOPILOT_VERSION").uid == 7


def signed(message, key=KEY, at=NOW, link_id=3):
    """Return a signed frame, as pymavlink signs it."""
    packer = m.MAVLink(None, srcSystem=US[0], srcComponent=US[1])
    packer.signing.secret_key, packer.signing.sign_outgoing = key, True
    packer.signing.link_id, packer.signing.timestamp = link_id, round((at - 1_420_070_400) * 1e5)
    return message.pack(packer)


ARM = m.MAVLink_command_long_message(1, 1, 400, 0, 1, *[0] * 6)
BEAT = m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3)


def test_with_a_key_only_what_is_well_signed_and_new_is_heard():
    wire = Wire(endpoint={"key": KEY})
    for frame in (
        ARM.pack(wire.packer),
        ARM.pack(wire.packer, force_mavlink1=True),
        signed(ARM, OTHER),
        signed(ARM, at=NOW - 61),
        signed(ARM)[:-1] + b"\0",
    ):
        wire.endpoint.receive(frame)
        assert not wire.sim.autopilot.armed
    frame = signed(ARM)
    wire.endpoint.receive(frame)
    assert wire.sim.autopilot.armed
    wire.sim.autopilot.kill()
    wire.endpoint.receive(frame)
    wire.endpoint.receive(signed(ARM, at=NOW - 1))
    assert not wire.sim.autopilot.armed
    wire.endpoint.receive(signed(ARM, at=NOW + 1))
    assert wire.sim.autopilot.armed


def test_a_heartbeat_needs_no_signature():
    wire = Wire(endpoint={"key": KEY})
    wire.sim.autopilot.parameters.set("NAV_DLL_ACT", 3)
    heard = []
    wire.sim.autopilot.hear_ground_station = lambda: heard.append(1)
    wire.send(BEAT)
    assert heard == [1]


def test_ours_are_signed_and_their_times_grow():
    wire = Wire(endpoint={"key": KEY, "links": 2})
    reader = m.MAVLink(None)
    reader.signing.secret_key = KEY
    reader.signing.timestamp = round((NOW - 1_420_070_400) * 1e5)
    heard = 0
    for _ in range(50):
        wire.sim.step(DT)
        wire.endpoint.step()
        for link in (0, 1):
            for datagram in wire.endpoint.outgoing(link):
                messages = reader.parse_buffer(datagram) or []
                for message in messages:
                    # pymavlink checks no signature of a message it does not know.
                    unknown = isinstance(message, m.MAVLink_unknown)
                    assert unknown or (message.get_signed() and message.get_link_id() == link)
                    heard += 1
    assert heard > 100
    assert (reader.signing.badsig_count, reader.signing.reject_count) == (0, 0)


def setup(key, timestamp=1):
    return m.MAVLink_setup_signing_message(1, 1, list(key), timestamp)


def test_a_key_is_taken_changed_and_given_up_by_message_but_not_while_armed():
    wire = Wire()
    wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0)
    wire.send(setup(KEY))
    assert wire.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0) == m.MAV_RESULT_ACCEPTED
    wire.send(setup(KEY))
    wire.send(ARM)
    wire.send(setup(OTHER))
    assert not wire.sim.autopilot.armed
    wire.endpoint.receive(signed(setup(OTHER)))
    wire.endpoint.receive(signed(ARM, KEY, NOW + 2))
    assert not wire.sim.autopilot.armed
    wire.endpoint.receive(signed(setup(bytes(32), 0), OTHER, NOW + 3))
    wire.send(ARM)
    assert wire.sim.autopilot.armed


def test_strangers_cannot_fill_the_memory_or_lock_a_stream():
    signing = Signing(lambda: NOW, KEY)
    inbox = Inbox(signing)
    for link_id in range(100):
        list(inbox.messages(signed(ARM, OTHER, NOW + 50, link_id), whole=True))
    assert len(list(inbox.messages(signed(ARM, link_id=5), whole=True))) == 1
    for link_id in range(100):
        list(inbox.messages(signed(ARM, KEY, NOW, link_id), whole=True))
    assert len(signing._streams) == 16


def test_a_key_of_another_length_is_refused():
    with pytest.raises(ValueError, match="32 bytes"):
        Endpoint(build(Scenario()), key=b"short")


def test_the_same_calls_give_the_same_bytes_on_every_link():
    def spoken():
        wire = Wire("dynamic", seed=3, endpoint={"links": 2, "key": KEY})
        wire.endpoint.receive(signed(ARM))
        wire.endpoint.receive(
            signed(m.MAVLink_command_long_message(1, 1, 22, 0, *[float("nan")] * 7), at=NOW + 1)
        )
        said = []
        for _ in range(500):
            wire.sim.step(DT)
            wire.endpoint.step()
            said += [wire.endpoint.outgoing(link) for link in (0, 1)]
        return said

    assert spoken() == spoken()
