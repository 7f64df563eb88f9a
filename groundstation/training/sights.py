"""Puts the records of a bus in the order of their times, so that who measures live sees what a recording shows.

The vehicle's records come from one process and the hand's from another: at any moment one of them is ahead. A record
is passed on once nothing before it can still come.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator

from groundstation.messages import Handle, Phase, PilotState, VehicleState, VehicleStatus
from groundstation.training.measurer import HandSight, VehicleSight

# A process that is silent for so long is not waited for, s.
PATIENCE_S = 0.5


class Sights:
    """Merges what was read off the bus.

    Each `take` is given what came since the last: states read before statuses and pilot states before handles, for
    each process sends the latter first.
    """

    def __init__(self) -> None:
        self._states: deque[VehicleState] = deque()
        self._statuses: deque[VehicleStatus] = deque()
        self._pilots: deque[PilotState] = deque()
        self._handles: deque[Handle] = deque()
        self._state_t = self._pilot_t = -math.inf
        self._status: VehicleStatus | None = None
        self._handle: Handle | None = None

    def take(
        self,
        states: Iterable[VehicleState],
        statuses: Iterable[VehicleStatus],
        pilots: Iterable[PilotState],
        handles: Iterable[Handle],
    ) -> Iterator[VehicleSight | HandSight]:
        """Take records in and yield what is due, in the order of time."""
        self._states.extend(states)
        self._statuses.extend(statuses)
        self._pilots.extend(pilots)
        self._handles.extend(handles)
        self._state_t = self._states[-1].t if self._states else self._state_t
        self._pilot_t = self._pilots[-1].t if self._pilots else self._pilot_t
        newest, oldest = max(self._state_t, self._pilot_t), min(self._state_t, self._pilot_t)
        yield from self._until(max(oldest, newest - PATIENCE_S))

    def rest(self) -> Iterator[VehicleSight | HandSight]:
        """Yield what is left when nothing comes any more."""
        yield from self._until(math.inf)

    def _until(self, t: float) -> Iterator[VehicleSight | HandSight]:
        """Yield what lies before t."""
        states, pilots = self._states, self._pilots
        while True:
            state_t = states[0].t if states else math.inf
            pilot_t = pilots[0].t if pilots else math.inf
            if min(state_t, pilot_t) >= t:
                return
            if state_t <= pilot_t:
                if sight := self._vehicle(states.popleft()):
                    yield sight
            else:
                yield self._hand(pilots.popleft())

    def _vehicle(self, state: VehicleState) -> VehicleSight | None:
        while self._statuses and self._statuses[0].t <= state.t:
            self._status = self._statuses.popleft()
        status = self._status
        if status is None or not state.valid:
            return None
        x, y, z, yaw = state.position
        vx, vy, vz, _ = state.velocity
        return VehicleSight(state.t, (x, y, z, yaw), (vx, vy, vz), bool(status.armed), bool(status.in_air))

    def _hand(self, pilot: PilotState) -> HandSight:
        while self._handles and self._handles[0].t <= pilot.t:
            self._handle = self._handles.popleft()
        x, y, z, _ = pilot.error
        a, b, c, _ = pilot.v_ref
        d, e, f, _ = pilot.v_safe
        return HandSight(
            t=pilot.t,
            coupled=pilot.phase == Phase.ENGAGED,
            error=(x, y, z),
            disagreement=math.hypot(a - d, b - e, c - f),
            force=tuple(self._handle.force) if self._handle else (0.0, 0.0, 0.0),
            on_leash=bool(pilot.on_leash),
        )
