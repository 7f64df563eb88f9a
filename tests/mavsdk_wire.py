"""A real MAVSDK in this process, with a vehicle's bytes put in and its own bytes taken out; no socket, no clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import mavsdk
from mavsdk import Configuration, Mavsdk, System
from pymavlink.dialects.v20 import common as m

PATIENCE_S = 20.0
VEHICLE = 7


class Clock:
    """A time that stands still until it is moved."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


class Wire:
    """MAVSDK as the link has it, and the one vehicle it hears.

    Args:
        autopilot: Of the vehicle, a MAV_AUTOPILOT.

    Attributes:
        system: The vehicle.
    """

    def __init__(self, autopilot: int = m.MAV_AUTOPILOT_PX4) -> None:
        self._autopilot = autopilot
        self._taken = 0
        # Its own lines, which it prints otherwise.
        mavsdk.log_subscribe(lambda *_: True)
        self._sent = bytearray()
        self._mav = Mavsdk(Configuration.create_manual(255, 190, always_send_heartbeats=True))
        self._mav.subscribe_raw_bytes_to_be_sent(lambda data: self._sent.extend(bytes(data)))
        self._mav.add_any_connection("raw://")
        self.system: System = self._found()

    def say(self, message: m.MAVLink_message, *, system: int = VEHICLE, component: int = 1) -> None:
        """Put a message in as if the vehicle, or another, had sent it."""
        packer = m.MAVLink(None, srcSystem=system, srcComponent=component)
        self._mav.pass_received_raw_bytes(message.pack(packer))

    def sent(self, kind: str) -> list[m.MAVLink_message]:
        """Return all messages of a kind that MAVSDK has sent."""
        parser = m.MAVLink(None)
        parser.robust_parsing = True
        return [x for x in parser.parse_buffer(bytes(self._sent)) or () if x.get_type() == kind]

    def taken(self) -> bytes:
        """Return what MAVSDK has sent since the last time."""
        data = bytes(self._sent[self._taken :])
        self._taken += len(data)
        return data

    def until(self, condition: Callable[[], object], what: str) -> None:
        """Wait until a condition holds."""
        deadline = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < deadline, f"waited {PATIENCE_S:.0f} s for {what}"
            time.sleep(0.002)

    def close(self) -> None:
        """End MAVSDK."""
        self._mav.destroy()
        mavsdk.log_unsubscribe()

    def _found(self) -> System:
        heartbeat = m.MAVLink_heartbeat_message(
            m.MAV_TYPE_QUADROTOR, self._autopilot, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 0, 3, 3
        )
        found: list[System] = []

        def heard() -> bool:
            self.say(heartbeat)
            found[:] = [system for system in self._mav.get_systems() if system.has_autopilot()]
            return bool(found)

        self.until(heard, "MAVSDK finds the vehicle")
        return found[0]


def ring(distances: list[int], *, frame: int = m.MAV_FRAME_BODY_FRD, offset: float = 0.0, **changed: float):
    """An OBSTACLE_DISTANCE, clockwise from forward, cm; what is not said is not known."""
    whole = [*distances, *[0xFFFF] * (72 - len(distances))]
    fields = {"increment": 5, "lowest": 20, "highest": 1200, "increment_f": 5.0} | changed
    return m.MAVLink_obstacle_distance_message(
        5, 0, whole, int(fields["increment"]), int(fields["lowest"]), int(fields["highest"]),
        fields["increment_f"], offset, frame,
    )  # fmt: skip


def beam(centimetres: int, orientation: int, *, number: int = 0, fov: float = 0.0, quality: int = 0):
    """A DISTANCE_SENSOR."""
    return m.MAVLink_distance_sensor_message(
        5, 10, 4000, centimetres, 0, number, orientation, 255, fov, fov, [0.0] * 4, quality
    )


NAN = math.nan
