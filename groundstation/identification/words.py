"""What was identified, as tables for the terminal and as numbers for programs."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.identification.fit import AHEAD_S, Identified, Told
from groundstation.identification.response import CHI, PARAMETERS
from groundstation.identification.samples import AXES, UNITS, Numbers

# Normal equations worse than this do not tell all of χ apart.
ILL_CONDITIONED = 1e4


def table(found: Identified, tolds: Sequence[Told], learned: Sequence[str]) -> str:
    """Return the tables.

    Args:
        found: What was identified.
        tolds: How well it tells each flight.
        learned: Names of the flights it is from.
    """
    lines = ["χ             95 % interval"]
    for name, value, low, high in list(zip(PARAMETERS, found.parameters, found.low, found.high, strict=True))[
        :CHI
    ]:
        lines.append(f"{name:<8}{value:8.4f}   {low:8.4f} {high:8.4f}")
    lines.append(
        f"delay {found.delay:.3f} s, condition {found.condition:.1f}, prior's weight {found.ridge:g}"
    )
    if found.condition > ILL_CONDITIONED:
        lines.append("The flights do not tell all of χ apart: excite every axis, and turn while flying.")
    lines += ["", "R²".ljust(40) + "".join(axis.rjust(10) for axis in AXES)]
    lines.append(_row("cross-validated, windows held out", found.crossed))
    for told in tolds:
        lines.append(f"{told.flight}{'' if told.flight in learned else ' (not learned from)'}")
        lines.append(_row("  one sample ahead", told.one_step))
        lines.append(_row(f"  {AHEAD_S:g} s ahead", told.ahead))
        lines.append(_row("  free flight, start to end", told.free))
        units = "".join(f"{value:.3f} {unit}".rjust(10) for value, unit in zip(told.rms, UNITS, strict=True))
        lines.append("  what it leaves, RMS".ljust(40) + units)
    return "\n".join(lines)


def as_json(found: Identified, tolds: Sequence[Told]) -> dict[str, object]:
    """Return the same for programs."""
    names = PARAMETERS[:CHI]
    return {
        "chi": dict(zip(names, found.parameters.tolist(), strict=False)),
        "low": dict(zip(names, found.low.tolist(), strict=False)),
        "high": dict(zip(names, found.high.tolist(), strict=False)),
        "delay_s": found.delay,
        "condition": found.condition,
        "r2_cross_validated": found.crossed.tolist(),
        "flights": {
            told.flight: {
                "r2_one_step": told.one_step.tolist(),
                "r2_ahead": told.ahead.tolist(),
                "r2_free": told.free.tolist(),
                "rms": told.rms.tolist(),
            }
            for told in tolds
        },
    }


def _row(name: str, values: Numbers) -> str:
    return name.ljust(40) + "".join(f"{value:.4f}".rjust(10) for value in values)
