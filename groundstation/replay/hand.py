"""The hand of a recording: it moves the handle as it was moved, whatever the force."""

from __future__ import annotations

import numpy as np

from drivers.arm import ArmState
from drivers.device import ZERO3, Vector3
from groundstation.errors import InputError
from groundstation.evaluation.hands import CENTRE
from groundstation.pilot.mapping import Displacement
from groundstation.pilot.sight import VehicleSample
from groundstation.recording import lanes, schema
from groundstation.review.flight import Flight, Numbers
from groundstation.review.outcome import COUPLED


class RecordedHand:
    """Hand and arm in one: at rest until the hand is coupled, then as recorded from that moment on.

    Args:
        t: (n,), since the hand was coupled, s, ascending.
        position: (n, 3), handle's displacement, handle frame, m.
        velocity: (n, 3), its velocity, m/s.
        yaw: (n,), its rotation, rad.
    """

    def __init__(self, t: Numbers, position: Numbers, velocity: Numbers, yaw: Numbers) -> None:
        self._t, self._yaw = t, yaw.tolist()
        self._positions, self._velocities = position.tolist(), velocity.tolist()
        self._elapsed = 0.0
        self._coupled = False

    @property
    def seconds(self) -> float:
        """How long it was coupled."""
        return float(self._t[-1])

    @property
    def done(self) -> bool:
        """Whether all of it was played."""
        return self._elapsed >= self.seconds

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


def recorded_hand(flight: Flight, workspace: float) -> RecordedHand:
    """Return the hand of a recording, from when it was first coupled to when it was let go.

    Args:
        flight: The recording.
        workspace: Of the handle it is to move, m; a motion on a smaller or larger device is scaled to it.

    Raises:
        InputError: It was never coupled.
    """
    start, end = coupled_span(flight)
    t, position = flight.series(schema.HANDLE_POSITION)
    _, velocity = flight.series(schema.HANDLE_VELOCITY)
    inside = (t >= start) & (t <= end)
    if inside.sum() < 2:
        raise InputError(f"{flight.path}: holds no motion of the handle while it was coupled.")
    own = float(flight.properties(schema.DEVICE).get("workspace_m", 0.0)) or workspace
    scale = workspace / own
    return RecordedHand(
        t[inside] - start, scale * position[inside, :3], scale * velocity[inside], position[inside, 3]
    )


def coupled_span(flight: Flight) -> tuple[float, float]:
    """Return from when to when the hand was first coupled, s.

    Raises:
        InputError: It never was.
    """
    phases = flight.states(lanes.PHASE)
    starts = [place for place, (_, word) in enumerate(phases) if word in COUPLED]
    if not starts:
        raise InputError(
            f"{flight.path}: the hand was never coupled to the vehicle, so there is nothing to replay."
        )
    after = next((t for t, word in phases[starts[0] :] if word not in COUPLED), flight.duration)
    return phases[starts[0]][0], after
