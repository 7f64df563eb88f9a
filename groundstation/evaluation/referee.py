"""Judges a virtual flight by what it sees of it: the mission's criteria, and the figures of the table."""

from __future__ import annotations

import math

from groundstation.evaluation.case import Outcome
from groundstation.evaluation.flight import VirtualFlight
from groundstation.evaluation.sample import Sample
from groundstation.frames import Vector4
from groundstation.messages import Phase
from groundstation.pilot.pilot import Outputs
from groundstation.training.director import Director, Stage
from groundstation.training.mission import Mission
from sim.environment.world import World


def disagreement(outputs: Outputs) -> float:
    """Return |v_ref − v_safe|, m/s: by how much the guard changes what was asked for; yaw has no part in it."""
    (a, b, c, _), (x, y, z, _) = outputs.v_ref, outputs.v_safe
    return math.hypot(a - x, b - y, c - z)


class Referee:
    """An observer of one flight.

    Args:
        mission: What is flown.
        radius: The vehicle's, m.
    """

    def __init__(self, mission: Mission, radius: float) -> None:
        self._director = Director(mission, World(mission.obstacle), radius)
        self._took_off = False
        self._coupled_t = math.nan
        self._held_t = math.nan
        self._samples = 0
        self._errors = self._forces = self._disagreements = 0.0
        self._clearance = math.inf

    @property
    def target_held(self) -> bool:
        """The vehicle has been kept at the target for long enough: what is left is to land."""
        return self._director.at_the_end or self._director.stage is Stage.DONE

    def __call__(self, sample: Sample) -> None:
        """Take note of a sample while there is something to fly."""
        if not self._took_off:
            self._took_off = True
            x, y, _, yaw = sample.p
            self._director.vehicle(0.0, (x, y, 0.0, yaw), in_air=True, armed=True)
        if self.target_held:
            return
        self._director.vehicle(sample.t, sample.p, in_air=True, armed=True)
        if self.target_held:
            self._held_t = sample.t
        if sample.phase is Phase.ENGAGED:
            self._note(sample)

    def landed(self, t: float, position: Vector4) -> None:
        """Take note of the landing, at `t` s since take-off."""
        self._director.vehicle(t, position, in_air=False, armed=False)

    def _note(self, sample: Sample) -> None:
        outputs = sample.outputs
        if not self._samples:
            self._coupled_t = sample.t
        self._samples += 1
        x, y, z, _ = outputs.error
        self._errors += x * x + y * y + z * z
        self._forces += math.hypot(*outputs.force)
        self._disagreements += disagreement(outputs)
        self._clearance = min(self._clearance, sample.clearance)

    def outcome(self, flight: VirtualFlight, processor: float) -> Outcome:
        """Return what came of the flight, which took so many seconds of processor time."""
        local, director = flight.local, self._director
        seen, struck = director.figures.collisions, len(flight.vehicle.collisions)
        reasons = director.shortcomings()
        if struck > director.mission.criteria.max_collisions >= seen:
            reasons.append(f"{struck} collisions")
        completed = not reasons
        if reasons and local.coupling.losses:
            reasons.append(f"the hand was uncoupled: {local.coupling.reason}")
        count = self._samples or math.nan
        return Outcome(
            completed=completed,
            time=_known(self._held_t - self._coupled_t),
            rms_error=_known(math.sqrt(self._errors / count)),
            clearance=_known(self._clearance),
            collisions=max(seen, struck),
            max_force=_known(local.strongest if self._samples else math.nan),
            mean_force=_known(self._forces / count),
            hand_work=local.given,
            dissipated=local.outputs.port.dissipated,
            disagreement=_known(self._disagreements / count),
            uncoupled=local.coupling.losses,
            flown=flight.t,
            processor=processor,
            reason="; ".join(reasons),
        )


def _known(figure: float) -> float | None:
    return figure if math.isfinite(figure) else None
