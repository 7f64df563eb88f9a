"""What each tick of a recorded servo was made from, besides the records that it knew."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from groundstation.errors import InputError
from groundstation.messages import CommandKind
from groundstation.recording import schema
from groundstation.recording.parts import parts_of
from groundstation.review.flight import Flight, Numbers
from groundstation.review.rrd import is_whole, open_reader

# Of a recording that did not end properly, how much of the end may lack a part, s.
_UNSURE_S = 2.0


class Ticks(NamedTuple):
    """A servo's ticks, one after the other from its very first, n of them.

    Attributes:
        t: (n,), monotonic s, the floats that the servo had.
        hand: (n, 8), position, velocity, yaw and the sample's time, handle frame.
        buttons: (n,), one bit each.
        rows: (n, 6), as `schema.TICK` has it.
        known: (n, 5), as `schema.KNOWN` has it.
        ending: Why they end before the recording does, in words, or "".
    """

    t: Numbers
    hand: Numbers
    buttons: Numbers
    rows: Numbers
    known: Numbers
    ending: str


def ticks_of(flight: Flight) -> Ticks:
    """Return a recording's ticks, up to the first that is missing.

    Raises:
        InputError: It does not hold what its ticks were made from, or not from the first on.
    """
    n, ending = _extent(flight)
    t = flight.clock(schema.HANDLE_POSITION)[:n]
    position, velocity = (
        flight.series(schema.HANDLE_POSITION).values,
        flight.series(schema.HANDLE_VELOCITY).values,
    )
    sampled = t - flight.series(schema.SAMPLE_AGE).values[:n, 0]
    return Ticks(
        t,
        np.column_stack((position[:n, :3], velocity[:n], position[:n, 3], sampled)),
        flight.held(schema.HANDLE_BUTTONS, t)[:, 0],
        flight.held(schema.TICK, t),
        flight.held(schema.KNOWN, t),
        ending,
    )


def _extent(flight: Flight) -> tuple[int, str]:
    """Return how many ticks there are without a gap, and why they end before the recording does, or ""."""
    t, when = flight.clock(schema.HANDLE_POSITION), flight.clock(schema.TICK)
    if not len(t) or not len(when):
        raise InputError(
            f"{flight.path}: does not hold what the servo's ticks were made from; leave out --check."
        )
    number = flight.series(schema.TICK).values[:, 0]
    place = np.searchsorted(t, when)
    there = np.append(t, np.nan)[place] == when
    counted: npt.NDArray[np.bool_] = there & (number == place + 1)
    if not counted[0]:
        raise InputError(
            f"{flight.path}: begins at the servo's tick {number[0]:.0f}, and what it knew by then is not recorded; "
            "leave out --check to fly its hand in the simulator."
        )
    n, ending = len(t), ""
    if not counted.all():
        first = int(np.argmin(counted))
        n = int(place[first - 1]) + 1
        ending = f"the recording lacks ticks after {when[first - 1] - flight.start:.3f} s"
    if not is_whole(open_reader(parts_of(flight.path)[-1])):
        n = min(n, int(np.searchsorted(t, t[-1] - _UNSURE_S)))
        ending = ending or f"the recording did not end properly; its last {_UNSURE_S:.0f} s are left out"
    given = flight.clock(schema.COMMANDED)[
        flight.series(schema.COMMANDED).values[:, 1] == CommandKind.SETTINGS
    ]
    if len(given) and (before := int(np.searchsorted(t, given[0]))) < n:
        n, ending = (
            before,
            f"other settings were taken at {given[0] - flight.start:.3f} s, and which is not recorded",
        )
    if not n:
        raise InputError(f"{flight.path}: ends before there is anything to check.")
    return n, ending
