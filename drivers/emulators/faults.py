"""What a bad line does to bytes."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random


@dataclass(slots=True)
class Faults:
    """A line that spoils what passes it.

    Attributes:
        drop: Share of bytes that never come.
        duplicate: Share of bytes that come twice.
        truncate: Share of bytes after which the rest of what was sent together is missing.
        random: Where chance comes from.
        events: How many faults there were.
    """

    drop: float = 0.0
    duplicate: float = 0.0
    truncate: float = 0.0
    random: Random = field(default_factory=lambda: Random(0))
    events: int = 0

    def spoil(self, data: bytes) -> bytes:
        """Return what comes of the bytes that were sent together."""
        drop, twice = self.drop, self.drop + self.duplicate
        every = twice + self.truncate
        if not every:
            return data
        come = bytearray()
        for byte in data:
            chance = self.random.random()
            if chance >= every:
                come.append(byte)
                continue
            self.events += 1
            if chance >= twice:
                break
            if chance >= drop:
                come += bytes((byte, byte))
        return bytes(come)
