"""Carries out in virtual time what a mission's timetable, or an instructor, wants to happen."""

from __future__ import annotations

import math

from groundstation.evaluation.flight import VirtualFlight
from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    Event,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)


class Happenings:
    """What has been done to a flight.

    Args:
        flight: Vehicle, link and handle.
    """

    def __init__(self, flight: VirtualFlight) -> None:
        self._flight = flight
        self._device_back_t = -math.inf

    def begin(self, event: Event) -> None:
        """Let something happen now."""
        flight, t = self._flight, self._flight.local.t
        vehicle, link = flight.vehicle, flight.link
        told = vehicle.autopilot.parameters.set
        match event:
            case WindChange(velocity=wind, turbulence=turbulence):
                names = ("SIM_WIND_E", "SIM_WIND_N", "SIM_WIND_U", "SIM_WIND_TURB")
                for name, value in zip(names, (*wind, turbulence), strict=True):
                    told(name, value)
            case GustNow(velocity=peak, duration_s=seconds):
                vehicle.gust(peak, seconds)
            case Delay(round_trip_s=seconds, jitter_s=jitter):
                self._change(delay=0.5 * seconds, jitter=jitter)
            case Loss(share=share):
                self._change(loss=share)
            case LinkLoss(duration_s=seconds):
                link.up.black_out(t + seconds)
                link.down.black_out(t + seconds)
            case DeviceLoss(duration_s=seconds):
                self._device_back_t = t + seconds
                flight.local.coupling.present = False
            case BatteryLeft(remaining=share):
                vehicle.battery.remaining = share
            case GpsLoss(duration_s=seconds):
                told("SIM_GPS_LOST", seconds)

    def go_on(self) -> None:
        """End what lasts no longer; to be called as the flight goes on."""
        local = self._flight.local
        if not local.coupling.present and local.t >= self._device_back_t:
            local.coupling.present = True

    def _change(self, **fields: float) -> None:
        """Go on with another channel, both ways, as far as it is named."""
        for way in (self._flight.link.up, self._flight.link.down):
            way.change(way.conditions._replace(**fields))
