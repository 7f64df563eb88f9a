"""The whole program for long, with random faults: nothing may die, grow, or fall behind.

The program with its screen in a terminal, a simulated vehicle behind a tap, a hand that never rests. Every few
seconds something goes wrong; then the operator engages again. Which and when is drawn from a seed.
"""

from __future__ import annotations

import contextlib
import math
import os
import random
import signal
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from pymavlink.dialects.v20 import common as mavlink

from bench import gauges
from bench.rig import Hand, Program, Tap, vehicle
from groundstation.messages import CommandKind, FlightMode, Health, Phase, Severity

FULL_S, SHORT_S = 1800.0, 300.0
GROWTH_BAR_MB, TICKS_BAR = 1.0, 0.99
# Caches fill, pages of the screen are made for the first time.
_WARM_UP = 0.2
_SAMPLE_S = 1.0
_BETWEEN_S = (2.0, 6.0)
_COUPLE_S = 45.0
_REACH_M = 0.06
# A process is stopped for no longer.
_HELD_UP_S = 2.0
# As many events as the screen keeps, and a few more.
_SAID = 520
# Some three minutes of recording: its parts are begun and ended all the time.
_CONFIG = "[recording]\npart_mb = 60\n"
_KEYS = (
    "\x1b[18~",
    "\x1b[19~",
    "\x1b[20~",
    "\x1b[21~",
    "\x1b[24~",
    "v",
    "+",
    "-",
    "g",
    "\t",
    "p",
    "f",
    "o",
    "?",
    "\x1b",
)


class Soak:
    """The program, and what is done to it.

    Args:
        folder: Where recordings go.
        seed: Of the faults.

    Attributes:
        readings: Of each process, by role.
        done: How often each fault was done.
        uncoupled: How often the hand could not be coupled again in time.
        ticks, missed: Of the servo, while nothing was wrong.
    """

    def __init__(self, folder: Path, seed: int) -> None:
        self._draw = random.Random(seed)
        self._tap = Tap()
        self._vehicle = contextlib.ExitStack()
        self._start_vehicle()
        address = str(folder / "hand.sock")
        self._hand = Hand(address)
        config = folder / "config.toml"
        config.write_text(_CONFIG)
        self.program = Program(
            "--connect", f"udpout://127.0.0.1:{self._tap.program_port}", "--device", f"virtual:{address}",
            "--mission", "free", "--logs", str(folder), "--config", str(config), columns=120, rows=40,
        )  # fmt: skip
        self._pids = {"screen": self.program.process.pid, **self.program.pids()}
        self._next_sample = 0.0
        self.readings: dict[str, list[gauges.Reading]] = {role: [] for role in self._pids}
        self.done: Counter[str] = Counter()
        self.uncoupled = 0
        self.ticks = self.missed = 0
        self._faults: dict[str, Callable[[], None]] = {
            "link cut": self._cut,
            "process stopped": self._stop,
            "hand silent": self._silence,
            "taken over": self._take_over,
            "vehicle restarted": self._restart_vehicle,
            "poor link": self._worsen,
            "garbage": self._babble,
            "keys": self._press,
            "released": self._release,
        }

    def run(self, seconds: float) -> Iterator[str]:
        """Do faults for so long; yield a line about each twentieth of it."""
        self._look_round()
        began = time.monotonic()
        told = 0
        while (passed := time.monotonic() - began) < seconds and not self.dead():
            self._couple()
            self._fly(self._draw.uniform(*_BETWEEN_S))
            fault = self._draw.choice(list(self._faults))
            self._faults[fault]()
            self.done[fault] += 1
            if passed > (told + 1) * seconds / 20:
                told += 1
                yield f"{passed:6.0f} s: {self.done.total()} faults, {self.uncoupled} times not coupled again in time"

    def _look_round(self) -> None:
        """Fill what is kept up to a number, open every page, hold all up once, fly to the landing: no growth."""
        for number in range(_SAID):
            self.program.bus.event(Severity.INFO, f"Said before the soak begins, {number} of {_SAID}.")
            if number % 10 == 0:
                self._pass(0.1)
        self._couple()
        for key in (*_KEYS, *_KEYS):
            self.program.type(key)
            self._pass(1.0)
        for role in self._pids:
            self._hold_up(role, _HELD_UP_S)
            self._couple()
        self._land()
        self._back()

    def _land(self) -> None:
        end = time.monotonic() + _COUPLE_S
        while time.monotonic() < end and not self.dead():
            status = self.program.console.snapshot().status
            if status and not status.armed:
                return
            if status and status.in_air and status.mode != FlightMode.LAND:
                self.program.console.command(CommandKind.LAND)
            self._pass(1.0)

    def dead(self) -> list[str]:
        """Return the processes that have died."""
        return [role for role, pid in self._pids.items() if gauges.read(pid, 0.0) is None]

    def close(self) -> None:
        """End everything."""
        self._hand.close()
        self.program.close()
        self._vehicle.close()
        self._tap.close()

    def _start_vehicle(self) -> None:
        self._vehicle.close()
        self._vehicle.enter_context(vehicle(self._tap.vehicle_port))

    def _pass(self, seconds: float) -> None:
        """Let time pass, the hand moving, and look at the processes meanwhile."""
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end and not self.dead():
            self._hand.put((_REACH_M * math.cos(now), _REACH_M * math.sin(0.7 * now), 0.0))
            self._sample(now)
            time.sleep(0.02)

    def _fly(self, seconds: float) -> None:
        """Fly undisturbed, and count the servo's ticks."""
        before = self.program.console.snapshot().servo
        self._pass(seconds)
        after = self.program.console.snapshot().servo
        if before and after:
            self.ticks += after.ticks - before.ticks
            self.missed += after.missed - before.missed

    def _sample(self, now: float) -> None:
        if now < self._next_sample:
            return
        self._next_sample = now + _SAMPLE_S
        for role, pid in self._pids.items():
            if reading := gauges.read(pid, now):
                self.readings[role].append(reading)
        # What was overheard is of no use here, and the snapshot takes the events out.
        for heard in (self._tap.heard, self._tap.said, self._tap.setpoints, self._tap.commands):
            heard.clear()
        self.program.console.snapshot()

    def _couple(self) -> None:
        """Do what an operator does to fly on."""
        console, end = self.program.console, time.monotonic() + _COUPLE_S
        while time.monotonic() < end and not self.dead():
            view = console.snapshot()
            status, pilot = view.status, view.pilot
            if pilot and pilot.phase == Phase.ENGAGED:
                return
            self._hand.put((0.0, 0.0, 0.0))
            if status and status.connected and view.t - status.t < 0.5:
                if not status.armed and status.health & Health.ARMABLE:
                    console.command(CommandKind.ARM)
                elif status.armed and not status.in_air:
                    console.command(CommandKind.TAKEOFF)
                elif status.in_air and status.mode in {FlightMode.HOLD, FlightMode.OFFBOARD}:
                    console.command(CommandKind.ENGAGE)
                elif status.in_air and status.mode is not FlightMode.TAKEOFF:
                    console.command(CommandKind.HOLD)
            for _ in range(50):
                self._sample(time.monotonic())
                time.sleep(0.02)
        self.uncoupled += 1

    def _cut(self) -> None:
        self._tap.passes = lambda _: False
        self._pass(self._draw.uniform(0.2, 8.0))
        self._tap.passes = lambda _: True

    def _stop(self) -> None:
        self._hold_up(self._draw.choice(list(self._pids)), self._draw.uniform(0.05, _HELD_UP_S))

    def _hold_up(self, role: str, seconds: float) -> None:
        os.kill(self._pids[role], signal.SIGSTOP)
        self._pass(seconds)
        os.kill(self._pids[role], signal.SIGCONT)

    def _silence(self) -> None:
        self._hand.silent = True
        time.sleep(self._draw.uniform(0.1, 1.0))
        self._hand.silent = False

    def _take_over(self) -> None:
        other = mavlink.MAVLink(None, srcSystem=254, srcComponent=190)
        hold = other.command_long_encode(1, 1, 176, 0, 1 | 128, 4, 3, 0, 0, 0, 0)
        self._tap.inject(bytes(hold.pack(other)))
        self._pass(1.0)

    def _restart_vehicle(self) -> None:
        self._start_vehicle()
        self._pass(1.0)

    def _worsen(self) -> None:
        poor = {"DELAY": 0.15, "JITTER": 0.05, "LOSS": 0.1, "REORD": 0.2, "DUP": 0.1}
        self._set(poor)
        self._pass(3.0)
        for _ in range(10):
            self._set(dict.fromkeys(poor, 0.0))
            self._pass(0.05)

    def _set(self, conditions: dict[str, float]) -> None:
        other = mavlink.MAVLink(None, srcSystem=254, srcComponent=190)
        for way in ("UP", "DN"):
            for name, value in conditions.items():
                parameter = f"SIM_{way}_{name}".encode()
                message = other.param_set_encode(1, 1, parameter, value, mavlink.MAV_PARAM_TYPE_REAL32)
                self._tap.inject(bytes(message.pack(other)))

    def _babble(self) -> None:
        for _ in range(50):
            self._tap.say(self._draw.randbytes(self._draw.randint(1, 300)))
        self._pass(0.2)

    def _press(self) -> None:
        for _ in range(8):
            self.program.type(self._draw.choice(_KEYS))
            self._pass(0.15)
        self._back()

    def _back(self) -> None:
        """Go back to the flight, as an operator does, from a page and what lies over it."""
        for _ in range(3):
            self.program.type("\x1b")
            self._pass(0.3)

    def _release(self) -> None:
        self.program.console.command(CommandKind.DISENGAGE)
        self._pass(0.5)


class Result(NamedTuple):
    """What came of a soak.

    Attributes:
        grown: What each process has taken more after the warm-up, by role.
        faults: How often each was done.
        dead: Processes that died.
        uncoupled: How often the hand could not be coupled again in time.
        ticks, missed: Of the servo, while nothing was stopped.
    """

    grown: Mapping[str, gauges.Growth]
    faults: Counter[str]
    dead: Sequence[str]
    uncoupled: int
    ticks: int
    missed: int

    @property
    def kept(self) -> float:
        """The share of ticks that were kept."""
        return self.ticks / max(1, self.ticks + self.missed)

    def violations(self) -> list[str]:
        """Return in words what is not as it must be."""
        grown = [
            f"{role} has grown"
            for role, growth in self.grown.items()
            if growth.memory > GROWTH_BAR_MB or growth.descriptors > 0
        ]
        died = [f"{role} has died" for role in self.dead]
        late = [f"{self.kept:.1%} of the ticks"] if self.kept < TICKS_BAR else []
        return grown + died + late + ["not coupled again"] * bool(self.uncoupled)

    def table(self) -> Iterator[str]:
        """Yield it in words."""
        yield from (f"{role:<9} {growth}" for role, growth in self.grown.items())
        yield f"faults: {', '.join(f'{name} {count}' for name, count in sorted(self.faults.items()))}"
        yield f"died {len(self.dead)} (0), not coupled again in time {self.uncoupled} (0)"
        yield f"ticks {self.kept:.2%} of {self.ticks + self.missed} while nothing was stopped (≥ {TICKS_BAR:.0%})"
        yield f"VIOLATED: {', '.join(bad)}" if (bad := self.violations()) else "all within the bars"


def soak(seconds: float, seed: int) -> Generator[str, None, Result]:
    """Soak for so long: yield its course, return what came of it."""
    with tempfile.TemporaryDirectory() as folder:
        it = Soak(Path(folder), seed)
        try:
            yield from it.run(seconds)
            dead = it.dead()
        finally:
            it.close()
    grown = {
        role: gauges.growth(readings[round(_WARM_UP * len(readings)) :])
        for role, readings in it.readings.items()
    }
    return Result(grown, it.done, dead, it.uncoupled, it.ticks, it.missed)


def main(*, short: bool) -> Iterator[str]:
    """Yield the table."""
    result = yield from soak(SHORT_S if short else FULL_S, seed=0)
    yield from result.table()
