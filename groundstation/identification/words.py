"""What was identified, as tables for the terminal and as numbers for programs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from msgspec.structs import asdict

from groundstation.identification.findings import Findings
from groundstation.identification.fit import Identified
from groundstation.identification.response import CHI, DELAYS, NAMES
from groundstation.identification.samples import AXES, UNITS, Numbers
from groundstation.identification.validate import AHEAD_S, Ahead, Validation

# Normal equations worse than this do not tell all of χ apart.
ILL_CONDITIONED = 1e4
# Half an interval that is more than this share of its parameter: the flights do not tell this one.
_WIDE = 0.25
# A delay that is more than this is missed in a simulation without one, s: a tenth of a multirotor's response.
_MISSED_S = 0.05
# Regression alone that tells held-out windows so much better shows that the flights are too short to refine.
_WORSE = 0.01
# A steady wind that tells so much more of an axis is worth a word.
_WINDY = 0.05
_NAME, _CELL = 46, 12


def table(found: Findings) -> str:
    """Return the tables and what to make of them."""
    lines = [
        f"learned from {flight.name}: {flight.seconds:.1f} s{_left_out(flight.left_out)}"
        for flight in found.learned
    ]
    lines += ["", *_parameters(found), "", _row("R²", AXES)]
    lines.append(_row("held-out quarters of the flights", _cells(found.identified.crossed)))
    lines.append(_row("  by the regression alone, not refined", _cells(found.identified.crossed_regression)))
    for place, validation in enumerate(found.validations):
        lines.append(validation.flight + ("" if found.seen(place) else " (not learned from)"))
        lines += _validation(validation, found.flights[place].dt)
        if found.compared_validations:
            cells = _cells(found.compared_validations[place].free)
            lines.append(_row(f"  {found.compared}, free flight", cells))
    lines += _matrix(found)
    remarks = remarks_on(found)
    return "\n".join([*lines, *([""] if remarks else []), *remarks])


def remarks_on(found: Findings) -> list[str]:
    """Return what to beware of, a sentence each."""
    remarks: list[str] = []
    of = found.identified
    if of.condition > ILL_CONDITIONED:
        remarks.append("The flights do not tell all of χ apart: excite every axis, and turn while flying.")
    if wide := [name for name, share in zip(NAMES, _shares(of), strict=True) if share > _WIDE]:
        remarks.append(f"Not well told by these flights: {', '.join(wide)}; their intervals are wide.")
    if np.nanmean(of.crossed_regression) > np.nanmean(of.crossed) + _WORSE:
        remarks.append("What was held out is told worse than by the regression alone: fly longer.")
    for each in found.validations:
        if np.nanmax(each.windy - each.free, initial=0.0) > _WINDY:
            east, north, up = each.push
            remarks.append(
                f"{each.flight}: a steady push of {math.hypot(east, north, up):.2f} m/s² accounts for much that the "
                "free flight in calm air misses: wind, or a vehicle out of trim."
            )
    return remarks


def missing_delay(found: Findings) -> str | None:
    """Return that the simulator does not fly the delay that was found, or None if that hardly matters."""
    longest = float(found.identified.parameters.delays.max())
    if longest <= _MISSED_S:
        return None
    return (
        f"The delay of {longest:.2f} s is not in the airframe: give --no-delay to have it in χ, or what of it is the "
        "link's to the simulator with --channel."
    )


def as_json(found: Findings) -> dict[str, object]:
    """Return the same for programs; null where an axis hardly moved."""
    of = found.identified
    return {
        "chi": dict(zip(NAMES, of.parameters.chi.tolist(), strict=True)),
        "low": dict(zip(NAMES, of.low[:CHI].tolist(), strict=True)),
        "high": dict(zip(NAMES, of.high[:CHI].tolist(), strict=True)),
        "delay_s": dict(zip(DELAYS, of.parameters.delays.tolist(), strict=True)),
        "delay_low_s": dict(zip(DELAYS, of.low[CHI:].tolist(), strict=True)),
        "delay_high_s": dict(zip(DELAYS, of.high[CHI:].tolist(), strict=True)),
        "condition": of.condition,
        "ridge": of.ridge,
        "r2_held_out": _listed(of.crossed),
        "r2_held_out_regression": _listed(of.crossed_regression),
        "flights": {
            validation.flight: {"learned_from": found.seen(place), **_validation_json(validation)}
            for place, validation in enumerate(found.validations)
        },
        "matrix": [
            {"learned_from": pair.learned, "flight": pair.flight, "r2_free": _listed(pair.free)}
            for pair in (found.matrix.pairs if found.matrix else ())
        ],
        "compared": None if found.compared_chi is None else _compared_json(found),
    }


def _validation_json(validation: Validation) -> dict[str, object]:
    return {
        "r2_one_step": _listed(validation.one_step.model),
        "r2_one_step_if_nothing_changed": _listed(validation.one_step.nothing),
        "r2_ahead": _listed(validation.ahead.model),
        "r2_ahead_if_nothing_changed": _listed(validation.ahead.nothing),
        "r2_free": _listed(validation.free),
        "r2_free_low": _listed(validation.low),
        "r2_free_high": _listed(validation.high),
        "r2_free_in_steady_wind": _listed(validation.windy),
        "push_m_s2": _listed(validation.push),
        "rms": _listed(validation.rms),
    }


def _compared_json(found: Findings) -> dict[str, object]:
    assert found.compared_chi is not None
    return {
        "airframe": found.compared,
        "chi": asdict(found.compared_chi),
        "flights": {each.flight: _validation_json(each) for each in found.compared_validations or ()},
    }


def _parameters(found: Findings) -> Iterator[str]:
    of = found.identified
    other = None if found.compared_chi is None else list(asdict(found.compared_chi).values())
    yield f"{'χ':<14}{'found':>8}   {'95 % interval':^19}{'±':>7}{'' if other is None else f'   {found.compared}'}"
    for place, (name, share) in enumerate(zip(NAMES, _shares(of), strict=True)):
        line = f"{name:<14}{of.parameters.chi[place]:>8.4f}   {of.low[place]:>8.4f} to {of.high[place]:>7.4f}"
        line += f"{100 * share:>5.0f} %" if share < 10 else f"{'> 999 %':>7}"
        yield line + ("" if other is None else f"   {other[place]:.4f}")
    for place, name in enumerate(DELAYS if of.longest_delay else ()):
        low, high = of.low[CHI + place], of.high[CHI + place]
        yield f"{'delay ' + name:<14}{of.parameters.delays[place]:>8.3f}   {low:>8.3f} to {high:>7.3f} s"
    if not of.longest_delay:
        yield "no delay looked for: what is late is in χ"
    yield f"condition {of.condition:.1f}, prior's weight {of.ridge:g}"


def _validation(validation: Validation, dt: float) -> Iterator[str]:
    yield from _ahead("  one sample", dt, validation.one_step)
    yield from _ahead(" ", AHEAD_S, validation.ahead)
    yield _row("  free flight, start to end", _cells(validation.free))
    yield _row("    95 % from", _cells(validation.low))
    yield _row("    95 % to", _cells(validation.high))
    yield _row("    in a steady wind, fitted to this flight", _cells(validation.windy))
    units = [f"{value:.3f} {unit}" for value, unit in zip(validation.rms, UNITS, strict=True)]
    yield _row("    what it leaves, RMS", units)


def _ahead(name: str, seconds: float, ahead: Ahead) -> Iterator[str]:
    yield _row(f"{name} {seconds:.2g} s ahead", _cells(ahead.model))
    yield _row("    if nothing changed", _cells(ahead.nothing))


def _matrix(found: Findings) -> Iterator[str]:
    if found.matrix is None:
        return
    yield ""
    yield _row("R², free: learned from one alone → told", AXES)
    for pair in found.matrix.pairs:
        yield _row(f"  {pair.learned} → {pair.flight}", _cells(pair.free))
    yield from found.matrix.alone


def _row(name: str, cells: Sequence[str]) -> str:
    return name.ljust(_NAME) + "".join(cell.rjust(_CELL) for cell in cells)


def _cells(values: Numbers) -> list[str]:
    return ["still" if math.isnan(value) else f"{value:.4f}" for value in values]


def _listed(values: Numbers) -> list[float | None]:
    return [None if math.isnan(value) else float(value) for value in values]


def _shares(found: Identified) -> Numbers:
    """Return half of each interval as a share of its parameter, (10,)."""
    half = 0.5 * (found.high - found.low)[:CHI]
    return half / np.maximum(np.abs(found.parameters.chi), 1e-9)


def _left_out(seconds: float) -> str:
    return (
        f", and {seconds:.1f} s that are not known or in too short pieces left out" if seconds >= 0.5 else ""
    )
