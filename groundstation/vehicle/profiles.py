"""What is asked of an autopilot and judged of it, as data: picked by its type, which its heartbeat tells."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from groundstation.frames import Vector3
from groundstation.messages import Autopilot, FlightMode
from groundstation.vehicle import ardupilot, px4
from groundstation.vehicle.failsafes import Judged, unsafe


class Profile(NamedTuple):
    """An autopilot.

    Attributes:
        name: For people.
        judged: Parameters that are read and judged.
        speeds: Names of those that bound the speed: around, up, down.
        unit: That they are in, m/s.
        takeoff_altitude: The parameter that says where take-off ends, m; "" where that goes with the command.
        modes: Custom modes, main and sub, that it is asked for.
        bytewise: A whole number's bits travel in a parameter's float; else the float has its value.
        since: The oldest firmware, major and minor, whose parameters and modes are those that are known here.
        tested: It has been flown with this program, if only a simulation of it.
    """

    name: str
    judged: tuple[Judged, ...]
    speeds: tuple[str, str, str]
    unit: float
    takeoff_altitude: str
    modes: frozenset[tuple[float, float]]
    bytewise: bool
    since: tuple[int, int]
    tested: bool

    @property
    def label(self) -> str:
        """The name, and that it is untested where it is."""
        return self.name if self.tested else f"{self.name} (untested)"


PROFILES: Mapping[Autopilot, Profile] = {
    Autopilot.PX4: Profile(
        "PX4",
        px4.JUDGED,
        px4.SPEEDS,
        1.0,
        px4.TAKEOFF_ALTITUDE,
        px4.MODES,
        bytewise=True,
        since=px4.SINCE,
        tested=True,
    ),
    Autopilot.ARDUPILOT: Profile(
        "ArduPilot",
        ardupilot.JUDGED,
        ardupilot.SPEEDS,
        0.01,
        "",
        ardupilot.MODES,
        bytewise=False,
        since=ardupilot.SINCE,
        tested=False,
    ),
}
_UNKNOWN = (
    "this autopilot is neither PX4 nor ArduPilot: what it does by itself is not known, so it is not flown"
)

# Modes that a landing may leave behind and that no vehicle takes off in: it is armed by way of Hold.
LEFT_BY_LANDING = frozenset({FlightMode.LAND, FlightMode.RETURN, FlightMode.OFFBOARD})


def profile_of(autopilot: int) -> Profile | None:
    """Return an autopilot's profile, or None where nothing is known of it."""
    return next((profile for kind, profile in PROFILES.items() if kind == autopilot), None)


def outdated(profile: Profile, firmware: str) -> bool:
    """Say whether a firmware, as in 1.15.2 or 1.16.0 (beta), is older than what is known; unknown is not old."""
    numbers = [part for part in firmware.partition(" ")[0].split(".")[:2] if part.isdecimal()]
    return len(numbers) == 2 and (int(numbers[0]), int(numbers[1])) < profile.since


def unsafe_for(profile: Profile | None, values: Mapping[str, float]) -> str:
    """Return why a vehicle's parameters keep the hand from being coupled, or ""."""
    return _UNKNOWN if profile is None else unsafe(profile.judged, values)


def speed_limits(profile: Profile | None, values: Mapping[str, float]) -> Vector3:
    """Return the largest speeds that a vehicle allows, m/s: around, up, down; 0 where that is not known.

    What is no speed, as a negative one, is not known; preflight tells what is wrong with it.
    """
    if profile is None:
        return 0.0, 0.0, 0.0
    told = (values.get(name, 0.0) * profile.unit for name in profile.speeds)
    around, up, down = (speed if math.isfinite(speed) and speed > 0.0 else 0.0 for speed in told)
    return around, up, down
