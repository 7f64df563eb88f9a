"""Sticks on the wire: a joystick's, and channels in the place of a radio's."""

import pytest
from pymavlink.dialects.v20 import common as m
from sim_wire import DT, Wire

from sim.autopilot.modes import Mode


def joystick(wire, x=0, y=0, z=500, r=0, target=1):
    wire.send(m.MAVLink_manual_control_message(target, x, y, z, r, 0))


def channels(wire, *first):
    wire.send(m.MAVLink_rc_channels_override_message(1, 1, *first, *[0xFFFF] * (8 - len(first)), *[0] * 10))


def position_mode(wire, sticks):
    sticks()
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, 3, 0) == m.MAV_RESULT_ACCEPTED
    assert wire.sim.autopilot.mode is Mode.POSITION


@pytest.mark.parametrize(
    ("sticks", "axis", "sign"),
    [
        ({"x": 1000}, 0, 1),
        ({"y": 1000}, 1, -1),
        ({"z": 1000}, 2, 1),
        ({"z": 0}, 2, -1),
        ({"r": 1000}, 3, -1),
    ],
)
def test_a_joystick_flies_forward_right_up_and_clockwise(sticks, axis, sign):
    wire = Wire().take_off()
    position_mode(wire, lambda: joystick(wire))
    wire.run(0.8, lambda: joystick(wire, **sticks))
    v = wire.sim.v
    assert v[axis] * sign > 0.3
    assert all(abs(v[other]) < 0.05 for other in range(4) if other != axis)
    wire.run(1.1, lambda: joystick(wire))
    assert wire.newest("HEARTBEAT").custom_mode == 3 << 16
    assert wire.newest("HEARTBEAT").base_mode & m.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED


def test_a_joystick_for_another_vehicle_or_out_of_range_moves_nothing():
    wire = Wire().take_off()
    position_mode(wire, lambda: joystick(wire))
    wire.run(0.4, lambda: joystick(wire, x=1000, target=9) or joystick(wire))
    assert abs(wire.sim.v[0]) < 0.05
    wire.run(0.4, lambda: joystick(wire, x=32767, y=-32768, z=32767, r=32767))
    assert all(abs(speed) < 0.05 for speed in wire.sim.v)


def test_overridden_channels_fly_and_are_told_back():
    wire = Wire().take_off()
    assert wire.newest("RC_CHANNELS").chancount == 0
    position_mode(wire, lambda: channels(wire, 1500, 1500, 1500, 1500))
    wire.run(0.8, lambda: channels(wire, 1500, 2000, 1500, 1500, 1200))
    assert wire.sim.v[0] > 0.3
    told = wire.newest("RC_CHANNELS")
    assert (told.chancount, told.chan2_raw, told.chan5_raw, told.chan6_raw) == (5, 2000, 1200, 0xFFFF)
    channels(wire, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0)
    wire.run(0.1)
    assert (wire.newest("RC_CHANNELS").chancount, wire.newest("RC_CHANNELS").chan2_raw) == (4, 2000)


def test_no_position_mode_without_sticks():
    wire = Wire().take_off()
    assert wire.command(m.MAV_CMD_DO_SET_MODE, 1, 3, 0) == m.MAV_RESULT_TEMPORARILY_REJECTED
    wire.run(DT)
    assert any(text.startswith("Position denied: ") for text in wire.texts())
