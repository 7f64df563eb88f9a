"""What the pilot knows of the vehicle: the newest believable state and status from the bus, and what it sees."""

from __future__ import annotations

from math import inf, isfinite, nan

from groundstation.bus import Bus
from groundstation.frames import Vector3, Vector4
from groundstation.messages import (
    OBSTACLES,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    FlightMode,
    Ranges,
    Stream,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.engagement import believable
from groundstation.pilot.ranges import Echoes, Seen, bounding, echoes
from groundstation.pilot.sight import VehicleSample, carried_on
from groundstation.pilot.surroundings import USUAL_RADIUS

# A vehicle's clock that goes back by more has started anew, s; less is a late sample.
_REBOOT_S = 1.0
# What was seen longer ago may have gone, s; and a place told longer before or after is not where it was seen from.
SEEN_S = 0.5


class VehicleFeed:
    """The newest of the vehicle.

    Args:
        bus: Where it comes from.
        radius: Of the vehicle's hull, m.

    Attributes:
        sample: Position and velocity, the last that were believable.
        state_t: When that state came, monotonic s; minus infinity before the first.
        newest_t, status_t, ranges_t: `t` of the newest state, believable or not, of the newest status, and of what
            was last seen around; 0 before the first.
        believable: The very newest state is.
        valid: The vehicle trusts that state itself.
        boots: How often its clock started anew.
        connected, armed, in_air, mode, streaming: As in `VehicleStatus`.
        delay: Measured round trip, s; NaN while it is not known.
        unsafe: Why its own failsafes keep the hand from being coupled, or "".
        speed_limits: The largest speeds that it allows, m/s: around, up, down; 0 where that is not known.
        loss: Share of its frames lost lately, 0 to 1.
        seen: Points of obstacles that its own sensors see and that matter where it will be, world, m; see
            `groundstation.pilot.ranges`.
    """

    def __init__(self, bus: Bus, radius: float = USUAL_RADIUS) -> None:
        self._states = bus.subscriber(VEHICLE_STATE, depth=1)
        self._statuses = bus.subscriber(VEHICLE_STATUS, depth=1)
        self._ranges = bus.subscriber(OBSTACLES, depth=1)
        self._radius = radius
        self._state: VehicleState | None = None
        self._status: VehicleStatus | None = None
        self._looked: Ranges | None = None
        self._echoes = Echoes()
        self._boot_t = 0.0
        self.sample = VehicleSample()
        self.state_t = -inf
        self.newest_t = self.status_t = self.ranges_t = 0.0
        self.believable = True
        self.valid = False
        self.boots = 0
        self.connected = False
        self.armed = False
        self.in_air = False
        self.mode = FlightMode.UNKNOWN
        self.streaming = Stream.IDLE
        self.delay = nan
        self.loss = 0.0
        self.unsafe = ""
        self.speed_limits: Vector3 = (0.0, 0.0, 0.0)
        self.seen: tuple[Vector3, ...] = ()

    def update(self, now: float, ahead: Vector4) -> None:
        """Take what came since the last tick.

        Args:
            now: Monotonic s.
            ahead: Where the vehicle will be when what is sent now reaches it, world, m and rad. With a delay it is
                there that obstacles matter: from where it was told to be, others may be nearer.
        """
        status = self._statuses.newest()
        if status is not None and status is not self._status:
            self._status = status
            self._take_status(status)
        moved = False
        state = self._states.newest()
        if state is not None and state is not self._state:
            self._state = state
            self._take_state(state)
            moved = True
        ranges = self._ranges.newest()
        if ranges is not None and ranges is not self._looked:
            self._looked = ranges
            self._take_ranges(ranges)
            moved = True
        if not now - self.ranges_t <= SEEN_S:
            self._echoes, self.seen = Echoes(), ()
        elif moved:
            self.seen = bounding(self._echoes, ahead[:3])

    def _take_state(self, state: VehicleState) -> None:
        self.newest_t = state.t
        position, velocity = tuple(state.position), tuple(state.velocity)
        self.valid = bool(state.valid)
        # A clock may well stand at a million seconds: that is eleven days since its machine was started.
        clocks = isfinite(state.t) and isfinite(state.boot_t)
        self.believable = clocks and believable((*position, *velocity))
        if not self.believable:
            return
        self.sample = VehicleSample(position, velocity)
        self.state_t = state.t
        if state.boot_t < self._boot_t - _REBOOT_S:
            self.boots += 1
        self._boot_t = state.boot_t

    def _take_status(self, status: VehicleStatus) -> None:
        self.status_t = status.t
        self.connected = bool(status.connected)
        self.armed = bool(status.armed)
        self.in_air = bool(status.in_air)
        self.mode = FlightMode(status.mode)
        self.streaming = Stream(status.streaming)
        self.unsafe = status.unsafe.decode(errors="replace")
        around, up, down = (max(0.0, limit) for limit in status.speed_limits)
        self.speed_limits = (around, up, down)
        self.delay = status.rtt if believable((status.rtt,)) and status.rtt > 0.0 else nan
        # What cannot be is taken for the worst.
        self.loss = status.loss if 0.0 <= status.loss <= 1.0 else 1.0

    def _take_ranges(self, ranges: Ranges) -> None:
        """Place what was measured, from where the vehicle was as it came; without that there is nothing."""
        self.ranges_t = ranges.t
        since = ranges.t - self.state_t
        if not (self.valid and abs(since) <= SEEN_S):
            self._echoes = Echoes()
            return
        seen = Seen(tuple(ranges.ring), ranges.below, ranges.above)
        self._echoes = echoes(seen, carried_on(self.sample, since), self._radius)
