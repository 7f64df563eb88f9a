"""What a ground station lets happen to a vehicle once, by parameters that go back to 0 by themselves.

A gust from now on (SIM_GUST_S with SIM_GUST_E, _N, _U), a battery that has only so much left (SIM_BAT_LEFT), so many
seconds without GPS (SIM_GPS_LOST). The same value told again while it stands is a repetition on a bad link, and
nothing new; another one takes its place.
"""

from __future__ import annotations

from collections.abc import Callable

from sim.autopilot.parameters import Parameters
from sim.battery import Battery
from sim.kinematics import Vector3

GUST, CHARGE, GPS = "SIM_GUST_S", "SIM_BAT_LEFT", "SIM_GPS_LOST"
MOMENTARY = (GUST, CHARGE, GPS)
_PEAK = ("SIM_GUST_E", "SIM_GUST_N", "SIM_GUST_U")
# How long the battery's parameter stands, s: a repetition on a link with a round trip of two seconds is still known.
_STANDS_S = 5.0


class Momentary:
    """Follows the parameters.

    Args:
        parameters: The autopilot's.
        battery: Is given its charge.
        gust: Lets a gust blow from now on: its peak, ENU, m/s, and how long, s.
        lose_gps: Takes GPS away, or gives it back.
    """

    def __init__(
        self,
        parameters: Parameters,
        battery: Battery,
        gust: Callable[[Vector3, float], None],
        lose_gps: Callable[[bool], None],
    ) -> None:
        self._parameters, self._battery = parameters, battery
        self._gust, self._lose_gps = gust, lose_gps
        self._seen = parameters.changed
        self._taken: dict[str, float] = dict.fromkeys(MOMENTARY, 0.0)
        self._ends: dict[str, float] = {}

    def step(self, t: float) -> None:
        """Begin what is asked for, and end what is over, at time `t`, s."""
        if self._parameters.changed != self._seen:
            self._seen = self._parameters.changed
            for name in MOMENTARY:
                if self._parameters[name] != self._taken[name]:
                    self._take(name, self._parameters[name], t)
        if self._ends:
            for name in [name for name, end in self._ends.items() if t >= end]:
                self._parameters.set(name, 0.0)
                self._take(name, 0.0, t)

    def _take(self, name: str, value: float, t: float) -> None:
        self._taken[name] = value
        if value > 0.0:
            self._ends[name] = t + (_STANDS_S if name == CHARGE else value)
        else:
            self._ends.pop(name, None)
        if name == GPS:
            self._lose_gps(value > 0.0)
        elif name == CHARGE and value > 0.0:
            self._battery.remaining = value
        elif name == GUST and value > 0.0:
            east, north, up = (self._parameters[each] for each in _PEAK)
            self._gust((east, north, up), value)
