"""What is wrong, as the operator has to deal with it: each thing once, new until acknowledged, heard as well as seen.

Three priorities, as in a cockpit (FAA AC 25.1322-1): an alarm needs the operator now, a caution soon, an advisory is
to be known. Pure: fed with what is wrong at a moment; time comes with it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

from groundstation.messages import Severity

# An alarm is rung again until somebody has said that he knows, s.
AGAIN_S = 4.0
# What comes back so soon was not away: it stays acknowledged, s.
BACK_S = 5.0

PRIORITIES = {Severity.ALARM: "ALARM", Severity.WARNING: "CAUTION", Severity.INFO: "ADVISORY"}


class Alert(NamedTuple):
    """Something that is wrong at a moment.

    Attributes:
        severity: How wrong.
        key: What it is, the same from moment to moment.
        text: In a sentence, with the figures of the moment.
    """

    severity: Severity
    key: str
    text: str


@dataclass(frozen=True, slots=True)
class Alarm:
    """Something that has been wrong for a while.

    Attributes:
        severity: How wrong it is now.
        peak: How wrong it has been since it began; worse than that, it is new again.
        key: What it is.
        text: In a sentence, as it is now.
        since: When it began, s.
        seen: When it was last so, s.
        acknowledged: The operator knows.
    """

    severity: Severity
    peak: Severity
    key: str
    text: str
    since: float
    seen: float
    acknowledged: bool = False

    @property
    def rank(self) -> tuple[bool, int, float]:
        """Its place in the list, the first the lowest: what is new, then what is grave, then what is recent."""
        return self.acknowledged or self.severity is Severity.INFO, -self.severity, -self.since


class Alarms:
    """Keeps what is wrong from moment to moment.

    Attributes:
        muted: No bell is to be rung.
    """

    def __init__(self) -> None:
        self.muted = False
        self._known: dict[str, Alarm] = {}
        self._rung = -AGAIN_S
        self._new = False

    def look(self, alerts: Iterable[Alert], now: float) -> tuple[Alarm, ...]:
        """Take note of all that is wrong at `now` (s) and return it, the most urgent first."""
        for alert in alerts:
            before = self._known.get(alert.key)
            severity, key, text = alert
            if before is None or severity > before.peak:
                self._known[key] = Alarm(severity, severity, key, text, since=now, seen=now)
                self._new |= severity is not Severity.INFO
            elif before.seen < now:
                self._known[key] = replace(before, severity=severity, text=text, seen=now)
        self._known = {key: alarm for key, alarm in self._known.items() if now - alarm.seen <= BACK_S}
        return tuple(sorted((a for a in self._known.values() if a.seen == now), key=lambda alarm: alarm.rank))

    def acknowledge(self) -> bool:
        """Take all that is wrong as known; return False where nothing is new."""
        new = [alarm for alarm in self._known.values() if not alarm.rank[0]]
        self._known |= {alarm.key: replace(alarm, acknowledged=True) for alarm in new}
        return bool(new)

    def rings(self, now: float) -> bool:
        """Say whether the bell is to be rung at `now` (s): for what is new, and for alarms again and again."""
        alarming = (alarm for alarm in self._known.values() if alarm.severity is Severity.ALARM)
        urgent = any(alarm.seen == now and not alarm.acknowledged for alarm in alarming)
        due = self._new or (urgent and now - self._rung >= AGAIN_S)
        self._new = False
        if due:
            self._rung = now
        return due and not self.muted
