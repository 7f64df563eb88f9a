"""The numbers that the paper's figures stand for, each with what it must be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from groundstation.report.document import Finding
from groundstation.report.figures.force import NEAR_M
from groundstation.report.paper_flights import PAPER, Flights, Flown
from groundstation.review.series import FlightSeries, Numbers, approaches, lengths

FINAL_M = 0.05
_LAST_S = 3.0
# What the order of additions may change, m/s, rad/s, N.
_ROUNDING = 1e-9
_LONGEST_LAG_S = 1.5


class Following(NamedTuple):
    """How the vehicle executes the reference, in the plane.

    Attributes:
        lag: The delay at which the two agree best, s.
        difference: Root mean square of what differs as it is, m/s.
        rest: The same once the lag is taken out.
    """

    lag: float
    difference: float
    rest: float


class Push(NamedTuple):
    """The strongest force while an obstacle was near: N, and its name; "" where none was."""

    force: float
    name: str


def findings(flights: Flights) -> list[Finding]:
    """Return what was found, in the order of the paper's figures."""
    calm, windy, assisted = flights
    return [
        *_motion("Fig. 9", calm),
        *_motion("Fig. 10", windy),
        *_force(windy, assisted),
        *_errors(calm),
        *_velocities(windy),
        _equations(calm, windy),
    ]


def to_target(flown: Flown) -> Numbers:
    """Return the distance to the target, (n,), m; its last is the final error."""
    target = flown.mission.target
    assert target is not None
    return lengths(np.array(target.position) - flown.series.p[:, :3])


def settled_at(t: Numbers, distance: Numbers, within: float) -> float | None:
    """Return from when on the distance stays within a bound, s, or None."""
    beyond = np.flatnonzero(distance > within)
    if not len(beyond):
        return float(t[0])
    return float(t[beyond[-1] + 1]) if beyond[-1] + 1 < len(t) else None


def strongest_near(series: FlightSeries, cue: str = "position") -> Push:
    """Return the strongest force of a cue while an obstacle was near; "position" is equation (5)."""
    strength = lengths(series.cues[cue])
    found = Push(0.0, "")
    for near in approaches(series, NEAR_M):
        during = (series.t >= near.start) & (series.t <= near.end)
        found = max(found, Push(float(strength[during].max()), near.name))
    return found


def following(series: FlightSeries) -> Following:
    """Return how far behind the reference the vehicle is, and what is left then."""
    step = float(series.t[1] - series.t[0])
    reference, executed = series.v_ref[:, :2], series.executed[:, :2]
    count = len(reference)

    def difference(shift: int) -> float:
        return _rms(lengths(reference[: count - shift] - executed[shift:]))

    shifts = range(min(round(_LONGEST_LAG_S / step), count - 1) + 1)
    best = min(shifts, key=difference)
    return Following(best * step, difference(0), difference(best))


def deviation(series: FlightSeries) -> float:
    """Return the largest difference to equations (4) and (5), m/s, rad/s or N, worked out here anew."""
    k1, stiffness = np.array(PAPER.control.k1), np.array(PAPER.control.stiffness)
    rate = series.p_h_rate + k1 * np.tanh(series.error)
    theta = series.seen[:, 3]
    c, s = np.cos(theta), np.sin(theta)
    v_ref = np.column_stack((c * rate[:, 0] + s * rate[:, 1], c * rate[:, 1] - s * rate[:, 0], rate[:, 2:]))
    force = -stiffness * (series.p_h - series.seen)[:, :3]
    return float(max(np.abs(v_ref - series.v_ref).max(), np.abs(force - series.cues["position"]).max()))


def _motion(where: str, flown: Flown) -> list[Finding]:
    series = flown.series
    closest = int(np.argmin(series.clearance))
    way = float(lengths(np.diff(series.p, axis=0)).sum())
    clearance = f"{series.clearance[closest]:.2f} m, {series.nearest[closest]}"
    limit = flown.mission.criteria.max_collisions
    return [
        Finding(where, "target reached and held", _yes(flown.held), "yes", flown.held),
        Finding(where, "way flown and time, to the end of the hold", f"{way:.1f} m in {series.t[-1]:.1f} s"),
        Finding(where, "closest to an obstacle, from the hull", clearance),
        Finding(where, "collisions", f"{flown.collisions}", f"{limit}", flown.collisions <= limit),
    ]


def _force(windy: Flown, assisted: Flown) -> list[Finding]:
    near, obstacles = strongest_near(windy.series), strongest_near(assisted.series, "environment")
    felt = float(lengths(windy.series.force).max())
    return [
        Finding("Fig. 11", f"strongest force with an obstacle nearer than {NEAR_M:g} m", _push(near)),
        Finding("Fig. 11", "strongest force that the hand felt, anywhere", f"{felt:.1f} N"),
        Finding("Fig. 11", "assisted: strongest force of the obstacles", _push(obstacles)),
    ]


def _push(push: Push) -> str:
    return f"{push.force:.1f} N, {push.name}" if push.name else "none was near"


def _errors(flown: Flown) -> list[Finding]:
    series, distance = flown.series, to_target(flown)
    last = series.t >= series.t[-1] - _LAST_S
    final, late = float(distance[-1]), _rms(distance[last])
    settled = settled_at(series.t, distance, FINAL_M)
    p_tilde = _rms(lengths(series.error)[last])
    bar = f"≤ {FINAL_M:g} m"
    return [
        Finding(
            "Fig. 12", "final distance to the target, without wind", f"{final:.3f} m", bar, final <= FINAL_M
        ),
        Finding(
            "Fig. 12", f"the same over the last {_LAST_S:g} s, RMS", f"{late:.3f} m", bar, late <= FINAL_M
        ),
        Finding(
            "Fig. 12",
            f"within {FINAL_M:g} m for good from",
            "never" if settled is None else f"{settled:.1f} s",
        ),
        Finding("Fig. 12", f"controller's error |p̃| over the last {_LAST_S:g} s, RMS", f"{p_tilde:.3f} m"),
    ]


def _velocities(flown: Flown) -> list[Finding]:
    found = following(flown.series)
    return [
        Finding("Fig. 13", "executed behind reference by", f"{found.lag:.2f} s"),
        Finding("Fig. 13", "horizontal difference, as it is, RMS", f"{found.difference:.2f} m/s"),
        Finding("Fig. 13", "the same with the lag taken out: wind and response", f"{found.rest:.2f} m/s"),
    ]


def _equations(*flights: Flown) -> Finding:
    most = max(deviation(flown.series) for flown in flights)
    what = "largest deviation of v_ref and f, both flights"
    return Finding("Eq. 4, 5", what, f"{most:.0e}", "≤ 1e-9", most <= _ROUNDING)


def _rms(values: Numbers) -> float:
    return float(np.sqrt(np.square(values).mean()))


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"
