"""The events of the bus and what the screen adds: refusals not yet told, and commands nobody answered."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from groundstation.console import Snapshot
from groundstation.messages import CommandAnswer, CommandKind, Event, Severity

# Longer than a vehicle's mode change takes to be confirmed by its 1 Hz heartbeat.
ANSWER_S = 5.0
# All parameters of a vehicle, a thousand or two, take their time through a radio.
_PATIENCE_S = {CommandKind.PARAMETERS: 60.0}
_SAME_S = 1.0
_SEVERITIES = frozenset(Severity)
_KINDS = frozenset(CommandKind)


@dataclass(frozen=True, slots=True)
class Note:
    """A line for the list of events."""

    t: float
    severity: Severity
    source: str
    text: str


class Answers:
    """Watches what becomes of the screen's own commands."""

    def __init__(self) -> None:
        self._open: dict[int, tuple[CommandKind, float]] = {}
        self.notes: deque[Note] = deque(maxlen=50)

    def sent(self, number: int, kind: CommandKind, t: float) -> None:
        """Remember a command that was sent at time `t`."""
        self._open[number] = (kind, t)

    def take(self, snapshot: Snapshot) -> list[Note]:
        """Return what is worth saying now: refusals, and commands that got no answer."""
        news = [
            Note(snapshot.t, Severity.WARNING, "screen", _refusal(answer))
            for answer in snapshot.answers
            if self._open.pop(answer.number, None) and not answer.ok
        ]
        for number, (kind, t) in list(self._open.items()):
            patience = _PATIENCE_S.get(kind, ANSWER_S)
            if snapshot.t - t > patience:
                del self._open[number]
                text = f"{_name(kind)}: no answer in {patience:.0f} s; check that the link and the pilot run."
                news.append(Note(snapshot.t, Severity.ALARM, "screen", text))
        self.notes.extend(news)
        return news


def merged(events: Sequence[Event], notes: Sequence[Note], count: int) -> list[Note]:
    """Return the newest `count` lines of both, oldest first; what an event says already is not said twice."""
    told = [from_event(event) for event in events[-count:]]
    own = [
        note
        for note in notes
        if not any(abs(note.t - other.t) < _SAME_S and note.text == other.text for other in told)
    ]
    return sorted([*told, *own], key=lambda note: note.t)[-count:] if count > 0 else []


def from_event(event: Event) -> Note:
    """Read an event of the bus."""
    severity = Severity(event.severity) if event.severity in _SEVERITIES else Severity.WARNING
    return Note(event.t, severity, words(event.source), words(event.text))


def words(field: bytes) -> str:
    """Read a text field of a record; control characters, which would move the cursor, become spaces."""
    text = field.decode(errors="replace")
    return "".join(letter if letter.isprintable() else " " for letter in text).strip()


def _refusal(answer: CommandAnswer) -> str:
    name = _name(CommandKind(answer.kind)) if answer.kind in _KINDS else "Command"
    said = words(answer.text)
    return said if "refused" in said.lower() else f"{name} refused: {said or 'no reason was given'}."


def _name(kind: CommandKind) -> str:
    return kind.name.capitalize().replace("_", " ")
