"""Take-off's altitude as a parameter, set through a real MAVSDK: told, not told, denied; and never waited for."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import pytest
from mavsdk.plugins.action import ActionResult
from mavsdk.plugins.param import Param
from mavsdk_wire import VEHICLE, Clock, Wire
from pymavlink.dialects.v20 import common as m

from groundstation.messages import CommandKind
from groundstation.vehicle.commander import Commander
from groundstation.vehicle.gate import Gate
from groundstation.vehicle.takeoff_altitude import TakeoffAltitude

NAME = "MIS_TAKEOFF_ALT"


@pytest.fixture
def wire() -> Iterator[Wire]:
    it = Wire()
    yield it
    it.close()


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def altitude(wire: Wire, clock: Clock) -> TakeoffAltitude:
    return TakeoffAltitude(wire.system, Gate(0.15, clock), NAME, 2.5, clock)


def tells(wire: Wire, value: float, name: str = NAME, number: int = 1) -> None:
    wire.say(m.MAVLink_param_value_message(name.encode(), value, m.MAV_PARAM_TYPE_REAL32, 2, number))


def asked(wire: Wire) -> list[float]:
    return [each.param_value for each in wire.sent("PARAM_SET") if each.param_id == NAME]


def test_it_is_set_when_the_vehicle_tells_that_it_is(wire: Wire, altitude: TakeoffAltitude) -> None:
    ends: list[ActionResult] = []
    tells(wire, 2.5)
    altitude.set(ends.append)
    altitude.turn()
    wire.until(lambda: asked(wire) == [2.5], "it is asked for")
    tells(wire, 2.5, "MPC_XY_VEL_MAX")
    tells(wire, 2.5)
    wire.until(lambda: altitude.turn() or ends, "it is told")
    altitude.turn()
    assert ends == [ActionResult.SUCCESS]


@pytest.mark.parametrize(
    ("told", "result"), [(None, ActionResult.TIMEOUT), (10.0, ActionResult.PARAMETER_ERROR)]
)
def test_what_the_vehicle_does_not_tell_is_asked_for_again_and_given_up(
    wire: Wire, altitude: TakeoffAltitude, clock: Clock, told: float | None, result: ActionResult
) -> None:
    ends: list[ActionResult] = []
    altitude.set(ends.append)
    for times in range(1, 5):
        altitude.turn()
        altitude.turn()
        wire.until(lambda times=times: len(asked(wire)) == times, "it is asked for")
        assert ends == []
        clock.now += 0.51
    if told is not None:
        tells(wire, told)
        time.sleep(0.2)
    altitude.turn()
    assert (ends, len(asked(wire))) == ([result], 4)


def test_another_command_ends_the_waiting(wire: Wire, altitude: TakeoffAltitude, clock: Clock) -> None:
    commander = Commander(wire.system, Gate(0.15, clock), 2.5, altitude)
    commander.do(CommandKind.TAKEOFF, 1)
    commander.turn()
    commander.do(CommandKind.LAND, 2)
    answer = commander.answers.get(timeout=5.0)
    assert (answer.number, answer.ok) == (1, False)
    tells(wire, 2.5)
    time.sleep(0.2)
    commander.turn()
    assert not [each for each in wire.sent("COMMAND_LONG") if each.command == m.MAV_CMD_NAV_TAKEOFF]


def test_a_take_off_does_not_wait_while_all_parameters_are_read(
    wire: Wire, altitude: TakeoffAltitude
) -> None:
    """MAVSDK sets a parameter only after what it reads, and its call waits: over a radio a minute."""
    commander = Commander(wire.system, Gate(0.15, time.monotonic), 2.5, altitude)
    reader = threading.Thread(target=Param(wire.system).get_all_params)
    reader.start()
    wire.until(lambda: wire.sent("PARAM_REQUEST_LIST"), "all are asked for")
    commander.do(CommandKind.TAKEOFF, 1)
    commander.turn()
    assert reader.is_alive()
    wire.until(lambda: asked(wire), "it is asked for")
    tells(wire, 2.5)
    wire.until(
        lambda: (
            commander.turn()
            or [
                each
                for each in wire.sent("COMMAND_LONG")
                if each.command == m.MAV_CMD_NAV_TAKEOFF and each.target_system == VEHICLE
            ]
        ),
        "the take-off leaves",
    )
    tells(wire, 12.0, "MPC_XY_VEL_MAX", 0)
    reader.join()
