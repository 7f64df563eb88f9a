"""What was identified as an airframe that the simulator flies and the pilot compensates."""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from pathlib import Path

import msgspec
import tomli_w

from groundstation.errors import InputError
from groundstation.identification.fit import Identified, Told
from sim.airframe import load_airframe
from sim.scenario import ScenarioError


def write_preset(path: Path, name: str, like: str, found: Identified, tolds: Sequence[Told]) -> None:
    """Write an airframe file and read it back.

    Args:
        path: The file; one that is there is replaced only if it was written by this.
        name: The airframe's.
        like: Whose size, speeds and battery it gets.
        found: What was identified.
        tolds: How well it tells flights; goes into the file as words.

    Raises:
        InputError: It cannot be written, or what was found cannot be flown.
    """
    try:
        table = msgspec.to_builtins(load_airframe(like))
    except ScenarioError as error:
        raise InputError(f"--like: {error}") from error
    table = {key: value for key, value in table.items() if value is not None and key != "body"}
    fits = "; ".join(
        f"{told.flight}: free flight R² {', '.join(f'{value:.3f}' for value in told.free)}" for told in tolds
    )
    table |= {
        "name": name,
        "title": f"{name}, identified",
        "source": f"Identified by groundstation on {datetime.datetime.now().astimezone():%Y-%m-%d}. {fits}.",
        "estimated": f"All but [chi] is that of {like}: put in your vehicle's own. Delay found: {found.delay:.3f} s.",
        "chi": msgspec.to_builtins(found.chi),
    }
    if path.exists() and "Identified by groundstation" not in path.read_text(
        encoding="utf-8", errors="replace"
    ):
        raise InputError(f"{path}: is there already and not written by 'identify'; choose another --out.")
    try:
        path.write_text(tomli_w.dumps(table), encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); choose another --out.") from error
    try:
        load_airframe(str(path))
    except ScenarioError as error:
        raise InputError(f"what was found cannot be flown: {error}") from error
