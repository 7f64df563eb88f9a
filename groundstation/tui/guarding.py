"""What the guard keeps away from, for as long as eyes need to see it: it often acts for a few ticks at a time."""

from __future__ import annotations

import math

from groundstation.console import Snapshot
from groundstation.tui.acts import pilot_silent
from groundstation.tui.notes import words

# A sign that is there for less is easily missed, s.
SHOWN_S = 0.6


class GuardWatch:
    """Remembers when the guard last acted."""

    def __init__(self) -> None:
        self._name = ""
        self._t = -math.inf

    def look(self, snapshot: Snapshot) -> str:
        """Return the name of what the guard keeps away from, now or a moment ago, or ""."""
        pilot = snapshot.pilot
        if pilot is None or pilot_silent(snapshot):
            return ""
        if pilot.guarding:
            self._name, self._t = words(pilot.guarded_by), snapshot.t
        return self._name if snapshot.t - self._t <= SHOWN_S else ""
