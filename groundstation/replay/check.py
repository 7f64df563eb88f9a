"""`groundstation replay --check`: today's pilot on the inputs of a recording, tick by tick, and where it differs."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

import groundstation
from groundstation.errors import InputError
from groundstation.recording import lanes
from groundstation.recording.about import revision
from groundstation.replay.again import Again, run_of
from groundstation.replay.changes import settings_for
from groundstation.replay.comparing import Difference, Said, differences
from groundstation.review.choosing import chosen
from groundstation.review.flight import Flight
from groundstation.review.sights import COUPLED
from groundstation.status_line import StatusLine

EXIT_DIFFERENT = 1
# What only a flight through the simulator has, and where it was not asked for.
_OF_WORLD = {
    "mission": None, "airframe": None, "model": None, "wind": "mission", "channel": "", "seed": None,
    "speed": None, "rerun": False, "viewer": None, "out": None,
}  # fmt: skip
_SHOWN = 8


class Checked(NamedTuple):
    """What a check came to.

    Attributes:
        ticks: How many were run again.
        seconds: How long they took in flight.
        coupled: How often the hand was coupled in them.
        recorded_with, checked_with: The versions.
        ending: Why it ends before the recording does, or "".
    """

    ticks: int
    seconds: float
    coupled: int
    recorded_with: str
    checked_with: str
    ending: str


def check(asked: argparse.Namespace) -> tuple[str, int]:
    """Check what was asked for; return what came of it in words, or as JSON, and the exit code.

    Raises:
        InputError: The recording does not hold what is needed, or an option does not fit.
    """
    for name, usual in _OF_WORLD.items():
        if getattr(asked, name) != usual:
            raise InputError(f"--{name}: --check flies nothing; leave one of them out.")
    flight = Flight(chosen(asked.flight, asked.logs))
    facts = flight.properties()
    controller = asked.controller or str(facts.get("controller", "paper"))
    again = Again(flight, run_of(flight, settings_for(asked, flight), controller))
    said, ticks = Said(flight.start), again.ticks.t
    with StatusLine(sys.stderr) as line:
        for t, batch in again.batches():
            said.add(batch)
            line.step(f"{t - flight.start:.1f} of {ticks[-1] - flight.start:.1f} s")
    found = differences(flight, said, ticks)
    checked = Checked(
        len(ticks),
        float(ticks[-1] - ticks[0]),
        _couplings(flight, float(ticks[-1]) - flight.start),
        f"{facts.get('groundstation', '')} {facts.get('revision', '')}".strip(),
        f"{groundstation.__version__} {revision()}".strip(),
        again.ticks.ending,
    )
    places = [int(np.searchsorted(ticks, each.t, side="right")) for each in found]
    tell = _as_json if asked.json else _in_words
    return tell(checked, found, places, flight.start), EXIT_DIFFERENT if found else 0


def _couplings(flight: Flight, until: float) -> int:
    """Return how often the hand was coupled, up to a time, s since the run was started."""
    words = [word in COUPLED for t, word in flight.states(lanes.PHASE) if t <= until]
    return sum(now and not before for before, now in zip([False, *words], words, strict=False))


def _in_words(checked: Checked, found: Sequence[Difference], places: Sequence[int], start: float) -> str:
    lines = [
        f"identical: {checked.ticks} ticks in {checked.seconds:.1f} s, coupled stretches: {checked.coupled}"
    ]
    if found:
        first = found[0]
        lines = [
            f"different at tick {places[0]} of {checked.ticks}, {first.t - start:.3f} s: "
            f"{first.what} was {first.recorded}, is {first.now}"
        ]
        lines += [
            f"  {each.t - start:10.3f} s  tick {place:<8} {each.what}: was {each.recorded}, is {each.now}"
            for each, place in zip(found[1:_SHOWN], places[1:_SHOWN], strict=True)
        ]
        if more := len(found) - _SHOWN:
            lines.append(f"  and {more} more quantities" if more > 0 else "")
    if checked.ending:
        lines.append(f"{checked.ending}.")
    lines.append(f"recorded with {checked.recorded_with}, checked with {checked.checked_with}")
    return "\n".join(line for line in lines if line)


def _as_json(checked: Checked, found: Sequence[Difference], places: Sequence[int], start: float) -> str:
    rows = [
        {**each._asdict(), "t": each.t - start, "tick": place}
        for each, place in zip(found, places, strict=True)
    ]
    return json.dumps({"identical": not found, **checked._asdict(), "differences": rows})
