"""The screen on a real bus: what another place publishes is shown, what the operator does arrives there."""

from __future__ import annotations

import asyncio
import time

import msgspec
import pytest
from canned_flight import CannedFlight, CannedReader, CannedSupervisor, canned_run

from drivers.stick import StickReceiver, StickSample, StickSender
from groundstation.bus import Bus
from groundstation.console import Console
from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    HANDLE,
    PILOT_STATE,
    SERVO_REPORT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    CommandAnswer,
    CommandKind,
    PilotState,
    Preset,
    Severity,
)
from groundstation.run_folder import new_run_id, run_folder, sweep
from groundstation.tui import running as app_module
from groundstation.tui.app import FlightApp
from groundstation.tui.running import fly_on_screen
from groundstation.tui.widgets.instrument import Instrument

TOPICS = {
    "handle": HANDLE, "pilot": PILOT_STATE, "vehicle": VEHICLE_STATE, "status": VEHICLE_STATUS,
    "servo": SERVO_REPORT, "device": DEVICE_REPORT,
}  # fmt: skip


@pytest.fixture
def run_id():
    name = new_run_id()
    run_folder(name).mkdir(mode=0o700, exist_ok=True)
    yield name
    sweep(name)


def publish(bus: Bus) -> None:
    """Publish one moment of the canned flight as of now."""
    flight = CannedFlight(canned_run())
    flight.advance(4.0)
    snapshot = flight.snapshot()
    late = time.monotonic() - snapshot.t
    for name, topic in TOPICS.items():
        record = getattr(snapshot, name)
        record.t += late
        if name == "status":
            record.heard_t += late
        bus.publisher(topic).send(record)


async def test_what_is_on_the_bus_is_shown_and_a_key_is_a_command_on_it(run_id):
    here, there = Bus(run_id, "screen"), Bus(run_id, "link")
    commands, answers = there.subscriber(COMMAND), there.publisher(COMMAND_ANSWER)
    app = FlightApp(canned_run(), Console(here, "screen"), CannedSupervisor(), None)
    async with app.run_test(notifications=True) as pilot:
        publish(there)
        there.event(Severity.WARNING, "Vehicle: the wind is strong")
        for _ in range(6):
            app.pull()
        status = app._flight.query_one("#status", Instrument).render_line(0).text
        assert "TAKEOFF" in status
        assert "ARMED" in status
        events = app._flight.query_one("#events", Instrument)
        assert any("the wind is strong" in events.render_line(y).text for y in range(events.size.height))
        await pilot.press("h")
        (command,) = commands.drain()
        assert (command.kind, command.value, command.source) == (CommandKind.HOLD, 0, b"screen")
        answer = CommandAnswer(
            t=time.monotonic(), number=command.number, kind=command.kind, ok=0, text=b"busy"
        )
        answers.send(answer)
        app.pull()
        await pilot.pause()
        assert [note.message for note in app._notifications] == ["Hold refused: busy."]
    here.close()
    there.close()


async def test_a_choice_is_a_command_with_the_value_that_follows_from_what_the_pilot_says(run_id):
    here, there = Bus(run_id, "screen"), Bus(run_id, "pilot")
    commands = there.subscriber(COMMAND)
    app = FlightApp(canned_run(), Console(here, "screen"), CannedSupervisor(), None)
    async with app.run_test() as pilot:
        # From a moment to come, so that it is not too old to be true on a machine that is busy.
        state = PilotState(t=time.monotonic() + 60.0, preset=Preset.ASSISTED, cues=31)
        there.publisher(PILOT_STATE).send(state)
        app.pull()
        await pilot.press("p", "1")
        sent = [(command.kind, command.value) for command in commands.drain()]
        assert sent == [(CommandKind.PRESET, Preset.TRANSPARENT), (CommandKind.CUES, 30)]
    here.close()
    there.close()


async def test_the_on_screen_stick_moves_the_virtual_handle(run_id):
    path = str(run_folder(run_id) / "hand.sock")
    receiver = StickReceiver(path, time.monotonic)
    receiver.open()
    sender = StickSender(path)
    flight = CannedFlight(canned_run())
    app = FlightApp(canned_run(), CannedReader(flight.snapshot()), CannedSupervisor(), sender)
    async with app.run_test() as pilot:
        await pilot.press("up", "up", "a")
        sample = await newest(receiver)
        assert sample.position == pytest.approx((0.04, 0.0, 0.0))
        assert sample.yaw == pytest.approx(0.2)
        await pilot.press("space")
        assert (await newest(receiver)).position == (0.0, 0.0, 0.0)
    receiver.close()
    sender.close()


async def newest(receiver: StickReceiver) -> StickSample:
    """Pass over what waits in the socket and return the next sample that comes."""
    while receiver.receive():
        pass
    while not (samples := receiver.receive()):
        await asyncio.sleep(0.005)
    return samples[-1]


@pytest.mark.parametrize(("own", "has_stick"), [(True, True), (False, False)])
def test_only_a_device_of_this_run_is_moved_by_the_screen(run_id, monkeypatch, own, has_stick):
    seen: list[object] = []

    def instead(run, console, supervisor, stick, **_) -> int:
        seen.append(stick)
        return 0

    monkeypatch.setattr(app_module, "run_screen", instead)
    device = f"virtual:{run_folder(run_id) / 'hand.sock'}" if own else "falcon"
    run = msgspec.structs.replace(canned_run(), run_id=run_id, device=device)
    bus = Bus(run_id, "screen")
    assert fly_on_screen(run, bus, CannedSupervisor()) == 0
    assert (seen[0] is not None) is has_stick
    bus.close()


async def test_a_stick_nobody_listens_to_does_not_disturb_the_screen(run_id):
    sender = StickSender(str(run_folder(run_id) / "nobody.sock"))
    flight = CannedFlight(canned_run())
    app = FlightApp(canned_run(), CannedReader(flight.snapshot()), CannedSupervisor(), sender)
    async with app.run_test():
        await asyncio.sleep(0.1)
        assert app.return_code is None
    sender.close()
