"""What is answered to commands, and what the vehicle and MAVSDK say, as answers and events on the bus."""

from __future__ import annotations

from collections import deque

from groundstation.bus import Bus
from groundstation.messages import ANSWER_TEXT, COMMAND_ANSWER, CommandAnswer, CommandKind, Severity, fit
from groundstation.vehicle.commander import Answer
from groundstation.vehicle.telemetry import Notes

# For so long what the vehicle said counts as the reason of a denial.
_REASON_S = 1.5


class Replies:
    """Answers commands, each once, and passes on what is told.

    Args:
        bus: Where answers and events go.
        notes: What other threads want told as events.
    """

    def __init__(self, bus: Bus, notes: Notes) -> None:
        self._bus, self._notes = bus, notes
        self._answers = bus.publisher(COMMAND_ANSWER)
        self._denials: deque[tuple[float, str]] = deque(maxlen=4)

    def tell(self, answer: Answer, now: float) -> None:
        """Pass on what became of a command."""
        if answer.ok:
            self._answer(answer.number, answer.kind, "", now)
        else:
            self.refuse(answer.number, answer.kind, answer.why, now)

    def refuse(self, number: int, kind: CommandKind, why: str, now: float) -> None:
        """Answer that a command is not carried out, and why."""
        self._answer(number, kind, f"{_name(kind)} refused: {self.with_reason(why, now)}.", now)

    def with_reason(self, why: str, now: float) -> str:
        """Add what the vehicle itself said in the last moment; its words are better than a result code."""
        said = [text for t, text in self._denials if now - t < _REASON_S]
        return f"{why} ({said[-1]})" if said else why

    def pass_on_notes(self, now: float) -> None:
        """Make events of what came meanwhile."""
        while not self._notes.empty():
            severity, text = self._notes.get()
            if severity is not Severity.INFO:
                self._denials.append((now, text.rstrip(".")))
            self._bus.event(severity, text)

    def _answer(self, number: int, kind: CommandKind, refusal: str, now: float) -> None:
        answer = CommandAnswer(t=now, number=number, kind=int(kind), ok=int(not refusal))
        answer.text = fit(refusal, ANSWER_TEXT)
        self._answers.send(answer)
        self._bus.event(Severity.WARNING if refusal else Severity.INFO, refusal or f"{_name(kind)} accepted.")


def _name(kind: CommandKind) -> str:
    return kind.name.capitalize().replace("_", " ")
