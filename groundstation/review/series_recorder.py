"""Takes down a virtual flight as a series."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from groundstation.evaluation.sample import Sample
from groundstation.messages import Phase
from groundstation.review.series import FlightSeries, clearances, turned
from sim.scenario import Obstacle


class SeriesRecorder:
    """An observer of a virtual flight.

    Args:
        obstacles: Of the world.
        radius: Of the vehicle, m.
        heading: The handle's axes turn with the vehicle (`mapping.frame`), and the force on it is turned back.
    """

    def __init__(self, obstacles: Sequence[Obstacle], radius: float, *, heading: bool = False) -> None:
        self._heading = heading
        self._obstacles = obstacles
        self._radius = radius
        self._samples: list[Sample] = []

    def __call__(self, sample: Sample) -> None:
        """Take note of a sample in which the hand is coupled."""
        if sample.phase is Phase.ENGAGED:
            self._samples.append(sample)

    @property
    def coupled(self) -> bool:
        """Whether the hand was coupled so far."""
        return bool(self._samples)

    def series(self) -> FlightSeries:
        """Return what was flown so far; the hand must have been coupled."""
        samples = self._samples
        outputs = [sample.outputs for sample in samples]
        p = np.array([sample.p for sample in samples])
        t = np.array([sample.t for sample in samples])
        cues = {
            name: np.array([getattr(each.cues, name) for each in outputs]) for name in outputs[0].cues._fields
        }
        seen = np.array([each.p for each in outputs])
        force = np.array([each.force for each in outputs])
        if self._heading:
            force, cues["damping"] = (turned(vectors, seen[:, 3]) for vectors in (force, cues["damping"]))
        clearance, nearest = clearances(p, self._obstacles, self._radius)
        return FlightSeries(
            t=t - t[0],
            p=p,
            p_h=np.array([each.p_h for each in outputs]),
            p_h_rate=np.array([each.p_h_rate for each in outputs]),
            seen=seen,
            error=np.array([each.error for each in outputs]),
            v_ref=np.array([each.v_ref for each in outputs]),
            executed=np.array([sample.v for sample in samples]),
            force=force,
            cues=cues,
            wind=np.array([sample.wind for sample in samples]),
            clearance=clearance,
            nearest=nearest,
        )
