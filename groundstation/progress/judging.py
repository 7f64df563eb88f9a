"""From a flight that was measured to what is kept of it, the same live and from its recording."""

from __future__ import annotations

import math

import msgspec

from groundstation import __version__
from groundstation.progress.flown import Flown
from groundstation.run import Run
from groundstation.training.judgement import judgement_of
from groundstation.training.measurer import Measurer
from groundstation.training.measures import Measures
from groundstation.training.reference import digest_of


def flight_of(run: Run) -> Flown:
    """Return what is known of a run's flights before they are flown."""
    assert run.mission is not None
    return Flown(
        run.pilot,
        run.mission.name,
        digest_of(run.mission),
        run.started,
        seed=run.seed,
        simulated=run.simulated,
        device=device_word(run.device),
        recording=run.recording.name,
        program=__version__,
    )


def device_word(device: str) -> str:
    """Return a device without the socket by which this program moves it: that is another one in each run."""
    name, _, address = device.partition(":")
    return name if address.startswith("/") else device.partition("@")[0]


def judged(known: Flown, attempt: int, measurer: Measurer, par: Measures | None) -> Flown:
    """Return what is to be kept of a flight that landed.

    Args:
        known: What is known of all flights of the run.
        attempt: Which it was, from 1.
        measurer: Has seen it.
        par: What it is held against; None where nobody flew for reference.
    """
    judgement = judgement_of(measurer, par)
    score = judgement.score
    values = {name: float(value) for name, value in msgspec.structs.asdict(judgement.measures).items()}
    return msgspec.structs.replace(
        known,
        attempt=attempt,
        instructed=measurer.instructed,
        duration_s=measurer.director.figures.duration,
        passed=judgement.passed if score else None,
        points=score.points if score else None,
        parts={part.name: part.share for part in score.parts} if score else {},
        measures={name: value for name, value in values.items() if math.isfinite(value)},
    )
