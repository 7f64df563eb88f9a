"""The options of `groundstation evaluate`. It imports nothing heavy: `--help` must answer at once."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "compare controllers over many flights in virtual time"
DESCRIPTION = """\
Fly many flights in virtual time, on all cores or a cluster, and compare them. Every combination of the values given
is flown with every seed. What is flown is kept at once: the same command goes on where it was stopped."""
EXAMPLES = """\
examples:
  groundstation evaluate                                             paper's controller and assisted, 10 seeds
  groundstation evaluate --delay 0,0.1,0.3 --loss 0,0.05             on a link that worsens
  groundstation evaluate --controller paper,my_module:MyController   your own controller against the paper's
  groundstation evaluate --operator novice,average,expert --wind calm,1,2 --seeds 30
  groundstation evaluate --guard barrier,risk_field,off --controller assisted --out guards.csv
  groundstation evaluate --cluster tcp://10.0.0.5:8786 --seeds 1000  on a Dask cluster

Columns and their formulas: docs/evaluate.md. Exit codes: 0 all flown, 1 the work broke off, 2 bad input, 130 stopped.
"""
RUN = "groundstation.evaluation.command:evaluate"

# Option, default, placeholder, what it is.
_AXES = (
    ("controller", "paper,assisted", "NAMES", "paper, assisted, transparent, training or MODULE:CLASS"),
    (
        "guard",
        "",
        "NAMES",
        "barrier, risk_field, off, where the preset has a guard (default: the settings')",
    ),
    ("mission", "paper", "NAMES", "missions with a target, by name or .toml file"),
    ("delay", "0", "S", "round trip to the vehicle and back"),
    ("jitter", "0", "S", "by how much the delay of each way varies"),
    ("loss", "0", "SHARE", "of frames lost, each way"),
    ("wind", "mission", "WINDS", "calm, mission, or speeds in m/s whose direction the seed chooses"),
    ("operator", "average", "NAMES", "who flies: novice, average, expert"),
)


def fill(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
    axes = parser.add_argument_group("axes: one value, or several with commas between them")
    for option, default, metavar, words in _AXES:
        told = f"{words} (default: {default})" if default else words
        axes.add_argument(f"--{option}", default=default, metavar=metavar, help=told)
    axes.add_argument("--seeds", type=int, default=10, metavar="N", help="how many, from 0 (default: 10)")
    same = parser.add_argument_group("the same for all flights")
    same.add_argument(
        "--rate", type=int, default=1000, metavar="HZ", help="of the servo; 250 is quicker (default: 1000)"
    )
    same.add_argument("--airframe", metavar="NAME", help="a preset or a .toml file (default: the mission's)")
    same.add_argument(
        "--model",
        choices=("kinematic", "dynamic", "rigid_body"),
        help="motion model (default: the mission's)",
    )
    same.add_argument("--config", type=Path, metavar="FILE", help="settings (default: groundstation.toml)")
    work = parser.add_argument_group("work and results")
    work.add_argument("--jobs", type=int, metavar="N", help="processes (default: as many as there are cores)")
    work.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help="fly on the Dask cluster with its scheduler there (extra 'cluster')",
    )
    work.add_argument(
        "--out",
        type=Path,
        default=Path("evaluation.parquet"),
        metavar="FILE",
        help="table, .parquet or .csv; log and figure come beside it (default: evaluation.parquet)",
    )
