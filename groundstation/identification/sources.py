"""Where identification gets its flights from: our recordings, PX4's logs, and tables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from groundstation.errors import InputError
from groundstation.identification.samples import Numbers, Raw, Samples, body_velocities, on_grid
from groundstation.identification.ulog import read_ulog

# Of a table, SI; velocities in the world, z up, references on the vehicle's axes.
COLUMNS = (
    "t",
    "x",
    "y",
    "z",
    "yaw",
    "vx",
    "vy",
    "vz",
    "yaw_rate",
    "ref_forward",
    "ref_left",
    "ref_up",
    "ref_yaw_rate",
)


def read_flight(path: Path) -> Samples:
    """Read a flight.

    Raises:
        InputError: It cannot be read, or tells nothing about a response.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: is none of {', '.join(_READERS)}; give a recording, a PX4 log or a table.")
    if not path.is_file():
        raise InputError(f"{path}: there is no such file.")
    return on_grid(path.name, reader(path))


def _read_csv(path: Path) -> Raw:
    try:
        with path.open(encoding="utf-8") as file:
            names = [name.strip() for name in file.readline().split(",")]
            if missing := [name for name in COLUMNS if name not in names]:
                raise InputError(f"{path}: has no column {', '.join(missing)}; docs/identify.md lists them.")
            table = np.loadtxt(file, delimiter=",", ndmin=2)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({error}).") from error
    except ValueError as error:
        raise InputError(f"{path}: is not a table of numbers ({error}).") from error
    if not len(table):
        raise InputError(f"{path}: has no rows.")
    column = {name: table[:, place] for place, name in enumerate(names)}
    velocity = np.column_stack([column[name] for name in ("vx", "vy", "vz")])
    v = body_velocities(velocity, column["yaw"], column["yaw_rate"])
    ref = np.column_stack([column[name] for name in COLUMNS[-4:]])
    return Raw(column["t"], v, ref)


def _read_recording(path: Path) -> Raw:
    """Take the setpoints that were sent, and the velocities that the vehicle told, from one of our recordings."""
    from groundstation.recording import schema
    from groundstation.review.flight import Flight

    flight = Flight(path)
    executed = [flight.series(quantity) for quantity in schema.EXECUTED]
    references = [flight.series(quantity) for quantity in schema.REFERENCES]
    t = executed[0].t
    if not len(t) or not len(references[0].t):
        raise InputError(
            f"{path}: holds no velocities and setpoints; give a flight in which the hand was coupled."
        )
    v = np.column_stack([series.values[:, 0] for series in executed])
    ref = np.column_stack([_held(series.t, series.values[:, 0], t) for series in references])
    return Raw(*_ascending(t, v, ref))


def _held(t: Numbers, values: Numbers, at: Numbers) -> Numbers:
    """Return values held from their times on, NaN before the first."""
    places = np.searchsorted(t, at, side="right") - 1
    return np.where(places >= 0, values[np.maximum(places, 0)], np.nan)


def _ascending(t: Numbers, v: Numbers, ref: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Leave out samples that came at the same instant as the one before."""
    new = np.concatenate(([True], np.diff(t) > 0.0))
    return t[new], v[new], ref[new]


_READERS: dict[str, Callable[[Path], Raw]] = {".rrd": _read_recording, ".ulg": read_ulog, ".csv": _read_csv}
