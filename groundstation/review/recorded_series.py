"""A recorded flight as a series: the stretches in which the hand was coupled, at the pilot's 50 Hz."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from groundstation.recording import lanes, schema
from groundstation.recording.schema import Quantity
from groundstation.review.flight import Flight
from groundstation.review.outcome import radius_of
from groundstation.review.series import FlightSeries, Numbers, clearances, turned
from groundstation.review.sights import COUPLED, words_at

_CUES = {
    "position": schema.FORCE_CUE,
    "environment": schema.ENVIRONMENT_CUE,
    "mismatch": schema.MISMATCH_CUE,
    "guard": schema.GUARD_CUE,
    "damping": schema.DAMPING_CUE,
    "guidance": schema.GUIDANCE_CUE,
}


def recorded_series(flight: Flight) -> FlightSeries | None:
    """Return a flight's coupled part; None where the hand was never coupled.

    Several stretches follow one another with the time between them left in. The wind is not known of a flight.
    """
    t, errors = flight.series(schema.ERROR)
    coupled = np.array([word in COUPLED for word in words_at(flight, lanes.PHASE, t)], bool)
    if coupled.sum() < 2:
        return None
    at = t[coupled]
    p = _between(flight, schema.POSITION, at)
    seen = _pilots(flight, schema.P_H, coupled, t) - errors[coupled]
    mission = flight.mission
    clearance, nearest = np.full(len(at), np.inf), np.full(len(at), "")
    if mission and mission.obstacle:
        clearance, nearest = clearances(p, mission.obstacle, radius_of(mission))
    heading = seen[:, 3] if flight.settings.mapping.frame == "heading" else np.zeros(len(at))
    cues = {name: _pilots(flight, quantity, coupled, t) for name, quantity in _CUES.items()}
    cues["damping"] = turned(cues["damping"], heading)
    return FlightSeries(
        t=at - at[0],
        p=p,
        p_h=_pilots(flight, schema.P_H, coupled, t),
        p_h_rate=_pilots(flight, schema.P_H_RATE, coupled, t),
        seen=seen,
        error=errors[coupled],
        v_ref=_reference(flight, coupled, t, at),
        executed=np.column_stack([_between(flight, quantity, at)[:, 0] for quantity in schema.EXECUTED]),
        force=turned(_newest(flight, schema.HANDLE_FORCE, at), heading),
        cues=cues,
        wind=np.full((len(at), 3), np.nan),
        clearance=clearance,
        nearest=nearest,
    )


def thinned(series: FlightSeries, most: int) -> FlightSeries:
    """Return a series with every so many samples left out that at most `most` are left: a page shows no more."""
    every = -(-len(series.t) // most)
    if every == 1:
        return series
    cues = {name: cue[::every] for name, cue in series.cues.items()}
    rest = {name: value[::every] for name, value in series._asdict().items() if name != "cues"}
    return FlightSeries(**rest, cues=cues)


def _pilots(flight: Flight, quantity: Quantity, coupled: npt.NDArray[np.bool_], t: Numbers) -> Numbers:
    """Return a quantity of the pilot's own rows; zeros where an earlier schema has none."""
    times, values = flight.series(quantity)
    if len(times) == len(t):
        return np.nan_to_num(values[coupled])
    return np.zeros((int(coupled.sum()), len(quantity.parts)))


def _reference(flight: Flight, coupled: npt.NDArray[np.bool_], t: Numbers, at: Numbers) -> Numbers:
    """Return v_ref of equation (4); of schema 1, which has none, the setpoints that were sent."""
    if len(flight.series(schema.V_REF).t) == len(t):
        return _pilots(flight, schema.V_REF, coupled, t)
    return np.column_stack([_newest(flight, quantity, at)[:, 0] for quantity in schema.REFERENCES])


def _newest(flight: Flight, quantity: Quantity, at: Numbers) -> Numbers:
    """Return the last values known at given times; zeros before the first."""
    t, values = flight.series(quantity)
    if not len(t):
        return np.zeros((len(at), len(quantity.parts)))
    places = np.searchsorted(t, at, side="right") - 1
    return np.where((places >= 0)[:, None], np.nan_to_num(values[np.maximum(places, 0)]), 0.0)


def _between(flight: Flight, quantity: Quantity, at: Numbers) -> Numbers:
    """Return values at given times on straight lines between those that are known; an angle by the short way."""
    t, values = flight.series(quantity)
    known = np.isfinite(values).all(axis=1)
    t, values = t[known], values[known]
    if not len(t):
        return np.zeros((len(at), len(quantity.parts)))
    if quantity is schema.POSITION:
        values = np.column_stack((values[:, :3], np.unwrap(values[:, 3])))
    return np.column_stack([np.interp(at, t, column) for column in values.T])
