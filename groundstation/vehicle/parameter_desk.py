"""The vehicle's parameters on the bus: commands come in, what was read goes out; are those that are judged safe?"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator

from mavsdk import System

from groundstation.bus import Bus
from groundstation.clock import Every
from groundstation.frames import Vector3
from groundstation.messages import PARAMETER, PARAMETER_TEXT, Command, CommandKind, Parameter, Severity, fit
from groundstation.vehicle.commander import Answer
from groundstation.vehicle.gate import Gate
from groundstation.vehicle.judged_parameters import JudgedParameters, Told
from groundstation.vehicle.parameters import Parameters, Read, cannot_be_set
from groundstation.vehicle.profiles import Profile, speed_limits, unsafe_for

_AGAIN_S = 1.0
# A change is told once, and may be lost on its way: all that are judged are asked for this often, s.
_ASK_S = 30.0
PARAMETER_COMMANDS = frozenset({CommandKind.PARAMETERS, CommandKind.SET_PARAMETER})


class ParameterDesk:
    """Between the bus and the thread that reads and sets.

    Args:
        bus: Where what was read goes.
        system: The vehicle.
        gate: Lets a parameter be set.
        profile: Of its autopilot; None where nothing is known of it.
    """

    def __init__(self, bus: Bus, system: System, gate: Gate, profile: Profile | None) -> None:
        self._profile = profile
        self._parameters = Parameters(system, gate)
        wanted, bytewise = (profile.judged, profile.bytewise) if profile else ((), False)
        self._heard = JudgedParameters(system, wanted, bytewise=bytewise, clock=time.monotonic)
        self._bus = bus
        self._publisher = bus.publisher(PARAMETER)
        self._whole: dict[str, bool] = {}
        self._judged: dict[str, Parameter] = {}
        self._again, self._ask = Every(_AGAIN_S), Every(_ASK_S)
        self._boots = self._absences = self._total = 0

    @property
    def unsafe(self) -> str:
        """Why the vehicle's parameters keep the hand from being coupled, or ""."""
        return unsafe_for(self._profile, self._heard.values)

    @property
    def speed_limits(self) -> Vector3:
        """The largest speeds that the vehicle allows, m/s: around, up, down; 0 where that is not known."""
        return speed_limits(self._profile, self._heard.values)

    def obey(self, command: Command, *, armed: bool) -> str:
        """Begin what is asked for; return why it is refused at once, or ""."""
        if self._parameters.reading:
            return "all parameters are being read; wait until they are"
        if command.kind == CommandKind.PARAMETERS:
            self._parameters.fetch_all(command.number)
            return ""
        name, amount = command.name.decode(errors="replace"), command.amount
        whole = self._whole.get(name)
        if whole is None:
            return f"{name} has not been read; read the parameters first"
        if not (why := cannot_be_set(amount, whole=whole, armed=armed)):
            self._parameters.set(command.number, name, amount, whole=whole)
        return why

    def pass_on(self, now: float, boots: int, absences: int) -> Iterator[Answer]:
        """Send what was read, and yield the answers.

        Args:
            now: Monotonic s.
            boots: How often the vehicle has started anew; then all is read anew.
            absences: How often it was not heard for a while; then those that are judged are asked for again.
        """
        if boots != self._boots:
            self._boots = boots
            self._heard.forget()
            self._judged.clear()
        for told in self._heard.turn():
            self._hear(told, now)
        while not self._parameters.read.empty():
            read = self._parameters.read.get()
            self._whole[read.name] = read.whole
            self._send(read, now)
        if self._ask.due(now) or absences != self._absences:
            self._absences = absences
            self._heard.ask_again()
        if self._again.due(now):
            # Who has come meanwhile gets to know what they are.
            for record in self._judged.values():
                self._publisher.send(record)
        while not self._parameters.answers.empty():
            yield self._parameters.answers.get()

    def _hear(self, told: Told, now: float) -> None:
        """Judge anew what the vehicle told, and say so where it is not what it was."""
        judged, value, before = told
        self._whole[judged.name] = judged.whole
        if before == value or (before is not None and math.isnan(before) and math.isnan(value)):
            return
        self._judged[judged.name] = self._send(Read(judged.name, value, judged.whole), now)
        if before is not None:
            found = judged.judge(value)
            remedy = f"; {found.remedy}" if found.remedy else ""
            words = f"The vehicle's {judged.name} is {value:g} now, was {before:g}: {found.means}{remedy}."
            self._bus.event(max(found.severity, Severity.WARNING), words)

    def _send(self, read: Read, now: float) -> Parameter:
        self._total = read.total or self._total
        record = Parameter(t=now, value=read.value, whole=read.whole, count=self._total)
        record.name = fit(read.name, PARAMETER_TEXT)
        self._publisher.send(record)
        return record

    def close(self) -> bool:
        """End the thread; say whether MAVSDK may be taken away now."""
        return self._parameters.close()
