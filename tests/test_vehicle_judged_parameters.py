"""What is judged of the vehicle's parameters, through a real MAVSDK: asked for, told, told by others, asked again."""

from __future__ import annotations

import struct
from collections.abc import Iterator

import pytest
from mavsdk_wire import VEHICLE, Clock, Wire
from pymavlink.dialects.v20 import common as m

from groundstation.vehicle.judged_parameters import JudgedParameters, Told
from groundstation.vehicle.px4 import JUDGED

LOSS, ACTION = "COM_OF_LOSS_T", "COM_OBL_RC_ACT"
WANTED = tuple(each for each in JUDGED if each.name in {LOSS, ACTION})


@pytest.fixture
def wire() -> Iterator[Wire]:
    it = Wire()
    yield it
    it.close()


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def judged(wire: Wire, clock: Clock) -> JudgedParameters:
    return JudgedParameters(wire.system, WANTED, bytewise=True, clock=clock)


def asked(wire: Wire) -> list[str]:
    return [
        each.param_id
        for each in wire.sent("PARAM_REQUEST_READ")
        if (each.target_system, each.target_component, each.param_index) == (VEHICLE, 1, -1)
    ]


def tell(wire: Wire, name: str, value: float, *, system: int = VEHICLE) -> None:
    whole = name == ACTION
    (sent,) = struct.unpack("<f", struct.pack("<i", int(value))) if whole else (value,)
    kind = m.MAV_PARAM_TYPE_INT32 if whole else m.MAV_PARAM_TYPE_REAL32
    wire.say(m.MAVLink_param_value_message(name.encode(), sent, kind, 900, 65535), system=system)


def heard(wire: Wire, judged: JudgedParameters, count: int) -> list[Told]:
    told: list[Told] = []
    wire.until(lambda: told.extend(judged.turn()) or len(told) >= count, f"{count} are told")
    return told


def test_all_are_asked_for_and_those_that_are_not_told_again(
    wire: Wire, judged: JudgedParameters, clock: Clock
) -> None:
    assert list(judged.turn()) == []
    wire.until(lambda: set(asked(wire)) == {LOSS, ACTION}, "both are asked for")
    tell(wire, LOSS, 0.5)
    (told,) = heard(wire, judged, 1)
    assert (told.judged.name, told.value, told.before) == (LOSS, 0.5, None)
    clock.now += 2.1
    list(judged.turn())
    wire.until(lambda: asked(wire).count(ACTION) == 2, "the other is asked for again")
    assert asked(wire).count(LOSS) == 1
    tell(wire, ACTION, 5)
    heard(wire, judged, 1)
    clock.now += 60.0
    assert list(judged.turn()) == []
    assert judged.values == {LOSS: 0.5, ACTION: 5.0}
    assert len(asked(wire)) == 3


def test_what_others_set_is_told_with_what_it_was_and_another_vehicle_s_is_not_ours(
    wire: Wire, judged: JudgedParameters
) -> None:
    tell(wire, ACTION, 5)
    heard(wire, judged, 1)
    tell(wire, ACTION, 0, system=VEHICLE + 1)
    tell(wire, "SOMETHING_ELSE", 3.0)
    tell(wire, ACTION, -1)
    (told,) = heard(wire, judged, 1)
    assert (told.before, judged.values.keys()) == (5.0, {ACTION})
    assert told.value != told.before


def test_after_a_new_start_nothing_is_known_and_all_is_asked_for(
    wire: Wire, judged: JudgedParameters
) -> None:
    tell(wire, LOSS, 0.5)
    tell(wire, ACTION, 5)
    heard(wire, judged, 2)
    before = len(asked(wire))
    judged.ask_again()
    list(judged.turn())
    wire.until(lambda: len(asked(wire)) == before + 2, "all are asked for")
    assert judged.values == {LOSS: 0.5, ACTION: 5.0}
    judged.forget()
    assert judged.values == {}
    list(judged.turn())
    wire.until(lambda: len(asked(wire)) == before + 4, "all are asked for once more")
