"""What may leave the link: what is meant, for the vehicle that is flown; pure, and on the wire of a real MAVSDK."""

from __future__ import annotations

import math
import struct
import time
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mavsdk.plugins.action import Action
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkMessage
from mavsdk.plugins.param import Param
from mavsdk_wire import VEHICLE, Wire
from pymavlink.dialects.v20 import common as m

from groundstation.messages import Autopilot, CommandKind
from groundstation.vehicle import allowed
from groundstation.vehicle.commander import Commander
from groundstation.vehicle.gate import KILL_S, Gate, message_number, split_frames
from groundstation.vehicle.profiles import PROFILES
from groundstation.vehicle.takeoff_altitude import TakeoffAltitude

NAN = math.nan
BLANK = (NAN,) * 7


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Station:
    """A gate that knows its vehicle, and what it told."""

    def __init__(self, autopilot: Autopilot = Autopilot.PX4, system: int = VEHICLE) -> None:
        self.clock, self.told = Clock(), []
        self.gate = Gate(0.15, self.clock, self.told.append)
        self.profile = PROFILES[autopilot]
        if system:
            self.gate.address(system, self.profile.modes)

    def altitude(self, wire: Wire) -> TakeoffAltitude | None:
        name = self.profile.takeoff_altitude
        return TakeoffAltitude(wire.system, self.gate, name, 2.0, time.monotonic) if name else None

    def passes(self, message: m.MAVLink_message) -> bool:
        return self.gate.passes(message.pack(m.MAVLink(None, srcSystem=255, srcComponent=190)))

    def command(self, number: int, *params: float, system: int = VEHICLE) -> bool:
        given = (*params, *BLANK)[:7]
        return self.passes(m.MAVLink_command_long_message(system, 1, number, 0, *given))


@pytest.fixture
def station() -> Station:
    return Station()


@pytest.mark.parametrize(
    ("number", "params"),
    [
        (m.MAV_CMD_NAV_LAND, ()),
        (m.MAV_CMD_NAV_LAND, (0.0,) * 7),
        (m.MAV_CMD_NAV_TAKEOFF, ()),
        (m.MAV_CMD_NAV_TAKEOFF, (NAN,) * 6 + (2.5,)),
        (m.MAV_CMD_DO_SET_MODE, (129.0, 4.0, 3.0)),
        (m.MAV_CMD_DO_SET_MODE, (1.0, 4.0, 5.0)),
        (m.MAV_CMD_DO_SET_MODE, (129.0, 6.0, 0.0)),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (1.0,)),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 0.0)),
        (m.MAV_CMD_SET_MESSAGE_INTERVAL, (32.0, 20_000.0)),
        (m.MAV_CMD_REQUEST_MESSAGE, (148.0,)),
    ],
)
def test_what_is_meant_leaves(station: Station, number: int, params: tuple[float, ...]) -> None:
    assert station.command(number, *params)
    assert station.told == []


@pytest.mark.parametrize(
    ("number", "params"),
    [
        # Armed or disarmed by force, however the bit patterns are turned.
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (1.0, 21196.0)),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 21196.0)),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 2989.0)),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (NAN,)),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, (0.5,)),
        (m.MAV_CMD_DO_FLIGHTTERMINATION, (1.0,)),
        (m.MAV_CMD_DO_PARACHUTE, (2.0,)),
        (m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (1.0,)),
        (m.MAV_CMD_DO_MOTOR_TEST, (1.0, 0.0, 50.0)),
        (m.MAV_CMD_DO_REPOSITION, ()),
        (m.MAV_CMD_NAV_TAKEOFF, (NAN,) * 6 + (math.inf,)),
        (m.MAV_CMD_NAV_TAKEOFF, (NAN,) * 6 + (-1.0,)),
        (m.MAV_CMD_NAV_LAND, (NAN,) * 4 + (47.0, 8.0)),
        # Manual, a mission, stabilised by a base mode without a custom one.
        (m.MAV_CMD_DO_SET_MODE, (129.0, 1.0, 0.0)),
        (m.MAV_CMD_DO_SET_MODE, (129.0, 4.0, 4.0)),
        (m.MAV_CMD_DO_SET_MODE, (128.0, 4.0, 3.0)),
        (m.MAV_CMD_SET_MESSAGE_INTERVAL, (32.0, 1.0)),
        (m.MAV_CMD_SET_MESSAGE_INTERVAL, (NAN, 20_000.0)),
    ],
)
def test_what_is_not_meant_stays_and_is_told_once(
    station: Station, number: int, params: tuple[float, ...]
) -> None:
    assert not station.command(number, *params)
    assert not station.command(number, *params)
    assert station.gate.dropped == 2
    assert len(station.told) == 1
    assert f"command {number}" in station.told[0]


@pytest.mark.parametrize("system", [0, 1, 255])
def test_nobody_but_the_vehicle_that_is_flown_is_commanded(station: Station, system: int) -> None:
    assert not station.command(m.MAV_CMD_NAV_LAND, system=system)
    assert not station.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, system=system)
    assert not station.passes(m.MAVLink_param_request_list_message(system, 1))


def test_before_a_vehicle_is_known_only_questions_leave() -> None:
    station = Station(system=0)
    assert not station.command(m.MAV_CMD_NAV_LAND)
    assert not station.command(m.MAV_CMD_DO_SET_MODE, 129.0, 4.0, 3.0)
    assert station.command(m.MAV_CMD_REQUEST_MESSAGE, 148.0)
    assert station.passes(m.MAVLink_heartbeat_message(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3))
    assert station.passes(m.MAVLink_timesync_message(0, 5))


def test_a_kill_leaves_for_a_moment_after_the_operator_s_own_and_never_arms(station: Station) -> None:
    kill = (m.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0)
    assert not station.command(*kill)
    station.gate.allow_kill()
    assert station.command(*kill)
    assert not station.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 21196.0)
    station.clock.now += KILL_S + 0.01
    assert not station.command(*kill)


def test_a_parameter_leaves_only_while_it_is_being_set(station: Station) -> None:
    def setting(name: bytes, value: float, kind: int = m.MAV_PARAM_TYPE_REAL32) -> bool:
        return station.passes(m.MAVLink_param_set_message(VEHICLE, 1, name, value, kind))

    assert not setting(b"COM_OF_LOSS_T", 60.0)
    station.gate.allow_parameter("COM_OF_LOSS_T", 0.3)
    assert setting(b"COM_OF_LOSS_T", 0.3)
    assert not setting(b"COM_OF_LOSS_T", 60.0)
    assert not setting(b"COM_OF_LOSS_T", NAN)
    assert not setting(b"COM_OBL_RC_ACT", 6.0)
    station.clock.now += 6.0
    assert not setting(b"COM_OF_LOSS_T", 0.3)


def test_an_integer_leaves_in_either_of_its_encodings_and_no_other_value_does(station: Station) -> None:
    def setting(bits: bytes) -> bool:
        (value,) = struct.unpack("<f", bits)
        kind = m.MAV_PARAM_TYPE_INT32
        return station.passes(m.MAVLink_param_set_message(VEHICLE, 1, b"COM_OBL_RC_ACT", value, kind))

    station.gate.allow_parameter("COM_OBL_RC_ACT", 6.0)
    assert setting(struct.pack("<i", 6))
    assert setting(struct.pack("<f", 6.0))
    assert not setting(struct.pack("<i", 7))
    assert not setting(struct.pack("<f", 0.0))
    # Its bits as a float are a NaN of all ones.
    station.gate.allow_parameter("COM_OBL_RC_ACT", -1.0)
    assert setting(struct.pack("<i", -1))


@pytest.mark.parametrize(
    "message",
    [
        m.MAVLink_set_mode_message(VEHICLE, 1, 0),
        m.MAVLink_manual_control_message(VEHICLE, 0, 0, 500, 0, 0),
        m.MAVLink_set_attitude_target_message(0, VEHICLE, 1, 0, [1, 0, 0, 0], 0, 0, 0, 0.5),
        m.MAVLink_command_int_message(VEHICLE, 1, 0, 400, 0, 0, 1, 21196, 0, 0, 0, 0, 0),
        m.MAVLink_mission_clear_all_message(VEHICLE, 1),
        m.MAVLink_setup_signing_message(VEHICLE, 1, [0] * 32, 0),
        m.MAVLink_serial_control_message(10, 0, 0, 0, 0, [0] * 70),
        m.MAVLink_heartbeat_message(m.MAV_TYPE_QUADROTOR, m.MAV_AUTOPILOT_PX4, 0, 0, 3, 3),
    ],
    ids=lambda message: message.get_type(),
)
def test_other_messages_stay(station: Station, message: m.MAVLink_message) -> None:
    assert not station.passes(message)
    assert f"message {message.get_msgId()} " in station.told[0]


@given(
    st.integers(0, 300),
    st.binary(max_size=60),
    st.builds(
        allowed.Addressee,
        st.sampled_from([0, VEHICLE]),
        st.just(PROFILES[Autopilot.PX4].modes),
        st.booleans(),
    ),
)
def test_any_payload_gets_an_answer_and_none_is_a_kill_that_was_not_meant(
    number: int, payload: bytes, addressee: allowed.Addressee
) -> None:
    why = allowed.refusal(number, payload, addressee)
    forced = number == allowed.COMMAND_LONG and payload[4:8].ljust(4, b"\0") == b"\x00\x98\xa5\x46"
    if forced and payload[28:30] == b"\x90\x01":
        assert why or addressee.killing


@pytest.fixture(params=[Autopilot.PX4, Autopilot.ARDUPILOT], ids=lambda kind: kind.name)
def flown(request: pytest.FixtureRequest) -> Iterator[tuple[Wire, Station]]:
    kinds = {Autopilot.PX4: m.MAV_AUTOPILOT_PX4, Autopilot.ARDUPILOT: m.MAV_AUTOPILOT_ARDUPILOTMEGA}
    wire = Wire(kinds[request.param])
    yield wire, Station(request.param)
    wire.close()


def left(wire: Wire, station: Station) -> list[m.MAVLink_message]:
    """Return what MAVSDK said that passed the gate."""
    parser = m.MAVLink(None)
    parser.robust_parsing = True
    frames = [frame for frame in split_frames(wire.taken()) if station.gate.passes(frame)]
    return [message for frame in frames for message in parser.parse_buffer(frame) or ()]


def test_every_act_of_the_operator_leaves_a_real_mavsdk_through_the_gate(
    flown: tuple[Wire, Station],
) -> None:
    wire, station = flown
    commander = Commander(wire.system, station.gate, 2.0, station.altitude(wire))
    for kind in (
        CommandKind.ARM, CommandKind.TAKEOFF, CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND,
        CommandKind.DISARM, CommandKind.KILL,
    ):  # fmt: skip
        wire.taken()
        commander.do(kind, 1)
        found: list[m.MAVLink_message] = []

        def acted(found: list[m.MAVLink_message] = found) -> bool:
            commander.turn()
            found += [
                each for each in left(wire, station) if each.get_type() in {"COMMAND_LONG", "PARAM_SET"}
            ]
            return any(getattr(each, "command", 0) not in {511, 512, 520} for each in found)

        wire.until(acted, f"{kind.name} leaves")
    assert station.told == []


def test_what_the_program_never_means_does_not_leave_a_real_mavsdk(flown: tuple[Wire, Station]) -> None:
    wire, station = flown
    action, direct, param = Action(wire.system), MavlinkDirect(wire.system), Param(wire.system)
    for act in (action.arm_force_async, action.kill_async, action.terminate_async, action.reboot_async):
        act(lambda *_: None)
    direct.send_message(
        MavlinkMessage("SET_MODE", 0, 0, VEHICLE, 1, '{"target_system":7,"base_mode":1,"custom_mode":0}')
    )
    assert param is not None
    kept: set[tuple[int, int]] = set()

    def all_kept() -> bool:
        for frame in split_frames(wire.taken()):
            if not station.gate.passes(frame):
                number = message_number(frame)
                kept.add((number, int.from_bytes(frame[38:40], "little") if number == 76 else 0))
        return {(76, 400), (76, 185), (76, 246), (11, 0)} <= kept

    wire.until(all_kept, "all kept back")
    assert len(station.told) == len(kept)
