"""The alarms: what is wrong in three priorities, each told once and kept until seen; when the bell rings. Pure.

A condition that comes and goes is one alarm with a count. One that has ended stays to be seen: an alarm until it is
acknowledged, a caution for a moment; an advisory goes with its cause. What has been acknowledged is told anew only
when it becomes more serious, or comes back after a while.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from groundstation.messages import Severity

# The bell is repeated this often while an alarm lasts that nobody has acknowledged, s.
RING_AGAIN_S = 3.0
# A caution that has ended is told for so long, s.
CAUTION_KEPT_S = 5.0
# What comes back sooner is the same trouble, which flutters, s.
FLUTTER_S = 5.0
# More that has ended and was never acknowledged is forgotten, oldest first.
_KEPT = 20


class Condition(NamedTuple):
    """Something that is so now.

    Attributes:
        key: The same for the same trouble, whatever its figures.
        severity: Alarm, caution (WARNING) or advisory (INFO).
        text: One sentence.
        t: When it was told, s, where it was told: told again, it counts again. NaN for what is seen to be so.
    """

    key: str
    severity: Severity
    text: str
    t: float = math.nan


@dataclass(slots=True)
class Alarm:
    """A condition with its story.

    Attributes:
        began: When it last began, s.
        ended: When it ended, s; infinite while it lasts.
        count: How often it has begun since it was last acknowledged.
        seen: The operator has acknowledged it.
    """

    key: str
    severity: Severity
    text: str
    told: float
    began: float
    ended: float = math.inf
    count: int = 1
    seen: bool = False

    @property
    def active(self) -> bool:
        """It lasts."""
        return self.ended == math.inf


class Alarms:
    """Keeps the alarms from frame to frame.

    Attributes:
        muted: The bell does not ring.
    """

    def __init__(self) -> None:
        self._alarms: dict[str, Alarm] = {}
        self._rung = -math.inf
        self._due = False
        self.muted = False

    def look(self, conditions: Iterable[Condition], now: float) -> None:
        """Take note of all that is so at a time, s; of one key the most serious."""
        present: dict[str, Condition] = {}
        for condition in conditions:
            other = present.get(condition.key)
            if other is None or condition.severity >= other.severity:
                present[condition.key] = condition
        for condition in present.values():
            self._present(condition, now)
        for alarm in self._alarms.values():
            if alarm.active and alarm.key not in present:
                alarm.ended = now
        self._forget(now)

    def acknowledge(self) -> int:
        """Take all as seen; return how many were not."""
        unseen = [alarm for alarm in self._alarms.values() if not alarm.seen]
        for alarm in unseen:
            alarm.seen = True
        self._due = False
        self._alarms = {key: alarm for key, alarm in self._alarms.items() if alarm.active}
        return sum(alarm.severity > Severity.INFO for alarm in unseen)

    def ring(self, now: float) -> bool:
        """Say whether to ring the bell now: for each new alarm, and again while it lasts and nobody has seen it."""
        waiting = any(
            alarm.severity is Severity.ALARM and alarm.active and not alarm.seen
            for alarm in self._alarms.values()
        )
        due = self._due or (waiting and now - self._rung >= RING_AGAIN_S)
        self._due = False
        if due:
            self._rung = now
        return due and not self.muted

    def listed(self) -> list[Alarm]:
        """Return all, the most pressing first: not seen, serious, lasting, new."""
        return sorted(
            self._alarms.values(),
            key=lambda alarm: (alarm.seen, -alarm.severity, not alarm.active, -alarm.began),
        )

    def first(self) -> Alarm | None:
        """Return what the operator should read now: an alarm or a caution not seen yet, else an alarm that lasts."""
        pressing = (
            alarm
            for alarm in self.listed()
            if (not alarm.seen and alarm.severity is Severity.WARNING)
            or (alarm.severity is Severity.ALARM and (not alarm.seen or alarm.active))
        )
        return next(pressing, None)

    def _present(self, condition: Condition, now: float) -> None:
        key, severity, text, told = condition
        alarm = self._alarms.get(key)
        if alarm is None:
            self._alarms[key] = Alarm(key, severity, text, told, now)
            self._due |= severity is Severity.ALARM
            return
        again = not alarm.active or told > alarm.told
        worse = severity > alarm.severity
        if worse or (again and now - min(alarm.ended, now) > FLUTTER_S):
            alarm.seen = False
            self._due |= severity is Severity.ALARM
        if again:
            alarm.count, alarm.began = alarm.count + 1, now
        # What was an alarm that nobody has seen yet is one until somebody has.
        alarm.severity = severity if alarm.seen else max(severity, alarm.severity)
        alarm.text, alarm.told, alarm.ended = text, told, math.inf

    def _forget(self, now: float) -> None:
        """Let go what has ended and need not be told any more."""

        def kept(alarm: Alarm) -> bool:
            if alarm.active:
                return True
            age = now - alarm.ended
            if alarm.seen or alarm.severity is Severity.WARNING:
                return age <= CAUTION_KEPT_S
            return alarm.severity is Severity.ALARM

        left = [alarm for alarm in self._alarms.values() if kept(alarm)]
        ended = sorted((alarm for alarm in left if not alarm.active), key=lambda alarm: alarm.ended)
        over = {alarm.key for alarm in ended[: max(len(ended) - _KEPT, 0)]}
        self._alarms = {alarm.key: alarm for alarm in left if alarm.key not in over}
