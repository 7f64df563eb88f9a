"""TIMESYNC, PING, parameters, missions, files."""

import struct

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import NAN, US, Wire

from sim.autopilot.parameters import NAMES


def test_timesync_and_ping_are_answered():
    wire = Wire()
    wire.run(2.0)
    answer = wire.ask(m.MAVLink_timesync_message(0, 123456789), "TIMESYNC")
    assert answer.ts1 == 123456789
    assert answer.tc1 == pytest.approx(2.0e9, abs=1e7)
    wire.send(m.MAVLink_timesync_message(55, 66))
    assert not any(message.get_type() == "TIMESYNC" for message in wire.run(0.1))
    answer = wire.ask(m.MAVLink_ping_message(42, 7, 0, 0), "PING")
    assert (answer.time_usec, answer.seq, answer.target_system, answer.target_component) == (42, 7, *US)
    wire.send(m.MAVLink_ping_message(42, 7, 1, 1))
    assert not any(message.get_type() == "PING" for message in wire.run(0.1))


def test_parameters_are_listed_completely_and_consistently():
    wire = Wire()
    wire.send(m.MAVLink_param_request_list_message(1, 1))
    values = [message for message in wire.run(0.5) if message.get_type() == "PARAM_VALUE"]
    assert [value.param_id for value in values] == list(NAMES)
    assert [value.param_index for value in values] == list(range(len(NAMES)))
    assert {value.param_count for value in values} == {len(NAMES)}


def as_float(whole):
    return struct.unpack("<f", struct.pack("<i", whole))[0]


def test_integers_travel_bytewise():
    wire = Wire()
    read = m.MAVLink_param_request_read_message(1, 1, b"COM_OBL_RC_ACT", -1)
    value = wire.ask(read, "PARAM_VALUE")
    assert value.param_type == m.MAV_PARAM_TYPE_INT32
    assert value.param_value == as_float(5)
    write = m.MAVLink_param_set_message(1, 1, b"COM_OBL_RC_ACT", as_float(4), m.MAV_PARAM_TYPE_INT32)
    assert wire.ask(write, "PARAM_VALUE").param_value == as_float(4)
    assert wire.sim.autopilot.parameters["COM_OBL_RC_ACT"] == 4


@pytest.mark.parametrize(
    ("value", "kind", "in_force"),
    [
        (3.5, m.MAV_PARAM_TYPE_REAL32, 3.5),
        (NAN, m.MAV_PARAM_TYPE_REAL32, 2.5),
        (-1.0, m.MAV_PARAM_TYPE_REAL32, 2.5),
        (1e9, m.MAV_PARAM_TYPE_REAL32, 2.5),
        (as_float(4), m.MAV_PARAM_TYPE_INT32, 2.5),
    ],
)
def test_the_answer_to_a_change_is_the_value_in_force(value, kind, in_force):
    write = m.MAVLink_param_set_message(1, 1, b"MIS_TAKEOFF_ALT", value, kind)
    assert Wire().ask(write, "PARAM_VALUE").param_value == in_force


def test_an_unknown_parameter_is_refused():
    wire = Wire()
    read = m.MAVLink_param_request_read_message(1, 1, b"NO_SUCH_THING", -1)
    assert wire.ask(read, "PARAM_ERROR").error == m.MAV_PARAM_ERROR_DOES_NOT_EXIST
    read = m.MAVLink_param_request_read_message(1, 1, b"", 999)
    assert wire.ask(read, "PARAM_ERROR").param_index == 999
    write = m.MAVLink_param_set_message(1, 1, b"NO_SUCH_THING", 1.0, m.MAV_PARAM_TYPE_REAL32)
    assert wire.ask(write, "PARAM_ERROR").param_id == "NO_SUCH_THING"


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_there_are_no_missions_and_none_is_taken(kind):
    wire = Wire()
    count = wire.ask(m.MAVLink_mission_request_list_message(1, 1, kind), "MISSION_COUNT")
    assert (count.count, count.mission_type, count.target_system) == (0, kind, US[0])
    for message, result in [
        (m.MAVLink_mission_count_message(1, 1, 3, kind), m.MAV_MISSION_UNSUPPORTED),
        (m.MAVLink_mission_count_message(1, 1, 0, kind), m.MAV_MISSION_ACCEPTED),
        (m.MAVLink_mission_clear_all_message(1, 1, kind), m.MAV_MISSION_ACCEPTED),
        (m.MAVLink_mission_request_int_message(1, 1, 0, kind), m.MAV_MISSION_INVALID_SEQUENCE),
    ]:
        ack = wire.ask(message, "MISSION_ACK")
        assert (ack.type, ack.mission_type) == (result, kind)


def test_files_are_refused():
    request = struct.pack("<HBBBBBBI", 9, 0, 3, 0, 0, 0, 0, 0).ljust(251, b"\0")
    answer = Wire().ask(m.MAVLink_file_transfer_protocol_message(0, 1, 1, request), "FILE_TRANSFER_PROTOCOL")
    sequence, _, opcode, size, asked, *_ = struct.unpack("<HBBBBBBI", bytes(answer.payload[:12]))
    assert (sequence, opcode, size, asked, answer.payload[12]) == (10, 129, 1, 3, 7)
