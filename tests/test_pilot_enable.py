"""The enabling switch: held in its middle the hand may be coupled; let go or squeezed through it is not."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest
from servo_bench import Bench, World, make_run

from drivers.emulated import Emulated
from drivers.stick import StickSender
from groundstation.bus import Bus
from groundstation.config import Buttons, ConfigError, Settings, load_settings
from groundstation.devices.keeper import DeviceKeeper
from groundstation.messages import CommandKind, FlightMode, Phase, Stream
from groundstation.pilot.chooser import enabled, squeezed
from groundstation.pilot.servo import Servo
from groundstation.run import write_run
from groundstation.run_folder import new_run_id, sweep

# Of a device with four buttons: the switch's two contacts, and nothing else.
BUTTONS = Buttons(clutch=-1, fine=-1, turn_left=-1, turn_right=-1, mapping=-1, release=-1, enable=0, panic=1)
OPEN, MIDDLE, THROUGH = 0, 0b01, 0b11
SETTINGS = Settings(buttons=BUTTONS)
PATIENCE_S = 30.0


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path, settings=SETTINGS)
    yield bench
    bench.close()


@pytest.mark.parametrize(
    ("position", "held", "through"),
    [(OPEN, False, False), (MIDDLE, True, False), (THROUGH, True, True), (0b10, False, True)],
)  # fmt: skip
def test_three_positions(position: int, held: bool, through: bool) -> None:
    assert enabled(position, BUTTONS) is held
    assert squeezed(position, BUTTONS) is through
    assert enabled(position, Buttons())
    assert not squeezed(0xFFFFFFFF, Buttons())


@pytest.mark.parametrize(
    ("position", "words"), [(OPEN, "enable control is not held"), (THROUGH, "squeezed through")]
)
def test_without_the_switch_in_its_middle_the_hand_is_not_coupled(
    bench: Bench, position: int, words: str
) -> None:
    bench.buttons = position
    bench.run(1.2)
    bench.world.command(CommandKind.ENGAGE, bench.now)
    bench.run(0.05)
    assert bench.phase() is Phase.DISENGAGED
    answer = bench.world.answers.newest()
    assert answer is not None
    assert words in answer.text.decode()


@pytest.mark.parametrize("position", [OPEN, THROUGH, 0b10])
def test_letting_go_and_squeezing_through_both_end_it_within_a_sample_and_nothing_comes_back(
    bench: Bench, position: int
) -> None:
    bench.buttons = MIDDLE
    bench.engage()
    bench.stick = (0.1, 0.0, 0.0)
    bench.run(1.0)
    list(bench.world.setpoints.drain())
    bench.buttons = position
    bench.run(0.011)
    assert bench.phase() is Phase.DISENGAGED
    assert bench.device.force == (0.0, 0.0, 0.0)
    last = list(bench.world.setpoints.drain())[-1]
    assert (last.active, *last.velocity) == (0, 0.0, 0.0, 0.0, 0.0)
    # Held again, with the handle centred and the vehicle in Offboard: still nothing without an act.
    bench.buttons, bench.stick = MIDDLE, (0.0, 0.0, 0.0)
    bench.run(2.0)
    assert bench.phase() is Phase.DISENGAGED
    assert not any(setpoint.active for setpoint in bench.world.setpoints.drain())
    bench.world.confirm(FlightMode.HOLD, Stream.IDLE)
    bench.engage()


def test_the_switch_has_a_button_of_its_own(tmp_path: Path) -> None:
    file = tmp_path / "groundstation.toml"
    file.write_text("[buttons]\nenable = 0\n")
    with pytest.raises(ConfigError, match="enable and clutch are both button 0"):
        load_settings(file)
    file.write_text("[buttons]\nenable = 6\npanic = 6\n")
    with pytest.raises(ConfigError, match="both button 6"):
        load_settings(file)
    file.write_text("[buttons]\nenable = 6\npanic = 7\n")
    assert msgspec.structs.asdict(load_settings(file).buttons)["panic"] == 7


def test_through_the_bytes_of_a_falcon_whose_switch_is_let_go(tmp_path: Path) -> None:
    """A servo in real time on the double of a Falcon: its buttons travel as its own bytes do."""
    run_id, address = new_run_id(), str(tmp_path / "hand.sock")
    run = make_run(run_id, "", settings=SETTINGS)
    write_run(run)
    world, bus = World(run_id, str(tmp_path / "unused.sock")), Bus(run_id, "pilot")
    keeper = DeviceKeeper(Emulated(f"falcon@{address}"), bus.event, time.monotonic)
    servo, sender = Servo(run, bus, keeper), StickSender(address)
    position = MIDDLE

    def until(condition: Callable[[], object], what: str) -> None:
        deadline = time.monotonic() + PATIENCE_S
        told = 0.0
        while time.monotonic() < deadline:
            now = time.monotonic()
            if now - told > 0.02:
                told = now
                sender.send((0.0, 0.0, 0.0), 0.0, position, now)
                world.say(now)
            servo.tick(now, 0.001)
            if condition():
                return
            time.sleep(0.001)
        pytest.fail(f"not {what} in time")

    def phase() -> Phase:
        newest = world.pilots.newest()
        return Phase(newest.phase) if newest else Phase.DISENGAGED

    try:
        until(
            lambda: (handle := world.handles.newest()) and handle.homed and handle.buttons == MIDDLE, "homed"
        )
        for then in (OPEN, THROUGH):
            position = MIDDLE
            world.confirm(FlightMode.HOLD, Stream.IDLE)
            until(lambda: (handle := world.handles.newest()) and handle.buttons == MIDDLE, "held")
            world.command(CommandKind.ENGAGE, time.monotonic())
            until(lambda: phase() is Phase.ENGAGING, "engaging")
            world.confirm()
            until(lambda: phase() is Phase.ENGAGED, "engaged")
            position = then
            until(lambda: phase() is Phase.DISENGAGED, "let go")
            setpoint = world.setpoints.newest()
            assert setpoint is not None
            assert not setpoint.active
    finally:
        servo.close()
        sender.close()
        bus.close()
        world.close()
        sweep(run_id)
