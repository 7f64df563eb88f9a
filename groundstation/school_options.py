"""The options of `groundstation school`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "learn to fly by feel: what comes next for you, and flying it"
DESCRIPTION = """\
Shows who flies, what they have passed and what comes next; Enter flies it with a simulated vehicle. After the landing
the debrief tells how it went, n goes on with the next exercise, q leads back here."""
EXAMPLES = """\
examples:
  groundstation school                       begin, or go on
  groundstation school --pilot Ann           as Ann
  groundstation school --device falcon       with a haptic device

exit codes: 0 done, 1 a process died, 2 bad input
"""
RUN = "groundstation.school_command:run"


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser: some of those of flying, which are there without this command, too."""
    left = argparse.SUPPRESS
    parser.add_argument("--pilot", metavar="NAME", default=left, help="who flies (default: who is logged in)")
    parser.add_argument(
        "--device",
        metavar="NAME[:ADDRESS]",
        default=left,
        help="haptic device (default: the on-screen stick)",
    )
    parser.add_argument("--config", type=Path, metavar="FILE", default=left, help="settings")
    parser.add_argument("--logs", type=Path, metavar="DIR", default=left, help="recordings go here")
