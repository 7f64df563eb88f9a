"""A servo in virtual time with a real bus and a real driver, and the rest of the program as it sees it there."""

from __future__ import annotations

from pathlib import Path

from drivers.stick import StickSender
from drivers.virtual import VirtualHandle
from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.devices.keeper import DeviceKeeper
from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    EVENT,
    HANDLE,
    OBSTACLES,
    PILOT_STATE,
    SETPOINT,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    Command,
    CommandKind,
    FlightMode,
    Phase,
    Severity,
    Stream,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.servo import Servo
from groundstation.run import Run, write_run
from groundstation.run_folder import new_run_id, sweep

DT = 0.001


def make_run(run_id: str, device: str, controller: str = "paper", settings: Settings | None = None) -> Run:
    return Run(
        run_id, "udpin://127.0.0.1:0", True, device, None, "", settings or Settings(), "", "", "",
        controller=controller,
    )  # fmt: skip


class World:
    """The rest of the program as the servo sees it on the bus: link, console, and whoever holds the stick."""

    def __init__(self, run_id: str, socket: str) -> None:
        self.bus = Bus(run_id, "test")
        self._states = self.bus.publisher(VEHICLE_STATE)
        self._statuses = self.bus.publisher(VEHICLE_STATUS)
        self._commands = self.bus.publisher(COMMAND)
        self.setpoints = self.bus.subscriber(SETPOINT)
        self.pilots = self.bus.subscriber(PILOT_STATE)
        self.answers = self.bus.subscriber(COMMAND_ANSWER)
        self.events = self.bus.subscriber(EVENT)
        self.handles = self.bus.subscriber(HANDLE)
        self.stick = StickSender(socket)
        self.state = VehicleState(valid=1, boot_t=30.0)
        self.state.position[:] = (1.0, 2.0, 3.0, 0.0)
        self.status = VehicleStatus(connected=1, armed=1, in_air=1, mode=FlightMode.HOLD)
        self.number = 0
        self.tells_state = True
        self.ranges = self.bus.publisher(OBSTACLES)

    def say(self, now: float) -> None:
        self.state.t = self.status.t = now
        if self.tells_state:
            self._states.send(self.state)
        self._statuses.send(self.status)

    def confirm(self, mode: FlightMode = FlightMode.OFFBOARD, stream: Stream = Stream.FLYING) -> None:
        self.status.mode, self.status.streaming = mode, stream

    def command(self, kind: CommandKind, now: float, value: int = 0) -> int:
        self.number += 1
        self._commands.send(Command(t=now, number=self.number, kind=kind, value=value, source=b"test"))
        return self.number

    def close(self) -> None:
        self.stick.close()
        self.bus.close()


class Bench:
    """A servo in virtual time."""

    def __init__(self, tmp_path: Path, controller: str = "paper", settings: Settings | None = None) -> None:
        self.now = 1000.0
        self.run_id = new_run_id()
        self.run_ = make_run(self.run_id, "", controller, settings)
        write_run(self.run_)
        socket = str(tmp_path / "hand.sock")
        self.world = World(self.run_id, socket)
        self.bus = Bus(self.run_id, "pilot")
        self.device = VirtualHandle(socket, lambda: self.now)
        self.servo = Servo(
            self.run_,
            self.bus,
            DeviceKeeper(self.device, self.bus.event, lambda: self.now, lambda work: work()),
            lambda: self.now,
        )
        self.stick: tuple[float, float, float] | None = (0.0, 0.0, 0.0)
        self.buttons = 0
        self.vehicle = True

    def tick(self) -> None:
        self.run(DT)

    def run(self, seconds: float) -> None:
        for tick in range(round(seconds / DT)):
            self.now += DT
            if self.stick is not None and tick % 10 == 0:
                self.world.stick.send(self.stick, 0.0, self.buttons, self.now)
            if self.vehicle and tick % 20 == 0:
                self.world.say(self.now)
            self.servo.tick(self.now, DT)

    def phase(self) -> Phase:
        newest = self.world.pilots.newest()
        assert newest is not None
        return Phase(newest.phase)

    def engage(self) -> None:
        self.run(1.2)
        self.world.command(CommandKind.ENGAGE, self.now)
        self.run(0.2)
        self.world.confirm(FlightMode.HOLD, Stream.STARTING)
        self.run(0.2)
        self.world.confirm()
        self.run(0.1)
        assert self.phase() is Phase.ENGAGED
        self.said()

    def said(self) -> list[tuple[Severity, str]]:
        return [(Severity(event.severity), event.text.decode()) for event in self.world.events.drain()]

    def close(self) -> None:
        self.servo.close()
        self.bus.close()
        self.world.close()
        sweep(self.run_id)
