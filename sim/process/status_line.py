"""How the vehicles are, for people: rewritten in place on a terminal, elsewhere a plain line at each change."""

from __future__ import annotations

import math
import os
import select
import shutil
import sys
from collections import deque
from collections.abc import Callable, Mapping, Sequence

from sim.process.vehicle import Vehicle

# So many vehicles have a line of their own; of the others only the number is told.
MOST_LINES = 8
# Below this share of the speed asked for, the machine does not keep up.
_KEEPS_UP = 0.95
# Where lines stay, the mean of so many is told: a moment is not worth a line.
_MEAN_OF = 10
_GREEN, _YELLOW, _RED, _PLAIN = "\x1b[32m", "\x1b[33m", "\x1b[31m", "\x1b[0m"


class StatusLine:
    """Writes the state of vehicles.

    Args:
        write: Takes text; it must never wait.
        columns: Returns the terminal's width, or None where lines are not to be rewritten.
        colour: Escape codes for colours are understood and wanted.
    """

    def __init__(
        self, write: Callable[[str], None], columns: Callable[[], int] | None, *, colour: bool
    ) -> None:
        self._write = write
        self._columns = columns
        self._colour = colour
        self._shown = 0
        self._told: list[tuple[object, ...]] = []
        self._achieved: deque[float] = deque(maxlen=_MEAN_OF)
        self._behind = False

    def say(self, text: str) -> None:
        """Write a line that stays."""
        self._write(f"{text}\n")

    def show(self, vehicles: Sequence[Vehicle], asked: float, achieved: float | None) -> None:
        """Write how the vehicles are.

        Args:
            vehicles: All of them.
            asked: Speed asked for, times real time.
            achieved: Speed since the last call; None at first.
        """
        shown = vehicles[:MOST_LINES]
        if self._columns is None:
            self._log(shown, asked, achieved, number=len(vehicles) > 1)
            return
        lines = [line(vehicle, number=len(vehicles) > 1) for vehicle in shown]
        if told := pace(asked, achieved):
            lines[-1] += f"  {told}"
        if len(vehicles) > len(shown):
            lines.append(f"and {len(vehicles) - len(shown)} more")
        width = max(1, self._columns() - 1)
        back = f"\x1b[{self._shown - 1}A" if self._shown > 1 else ""
        self._write(f"{back}\r" + "\n".join(f"{self._paint(text[:width])}\x1b[K" for text in lines))
        self._shown = len(lines)

    def end(self) -> None:
        """Leave the cursor on a new line."""
        if self._shown:
            self._write("\n")

    def _log(
        self, vehicles: Sequence[Vehicle], asked: float, achieved: float | None, *, number: bool
    ) -> None:
        """Write a line for each vehicle that has changed, and one when the machine begins or ceases to keep up."""
        states = [_state(vehicle) for vehicle in vehicles]
        for place, vehicle in enumerate(vehicles):
            if place >= len(self._told) or states[place] != self._told[place]:
                self.say(line(vehicle, number=number))
        self._told = states
        if achieved is None:
            return
        self._achieved.append(achieved)
        mean = sum(self._achieved) / len(self._achieved)
        behind = mean < _KEEPS_UP * asked
        if behind != self._behind:
            self._behind = behind
            self.say(pace(asked, mean) or "in real time again")

    def _paint(self, text: str) -> str:
        if not self._colour:
            return text
        for word, code in (
            (" armed", _GREEN),
            ("FAILSAFE", _RED),
            ("collisions", _YELLOW),
            ("behind", _YELLOW),
        ):
            text = text.replace(word, f"{code}{word}{_PLAIN}")
        return text


def line(vehicle: Vehicle, *, number: bool) -> str:
    """Return one line on how a vehicle is, with its system id where there are several."""
    simulator = vehicle.simulator
    autopilot = simulator.autopilot
    x, y, z, yaw = simulator.p
    parts = [
        f"{vehicle.system_id:3} " if number else "",
        f"{autopilot.mode.value:9} {'armed' if autopilot.armed else 'disarmed':9}",
        f"x {x:7.2f}  y {y:7.2f}  z {z:6.2f} m  yaw {math.degrees(yaw):4.0f}°",
        f"  battery {simulator.battery.remaining:4.0%}",
        "  FAILSAFE" if autopilot.failsafe else "",
        f"  {len(simulator.collisions)} collisions" if simulator.collisions else "",
        "" if any(connection.transport.heard for connection in vehicle.connections) else "  nobody listens",
    ]
    return "".join(parts)


def pace(asked: float, achieved: float | None) -> str:
    """Return how fast time passes, or "" where it is real time."""
    if achieved is not None and achieved < _KEEPS_UP * asked:
        return f"speed {achieved:.2f}, behind: {asked:g} asked"
    return "" if asked == 1.0 else f"speed {asked:g}"


def _state(vehicle: Vehicle) -> tuple[object, ...]:
    """Return what is worth a new line where lines stay."""
    autopilot = vehicle.simulator.autopilot
    return autopilot.mode, autopilot.armed, autopilot.failsafe, len(vehicle.simulator.collisions)


def on_stdout(environment: Mapping[str, str] = os.environ) -> StatusLine:
    """Return a status line on standard output; colour only on a terminal, and where NO_COLOR does not forbid it."""
    terminal = sys.stdout.isatty() and environment.get("TERM") != "dumb"
    colour = terminal and not environment.get("NO_COLOR")
    columns = (lambda: shutil.get_terminal_size().columns) if terminal else None
    return StatusLine(_writer(sys.stdout.fileno()), columns, colour=colour)


def _writer(descriptor: int) -> Callable[[str], None]:
    """Return a function that writes to a descriptor, or leaves it where that would wait: a vehicle cannot."""
    gone = False

    def write(text: str) -> None:
        nonlocal gone
        try:
            if not gone and select.select([], [descriptor], [], 0.0)[1]:
                os.write(descriptor, text.encode())
        except OSError:
            gone = True

    return write
