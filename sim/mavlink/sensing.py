"""What the vehicle's sensors measure of the truth: GPS, inertial unit, barometer, magnetometer, rangefinders."""

from __future__ import annotations

from math import cos, isfinite, sin

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.environment.rangefinder import RING_LIMIT, SECTORS, below, ring
from sim.kinematics import Vector3, world_rates
from sim.mavlink.motion import Builder, body_rates, boot_ms, boot_us, int32
from sim.sensors import GPS_HORIZONTAL, GPS_VERTICAL, Sensors
from sim.simulator import Simulator

# The earth's field in NED where the origin is, gauss (World Magnetic Model, rounded).
_FIELD: Vector3 = (0.213, 0.012, 0.430)
# How near and far the rangefinders measure, cm: downward, and the ring.
_DOWN_CM = (10, 4000)
_RING_CM = (20, round(100.0 * RING_LIMIT))
_NOTHING_NEAR = _RING_CM[1] + 1
_GPS_SPEED_ERROR = 0.1
# Dilutions, speed and course.
_UNKNOWN: tuple[int, int, int, int] = (0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF)


class Sensing:
    """Builds the messages on raw measurements.

    Args:
        simulator: The vehicle.
        sensors: Their noise.
    """

    def __init__(self, simulator: Simulator, sensors: Sensors) -> None:
        self._sim = simulator
        self._sensors = sensors
        self.builders: dict[int, Builder] = {
            m.MAVLINK_MSG_ID_GPS_RAW_INT: self.gps_raw_int,
            m.MAVLINK_MSG_ID_HIGHRES_IMU: self.highres_imu,
            m.MAVLINK_MSG_ID_SCALED_PRESSURE: self.scaled_pressure,
            m.MAVLINK_MSG_ID_DISTANCE_SENSOR: self.distance_sensor,
            m.MAVLINK_MSG_ID_OBSTACLE_DISTANCE: self.obstacle_distance,
            m.MAVLINK_MSG_ID_VIBRATION: self.vibration,
        }

    def gps_raw_int(self) -> m.MAVLink_message:
        """A GPS receiver's own measurement, and how exact it takes it to be."""
        if "gps" in self._sim.failed:
            return m.MAVLink_gps_raw_int_message(
                boot_us(self._sim), m.GPS_FIX_TYPE_NO_FIX, 0, 0, 0, *_UNKNOWN, 0
            )
        x, y, z, yaw = self._sim.p
        latitude, longitude, height = frames.geodetic(*self._sensors.gps((x, y, z), self._sim.t))
        east, north, _, _ = world_rates(yaw, self._sim.v)
        speed, course = frames.course(east, north)
        return m.MAVLink_gps_raw_int_message(
            boot_us(self._sim),
            m.GPS_FIX_TYPE_3D_FIX,
            int32(latitude * 1e7),
            int32(longitude * 1e7),
            int32(height * 1e3),
            80,
            120,
            min(round(speed * 1e2), 0xFFFF),
            round(course * 1e2) % 36000,
            14,
            int32(height * 1e3),
            round(1e3 * GPS_HORIZONTAL),
            round(1e3 * GPS_VERTICAL),
            round(1e3 * _GPS_SPEED_ERROR),
        )

    def highres_imu(self) -> m.MAVLink_message:
        """The inertial unit, magnetometer and barometer."""
        force = frames.frd(*self._sim.attitude.specific_force())
        field = frames.frd(*self._sim.attitude.onto_axes(self._field_on_heading()))
        height = self._height()
        return m.MAVLink_highres_imu_message(
            boot_us(self._sim),
            *self._sensors.accelerometer(force),
            *self._sensors.gyro(body_rates(self._sim)),
            *self._sensors.magnetometer(field),
            _pressure(height),
            0.0,
            height,
            20.0,
            0x1FFF,
        )

    def scaled_pressure(self) -> m.MAVLink_message:
        """Barometer."""
        return m.MAVLink_scaled_pressure_message(boot_ms(self._sim), _pressure(self._height()), 0.0, 2000)

    def distance_sensor(self) -> m.MAVLink_message:
        """A rangefinder that looks down."""
        x, y, z, _ = self._sim.p
        lowest, highest = _DOWN_CM
        distance = 100.0 * below(self._sim.world, (x, y, z))
        measured = max(lowest, round(distance)) if distance < highest else highest
        return m.MAVLink_distance_sensor_message(
            boot_ms(self._sim),
            lowest,
            highest,
            measured,
            m.MAV_DISTANCE_SENSOR_LASER,
            0,
            m.MAV_SENSOR_ROTATION_PITCH_270,
            255,
        )

    def obstacle_distance(self) -> m.MAVLink_message:
        """A ring of rangefinders on the vehicle: from forward on, clockwise on the wire."""
        lowest, highest = _RING_CM
        counter_clockwise = ring(self._sim.world, self._sim.p, SECTORS, RING_LIMIT)
        distances = [
            max(lowest, min(highest, round(100.0 * distance))) if isfinite(distance) else _NOTHING_NEAR
            for distance in (counter_clockwise[0], *reversed(counter_clockwise[1:]))
        ]
        step = 360.0 / SECTORS
        return m.MAVLink_obstacle_distance_message(
            boot_us(self._sim),
            m.MAV_DISTANCE_SENSOR_LASER,
            distances,
            round(step),
            lowest,
            highest,
            step,
            0.0,
            m.MAV_FRAME_BODY_FRD,
        )

    def vibration(self) -> m.MAVLink_message:
        """None: the models do not shake."""
        return m.MAVLink_vibration_message(boot_us(self._sim), 0.0, 0.0, 0.0, 0, 0, 0)

    def _height(self) -> float:
        """Return the height above sea level that the barometer makes of the pressure, m."""
        return self._sensors.barometer(frames.ORIGIN[2] + self._sim.p[2], self._sim.t)

    def _field_on_heading(self) -> Vector3:
        """Return the earth's magnetic field on the heading's level axes, FLU, gauss."""
        north, east, down = _FIELD
        angle = frames.heading(self._sim.p[3])
        c, s = cos(angle), sin(angle)
        return c * north + s * east, s * north - c * east, -down


def _pressure(height: float) -> float:
    """Return the pressure of the standard atmosphere, hPa (ICAO Doc 7488, troposphere); none above it."""
    return 1013.25 * max(0.0, 1.0 - 2.25577e-5 * height) ** 5.25588
