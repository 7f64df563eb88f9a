"""What the operator chooses in flight: mapping, fine, clutch, preset, cues."""

from __future__ import annotations

from typing import NamedTuple

from groundstation.messages import Cue, MappingMode, Preset

# Those that need nothing but the flight itself; guidance needs a mission's way.
ALL_CUES = int(Cue.POSITION | Cue.ENVIRONMENT | Cue.MISMATCH | Cue.GUARD | Cue.DAMPING)
GUIDED_CUES = ALL_CUES | int(Cue.GUIDANCE)


class Choices(NamedTuple):
    """The operator's choices at one tick, buttons and commands together.

    Attributes:
        mapping: Rate or position.
        fine: Move finely.
        clutched: Move nothing.
        turn: Turn by buttons: 1 left, −1 right.
        preset: Which cues and helps.
        cues: Those of `Cue` that are on; a preset may give an enabled one no weight.
    """

    mapping: MappingMode = MappingMode.RATE
    fine: bool = False
    clutched: bool = False
    turn: int = 0
    preset: Preset = Preset.ASSISTED
    cues: int = ALL_CUES
