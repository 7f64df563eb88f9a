"""What was identified as an airframe that the simulator flies and the pilot compensates."""

from __future__ import annotations

import datetime
from pathlib import Path

import msgspec
import tomli_w

from groundstation import __version__
from groundstation.errors import InputError
from groundstation.identification.findings import Findings
from groundstation.identification.response import DELAYS, NAMES
from groundstation.identification.samples import AXES, Numbers
from sim.airframe import Airframe, load_airframe
from sim.models.dynamic import Chi
from sim.scenario import ScenarioError

# By which a file is known that may be replaced.
_MARK = "# Identified by groundstation"


def check(path: Path) -> None:
    """Say what is in the way of writing an airframe there.

    Raises:
        InputError: A file is there that this did not write.
    """
    if path.exists() and not path.read_text(encoding="utf-8", errors="replace").startswith(_MARK):
        raise InputError(f"{path}: is there already and not written by 'identify'; choose another --out.")


def like(name: str) -> Airframe:
    """Return the airframe whose size, speeds and battery are taken.

    Raises:
        InputError: There is none.
    """
    try:
        return load_airframe(name)
    except ScenarioError as error:
        raise InputError(f"--like: {error}") from error


def chi_of(name: str) -> Chi:
    """Return the χ of an airframe to compare with.

    Raises:
        InputError: There is no such airframe, or it has no χ.
    """
    try:
        chi = load_airframe(name).chi
    except ScenarioError as error:
        raise InputError(f"--compare: {error}") from error
    if chi is None:
        raise InputError(f"--compare {name}: has no [chi]; choose an airframe that flies the model dynamic.")
    return chi


def write(path: Path, name: str, other: str, found: Findings) -> None:
    """Write an airframe file; it is read back before it takes its place.

    Args:
        path: The file; one that is there is replaced only if it was written by this.
        name: The airframe's.
        other: Whose size, speeds and battery it gets.
        found: What was identified.

    Raises:
        InputError: It cannot be written, or what was found cannot be flown.
    """
    check(path)
    new = path.with_name(f".{path.stem}.new.toml")
    try:
        new.write_text(_text(name, other, found), encoding="utf-8")
        load_airframe(str(new))
        new.replace(path)
    except ScenarioError as error:
        reason = str(error).removeprefix(f"{new}: ")
        raise InputError(f"{path}: is not written, for what was found cannot be flown ({reason})") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another --out.") from error
    finally:
        new.unlink(missing_ok=True)


def _text(name: str, other: str, found: Findings) -> str:
    table = msgspec.to_builtins(like(other))
    learned = ", ".join(flight.name for flight in found.learned)
    table |= {
        "name": name,
        "title": f"{name}, identified",
        "source": f"chi: identified from {learned} on {_today()}; the comments tell how well.",
        "estimated": f"All but chi is that of {other}: put in your vehicle's own.",
        "chi": {key: round(value, 5) for key, value in msgspec.to_builtins(found.identified.chi).items()},
    }
    # What other rotors do was not identified.
    table = {key: value for key, value in table.items() if value is not None and key != "body"}
    intervals = {
        key: f"  # {low:.4f} to {high:.4f}"
        for key, low, high in zip(NAMES, found.identified.low, found.identified.high, strict=False)
    }
    lines = [line + intervals.get(line.partition(" ")[0], "") for line in tomli_w.dumps(table).splitlines()]
    return "\n".join([*_comments(found), *lines, ""])


def _comments(found: Findings) -> list[str]:
    delays = ", ".join(
        f"{name} {delay:.3f} s"
        for name, delay in zip(DELAYS, found.identified.parameters.delays, strict=True)
    )
    lines = [
        f"{_MARK} {__version__} on {_today()}; docs/identify.md explains what the figures mean.",
        *(f"# Learned from {flight.name}, {flight.seconds:.0f} s." for flight in found.learned),
        f"# Delays found, which no airframe has: {delays}."
        if found.identified.longest_delay
        else "# No delay was looked for: what is late is in chi.",
        f"# R² by {', '.join(AXES)}: held-out quarters {_numbers(found.identified.crossed)}.",
    ]
    for place, validation in enumerate(found.validations):
        seen = "" if found.seen(place) else ", not learned from"
        lines.append(f"# {validation.flight}{seen}: free flight {_numbers(validation.free)}.")
    return [*lines, "# Behind each of chi: its 95 % interval."]


def _numbers(values: Numbers) -> str:
    return ", ".join(f"{value:.3f}" for value in values)


def _today() -> str:
    return f"{datetime.datetime.now().astimezone():%Y-%m-%d}"
