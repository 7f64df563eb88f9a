"""A channel's conditions as people give them: `--channel` on the command line, SIM_* parameters in flight."""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.autopilot.parameters import LEAST_RATE, SPECS, Parameters
from sim.channel import IDEAL, Conditions

BLACKOUT = "SIM_NET_BLACK"
_UP, _DOWN = "SIM_UP_", "SIM_DN_"
# What can be changed in flight, and how its parameter ends.
_IN_FLIGHT = {
    "delay": "DELAY",
    "jitter": "JITTER",
    "loss": "LOSS",
    "duplicate": "DUP",
    "reorder": "REORD",
    "rate": "RATE",
}
_MOST_BURST = 1000.0
_MOST_SECONDS = 1e6
_KEYS = (*Conditions._fields[:-1], "blackout")
HELP = """\
channel, in virtual time, on each link between the vehicle and everyone else:
  delay=S            every frame takes so long, s
  jitter=S           up to so much more or less, s; the order stays
  loss=SHARE         lost, 0 to 0.95;  burst=N: in bursts of N frames on average
  duplicate=SHARE    come twice, 0 to 1
  reorder=SHARE      may be overtaken, 0 to 1
  rate=BYTES         bytes a second, 0 without limit
  blackout=T+S       from T s after the start nothing for S s
  With up. before it only to the vehicle, with down. only from it, else both. In flight by the parameters
  SIM_UP_* and SIM_DN_*, and SIM_NET_BLACK for a blackout of so many seconds from now.
"""


class ConditionsError(Exception):
    """A channel is described wrongly; the message is one sentence with key and reason."""


class BothWays(NamedTuple):
    """Conditions to the vehicle (`up`) and from it (`down`)."""

    up: Conditions = IDEAL
    down: Conditions = IDEAL


IDEAL_BOTH_WAYS = BothWays()


def parse_conditions(text: str) -> BothWays:
    """Parse `KEY=VALUE,...` as `HELP` describes it; what comes later holds.

    Raises:
        ConditionsError: A key is unknown, or a value is not a number or out of its range.
    """
    both = IDEAL_BOTH_WAYS
    for item in filter(None, (part.strip() for part in text.split(","))):
        name, _, value = item.partition("=")
        way, _, key = name.strip().rpartition(".")
        if way not in ("", "up", "down") or key not in _KEYS:
            raise ConditionsError(f"{name}: unknown; give {', '.join(_KEYS)}, with up. or down. for one way.")
        if way != "down":
            both = both._replace(up=_with(both.up, key, value.strip(), item))
        if way != "up":
            both = both._replace(down=_with(both.down, key, value.strip(), item))
    return both


def _with(conditions: Conditions, key: str, value: str, item: str) -> Conditions:
    if key == "blackout":
        begin, plus, length = value.partition("+")
        if not plus:
            raise ConditionsError(
                f"{item}: is not a blackout; give START+LENGTH, both in s, as blackout=20+5."
            )
        begin_t = _number(begin, item, _MOST_SECONDS)
        blackout = (begin_t, begin_t + _number(length, item, _MOST_SECONDS))
        return conditions._replace(blackouts=(*conditions.blackouts, blackout))
    highest = _MOST_BURST if key == "burst" else SPECS[_UP + _IN_FLIGHT[key]].highest
    number = _number(value, item, highest)
    if key == "burst" and 0.0 < number < 1.0:
        raise ConditionsError(
            f"{item}: is shorter than a frame; give 1 or more, or 0 for independent losses."
        )
    return conditions._replace(**{key: number})


def _number(text: str, item: str, highest: float) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0.0 <= number <= highest:
        raise ConditionsError(f"{item}: {text!r} is not a number from 0 to {highest:g}.")
    return number


def publish(both: BothWays, parameters: Parameters) -> None:
    """Set the parameters that tell of the conditions, and change them."""
    for start, conditions in ((_UP, both.up), (_DOWN, both.down)):
        for field, end in _IN_FLIGHT.items():
            parameters.set(start + end, getattr(conditions, field))


def changed(both: BothWays, parameters: Parameters) -> BothWays:
    """Return the conditions that the parameters ask for; what has no parameter stays."""

    def one(start: str, conditions: Conditions) -> Conditions:
        asked = {field: parameters[start + end] for field, end in _IN_FLIGHT.items()}
        if asked["rate"] > 0.0:
            asked["rate"] = max(asked["rate"], LEAST_RATE)
        return conditions._replace(**asked)

    return BothWays(one(_UP, both.up), one(_DOWN, both.down))
