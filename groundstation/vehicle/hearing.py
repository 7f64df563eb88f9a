"""Who is heard on the link, in words: the vehicle's silence and its end, another vehicle, what is not signed."""

from __future__ import annotations

from collections.abc import Iterator

from groundstation.conditions import Conditions
from groundstation.config import Safety
from groundstation.failsafe import BY_FAULT, Fault
from groundstation.messages import Severity
from groundstation.vehicle.pump import Pump
from groundstation.vehicle.signing import Refusals

_SIGNED = (
    "The vehicle signs its messages and may refuse what is not signed; "
    "end here and start with --signing-key FILE, its key."
)
_CONTRADICTED = (
    "A heartbeat in a vehicle's name calls it another autopilot than before and is not believed; "
    "if its firmware was changed, start anew."
)
_SILENT = BY_FAULT[Fault.LINK_SILENT]


class Hearing:
    """Watches what the pump hears.

    Args:
        pump: Moves the bytes.
        safety: From when the vehicle counts as silent.

    Attributes:
        absences: How often the vehicle was silent and is heard again.
    """

    def __init__(self, pump: Pump, safety: Safety) -> None:
        self._pump, self._safety = pump, safety
        self._refusals = Refusals()
        self._silent = False
        self._told: frozenset[int] = frozenset()
        self._said: frozenset[str] = frozenset()
        self.absences = 0

    def news(self, now: float) -> Iterator[tuple[Severity, str]]:
        """Yield what is to be told at `now`, monotonic s, each once."""
        seen = Conditions(silence=now - self._pump.heard_t if self._pump.heard_t else 0.0)
        if _SILENT.holds(seen, self._safety) != self._silent:
            self._silent = not self._silent
            self.absences += not self._silent
            yield (
                (_SILENT.severity, _SILENT.say(seen))
                if self._silent
                else (Severity.INFO, "The vehicle is heard again.")
            )
        if others := self._pump.others - self._told:
            self._told |= others
            for system in sorted(others):
                yield Severity.WARNING, _another(system)
        for words, so in ((_SIGNED, self._pump.signed), (_CONTRADICTED, self._pump.contradicted)):
            if so and words not in self._said:
                self._said |= {words}
                yield Severity.WARNING, words
        if words := self._refusals.news(now, self._pump.refused, heard=bool(self._pump.heard_t)):
            yield Severity.WARNING, words


def _another(system: int) -> str:
    return (
        f"Another vehicle, system {system}, is heard on this link and left alone; "
        "to fly that one, take the other off it and start anew."
    )
