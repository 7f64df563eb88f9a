"""What the pilot knows of the vehicle: the newest believable state and status from the bus."""

from __future__ import annotations

from groundstation.bus import Bus
from groundstation.messages import (
    VEHICLE_STATE,
    VEHICLE_STATUS,
    FlightMode,
    Stream,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.engagement import believable
from groundstation.pilot.sight import VehicleSample

# A vehicle's clock that goes back by more has started anew, s; less is a late sample.
_REBOOT_S = 1.0


class VehicleFeed:
    """The newest of the vehicle.

    Args:
        bus: Where it comes from.

    Attributes:
        sample: Position and velocity, the last that were believable.
        state_t: When that state came, monotonic s; minus infinity before the first.
        believable: The very newest state is.
        valid: The vehicle trusts that state itself.
        boots: How often its clock started anew.
        connected, armed, in_air, mode, streaming: As in `VehicleStatus`.
    """

    def __init__(self, bus: Bus) -> None:
        self._states = bus.subscriber(VEHICLE_STATE, depth=1)
        self._statuses = bus.subscriber(VEHICLE_STATUS, depth=1)
        self._state: VehicleState | None = None
        self._status: VehicleStatus | None = None
        self._boot_t = 0.0
        self.sample = VehicleSample()
        self.state_t = -float("inf")
        self.believable = True
        self.valid = False
        self.boots = 0
        self.connected = False
        self.armed = False
        self.in_air = False
        self.mode = FlightMode.UNKNOWN
        self.streaming = Stream.IDLE

    def update(self) -> None:
        """Take what came since the last tick."""
        state = self._states.newest()
        if state is not None and state is not self._state:
            self._state = state
            self._take_state(state)
        status = self._statuses.newest()
        if status is not None and status is not self._status:
            self._status = status
            self._take_status(status)

    def _take_state(self, state: VehicleState) -> None:
        position, velocity = tuple(state.position), tuple(state.velocity)
        self.valid = bool(state.valid)
        self.believable = believable((*position, *velocity, state.t, state.boot_t))
        if not self.believable:
            return
        self.sample = VehicleSample(position, velocity)
        self.state_t = state.t
        if state.boot_t < self._boot_t - _REBOOT_S:
            self.boots += 1
        self._boot_t = state.boot_t

    def _take_status(self, status: VehicleStatus) -> None:
        self.connected = bool(status.connected)
        self.armed = bool(status.armed)
        self.in_air = bool(status.in_air)
        self.mode = FlightMode(status.mode)
        self.streaming = Stream(status.streaming)
