"""What the vehicle says, from MAVSDK's callbacks into our frames and records.

Callbacks run on MAVSDK's thread and only leave values here; the link's loop picks them up.
"""

from __future__ import annotations

import math
import queue
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from mavsdk import System
from mavsdk.plugins import telemetry as plugin
from mavsdk.plugins.telemetry import Telemetry

from groundstation.frames import Vector3, enu_from_ned, yaw_from_heading
from groundstation.messages import Attitude, FlightMode, Health, Severity, VehicleState

_MODES = {
    plugin.FlightMode.READY: FlightMode.READY,
    plugin.FlightMode.TAKEOFF: FlightMode.TAKEOFF,
    plugin.FlightMode.HOLD: FlightMode.HOLD,
    plugin.FlightMode.MISSION: FlightMode.MISSION,
    plugin.FlightMode.RETURN_TO_LAUNCH: FlightMode.RETURN,
    plugin.FlightMode.LAND: FlightMode.LAND,
    plugin.FlightMode.OFFBOARD: FlightMode.OFFBOARD,
    plugin.FlightMode.MANUAL: FlightMode.MANUAL,
    plugin.FlightMode.ALTCTL: FlightMode.ALTITUDE,
    plugin.FlightMode.POSCTL: FlightMode.POSITION,
    plugin.FlightMode.UNKNOWN: FlightMode.UNKNOWN,
}
# A heading is one of about the same moment as a position for so long, s.
_ATTITUDE_S = 0.5
# So many attitudes wait for the link, which takes them many times a second.
_ATTITUDES = 256
_ALARMING = plugin.StatusTextType.ERROR
_WARNING = plugin.StatusTextType.WARNING


@dataclass(slots=True)
class Origin:
    """Where the world's origin lies in the vehicle's local frame: where it was first armed since it booted.

    Until then it follows the vehicle, so that an unarmed vehicle stands at zero.
    """

    offset: Vector3 = (0.0, 0.0, 0.0)
    fixed: bool = False

    def world(self, local: Vector3, *, armed: bool) -> Vector3:
        """Return the world position (ENU, m) of a local one (ENU, m), and fix the origin on arming."""
        if not self.fixed:
            self.offset = local
            self.fixed = armed
        return local[0] - self.offset[0], local[1] - self.offset[1], local[2] - self.offset[2]


Notes = queue.SimpleQueue[tuple[Severity, str]]


class VehicleView:
    """The newest of everything MAVSDK tells of one vehicle.

    Args:
        notes: Where the vehicle's words go.
        clock: Monotonic seconds.

    Attributes:
        attitudes: Those that came and were not taken yet.
        boots: How often it has started anew.
        mode_t: When the heartbeat came that `mode` is from, s.
    """

    def __init__(self, notes: Notes, clock: Callable[[], float]) -> None:
        self._notes = notes
        self._clock = clock
        self._system: System | None = None
        self._telemetry: Telemetry | None = None
        self._origin = Origin()
        self._state = VehicleState()
        self._attitude_t = -math.inf
        self._rates = (0.0, 0.0, 0.0)
        self.attitudes: deque[Attitude] = deque(maxlen=_ATTITUDES)
        # Copies: what is sent must not change meanwhile, nor go out twice with one time.
        self._states: deque[VehicleState] = deque(maxlen=1)
        self.mode = FlightMode.UNKNOWN
        self.mode_t = 0.0
        self.armed = False
        self.in_air = False
        self.battery = math.nan
        self.voltage = math.nan
        self.boots = 0
        self.health = Health(0)

    def attach(self, system: System, rate: float) -> None:
        """Subscribe to a discovered vehicle's telemetry and ask for position and attitude at `rate` Hz."""
        telemetry = Telemetry(system)
        self._system, self._telemetry = system, telemetry
        telemetry.subscribe_attitude_euler(self._on_attitude)
        telemetry.subscribe_attitude_angular_velocity_body(self._on_rates)
        telemetry.subscribe_position_velocity_ned(self._on_position)
        telemetry.subscribe_flight_mode(self._on_mode)
        telemetry.subscribe_armed(self._on_armed)
        telemetry.subscribe_in_air(self._on_in_air)
        telemetry.subscribe_battery(self._on_battery)
        telemetry.subscribe_health(self._on_health)
        telemetry.subscribe_rc_status(self._on_transmitter)
        telemetry.subscribe_status_text(self._on_text)
        telemetry.set_rate_position_velocity_ned_async(rate, _ignore)
        telemetry.set_rate_attitude_euler_async(rate, _ignore)

    def connected(self) -> bool:
        """Say whether MAVSDK still hears the vehicle's heartbeat."""
        return self._system is not None and self._system.is_connected()

    def yaw(self) -> float:
        """Return the newest yaw, rad; NaN while none has come lately."""
        fresh = self._clock() - self._attitude_t < _ATTITUDE_S
        return self._state.position[3] if fresh else math.nan

    @property
    def fresh(self) -> bool:
        """A position came since `take_state` was last called."""
        return bool(self._states)

    def take_state(self) -> VehicleState:
        """Return the newest state for publishing, once."""
        return self._states.popleft()

    def _on_attitude(self, angle: plugin.EulerAngle, _: object) -> None:
        boot_t = angle.timestamp_us * 1e-6
        if boot_t < self._state.boot_t - 1.0:
            self._origin = Origin()
            self.boots += 1
            self._notes.put((Severity.ALARM, "The vehicle has rebooted; the world's origin starts anew."))
        state = self._state
        state.boot_t = boot_t
        state.roll = math.radians(angle.roll_deg)
        # FRD → FLU: forward is shared, so roll keeps its sign and pitch turns it.
        state.pitch = -math.radians(angle.pitch_deg)
        state.position[3] = yaw_from_heading(angle.yaw_deg)
        self._attitude_t = now = self._clock()
        self.attitudes.append(
            Attitude(
                t=now,
                roll=state.roll,
                pitch=state.pitch,
                yaw=state.position[3],
                rates=self._rates,
                boot_t=boot_t,
            )
        )

    def _on_rates(self, rates: plugin.AngularVelocityBody, _: object) -> None:
        self._rates = (rates.roll_rad_s, -rates.pitch_rad_s, -rates.yaw_rad_s)

    def _on_position(self, sample: plugin.PositionVelocityNed, _: object) -> None:
        now = self._clock()
        place, motion = sample.position, sample.velocity
        local = enu_from_ned((place.north_m, place.east_m, place.down_m))
        velocity = enu_from_ned((motion.north_m_s, motion.east_m_s, motion.down_m_s))
        if not all(map(math.isfinite, (*local, *velocity, self._rates[2], self._state.position[3]))):
            self._state.valid = 0
            self._state.t = now
            self._states.append(VehicleState.from_buffer_copy(self._state))
            return
        position = self._origin.world(local, armed=self.armed)
        state = self._state
        state.position[:3] = position
        state.velocity[:] = (*velocity, self._rates[2])
        # A position is worth nothing to equation (3) without a heading of about the same moment.
        state.valid = int(now - self._attitude_t < _ATTITUDE_S)
        state.t = now
        self._states.append(VehicleState.from_buffer_copy(state))

    def _on_mode(self, mode: plugin.FlightMode, _: object) -> None:
        self.mode = _MODES.get(mode, FlightMode.OTHER)
        self.mode_t = self._clock()

    def _on_armed(self, armed: bool, _: object) -> None:
        self.armed = bool(armed)

    def _on_in_air(self, in_air: bool, _: object) -> None:
        self.in_air = bool(in_air)

    def _on_battery(self, battery: plugin.Battery, _: object) -> None:
        self.battery = battery.remaining_percent / 100.0
        self.voltage = battery.voltage_v

    def _on_health(self, health: plugin.Health, _: object) -> None:
        self.health = (
            Health.GYRO * bool(health.is_gyrometer_calibration_ok)
            | Health.ACCELEROMETER * bool(health.is_accelerometer_calibration_ok)
            | Health.MAGNETOMETER * bool(health.is_magnetometer_calibration_ok)
            | Health.LOCAL_POSITION * bool(health.is_local_position_ok)
            | Health.GLOBAL_POSITION * bool(health.is_global_position_ok)
            | Health.HOME * bool(health.is_home_position_ok)
            | Health.ARMABLE * bool(health.is_armable)
            | self.health & Health.TRANSMITTER
        )

    def _on_transmitter(self, heard: plugin.RcStatus, _: object) -> None:
        self.health = self.health & ~Health.TRANSMITTER | Health.TRANSMITTER * bool(heard.is_available)

    def _on_text(self, text: plugin.StatusText, _: object) -> None:
        if text.type >= _ALARMING:
            severity = Severity.ALARM
        elif text.type >= _WARNING:
            severity = Severity.WARNING
        else:
            severity = Severity.INFO
        self._notes.put((severity, f"Vehicle: {text.text}"))


def _ignore(_result: object, _: object) -> None:
    """A vehicle that denies a rate is flown at the rate it gives; the state's age is measured anyway."""
