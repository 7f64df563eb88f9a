"""The hand of a recording: it moves the handle as it was moved, whatever the force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drivers.arm import ArmState
from drivers.device import ZERO3, Vector3
from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.evaluation.hands import CENTRE
from groundstation.pilot.choices import Choices
from groundstation.pilot.mapping import Displacement
from groundstation.pilot.sight import VehicleSample
from groundstation.recording import lanes, schema
from groundstation.replay.choosing import Change, chosen_over
from groundstation.review.flight import Flight, Numbers
from groundstation.review.sights import COUPLED

# Modes in which the vehicle stays where the hand left it.
_STAYING = frozenset({"hold", "offboard", "unknown"})


class Stretch(NamedTuple):
    """From when to when the hand was coupled, s."""

    start: float
    end: float


class RecordedHand:
    """Hand, arm and operator in one: at rest until first coupled, then as recorded from that moment on.

    Args:
        t: (n,), since the hand was first coupled, s, ascending.
        position: (n, 3), handle's displacement, handle frame, m.
        velocity: (n, 3), its velocity, m/s.
        yaw: (n,), its rotation, rad.
        stretches: In which the hand was coupled, on the same clock, the first from 0 on.
        changes: Of what the operator chose, on the same clock, at least one.
    """

    def __init__(
        self,
        t: Numbers,
        position: Numbers,
        velocity: Numbers,
        yaw: Numbers,
        *,
        stretches: Sequence[Stretch],
        changes: Sequence[Change],
    ) -> None:
        self._t, self._yaw = t, yaw.tolist()
        self._positions, self._velocities = position.tolist(), velocity.tolist()
        self._stretches, self._changes = stretches, changes
        self._change = 0
        self._elapsed = 0.0
        self._coupled = False

    @property
    def seconds(self) -> float:
        """From the first coupling to the last release."""
        return self._stretches[-1].end

    @property
    def done(self) -> bool:
        """Whether all of it was played."""
        return self._elapsed >= self.seconds

    def couples(self) -> bool:
        """Say whether the hand was coupled then; before the first time it waits to be."""
        return not self._coupled or any(start <= self._elapsed < end for start, end in self._stretches)

    def choices(self) -> Choices:
        """Return what was chosen then."""
        following = self._change + 1
        while following < len(self._changes) and self._changes[following].t <= self._elapsed:
            self._change, following = following, following + 1
        return self._changes[self._change].choices

    def decide(self, t: float, vehicle: VehicleSample) -> Displacement:  # noqa: ARG002 - it sees nothing
        """Begin: this is only asked while the hand is coupled. What it wants, `step` knows."""
        self._coupled = True
        return CENTRE

    def step(
        self,
        state: ArmState,
        dt: float,
        intention: Vector3,  # noqa: ARG002
        intended_yaw: float,  # noqa: ARG002
        force: Vector3,  # noqa: ARG002
    ) -> ArmState:
        """Return where the handle was that much later, in place of where an arm would be."""
        if not self._coupled:
            return state
        self._elapsed += dt
        place = int(np.searchsorted(self._t, self._elapsed, side="right")) - 1
        if place < 0 or self.done:
            return ArmState(ZERO3, ZERO3, 0.0, 0.0)
        x, y, z = self._positions[place]
        u, v, w = self._velocities[place]
        return ArmState((x, y, z), (u, v, w), self._yaw[place], 0.0)


def recorded_hand(flight: Flight, workspace: float, settings: Settings) -> RecordedHand:
    """Return the hand of a recording, from when it was first coupled to when it was last let go.

    Args:
        flight: The recording.
        workspace: Of the handle it is to move, m; a motion on a smaller or larger device is scaled to it.
        settings: To replay with.

    Raises:
        InputError: It was never coupled.
    """
    spans = stretches(flight)
    start, end = spans[0].start, spans[-1].end
    t, position = flight.series(schema.HANDLE_POSITION)
    _, velocity = flight.series(schema.HANDLE_VELOCITY)
    inside = (t >= start) & (t <= end)
    if inside.sum() < 2:
        raise InputError(f"{flight.path}: holds no motion of the handle while it was coupled.")
    own = float(flight.properties(schema.DEVICE).get("workspace_m", 0.0)) or workspace
    scale = workspace / own
    return RecordedHand(
        t[inside] - start,
        scale * position[inside, :3],
        scale * velocity[inside],
        position[inside, 3],
        stretches=[Stretch(since - start, until - start) for since, until in spans],
        changes=[Change(at - start, choices) for at, choices in chosen_over(flight, settings)],
    )


def stretches(flight: Flight) -> list[Stretch]:
    """Return from when to when the hand was coupled, time after time, s, as far as a replay can follow.

    Between them the vehicle held; once it was flown elsewhere, what came after began at a place the replay is not at.

    Raises:
        InputError: It never was coupled.
    """
    found: list[Stretch] = []
    start: float | None = None
    for t, word in [*flight.states(lanes.PHASE), (flight.duration, "")]:
        if word in COUPLED and start is None:
            start = t
        elif word not in COUPLED and start is not None:
            found.append(Stretch(start, t))
            start = None
    if not found:
        raise InputError(
            f"{flight.path}: the hand was never coupled to the vehicle, so there is nothing to replay."
        )
    away = [t for t, word in flight.states(lanes.MODE) if word not in _STAYING and t > found[0].end]
    return [stretch for stretch in found if not away or stretch.start < away[0]]
