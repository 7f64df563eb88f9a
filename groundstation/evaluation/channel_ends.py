"""The link between ground and vehicle in virtual time: what crosses it, and what the ground measures of it.

Frames are packed and go through `sim.channel.Channel`, one each way, so that delay, jitter and losses act on them as
on MAVLink's. The ground measures the round trip as `groundstation.vehicle.round_trip` does by TIMESYNC, and the share
lost as `groundstation.vehicle.pump` does by sequence numbers: nobody is told what the channel was set to.
"""

from __future__ import annotations

import math
import struct
from enum import IntEnum
from typing import NamedTuple

from groundstation.frames import Vector4
from groundstation.pilot.sight import VehicleSample
from groundstation.vehicle.pump import Losses
from groundstation.vehicle.trips import Trips
from sim.channel import Channel, Conditions

# As `groundstation.vehicle.round_trip` asks.
_ASK_EVERY_S = 0.1
_SEQUENCE = 256
_VEHICLE = (1, 1)


class _Kind(IntEnum):
    SETPOINT = 0
    REQUEST = 1
    TIMESYNC = 2
    TELEMETRY = 3


_SETPOINT = struct.Struct("<B4d")
_REQUEST = struct.Struct("<BB")
_TIMESYNC = struct.Struct("<BBI")
_TELEMETRY = struct.Struct("<BBBBBd8d")


class Request(IntEnum):
    """A mode that the ground asks for; without an answer it asks again."""

    OFFBOARD = 0
    HOLD = 1
    LAND = 2


class Report(NamedTuple):
    """What the vehicle tells of itself.

    Attributes:
        sample: Position and velocity as it believes them.
        offboard: The setpoints steer it.
        armed: Its motors run.
        trusted: It trusts its own position.
        battery: What is left, 0 to 1.
    """

    sample: VehicleSample
    offboard: bool
    armed: bool
    trusted: bool
    battery: float


class Link:
    """Both directions.

    Args:
        up: What the channel does on the way to the vehicle.
        down: Likewise from it.
        seed: Of all that is random here.
    """

    def __init__(self, up: Conditions, down: Conditions, seed: int) -> None:
        self.up = Channel(up, f"up {seed}")
        self.down = Channel(down, f"down {seed}")


class GroundEnd:
    """The ground's end of a link.

    Args:
        link: Both directions.

    Attributes:
        report: The newest that came, or None.
        sample: Of it; zeros before.
        heard_t: When, s; minus infinity before.
        round_trip: As measured, s; NaN before the first answer.
        loss: Share of the vehicle's frames lost in the last seconds, 0 to 1.
    """

    def __init__(self, link: Link) -> None:
        self._up, self._down = link.up, link.down
        self._losses = Losses()
        self._trips = Trips()
        self._asked = 0
        self._next_ask = -math.inf
        self.report: Report | None = None
        self.sample = VehicleSample()
        self.heard_t = -math.inf
        self.round_trip = math.nan
        self.loss = 0.0

    def give(self, t: float, velocity: Vector4) -> None:
        """Send a setpoint, vehicle's axes, m/s and rad/s."""
        self._up.send(t, _SETPOINT.pack(_Kind.SETPOINT, *velocity))

    def request(self, t: float, request: Request) -> None:
        """Ask for a mode."""
        self._up.send(t, _REQUEST.pack(_Kind.REQUEST, request))

    def measure(self, t: float) -> None:
        """Reckon round trip and share lost as they are at `t`, s, and ask for the time when that is due."""
        self.loss = self._losses.share(t)
        self.round_trip = self._trips.seconds(t)
        if t >= self._next_ask:
            self._next_ask = t + _ASK_EVERY_S
            self._asked += 1
            self._trips.asked(self._asked, t)
            self._up.send(t, _TIMESYNC.pack(_Kind.TIMESYNC, 0, self._asked))

    def listen(self, t: float) -> None:
        """Take what has come by `t`, s."""
        for frame in self._down.due(t):
            self._losses.count(t, *_VEHICLE, frame[1])
            if frame[0] == _Kind.TIMESYNC:
                self._trips.answered(_TIMESYNC.unpack(frame)[2], t)
                continue
            _, _, offboard, armed, trusted, battery, x, y, z, yaw, vx, vy, vz, turn = _TELEMETRY.unpack(frame)
            self.sample = VehicleSample((x, y, z, yaw), (vx, vy, vz, turn))
            self.report = Report(self.sample, bool(offboard), bool(armed), bool(trusted), battery)
            self.heard_t = t


class VehicleEnd:
    """The vehicle's end of a link.

    Args:
        link: Both directions.

    Attributes:
        request: The mode asked for since it was last taken, or None.
    """

    def __init__(self, link: Link) -> None:
        self._up, self._down = link.up, link.down
        self._sequence = 0
        self.request: Request | None = None

    def listen(self, t: float) -> Vector4 | None:
        """Take what has come by `t`, s; return the newest setpoint among it, or None."""
        setpoint = None
        for frame in self._up.due(t):
            kind = frame[0]
            if kind == _Kind.SETPOINT:
                _, forward, left, up, turn = _SETPOINT.unpack(frame)
                setpoint = (forward, left, up, turn)
            elif kind == _Kind.REQUEST:
                self.request = Request(frame[1])
            else:
                self._send(t, bytes((kind, self._sequence)) + frame[2:])
        return setpoint

    def tell(self, t: float, report: Report) -> None:
        """Send telemetry."""
        (position, velocity), *told = report
        self._send(t, _TELEMETRY.pack(_Kind.TELEMETRY, self._sequence, *told, *position, *velocity))

    def _send(self, t: float, frame: bytes) -> None:
        self._sequence = (self._sequence + 1) % _SEQUENCE
        self._down.send(t, frame)
