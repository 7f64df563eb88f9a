"""The remote site in virtual time: the simulated vehicle behind its end of the link."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.evaluation.channel_ends import Link, Report, Request, VehicleEnd
from groundstation.pilot.sight import VehicleSample
from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.kinematics import world_rates
from sim.simulator import Simulator

# Physics at 250 Hz, as `python -m sim` runs it.
STEP_S = 0.004
_MODES = {Request.OFFBOARD: Mode.OFFBOARD, Request.HOLD: Mode.HOLD, Request.LAND: Mode.LAND}
_CLIMB_S = 60.0
_SETTLE_S = 1.0


class TakeOffError(Exception):
    """The vehicle did not come to hover; the message says why."""


class RemoteSite:
    """A vehicle that follows what comes over a link, and tells of itself.

    Args:
        vehicle: On the ground.
        link: To the ground station.
        telemetry_hz: How often it tells of itself.
    """

    def __init__(self, vehicle: Simulator, link: Link, telemetry_hz: float) -> None:
        self.vehicle = vehicle
        self._end = VehicleEnd(link)
        self._telemetry_every = max(1, round(1.0 / (telemetry_hz * STEP_S)))
        self._steps = 0

    def take_off(self, altitude: float, climbing: Callable[[Simulator], None]) -> None:
        """Climb to `altitude`, m, by the autopilot alone, and come to rest there.

        Args:
            altitude: Above the ground, m.
            climbing: Is shown the vehicle after every step.

        Raises:
            TakeOffError: It will not arm, or is not up after a minute.
        """
        vehicle, autopilot = self.vehicle, self.vehicle.autopilot
        for verdict in (autopilot.arm(), autopilot.take_off(altitude)):
            if not verdict.ok:
                raise TakeOffError(f"The vehicle will not take off: {verdict.why}.")
        for _ in range(round(_CLIMB_S / STEP_S)):
            vehicle.step(STEP_S)
            climbing(vehicle)
            if autopilot.mode is Mode.HOLD:
                break
        else:
            raise TakeOffError(f"The vehicle is not at {altitude:g} m after {_CLIMB_S:.0f} s.")
        for _ in range(round(_SETTLE_S / STEP_S)):
            vehicle.step(STEP_S)
            climbing(vehicle)

    def step(self) -> None:
        """Do what came over the link, fly for `STEP_S`, tell of it where that is due."""
        vehicle, end = self.vehicle, self._end
        autopilot = vehicle.autopilot
        setpoint = end.listen(vehicle.t)
        if setpoint is not None:
            # A velocity on the heading becomes one of the world when it arrives, as in `sim.mavlink.setpoints`.
            x, y, z, turn = world_rates(vehicle.estimate.p[3], setpoint)
            autopilot.offboard(Target(velocity=(x, y, z), yaw_rate=turn))
        if end.request is not None:
            autopilot.hear_ground_station()
            autopilot.set_mode(_MODES[end.request])
            end.request = None
        vehicle.step(STEP_S)
        self._steps += 1
        if self._steps % self._telemetry_every == 0:
            self._tell()

    def _tell(self) -> None:
        vehicle = self.vehicle
        p, v, trusted = vehicle.estimate
        sample = VehicleSample(p, world_rates(p[3], v))
        offboard = vehicle.autopilot.mode is Mode.OFFBOARD
        report = Report(sample, offboard, vehicle.autopilot.armed, trusted, vehicle.battery.remaining)
        self._end.tell(vehicle.t, report)
