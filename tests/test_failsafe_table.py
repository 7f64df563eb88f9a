"""The failsafe table row by row: each condition, made true alone where it is seen, gives its action and its words."""

from __future__ import annotations

import math
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import hypot, nan
from pathlib import Path

import msgspec
import pytest
from canned_flight import CannedFlight, canned_run
from servo_bench import DT, Bench
from test_tui_judge import frame

from groundstation.bus import Bus
from groundstation.child import Lifeline
from groundstation.conditions import Conditions
from groundstation.config import Buttons, Safety, Settings, Shield
from groundstation.failsafe import BY_FAULT, TABLE, Action, Fault, Row, Who, rows, table
from groundstation.messages import COMMAND, EVENT, CommandKind, FlightMode, Phase, Ranges, Severity, Stream
from groundstation.processes import Process, Supervisor
from groundstation.recording.parts import parts_of
from groundstation.run import write_run
from groundstation.run_folder import new_run_id, run_folder, sweep
from groundstation.tui.alerts import conditions
from groundstation.vehicle.offboard import Act, OffboardStream, Seen

DOC = Path(__file__).resolve().parents[1] / "docs" / "operating.md"
SETTINGS = Settings(buttons=Buttons(enable=6, panic=7), shield=Shield(ceiling=3.4))
HELD, PANIC = 1 << 6, 1 << 7


def said(row: Row) -> re.Pattern[str]:
    """Return what a row's words look like with any figures in them."""
    return re.compile(".*".join(map(re.escape, re.split(r"\{[^}]*\}", row.words))))


def test_every_fault_has_one_row() -> None:
    assert [row.fault for row in TABLE] == list(dict.fromkeys(row.fault for row in TABLE))
    assert set(BY_FAULT) == set(Fault)


def test_where_all_is_well_no_row_holds() -> None:
    assert [row.fault for row in TABLE if row.holds(Conditions(), Safety())] == []


def test_the_documentation_shows_the_table() -> None:
    assert table() in DOC.read_text(encoding="utf-8")


# What the pilot sees, in a whole servo with a real bus and driver.


class Device:
    """A driver that can be made to fail as the bench's own cannot."""

    def __init__(self, inner: object) -> None:
        self._inner = inner
        self.gone, self.homed = False, True

    def __getattr__(self, name: str) -> object:
        return getattr(self._inner, name)

    def read(self) -> object:
        from drivers.device import DeviceError

        if self.gone:
            raise DeviceError("unplugged")
        return self._inner.read()._replace(homed=self.homed)


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path, settings=SETTINGS)
    bench.double = Device(bench.device)
    bench.servo._keeper._device = bench.double
    bench.buttons = HELD
    yield bench
    bench.close()


def set_status(**changes: float | bytes) -> Callable[[Bench], None]:
    def spoil(bench: Bench) -> None:
        for name, value in changes.items():
            setattr(bench.world.status, name, value)

    return spoil


def set_state(name: str, value: object) -> Callable[[Bench], None]:
    def spoil(bench: Bench) -> None:
        setattr(bench.world.state, name, value)

    return spoil


def set_bench(name: str, value: object) -> Callable[[Bench], None]:
    def spoil(bench: Bench) -> None:
        setattr(bench, name, value)

    return spoil


def stall(bench: Bench) -> None:
    bench.now += 0.2


def no_states(bench: Bench) -> None:
    bench.world.tells_state = False


ENGAGED: dict[Fault, Callable[[Bench], None]] = {
    Fault.DEVICE_LOST: lambda bench: setattr(bench.double, "gone", True),
    Fault.NOT_HOMED: lambda bench: setattr(bench.double, "homed", False),
    Fault.SQUEEZED: set_bench("buttons", HELD | PANIC),
    Fault.NOT_ENABLED: set_bench("buttons", 0),
    Fault.UNBELIEVABLE: set_state("velocity", (nan, 0.0, 0.0, 0.0)),
    Fault.HANDLE_STALE: set_bench("stick", None),
    Fault.SERVO_STALLED: stall,
    Fault.REBOOTED: set_state("boot_t", 0.5),
    Fault.LINK_CUT: set_status(connected=0),
    Fault.STATE_STALE: no_states,
    Fault.LINK_POOR: set_status(loss=0.9),
    Fault.UNTRUSTED: set_state("valid", 0),
    Fault.DISARMED: set_status(armed=0),
    Fault.LANDED: set_status(in_air=0),
    Fault.OVERSPEED: set_state("velocity", (5.6, 0.0, 0.0, 0.0)),
    Fault.MODE_TAKEN: lambda bench: bench.world.confirm(FlightMode.POSITION),
    Fault.STREAM_STOPPED: lambda bench: bench.world.confirm(stream=Stream.ENDED),
}
ENGAGING: dict[Fault, Callable[[Bench], None]] = {
    Fault.MODE_MEANWHILE: lambda bench: bench.world.confirm(FlightMode.RETURN, Stream.STARTING),
    Fault.UNCONFIRMED: lambda _: None,
}
REFUSED: dict[Fault, Callable[[Bench], None]] = {
    Fault.STATE_UNKNOWN: no_states,
    Fault.UNSAFE: set_status(unsafe=b"GF_ACTION = 4 (Terminate)"),
    Fault.STREAM_ENDING: set_status(streaming=Stream.FLYING),
    Fault.NOT_CENTRED: set_bench("stick", (0.05, 0.0, 0.0)),
}
FLOWN = {Fault.STATE_LATE, Fault.OBSTACLE, Fault.FENCE}


def test_every_row_of_the_pilot_is_tested_here() -> None:
    assert {row.fault for row in rows(Who.PILOT)} == {*ENGAGED, *ENGAGING, *REFUSED, *FLOWN}


def force_on(bench: Bench) -> float:
    """Return the force on the hand, N."""
    return hypot(*bench.world.handles.newest().force)


def until_released(bench: Bench, within: float) -> float:
    """Run until the hand is uncoupled; return the force on it at that very tick, N."""
    for _ in range(round(within / DT)):
        bench.tick()
        if bench.phase() is Phase.DISENGAGED:
            return force_on(bench)
    pytest.fail(f"still coupled after {within} s")


@pytest.mark.parametrize("fault", ENGAGED, ids=str)
def test_what_ends_a_coupling(bench: Bench, fault: Fault) -> None:
    row = BY_FAULT[fault]
    bench.engage()
    bench.stick = (0.1, 0.0, 0.0)
    bench.run(1.0)
    assert force_on(bench) > 1.0
    ENGAGED[fault](bench)
    force = until_released(bench, 0.6)
    if row.action is Action.CUT:
        assert force == 0.0
    else:
        assert row.action is Action.FADE
        assert (force > 0.0) is (fault is not Fault.STATE_STALE)
    setpoint = bench.world.setpoints.newest()
    assert (setpoint.active, *setpoint.velocity) == (0, 0.0, 0.0, 0.0, 0.0)
    told = [(severity, words) for severity, words in bench.said() if words.startswith("Disengaged: ")]
    assert [severity for severity, _ in told] == [row.severity]
    assert said(row).search(told[0][1])
    bench.run(0.1)
    assert force_on(bench) == 0.0


@pytest.mark.parametrize("fault", ENGAGING, ids=str)
def test_what_ends_engaging(bench: Bench, fault: Fault) -> None:
    row = BY_FAULT[fault]
    bench.run(1.2)
    bench.world.command(CommandKind.ENGAGE, bench.now)
    bench.run(0.1)
    assert bench.phase() is Phase.ENGAGING
    ENGAGING[fault](bench)
    until_released(bench, 3.1)
    assert any(severity is row.severity and said(row).search(words) for severity, words in bench.said())


# These are seen only by what has been since engaging.
SINCE = {Fault.REBOOTED, Fault.MODE_TAKEN, Fault.STREAM_STOPPED}


@pytest.mark.parametrize("fault", [each for each in [*ENGAGED, *REFUSED] if each not in SINCE], ids=str)
def test_what_refuses_to_couple(bench: Bench, fault: Fault) -> None:
    spoil = (ENGAGED | REFUSED)[fault]
    if fault is Fault.STATE_UNKNOWN:
        spoil(bench)
    bench.run(1.2)
    bench.said()
    spoil(bench)
    if fault is not Fault.SERVO_STALLED:
        bench.run(0.6 if fault is Fault.STATE_STALE else 0.15)
    bench.world.command(CommandKind.ENGAGE, bench.now)
    bench.tick()
    assert bench.phase() is Phase.DISENGAGED
    answer = bench.world.answers.newest()
    assert answer is not None
    assert not answer.ok
    assert said(BY_FAULT[fault]).search(answer.text.decode())
    assert not any(setpoint.active for setpoint in bench.world.setpoints.drain())


def test_a_late_state_lets_the_force_fade_and_keeps_the_hand(bench: Bench) -> None:
    assert BY_FAULT[Fault.STATE_LATE].action is Action.EASE
    bench.engage()
    bench.stick = (0.1, 0.0, 0.0)
    bench.run(1.0)
    no_states(bench)
    bench.run(0.3)
    assert bench.phase() is Phase.ENGAGED
    assert force_on(bench) == 0.0


@pytest.mark.parametrize(
    ("fault", "stick", "by"),
    [(Fault.OBSTACLE, (0.1, 0.0, 0.0), "sensor"), (Fault.FENCE, (0.0, 0.0, 0.1), "ceiling")],
)
def test_what_is_near_bounds_the_velocity(
    bench: Bench, fault: Fault, stick: tuple[float, float, float], by: str
) -> None:
    assert BY_FAULT[fault].action is Action.BOUND
    bench.engage()
    bench.stick = stick
    for _ in range(20):
        ring = [math.inf] * 72
        ring[0] = 0.9 if fault is Fault.OBSTACLE else math.inf
        bench.world.ranges.send(Ranges(t=bench.now, ring=tuple(ring), below=3.0, above=math.inf, limit=12.0))
        bench.run(0.05)
    pilot = bench.world.pilots.newest()
    assert (pilot.phase, pilot.guarding, pilot.guarded_by.decode()) == (Phase.ENGAGED, 1, by)
    axis = 0 if fault is Fault.OBSTACLE else 2
    assert pilot.v_safe[axis] < pilot.v_ref[axis] - 0.3
    shown = frame(guarded_by=by)
    assert any(BY_FAULT[fault].say(Conditions(guarded_by=by)) == each.text for each in conditions(shown))


# What the link sees.


def streaming(state: Stream) -> OffboardStream:
    return OffboardStream(Safety(), state=state)


def test_every_row_of_the_link_is_tested_here() -> None:
    assert {row.fault for row in rows(Who.LINK)} == {
        Fault.PILOT_SILENT,
        Fault.STREAM_TAKEN,
        Fault.LINK_SILENT,
    }


@pytest.mark.parametrize(
    ("fault", "age", "mode", "act"),
    [
        (Fault.PILOT_SILENT, 0.16, FlightMode.OFFBOARD, Act.CLOSE_AND_HOLD),
        (Fault.PILOT_SILENT, nan, FlightMode.OFFBOARD, Act.CLOSE_AND_HOLD),
        (Fault.STREAM_TAKEN, 0.01, FlightMode.POSITION, Act.CLOSE),
    ],
)
def test_what_ends_the_stream(fault: Fault, age: float, mode: FlightMode, act: Act) -> None:
    row = BY_FAULT[fault]
    assert (row.action is Action.HOLD) is (act is Act.CLOSE_AND_HOLD)
    stream = streaming(Stream.FLYING)
    assert stream.step(Seen(10.0, True, 0.01, FlightMode.OFFBOARD, 9.9)) == (Act.NOTHING, "")
    done, why = stream.step(Seen(10.1, True, age, mode, 10.0))
    assert done is act
    assert said(row).search(why)
    assert stream.state is Stream.ENDED


def test_a_silent_vehicle_is_told_by_a_real_link(tmp_path: Path) -> None:
    import queue

    from mavsdk import Configuration, Mavsdk

    from groundstation.vehicle.asleep import Sleep
    from groundstation.vehicle.conversation import Conversation
    from groundstation.vehicle.gate import Gate
    from groundstation.vehicle.open_transport import open_transport
    from groundstation.vehicle.pump import Pump
    from groundstation.vehicle.transport import Url

    row = BY_FAULT[Fault.LINK_SILENT]
    run = msgspec.structs.replace(canned_run(), run_id=new_run_id())
    write_run(run)
    bus = Bus(run.run_id, "link")
    events = bus.subscriber(EVENT)
    gate = Gate(0.15, time.monotonic)
    pump = Pump(open_transport(Url("udpin", "127.0.0.1", 0)), gate, None, time.monotonic)
    mav = Mavsdk(Configuration.create_manual(255, 190, True))
    pump.start(mav)
    vehicle = Conversation(run, bus, mav, pump, gate, notes=queue.SimpleQueue(), sleep=Sleep())
    try:
        vehicle.turn()
        assert list(events.drain()) == []
        pump.heard_t = time.monotonic() - 0.6
        vehicle._next_status = 0.0
        vehicle.turn()
        ((severity, words),) = [(event.severity, event.text.decode()) for event in events.drain()]
        assert severity == row.severity
        assert said(row).fullmatch(words)
    finally:
        vehicle.close()
        pump.stop()
        mav.destroy()
        bus.close()
        sweep(run.run_id)


# What the supervisor sees, of real processes.


@pytest.fixture
def run(tmp_path: Path) -> Iterator[object]:
    run = msgspec.structs.replace(canned_run(), run_id=new_run_id(), log=str(tmp_path / "log"))
    write_run(run)
    yield run
    sweep(run.run_id)


ROLES = {
    Fault.PILOT_DEAD: "pilot",
    Fault.LINK_DEAD: "link",
    Fault.RECORDER_DEAD: "recorder",
    Fault.SIM_DEAD: "sim",
    Fault.PROCESS_DEAD: "something",
}


def test_every_row_of_the_supervisor_is_tested_here() -> None:
    assert {row.fault for row in rows(Who.SUPERVISOR)} == {*ROLES, Fault.PROCESS_STALLED}


def until(condition: Callable[[], object], within_s: float = 20.0) -> object:
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if found := condition():
            return found
        time.sleep(0.01)
    return pytest.fail("did not happen in time")


@pytest.mark.parametrize("fault", ROLES, ids=str)
def test_a_dead_process_has_the_pilot_let_go(run: object, fault: Fault) -> None:
    row, role = BY_FAULT[fault], ROLES[fault]
    assert row.action is Action.RELEASE
    bus = Bus(run.run_id, "test")
    events, commands = bus.subscriber(EVENT), bus.subscriber(COMMAND)
    process = Process(role, (sys.executable, "-c", "import time; time.sleep(60)"))
    supervisor = Supervisor(run, (process,), bus)
    try:
        assert supervisor.poll() == []
        os.kill(supervisor._watched[0].popen.pid, signal.SIGKILL)
        until(supervisor.poll)
        assert [command.kind for command in commands.drain()] == [CommandKind.DISENGAGE]
        assert any(f"The {role} process has died".encode() in event.text for event in events.drain())
        shown = frame(**supervisor.states())
        assert f"{role} has ended: {row.words}." in [each.text for each in conditions(shown)]
    finally:
        supervisor.stop()
        bus.close()


def test_a_stalled_process_is_told(run: object) -> None:
    row, now = BY_FAULT[Fault.PROCESS_STALLED], [100.0]
    bus = Bus(run.run_id, "test")
    events, commands = bus.subscriber(EVENT), bus.subscriber(COMMAND)
    process = Process("pilot", (sys.executable, "-c", "import time; time.sleep(60)"))
    supervisor = Supervisor(run, (process,), bus, lambda: now[0])
    try:
        supervisor.poll()
        now[0] += 16.0
        assert supervisor.poll() == []
        assert [event.text.decode() for event in events.drain()] == [f"The pilot process {row.words}."]
        assert list(commands.drain()) == []
    finally:
        supervisor.stop()
        bus.close()


ORPHAN = """
import os, sys, time
from pathlib import Path
from groundstation.bus import Bus
from groundstation.child import Lifeline
from groundstation.run import read_run
run = read_run(Path(sys.argv[1]))
bus = Bus(run.run_id, "pilot")
lifeline = Lifeline(bus)
print(os.getpid(), flush=True)
while lifeline.holds():
    time.sleep(0.01)
# As a servo that lets its device go.
time.sleep(0.5)
bus.close()
"""


def test_a_process_whose_screen_has_gone_says_so_and_ends(run: object) -> None:
    row = BY_FAULT[Fault.SCREEN_DEAD]
    assert {each.fault for each in rows(Who.ALL)} == {row.fault}
    bus = Bus(run.run_id, "test")
    events = bus.subscriber(EVENT)
    start = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {ORPHAN!r}, sys.argv[1]])"
    screen = subprocess.Popen(
        [sys.executable, "-c", start, str(run_folder(run.run_id) / "run.json")],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        pid = int(screen.stdout.readline())
        screen.kill()
        told: list[tuple[int, str]] = []

        def gone() -> bool:
            told.extend((event.severity, event.text.decode()) for event in events.drain())
            return not Path(f"/proc/{pid}").exists()

        until(gone)
        assert told == [(row.severity, row.words)]
    finally:
        screen.stdout.close()
        screen.wait()
        bus.close()


def test_a_lifeline_ends_by_a_signal_without_a_word_of_the_screen(run: object) -> None:
    assert threading.current_thread() is threading.main_thread()
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)}
    bus = Bus(run.run_id, "pilot")
    events = bus.subscriber(EVENT)
    try:
        lifeline = Lifeline(bus)
        assert lifeline.holds()
        os.kill(os.getpid(), signal.SIGHUP)
        assert not lifeline.holds()
        assert list(events.drain()) == []
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        bus.close()


# What the recorder sees.


def test_every_row_of_the_recorder_is_tested_here() -> None:
    assert {row.fault for row in rows(Who.RECORDER)} == {Fault.DISK_LOW, Fault.DISK_FULL}


def test_a_disk_that_gets_full_is_told_once_and_recording_goes_on(run: object) -> None:
    from groundstation.recording.batch import Batch
    from groundstation.recording.session import Session

    row, told = BY_FAULT[Fault.DISK_LOW], []
    recording = msgspec.structs.replace(run.settings.recording, warn_gb=1e9)
    settings = msgspec.structs.replace(run.settings, recording=recording)
    session = Session(msgspec.structs.replace(run, settings=settings), 0.0, lambda *each: told.append(each))
    for _ in range(3):
        session.take(Batch())
    session.close()
    low = [(severity, words) for severity, words in told if said(row).search(words)]
    assert [severity for severity, _ in low] == [row.severity]
    assert parts_of(run.recording)[0].stat().st_size > 0


def test_a_recording_that_cannot_be_written_is_told(run: object, tmp_path: Path) -> None:
    from groundstation.recording.file import _sentence

    row = BY_FAULT[Fault.DISK_FULL]
    assert row.severity is Severity.ALARM
    assert _sentence(tmp_path / "flight.rrd").startswith(f"{row.words}: ")


# What the screen sees.

SEEN: dict[Fault, Callable[[object], None]] = {
    Fault.LINK_LOST: lambda s: setattr(s.status, "heard_t", s.t - 2.1),
    Fault.BATTERY_EMPTY: lambda s: setattr(s.status, "battery", 0.15),
    Fault.BATTERY_LOW: lambda s: setattr(s.status, "battery", 0.30),
    Fault.SERVO_OVERRUN: lambda s: setattr(s.servo, "late_p99", 0.0051),
}


def test_every_row_of_the_screen_is_tested_here() -> None:
    assert {row.fault for row in rows(Who.SCREEN)} == set(SEEN)


@pytest.mark.parametrize("fault", SEEN, ids=str)
def test_what_the_screen_tells(fault: Fault) -> None:
    row = BY_FAULT[fault]
    flight = CannedFlight(canned_run())
    flight.advance(12.0)
    shown = flight.snapshot()
    before = {each.text for each in conditions(frame(replace(shown)))}
    SEEN[fault](shown)
    new = [each for each in conditions(frame(shown)) if each.text not in before]
    assert [(each.severity, bool(said(row).fullmatch(each.text))) for each in new] == [(row.severity, True)]
