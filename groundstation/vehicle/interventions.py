"""What an instructor or a timetable does to a simulated vehicle: by its parameters, told until it has confirmed.

Only parameters named here are ever written, only on a vehicle that this program simulates. It is no way around the
rule that the vehicle's other parameters are left alone while it is armed.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable

from mavsdk import System
from mavsdk.plugins.param import Param, ParamError, ParamResult

from groundstation.bus import Bus
from groundstation.clock import Every
from groundstation.messages import INTERVENTION, INTERVENTION_ANSWER, Intervention
from groundstation.training.answering import REAL, WELCOME_S, answer_to
from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.happening import Calm, Happening, unpacked
from groundstation.vehicle.gate import Gate

_BLACKOUT, _GUST, _GPS, _CHARGE = "SIM_NET_BLACK", "SIM_GUST_S", "SIM_GPS_LOST", "SIM_BAT_LEFT"
# These begin something that ends by itself: there is nothing to go back to.
_PASSING = frozenset(
    {_BLACKOUT, _GPS, "SIM_BAT_LEFT", "SIM_GUST_E", "SIM_GUST_N", "SIM_GUST_U", "SIM_GUST_S"}
)
# Longer than any silence that can be asked for, s.
_PATIENCE_S = 120.0
_AGAIN_S = 0.2
# A vehicle that says nothing for so long has a link that is lost, s.
_SILENT_S = 1.0
_END_S = 1.5

Write = tuple[str, float]


def writes_for(happening: Happening) -> tuple[Write, ...]:
    """Return which parameters make something happen, in the order in which they are set.

    What begins something is set to 0 before: the same value again is a repetition to the simulator, and nothing new.
    """
    match happening:
        case WindChange(velocity=(east, north, up), turbulence=sigma):
            return (
                ("SIM_WIND_E", east), ("SIM_WIND_N", north), ("SIM_WIND_U", up), ("SIM_WIND_TURB", sigma),
            )  # fmt: skip
        case GustNow(velocity=(east, north, up), duration_s=seconds):
            peak = ("SIM_GUST_E", east), ("SIM_GUST_N", north), ("SIM_GUST_U", up)
            return (_GUST, 0.0), *peak, (_GUST, seconds)
        case Delay(round_trip_s=seconds, jitter_s=jitter):
            return (*_both_ways("JITTER", jitter), *_both_ways("DELAY", 0.5 * seconds))
        case Loss(share=share):
            return _both_ways("LOSS", share)
        case LinkLoss(duration_s=seconds):
            return ((_BLACKOUT, seconds),)
        case BatteryLeft(remaining=share):
            return (_CHARGE, 0.0), (_CHARGE, share)
        case GpsLoss(duration_s=seconds):
            return (_GPS, 0.0), (_GPS, seconds)
        case DeviceLoss() | Calm():
            return ()


def _both_ways(name: str, value: float) -> tuple[Write, ...]:
    return (f"SIM_UP_{name}", value), (f"SIM_DN_{name}", value)


class Interventions:
    """The link's part of them: takes those that are a vehicle's from the bus, and answers each.

    Args:
        bus: Where they come from.
        simulated: The vehicle is; else all are refused.
    """

    def __init__(self, bus: Bus, *, simulated: bool) -> None:
        self._simulated = simulated
        self._asked = bus.subscriber(INTERVENTION)
        self._answers = bus.publisher(INTERVENTION_ANSWER)
        self._writer: Writer | None = None
        self._welcome = Every(WELCOME_S)

    def attach(self, system: System, gate: Gate, silence: Callable[[], float]) -> None:
        """Have a vehicle to do it to.

        Args:
            system: The vehicle.
            gate: Lets the parameters be set.
            silence: Returns for how long the vehicle has said nothing, s.
        """
        if self._simulated:
            self._writer = Writer(Param(system), gate, silence)

    def turn(self, now: float) -> None:
        """Begin what was asked for, and answer what is done or refused; never waits."""
        for asked in self._asked.drain():
            happening = unpacked(asked.happening)
            if isinstance(happening, DeviceLoss):
                continue
            if not self._simulated:
                self._answer(asked, REAL, now)
            elif happening is None:
                self._answer(asked, "it was not understood", now)
            elif self._writer is None:
                self._answer(asked, "no vehicle is connected", now)
            else:
                self._writer.begin(asked, happening)
        while self._writer and not self._writer.done.empty():
            asked, why = self._writer.done.get()
            self._answer(asked, why, now)

        if self._welcome.due(now):
            self._answers.welcome()

    def close(self) -> bool:
        """End the thread; say whether MAVSDK may be taken away now."""
        return self._writer is None or self._writer.close()

    def _answer(self, asked: Intervention, why: str, now: float) -> None:
        self._answers.send(answer_to(asked, why, now))


class Writer:
    """Sets the parameters on a thread, for the vehicle's word may take its time.

    Args:
        param: MAVSDK's, of a simulated vehicle.
        gate: Lets a parameter be set.
        silence: Returns for how long the vehicle has said nothing, s.

    Attributes:
        done: What has been carried out, with "" or why not, since it was last emptied.
    """

    def __init__(self, param: Param, gate: Gate, silence: Callable[[], float]) -> None:
        self._param, self._gate, self._silence = param, gate, silence
        self._before: dict[str, float] = {}
        self._work: queue.SimpleQueue[tuple[Intervention, Happening] | None] = queue.SimpleQueue()
        self.done: queue.SimpleQueue[tuple[Intervention, str]] = queue.SimpleQueue()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="interventions", daemon=True)
        self._thread.start()

    def begin(self, asked: Intervention, happening: Happening) -> None:
        """Carry something out, after what was begun before."""
        self._work.put((asked, happening))

    def close(self) -> bool:
        """End the thread; say whether it has ended, for MAVSDK must not be taken from under it."""
        self._over.set()
        self._work.put(None)
        self._thread.join(_END_S)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            asked, happening = work
            self.done.put((asked, self._carry_out(happening)))

    def _carry_out(self, happening: Happening) -> str:
        """Do it; return why it was not done, or ""."""
        back = (*self._before.items(), (_GPS, 0.0))
        writes = back if isinstance(happening, Calm) else writes_for(happening)
        try:
            for name, value in writes:
                self._remember(name)
                self._write(name, value)
        except _NotDoneError as error:
            return str(error)
        return ""

    def _remember(self, name: str) -> None:
        """Keep what a parameter was before it is first changed."""
        if name not in _PASSING and name not in self._before:
            self._before[name] = self._until_heard(name, lambda: self._param.get_param_float(name))

    def _write(self, name: str, value: float) -> None:
        def write() -> float:
            self._gate.allow_parameter(name, value)
            self._param.set_param_float(name, value)
            return value

        self._until_heard(name, write)

    def _until_heard(self, name: str, call: Callable[[], float]) -> float:
        """Call until the vehicle has answered; frames may be lost or on their way for seconds."""
        given_up_t = time.monotonic() + _PATIENCE_S
        heard = False
        while not self._over.is_set():
            heard = heard or self._silence() < _SILENT_S
            try:
                return call()
            except ParamError as error:
                if error.result is not ParamResult.TIMEOUT:
                    raise _NotDoneError(
                        f"the vehicle refused {name} ({error.result.name.lower()})"
                    ) from error
            if name == _BLACKOUT and heard and self._silence() > _SILENT_S:
                # It was the answer that was lost: asked again, it would be silent twice as long.
                return 0.0
            if time.monotonic() >= given_up_t:
                raise _NotDoneError("the vehicle did not answer; check the link")
            self._over.wait(_AGAIN_S)
        raise _NotDoneError("the flight ends")


class _NotDoneError(Exception):
    """Something could not be carried out; the message says why."""
