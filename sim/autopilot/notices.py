"""What the autopilot says: notices to the operator, and verdicts on what was asked of it."""

from __future__ import annotations

from collections import deque
from enum import IntEnum
from typing import NamedTuple

_KEPT = 64


class Severity(IntEnum):
    """Of a notice, numbered like MAV_SEVERITY."""

    EMERGENCY = 0
    CRITICAL = 2
    WARNING = 4
    INFO = 6


class Notice(NamedTuple):
    """Something said to the operator."""

    severity: Severity
    text: str


class Verdict(NamedTuple):
    """Whether an act was accepted; `why` says what forbids it."""

    ok: bool
    why: str = ""


ACCEPTED = Verdict(ok=True)


class Notices:
    """Hands every notice to every mailbox."""

    def __init__(self) -> None:
        self._mailboxes: list[deque[Notice]] = []

    def mailbox(self) -> deque[Notice]:
        """Return one more mailbox. It keeps the newest notices until they are taken."""
        box: deque[Notice] = deque(maxlen=_KEPT)
        self._mailboxes.append(box)
        return box

    def say(self, severity: Severity, text: str) -> None:
        """Tell everybody."""
        notice = Notice(severity, text)
        for box in self._mailboxes:
            box.append(notice)

    def denied(self, act: str, why: str) -> Verdict:
        """Refuse an act, and tell everybody why."""
        self.say(Severity.CRITICAL, f"{act} denied: {why}")
        return Verdict(ok=False, why=why)
