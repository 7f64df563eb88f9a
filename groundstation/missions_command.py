"""`groundstation missions`: each act's own module does it."""

from __future__ import annotations

import argparse
import importlib
from collections.abc import Callable
from typing import cast

_ACTS = {
    "list": "groundstation.training.listing:show_all",
    "show": "groundstation.tui.briefing:run",
    "check": "groundstation.training.listing:check",
    "measure": "groundstation.operators.measure:run",
    "new": "groundstation.training.making:run",
}


def run(asked: argparse.Namespace) -> int:
    """Do what was asked and return the exit code."""
    module, _, function = _ACTS[asked.act].partition(":")
    act = cast(Callable[[argparse.Namespace], int], getattr(importlib.import_module(module), function))
    return act(asked)
