"""What the checks came to when the vehicle was armed: told once, so that it stands in the recording."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from groundstation.messages import Severity
from groundstation.tui.acts import armed
from groundstation.tui.check import Check
from groundstation.tui.checks import checks
from groundstation.tui.checks_told import total
from groundstation.tui.frame import Frame


class ArmedChecks:
    """Watches a flight for its arming.

    Args:
        tell: Makes words an event.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._armed = False

    def look(self, frame: Frame) -> None:
        """Tell of the checks where the vehicle has just been armed."""
        now = armed(frame.snapshot)
        if now and not self._armed:
            self._tell(in_a_line(checks(frame)))
        self._armed = now


def in_a_line(found: Sequence[Check]) -> str:
    """Return what the checks come to, and the names of those that are not well, the worst first."""
    named = ", ".join(check.name for check in found if check.severity is not Severity.INFO)
    return f"Preflight on arming: {' '.join(total(found).split())}{f': {named}' if named else ''}."
