"""The parts of the force as the pilot tells them: how strong each is, and whether it takes part at all."""

from __future__ import annotations

import math
from typing import NamedTuple

from groundstation.messages import Cue, PilotState, Preset
from groundstation.pilot.presets import PRESETS
from groundstation.tui.choices import CUES

# Less is not felt: the detection threshold of a hand that moves is some hundredths of a newton.
FELT_N = 0.05


class Part(NamedTuple):
    """One cue.

    Attributes:
        cue: Which.
        key: Switches it.
        norm: As it goes into the force, N.
        on: The operator wants it.
        weighted: The preset gives it a weight.
    """

    cue: Cue
    key: str
    norm: float
    on: bool
    weighted: bool

    @property
    def name(self) -> str:
        """The cue in a word."""
        return str(self.cue.name).lower()

    @property
    def acts(self) -> bool:
        """It can be felt now."""
        return self.norm >= FELT_N

    @property
    def mark(self) -> str:
        """Whether it takes part, as a sign: ● it does, ○ it is off, – the preset has none of it."""
        return "–" if not self.weighted else "●" if self.on else "○"


def parts(pilot: PilotState, *, guided: bool = False) -> tuple[Part, ...]:
    """Return all cues, in the order of their keys; that of guidance only where the hand is guided."""
    weights = PRESETS[Preset(pilot.preset)].weights
    norms = {
        # The record has equation (5) as it stands, the others as they are weighted.
        Cue.POSITION: math.hypot(*pilot.force) * weights.position,
        Cue.ENVIRONMENT: math.hypot(*pilot.environment),
        Cue.MISMATCH: math.hypot(*pilot.mismatch),
        Cue.GUARD: math.hypot(*pilot.guard),
        Cue.DAMPING: math.hypot(*pilot.damping),
        Cue.GUIDANCE: math.hypot(*pilot.guidance),
    }
    found: list[Part] = []
    for (cue, choice), weight in zip(CUES.items(), weights, strict=True):
        takes_part = bool(pilot.cues & cue) and weight > 0.0
        norm = norms[cue] if takes_part else 0.0
        found.append(Part(cue, choice.key, norm, bool(pilot.cues & cue), weight > 0.0))
    return tuple(part for part in found if guided or part.cue is not Cue.GUIDANCE)
