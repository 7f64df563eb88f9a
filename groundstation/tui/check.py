"""What a check before a flight has found."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.messages import Severity


class Check(NamedTuple):
    """One check.

    Attributes:
        name: Of what is looked at.
        severity: ALARM: not to be flown so.
        state: How it is.
        remedy: What to do, or "".
    """

    name: str
    severity: Severity
    state: str
    remedy: str = ""
