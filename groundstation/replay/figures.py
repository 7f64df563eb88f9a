"""What a replayed flight came to, beside the recorded one."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from groundstation.review.series import FlightSeries, lengths
from groundstation.training.mission import Mission


class Row(NamedTuple):
    """A number of the recorded flight and of the replayed one; None where there is none."""

    name: str
    unit: str
    recorded: float | None
    replayed: float | None


def rows(recorded: FlightSeries, replayed: FlightSeries, mission: Mission) -> list[Row]:
    """Return the numbers of both flights, over the time in which both were coupled.

    Args:
        recorded: The recording.
        replayed: The replay.
        mission: Whose target is flown to.
    """
    end = min(recorded.t[-1], replayed.t[-1])
    both = [_until(series, end) for series in (recorded, replayed)]
    found = [Row("coupled for", "s", float(recorded.t[-1]), float(replayed.t[-1]))]
    for name, unit, measure in _MEASURES:
        values = [measure(series) for series in both]
        found.append(Row(name, unit, *(value if np.isfinite(value) else None for value in values)))
    if mission.target is not None:
        target = np.array(mission.target.position)
        ends = [float(np.linalg.norm(series.p[-1, :3] - target)) for series in both]
        found.append(Row("to the target, at the end", "m", *ends))
    apart = apart_by(*both)
    found.append(Row("ways apart, RMS", "m", None, _rms(apart)))
    found.append(Row("ways apart, largest", "m", None, float(apart.max())))
    return found


def apart_by(recorded: FlightSeries, replayed: FlightSeries) -> np.ndarray:
    """Return how far the vehicles are from one another at each sample of the replay, (n,), m; both begin at 0."""
    ways = [series.p[:, :3] - series.p[0, :3] for series in (recorded, replayed)]
    other = np.column_stack([np.interp(replayed.t, recorded.t, column) for column in ways[0].T])
    return np.asarray(np.linalg.norm(ways[1] - other, axis=1))


def fingerprint(replayed: FlightSeries) -> str:
    """Return what stands for every decision of a replay: on the same version it is the same."""
    content = b"".join(
        np.ascontiguousarray(each).tobytes() for each in (replayed.v_ref, replayed.force, replayed.p)
    )
    return hashlib.sha256(content).hexdigest()[:12]


def _errors(series: FlightSeries) -> np.ndarray:
    return lengths(series.error)


def _forces(series: FlightSeries) -> np.ndarray:
    return lengths(series.force)


def _until(series: FlightSeries, end: float) -> FlightSeries:
    n = max(1, int(np.searchsorted(series.t, end + 1e-9)))
    cues = {name: cue[:n] for name, cue in series.cues.items()}
    rest = {name: value[:n] for name, value in series._asdict().items() if name != "cues"}
    return FlightSeries(**rest, cues=cues)


def _way(series: FlightSeries) -> float:
    return float(np.linalg.norm(np.diff(series.p[:, :3], axis=0), axis=1).sum())


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.square(values).mean()))


_MEASURES: tuple[tuple[str, str, Callable[[FlightSeries], float]], ...] = (
    ("way flown", "m", _way),
    ("p̃, RMS", "m", lambda series: _rms(_errors(series))),
    ("p̃, largest", "m", lambda series: float(_errors(series).max())),
    ("force, RMS", "N", lambda series: _rms(_forces(series))),
    ("force, largest", "N", lambda series: float(_forces(series).max())),
    ("clearance, least", "m", lambda series: float(series.clearance.min())),
)
