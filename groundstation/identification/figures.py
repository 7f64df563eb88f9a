"""Measured and freely flown velocities, and χ with its intervals, as a page."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from groundstation import __version__
from groundstation.identification.fit import Identified, Told, free_flights
from groundstation.identification.response import CHI, PARAMETERS
from groundstation.identification.samples import AXES, UNITS, Samples
from groundstation.report.document import Finding, Plate, Report
from groundstation.report.figures import style

if TYPE_CHECKING:
    from matplotlib.figure import FigureBase

_HEIGHT, _CHI_HEIGHT = 5.2, 2.6
# More points than this a page's width does not show.
_POINTS = 2000


def report_on(
    found: Identified, flights: Sequence[Samples], tolds: Sequence[Told], learned: Sequence[str]
) -> Report:
    """Return the page on what was identified."""
    findings = [
        Finding(
            "free flight" if told.flight in learned else "validation",
            f"R² of {axis}, {told.flight}",
            f"{value:.3f}",
        )
        for told in tolds
        for axis, value in zip(AXES, told.free, strict=True)
    ]
    plates = [
        _flight(found, flight, told, seen=told.flight in learned)
        for flight, told in zip(flights, tolds, strict=True)
    ]
    plates.append(
        Plate(
            "χ",
            "The parameters with their 95 % intervals",
            "By drawing the windows of the flights anew. What crosses zero, or is wide, the flights do not tell.",
            _CHI_HEIGHT,
            partial(_draw_chi, found=found),
        )
    )
    lead = (
        "v_ref = M v̇ + C(ω) v, fitted so that the model, flown free from the first velocity on with the references "
        "that were sent, is nearest to the vehicle.",
    )
    facts = (
        ("Program", f"groundstation {__version__}"),
        ("Flights learned from", ", ".join(learned)),
        ("Delay", f"{found.delay:.3f} s from a reference's sending to its effect"),
        ("Condition", f"{found.condition:.1f}; weight of the prior {found.ridge:g}"),
    )
    return Report("The vehicle's velocity response", lead, findings, plates, facts)


def _flight(found: Identified, flight: Samples, told: Told, *, seen: bool) -> Plate:
    worst = int(np.argmin(told.free))
    return Plate(
        told.flight,
        f"The model tells {100 * told.free[worst]:.0f} % or more of every axis's motion",
        "Strong: what the vehicle flew. Thin: the model, which was given nothing but the first velocity and the "
        f"references. {'It learned from this flight.' if seen else 'It has not seen this flight before.'}",
        _HEIGHT,
        partial(_draw_flight, found=found, flight=flight),
    )


def _draw_flight(figure: FigureBase, found: Identified, flight: Samples) -> None:
    axes = figure.subplots(4, 1, sharex=True)
    start = 0.0
    for v, way in free_flights(found, flight):
        every = max(1, len(v) // _POINTS)
        t = start + np.arange(len(v)) * flight.dt
        for place, plot in enumerate(axes):
            plot.plot(
                t[::every],
                v[::every, place],
                color=style.TEXT,
                linewidth=1.6,
                label="flown" if start == 0.0 else None,
            )
            plot.plot(
                t[::every],
                way[::every, place],
                color=style.BAR,
                linewidth=0.9,
                label="model" if start == 0.0 else None,
            )
        start = float(t[-1]) + 1.0
    for axis, unit, plot in zip(AXES, UNITS, axes, strict=True):
        plot.set_ylabel(f"{axis}, {unit}")
    axes[0].legend(loc="upper right", ncols=2)
    axes[-1].set_xlabel("s")


def _draw_chi(figure: FigureBase, found: Identified) -> None:
    plot = figure.subplots()
    places = np.arange(CHI)
    value, low, high = (each[:CHI] for each in (found.parameters, found.low, found.high))
    errors = np.maximum(np.stack((value - low, high - value)), 0.0)
    plot.errorbar(
        places, value, errors, fmt="o", color=style.TEXT, ecolor=style.FAINT, capsize=3, markersize=4
    )
    plot.axhline(0.0, color=style.FAINT, linewidth=0.6)
    plot.set_xticks(places, [name.replace("chi_", "χ") for name in PARAMETERS[:CHI]])
