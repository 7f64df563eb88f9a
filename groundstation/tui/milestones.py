"""When a screen beside the flight comes up by itself: red checks before the first flight, the outcome after each."""

from __future__ import annotations

import math

from groundstation.console import Snapshot
from groundstation.tui.acts import armed, coupled, in_air

# Processes start, a vehicle is found, its estimator settles: what is still red after this is worth a look, s.
SETTLED_S = 10.0


class Milestones:
    """Watches a flight from its beginning."""

    def __init__(self) -> None:
        self._begun = math.nan
        self._readied = False
        self._flown = False

    def page(self, snapshot: Snapshot, red: int) -> str:
        """Return the name of the page that is due now, once; else "".

        Args:
            snapshot: What is known.
            red: How many checks forbid to fly.
        """
        if math.isnan(self._begun):
            self._begun = snapshot.t
        if armed(snapshot) or in_air(snapshot) or coupled(snapshot):
            self._readied = True
            self._flown = self._flown or in_air(snapshot)
            return ""
        if self._flown and snapshot.status is not None and snapshot.status.connected:
            self._flown = False
            return "debrief"
        if not self._readied and snapshot.t - self._begun > SETTLED_S:
            self._readied = True
            return "preflight" if red else ""
        return ""
