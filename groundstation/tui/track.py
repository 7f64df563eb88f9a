"""What the screen remembers of the flight: the way flown, and the last half minute of the curves."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from groundstation.console import Snapshot
from groundstation.frames import body_from_world
from groundstation.messages import VehicleState

Floats = NDArray[np.float64]


class Ring:
    """The last rows of a table, oldest first.

    Args:
        rows: Kept.
        columns: Numbers a row.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self._table = np.full((2 * rows, columns), np.nan)
        self._rows = rows
        self._end = 0

    def add(self, row: tuple[float, ...]) -> None:
        """Add a row and forget the oldest where there is no room."""
        if self._end == len(self._table):
            self._table[: self._rows] = self._table[self._rows :]
            self._end = self._rows
        self._table[self._end] = row
        self._end += 1

    def rows(self) -> Floats:
        """Return the rows, shape (n, columns); a view that the next `add` may change."""
        return self._table[max(self._end - self._rows, 0) : self._end]

    def clear(self) -> None:
        """Forget all."""
        self._end = 0


class Track:
    """The way flown: a point every few centimetres, so that hovering costs nothing."""

    SPACING_M = 0.05
    # A jump no vehicle flies between two frames: the world's origin has moved.
    JUMP_M = 5.0

    def __init__(self, length: int = 4000) -> None:
        self._ring = Ring(length, 4)
        self._last: tuple[float, float, float] | None = None

    def add(self, east: float, north: float, up: float, t: float) -> None:
        """Add where the vehicle is, world, m, at monotonic time `t`, s."""
        place = (east, north, up)
        if not all(map(math.isfinite, place)):
            return
        step = math.dist(self._last, place) if self._last else math.inf
        if step < self.SPACING_M:
            return
        if self._last and step > self.JUMP_M:
            self._ring.clear()
        self._ring.add((*place, t))
        self._last = place

    def points(self) -> Floats:
        """Return east, north, up, m, and time, s, oldest first, shape (n, 4)."""
        return self._ring.rows()


class History:
    """The curves of the paper's figures 11 to 13 over the last moments, at `RATE_HZ`.

    Columns: time; force x y z (handle, N); error x y z (world, m); velocity meant (v_c), then flown, each
    forward left up (vehicle, m/s).
    """

    RATE_HZ = 10.0
    SPAN_S = 40.0
    TIME, FORCE, ERROR, MEANT, FLOWN = 0, 1, 4, 7, 10
    _COLUMNS = 13

    def __init__(self) -> None:
        self._ring = Ring(int(self.SPAN_S * self.RATE_HZ), self._COLUMNS)
        self._next = -math.inf

    def add(self, snapshot: Snapshot, stale_s: float) -> None:
        """Take a sample if it is time for one. What is old or not known leaves a gap."""
        now = snapshot.t
        if now < self._next:
            return
        self._next = now + 1.0 / self.RATE_HZ - 1e-6
        handle, pilot, vehicle = snapshot.handle, snapshot.pilot, snapshot.vehicle
        force = error = flown = (math.nan, math.nan, math.nan)
        if handle and now - handle.t < stale_s:
            force = tuple(handle.force)
        if pilot and now - pilot.t < stale_s:
            error = tuple(pilot.error)[:3]
        meant = meant_velocity(snapshot, stale_s)[:3]
        if vehicle and now - vehicle.t < stale_s:
            flown = velocity_on_vehicle(vehicle)[:3]
        self._ring.add((now, *force, *error, *meant, *flown))

    def rows(self) -> Floats:
        """Return the samples, oldest first, shape (n, 13)."""
        return self._ring.rows()


def meant_velocity(snapshot: Snapshot, stale_s: float) -> tuple[float, float, float, float]:
    """Return v_c while setpoints are streamed: the velocity that the vehicle is meant to have.

    The setpoint itself is another while the vehicle's response is compensated.

    Args:
        snapshot: The newest of everything.
        stale_s: Age from which a setpoint is none, s.

    Returns:
        [forward, left, up, yaw rate], m/s and rad/s; NaN where nothing is streamed.
    """
    pilot, setpoint = snapshot.pilot, snapshot.setpoint
    if pilot is None or setpoint is None or not setpoint.active or snapshot.t - setpoint.t > stale_s:
        return math.nan, math.nan, math.nan, math.nan
    forward, left, up, yaw_rate = pilot.v_c
    return forward, left, up, yaw_rate


def velocity_on_vehicle(state: VehicleState) -> tuple[float, float, float, float]:
    """Return the velocity flown as [forward, left, up, yaw rate], m/s and rad/s; NaN where not known."""
    east, north, up, yaw_rate = state.velocity
    yaw = state.position[3]
    if not math.isfinite(yaw):
        return math.nan, math.nan, up, yaw_rate
    forward, left, climb = body_from_world((east, north, up), yaw)
    return forward, left, climb, yaw_rate
