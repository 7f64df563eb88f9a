"""What a fault is seen by, as plain facts: `groundstation.failsafe` has the table that judges them."""

from __future__ import annotations

from math import hypot, inf, nan
from typing import NamedTuple

from groundstation.messages import FlightMode, Phase, Stream


class Conditions(NamedTuple):
    """What a fault is seen by; who knows only some of it leaves the rest as where all is well.

    Attributes:
        t: Now, monotonic s.
        gap: Since the servo's last tick, s.
        believable: Every number from the vehicle is; those of the handle were judged where it is read.
        present, homed, centred: Of the handle.
        handle_age: Age of the handle's sample, s.
        connected, armed, in_air: Of the vehicle.
        mode: Who steers it.
        streaming: State of the setpoints' stream to it.
        state_age: Age of its state, s; infinite before the first.
        state_valid: It trusts that state itself.
        boots: How often it has rebooted since the servo started.
        link_fault: Why the link is too poor to fly by, in words, or "".
        unsafe: Why the vehicle's own failsafes forbid to couple, in words, or ""; what is coupled stays so.
        enabled: The enable control is held, or there is none.
        squeezed: It is squeezed through, as in a panic.
        speed, climb: Of the vehicle in the plane and up or down, m/s; `speed_limit`, `climb_limit` what is allowed.
        phase: How far the hand is coupled; `rebooted`, `engaged_in`, `streamed`, `waited` what has been since the
            operator engaged: a reboot, the mode by then, a stream, s.
        setpoint_age: Of the newest setpoint that the link has, s.
        silence: Since the vehicle was last heard, s.
        ended, stalled: Roles of processes that have ended, that do not answer.
        battery: Share left, 0 to 1; NaN where it is not told.
        late: Lateness of the servo, ticks.
        disk_gb, disk_least_gb: Left on the disk of the recording, and what is told.
        written: The recording takes what it is given.
        guarded_by: What the guard keeps away from, or "".
    """

    t: float = 0.0
    gap: float = 0.0
    believable: bool = True
    present: bool = True
    homed: bool = True
    centred: bool = True
    handle_age: float = 0.0
    connected: bool = True
    armed: bool = True
    in_air: bool = True
    mode: FlightMode = FlightMode.HOLD
    streaming: Stream = Stream.IDLE
    state_age: float = 0.0
    state_valid: bool = True
    boots: int = 0
    link_fault: str = ""
    unsafe: str = ""
    enabled: bool = True
    squeezed: bool = False
    speed: float = 0.0
    climb: float = 0.0
    speed_limit: float = inf
    climb_limit: float = inf
    phase: Phase = Phase.DISENGAGED
    rebooted: bool = False
    engaged_in: FlightMode = FlightMode.HOLD
    streamed: bool = False
    waited: float = 0.0
    setpoint_age: float = 0.0
    silence: float = 0.0
    ended: frozenset[str] = frozenset()
    stalled: frozenset[str] = frozenset()
    battery: float = nan
    late: float = 0.0
    disk_gb: float = inf
    disk_least_gb: float = 0.0
    written: bool = True
    guarded_by: str = ""

    @property
    def percent(self) -> float:
        """What is left of the battery, per cent."""
        return 100.0 * self.battery

    @property
    def fastest(self) -> float:
        """The vehicle's speed in space, m/s."""
        return hypot(self.speed, self.climb)
