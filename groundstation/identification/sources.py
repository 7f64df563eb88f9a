"""Where identification gets its flights from: our recordings, PX4's logs, and tables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from groundstation.errors import InputError
from groundstation.identification.samples import Numbers, Raw, body_velocities
from groundstation.identification.ulog import read_ulog

# Of a table, SI; velocities in the world, z up, references on the vehicle's axes.
COLUMNS = (
    "t",
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


def read_flight(path: Path) -> Raw:
    """Read a flight.

    Raises:
        InputError: It cannot be read.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: is none of {', '.join(_READERS)}; give a recording, a PX4 log or a table.")
    if not path.is_file():
        raise InputError(f"{path}: there is no such file; check the path.")
    return reader(path)


def _read_csv(path: Path) -> Raw:
    try:
        with path.open(encoding="utf-8") as file:
            names = [name.strip() for name in file.readline().split(",")]
            if missing := [name for name in COLUMNS if name not in names]:
                raise InputError(f"{path}: has no column {', '.join(missing)}; docs/identify.md lists them.")
            rows = [line for line in file if line.strip()]
        if not rows:
            raise InputError(f"{path}: has no rows.")
        table = np.loadtxt(rows, delimiter=",", ndmin=2)
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({error}).") from error
    except ValueError as error:
        raise InputError(f"{path}: is not a table of numbers ({error}).") from error
    if table.shape[1] != len(names):
        raise InputError(
            f"{path}: has {len(names)} names but {table.shape[1]} columns; name each column in line 1."
        )
    column = {name: table[:, place] for place, name in enumerate(names)}
    velocity = np.column_stack([column[name] for name in ("vx", "vy", "vz")])
    v = body_velocities(velocity, column["yaw"], column["yaw_rate"])
    return Raw(
        column["t"], v, column["yaw"], column["t"], np.column_stack([column[name] for name in COLUMNS[-4:]])
    )


def _read_recording(path: Path) -> Raw:
    """Take the setpoints that were sent, and the velocities that the vehicle told, from one of our recordings."""
    from groundstation.recording import schema
    from groundstation.review.flight import Flight

    flight = Flight(path)
    executed = [flight.series(quantity) for quantity in schema.EXECUTED]
    references = [flight.series(quantity) for quantity in schema.REFERENCES]
    position = flight.series(schema.POSITION)
    t, sent = executed[0].t, references[0].t
    if not len(t) or not len(sent) or not len(position.t):
        raise InputError(
            f"{path}: holds no velocities and setpoints; give a flight in which setpoints were sent."
        )
    v = np.column_stack([series.values[:, 0] for series in executed])
    ref = np.column_stack([series.values[:, 0] for series in references])
    seen = np.isfinite(position.values[:, 3])
    yaw = np.interp(t, position.t[seen], np.unwrap(position.values[seen, 3]))
    told, new = _ascending(t), _ascending(sent)
    return Raw(t[told], v[told], yaw[told], sent[new], ref[new])


def _ascending(t: Numbers) -> npt.NDArray[np.bool_]:
    """Return which samples did not come at the same instant as the one before."""
    return np.concatenate(([True], np.diff(t) > 0.0))


_READERS: dict[str, Callable[[Path], Raw]] = {".rrd": _read_recording, ".ulg": read_ulog, ".csv": _read_csv}
