"""What was identified as a page: flown and modelled velocities, their residuals, and χ with its intervals."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import astuple

from groundstation import __version__
from groundstation.identification.findings import Findings
from groundstation.identification.response import CHI, DELAYS, NAMES
from groundstation.identification.samples import AXES, UNITS, Numbers, Samples
from groundstation.identification.validate import AHEAD_S, Validation, free_flights
from groundstation.identification.words import remarks_on
from groundstation.report.document import Finding, Plate, Report, Table
from groundstation.report.figures import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

_HEIGHT, _CHI_HEIGHT = 7.6, 2.8
# More points than this a page's width does not show.
_POINTS = 2000
_LEAD = (
    "χ of v_ref = M v̇ + C(ω) v, fitted so that the model, flown free with the references that were sent, is nearest "
    "to the vehicle. R² is the share of an axis's motion that is told; 1 is all of it.",
)


def report_on(found: Findings) -> Report:
    """Return the page on what was identified."""
    of = found.identified
    findings = [
        Finding(_whether(found, place), _what(validation, axis), _score(validation, axis))
        for place, validation in enumerate(found.validations)
        for axis in range(4)
    ]
    plates = [_flight(found, place) for place in range(len(found.flights))]
    plates.append(
        Plate(
            "χ",
            "The parameters with their 95 % intervals",
            "By drawing blocks of the flights anew. What is wide, the flights do not tell."
            + (f" Crosses: {found.compared}." if found.compared else ""),
            _CHI_HEIGHT,
            partial(_draw_chi, found=found),
        )
    )
    delays = ", ".join(
        f"{name} {delay:.3f} s" for name, delay in zip(DELAYS, of.parameters.delays, strict=True)
    )
    facts = (
        ("Program", f"groundstation {__version__}"),
        *(("Learned from", f"{flight.name}, {flight.seconds:.1f} s") for flight in found.learned),
        ("From a reference to being told of it", delays),
        ("Condition", f"{of.condition:.1f}; weight of the prior {of.ridge:g}"),
    )
    return Report(
        "The vehicle's velocity response",
        [*_LEAD, *remarks_on(found)],
        findings,
        plates,
        facts,
        _tables(found),
    )


def _whether(found: Findings, place: int) -> str:
    return "learned from" if found.seen(place) else "not learned from"


def _what(validation: Validation, axis: int) -> str:
    return f"R² of {AXES[axis]}, flown free through {validation.flight}"


def _score(validation: Validation, axis: int) -> str:
    if np.isnan(validation.free[axis]):
        return "still"
    return f"{validation.free[axis]:.3f} ({validation.low[axis]:.3f} to {validation.high[axis]:.3f})"


def _tables(found: Findings) -> list[Table]:
    rows = [("held-out quarters", "each from its own first velocity", *_cells(found.identified.crossed))]
    for place, validation in enumerate(found.validations):
        name = validation.flight
        rows += [
            (name, f"{found.flights[place].dt:.2g} s ahead, one sample", *_cells(validation.one_step.model)),
            (name, "the same if nothing changed", *_cells(validation.one_step.nothing)),
            (name, f"{AHEAD_S:g} s ahead", *_cells(validation.ahead.model)),
            (name, "the same if nothing changed", *_cells(validation.ahead.nothing)),
            (name, "flown free", *_cells(validation.free)),
            (name, "the same in a steady wind, fitted", *_cells(validation.windy)),
        ]
    words = "One sample ahead is easy, and no proof: a model has to beat what predicts that nothing changes."
    tables = [Table("R² by how far is looked ahead", words, ("flight", "what is told", *AXES), rows)]
    if found.matrix:
        pairs = [(pair.learned, pair.flight, *_cells(pair.free)) for pair in found.matrix.pairs]
        heads = ("learned from alone", "flown free", *AXES)
        tables.append(Table("Learned from one flight, validated on another", "", heads, pairs))
    return tables


def _cells(values: Numbers) -> list[str]:
    return ["still" if np.isnan(value) else f"{value:.4f}" for value in values]


def _flight(found: Findings, place: int) -> Plate:
    validation, flight = found.validations[place], found.flights[place]
    worst = 100.0 * float(np.nanmin(validation.free))
    return Plate(
        flight.name,
        f"The model, flown free, tells {worst:.0f} % or more of every axis's motion",
        "Of each axis above: what the vehicle flew, and the model, which is given the first velocity and the "
        "references and nothing else; below: what is left. "
        + ("It learned from this flight." if found.seen(place) else "It has not seen this flight before."),
        _HEIGHT,
        partial(_draw_flight, found=found, flight=flight),
    )


def _draw_flight(figure: FigureBase, found: Findings, flight: Samples) -> None:
    rows: list[Axes] = list(figure.subplots(8, 1, sharex=True, height_ratios=[3, 1] * 4))
    of, start = found.identified.parameters, 0.0
    for v, way in free_flights(of.chi, of.delays, flight):
        every = max(1, len(v) // _POINTS)
        t = start + np.arange(len(v))[::every] * flight.dt
        label = start == 0.0
        for axis in range(4):
            above, below = rows[2 * axis], rows[2 * axis + 1]
            above.plot(t, v[::every, axis], color=style.VEHICLE, lw=1.6, label="vehicle" if label else None)
            above.plot(t, way[::every, axis], color=style.HAND, lw=0.9, label="model" if label else None)
            below.plot(t, (v - way)[::every, axis], color=style.FAINT, lw=style.THIN)
        start = float(t[-1]) + 1.0
    for axis, (name, unit) in enumerate(zip(AXES, UNITS, strict=True)):
        rows[2 * axis].set_ylabel(f"{name}\n{unit}")
        rows[2 * axis + 1].set_ylabel("residual", fontsize=style.SMALL, color=style.FAINT)
        rows[2 * axis + 1].axhline(0.0, color=style.GRID, lw=style.HAIR, zorder=0)
    figure.align_ylabels(rows)
    figure.legend(*rows[0].get_legend_handles_labels(), loc="outside upper right", ncols=2, frameon=False)
    rows[-1].set_xlabel("s")


def _draw_chi(figure: FigureBase, found: Findings) -> None:
    plot = figure.subplots()
    of, places = found.identified, np.arange(CHI)
    value, low, high = of.parameters.chi, of.low[:CHI], of.high[:CHI]
    plot.vlines(places, low, high, color=style.FAINT, lw=style.LINE)
    plot.plot(places, value, "o", color=style.VEHICLE, markersize=4, label="found")
    if found.compared_chi:
        plot.plot(
            places + 0.18,
            astuple(found.compared_chi),
            "x",
            color=style.HAND,
            markersize=4,
            label=found.compared,
        )
        figure.legend(*plot.get_legend_handles_labels(), loc="outside upper right", ncols=2, frameon=False)
    plot.axhline(0.0, color=style.GRID, lw=style.HAIR, zorder=0)
    plot.set_xticks(places, [name.replace("chi_", "χ") for name in NAMES])
