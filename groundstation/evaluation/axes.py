"""The axes of an evaluation as the command line gives them, checked."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Collection
from typing import NamedTuple, TypeVar

from groundstation.errors import InputError
from groundstation.evaluation.remote_site import STEP_S
from groundstation.evaluation.trial import AS_IN_MISSION, CALM, PRESET_NAMES
from sim.people import PEOPLE

GUARDS = ("barrier", "risk_field", "off")
_LONGEST_S, _MOST_LOSS, _STRONGEST = 10.0, 0.95, 40.0
_MOST_SEEDS, _FASTEST_HZ = 1_000_000, 4000
_STEPS_HZ = round(1.0 / STEP_S)

T = TypeVar("T", str, float)


class Axes(NamedTuple):
    """What is varied, and what is the same for all flights.

    Attributes:
        controllers, guards, missions, winds, operators: By name, as in `Case`; guards none: the settings'.
        delays, jitters, losses: s, s, and shares of frames.
        seeds: How many, from 0.
        rate: Of the servo, Hz.
        airframe, model: Others than the missions', or "".
    """

    controllers: tuple[str, ...]
    guards: tuple[str, ...]
    missions: tuple[str, ...]
    delays: tuple[float, ...]
    jitters: tuple[float, ...]
    losses: tuple[float, ...]
    winds: tuple[str, ...]
    operators: tuple[str, ...]
    seeds: int
    rate: float
    airframe: str = ""
    model: str = ""


def read_axes(asked: argparse.Namespace) -> Axes:
    """Return the axes that the command line gives.

    Raises:
        InputError: A value is none; the message names the option and says what may be given.
    """
    return Axes(
        controllers=_list("--controller", asked.controller, _controller),
        guards=_list("--guard", asked.guard, _one_of(GUARDS)) if asked.guard else (),
        missions=_list("--mission", asked.mission, lambda _, text: text),
        delays=_list("--delay", asked.delay, _number(_LONGEST_S, "s")),
        jitters=_list("--jitter", asked.jitter, _number(_LONGEST_S, "s")),
        losses=_list("--loss", asked.loss, _number(_MOST_LOSS, "as a share")),
        winds=_list("--wind", asked.wind, _wind),
        operators=_list("--operator", asked.operator, _one_of(PEOPLE)),
        seeds=_seeds(asked.seeds),
        rate=_rate(asked.rate),
        airframe=asked.airframe or "",
        model=asked.model or "",
    )


def _list(option: str, text: str, read: Callable[[str, str], T]) -> tuple[T, ...]:
    """Return the values of a comma list, each once."""
    values = [read(option, part.strip()) for part in text.split(",") if part.strip()]
    if not values:
        raise InputError(f"{option}: is empty; give a value, or several with commas between them.")
    return tuple(dict.fromkeys(values))


def _controller(option: str, text: str) -> str:
    if text not in PRESET_NAMES and ":" not in text:
        raise InputError(f"{option} {text}: is none of {', '.join(PRESET_NAMES)}, nor MODULE:CLASS.")
    return text


def _one_of(known: Collection[str]) -> Callable[[str, str], str]:
    def read(option: str, text: str) -> str:
        if text not in known:
            raise InputError(f"{option} {text}: is none of {', '.join(known)}.")
        return text

    return read


def _number(most: float, unit: str) -> Callable[[str, str], float]:
    def read(option: str, text: str) -> float:
        value = _float(text)
        if not 0.0 <= value <= most:
            raise InputError(f"{option} {text}: is not a number from 0 to {most:g}, {unit}.")
        return value

    return read


def _wind(option: str, text: str) -> str:
    if text in (CALM, AS_IN_MISSION):
        return text
    speed = _float(text)
    if not 0.0 <= speed <= _STRONGEST:
        raise InputError(
            f"{option} {text}: is neither {CALM}, {AS_IN_MISSION} nor a speed from 0 to {_STRONGEST:g}, m/s."
        )
    return f"{speed:g}"


def _seeds(seeds: int) -> int:
    if not 1 <= seeds <= _MOST_SEEDS:
        raise InputError(f"--seeds {seeds}: is not a number of seeds from 1 to {_MOST_SEEDS}.")
    return seeds


def _rate(rate: int) -> float:
    if not 0 < rate <= _FASTEST_HZ or rate % _STEPS_HZ:
        raise InputError(f"--rate {rate}: is not a multiple of {_STEPS_HZ} up to {_FASTEST_HZ}, Hz.")
    return float(rate)


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
