"""`groundstation report`: does what was asked."""

from __future__ import annotations

import argparse

from groundstation.report import paper


def run(asked: argparse.Namespace) -> int:
    """Write what was asked for and return the exit code.

    Raises:
        InputError: A recording cannot be read, or a file not be written.
    """
    return paper.report(asked.out, asked.seed, pdf=asked.pdf)
