"""Energy that travels to the far end of a link and back, in packets.

A wave of energy that has left comes back no sooner than a round trip later. How much is where is all that is kept:
a packet that is being filled, some that are under way, and what has returned (after Niemeyer and Slotine 1998,
Towards force-reflecting teleoperation over the internet, where packets carry the energy of the wave beside its
integral, and none is taken out of the line that has not come out of it).
"""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

# Packets a round trip is cut into.
PACKETS = 4
# What a round trip is taken for while it is not known, s: the longest the bench tries.
UNKNOWN = 1.4


class Line(NamedTuple):
    """Where the energy is that went into the line.

    Attributes:
        packet: In the packet that is being filled, J.
        age: Of that packet, s.
        under_way: In the packets that have left, J, oldest first.
        returned: What has come back and may be spent, J; less than zero for what was spent without.
    """

    packet: float = 0.0
    age: float = 0.0
    under_way: tuple[float, ...] = (0.0,) * PACKETS
    returned: float = 0.0


def exchanged(line: Line, sent: float) -> Line:
    """Return the line after `sent`, J, went in, or was taken out where it is less than zero.

    What is taken out comes from the packet that has not left yet, and then from what has returned.
    """
    packet = line.packet + sent
    if packet >= 0.0:
        return Line(packet, line.age, line.under_way, line.returned)
    return Line(0.0, line.age, line.under_way, line.returned + packet)


def carried(line: Line, dt: float, delay: float, most: float) -> Line:
    """Return the line another `dt`, s, later; of what has returned it keeps at most `most`, J.

    A packet leaves when it has been filled for its share of the round trip, `delay`, s (NaN: not known), and has
    returned when all of it has passed since.
    """
    age = line.age + dt
    if age * PACKETS < (delay if isfinite(delay) else UNKNOWN):
        return Line(line.packet, age, line.under_way, line.returned)
    first, *rest = line.under_way
    return Line(0.0, 0.0, (*rest, line.packet), min(most, line.returned + first))
