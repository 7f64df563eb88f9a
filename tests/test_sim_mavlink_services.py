"""TIMESYNC, PING, parameters, missions, files."""

import struct

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import DT, NAN, US, AllFrames, Wire

from sim.autopilot.parameters import NAMES
from sim.mavlink.dialect import RESPONSE_EVENT_ERROR, RequestEvent


def answers(messages, kind):
    """The vehicle asks questions of its own: TIMESYNC with tc1 = 0, PING to nobody."""
    found = [message for message in messages if message.get_type() == kind]
    return [x for x in found if (x.tc1 if kind == "TIMESYNC" else x.target_system)]


def test_timesync_and_ping_are_answered():
    wire = Wire()
    wire.run(2.0)
    wire.send(m.MAVLink_timesync_message(0, 123456789))
    (answer,) = answers(wire.run(DT), "TIMESYNC")
    assert answer.ts1 == 123456789
    assert answer.tc1 == pytest.approx(2.0e9, abs=1e7)
    wire.send(m.MAVLink_timesync_message(55, 66))
    assert not answers(wire.run(0.1), "TIMESYNC")
    wire.send(m.MAVLink_ping_message(42, 7, 0, 0))
    (answer,) = answers(wire.run(DT), "PING")
    assert (answer.time_usec, answer.seq, answer.target_system, answer.target_component) == (42, 7, *US)
    wire.send(m.MAVLink_ping_message(42, 7, 1, 1))
    assert not answers(wire.run(0.1), "PING")


def test_the_vehicle_asks_for_the_time_itself():
    questions = [x for x in Wire().run(2.0) if x.get_type() == "TIMESYNC"]
    assert len(questions) == pytest.approx(20, abs=1)
    assert all(question.tc1 == 0 for question in questions)


def test_parameters_are_listed_completely_and_consistently():
    wire = Wire()
    wire.send(m.MAVLink_param_request_list_message(1, 1))
    values = [message for message in wire.run(1.0) if message.get_type() == "PARAM_VALUE"]
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
    assert value.param_value == as_float(0)
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


def test_files_are_refused():
    request = struct.pack("<HBBBBBBI", 9, 0, 3, 0, 0, 0, 0, 0).ljust(251, b"\0")
    answer = Wire().ask(m.MAVLink_file_transfer_protocol_message(0, 1, 1, request), "FILE_TRANSFER_PROTOCOL")
    sequence, _, opcode, size, asked, *_ = struct.unpack("<HBBBBBBI", bytes(answer.payload[:12]))
    assert (sequence, opcode, size, asked, answer.payload[12]) == (10, 129, 1, 3, 7)


def test_there_are_no_logs_and_no_stored_events():
    wire = Wire()
    assert wire.ask(m.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF), "LOG_ENTRY").num_logs == 0
    wire.send(RequestEvent(1, 1, 5, 9))
    # pymavlink does not know the answer: its payload is sequence, oldest, ids and reason (0: unavailable).
    wire.inbox = AllFrames()
    frame = next(frame for frame in wire.run(DT) if frame.get_msgId() == RESPONSE_EVENT_ERROR)
    assert frame.payload == struct.pack("<HHBB", 5, 0, *US)


def test_a_negative_integer_keeps_its_bits():
    """The bits of −1 are a NaN's when they travel in a float's place."""
    wire = Wire()
    value = wire.ask(m.MAVLink_param_request_read_message(1, 1, b"COM_FLT_TIME_MAX", -1), "PARAM_VALUE")
    assert struct.pack("<f", value.param_value) == struct.pack("<i", -1)
    write = m.MAVLink_param_set_message(1, 1, b"COM_FLT_TIME_MAX", as_float(600), m.MAV_PARAM_TYPE_INT32)
    assert wire.ask(write, "PARAM_VALUE").param_value == as_float(600)
    write = m.MAVLink_param_set_message(1, 1, b"COM_FLT_TIME_MAX", as_float(-1), m.MAV_PARAM_TYPE_INT32)
    wire.ask(write, "PARAM_VALUE")
    assert wire.sim.autopilot.parameters["COM_FLT_TIME_MAX"] == -1


def test_what_the_vehicle_changes_by_itself_is_told():
    wire = Wire()
    wire.sim.autopilot.parameters.set("MIS_TAKEOFF_ALT", 7.0)
    told = [x for x in wire.run(0.1) if x.get_type() == "PARAM_VALUE"]
    assert [(x.param_id, x.param_value) for x in told] == [("MIS_TAKEOFF_ALT", 7.0)]
