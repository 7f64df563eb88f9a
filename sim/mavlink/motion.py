"""What the vehicle tells of its motion: one builder a message, from the simulator's state, in NED and FRD."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, hypot, nan, sin

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.kinematics import Vector3, world_rates
from sim.sensors import Sensors
from sim.simulator import Simulator

Builder = Callable[[], m.MAVLink_message]

# The earth's field in NED where the origin is, gauss (World Magnetic Model, rounded).
_FIELD: Vector3 = (0.213, 0.012, 0.430)
_RANGE_M = (0.1, 40.0)
_NO_COVARIANCE = (nan,) + (0.0,) * 20


class Motion:
    """Builds the messages on position, velocity and attitude, and the raw measurements of them.

    Args:
        simulator: The vehicle.
        sensors: Noise of its raw measurements.
    """

    def __init__(self, simulator: Simulator, sensors: Sensors) -> None:
        self._sim = simulator
        self._sensors = sensors
        self.builders: dict[int, Builder] = {
            m.MAVLINK_MSG_ID_GPS_RAW_INT: self.gps_raw_int,
            m.MAVLINK_MSG_ID_ATTITUDE: self.attitude,
            m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: self.attitude_quaternion,
            m.MAVLINK_MSG_ID_LOCAL_POSITION_NED: self.local_position_ned,
            m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: self.global_position_int,
            m.MAVLINK_MSG_ID_VFR_HUD: self.vfr_hud,
            m.MAVLINK_MSG_ID_HIGHRES_IMU: self.highres_imu,
            m.MAVLINK_MSG_ID_SCALED_PRESSURE: self.scaled_pressure,
            m.MAVLINK_MSG_ID_DISTANCE_SENSOR: self.distance_sensor,
            m.MAVLINK_MSG_ID_ALTITUDE: self.altitude,
            m.MAVLINK_MSG_ID_ODOMETRY: self.odometry,
        }

    def gps_raw_int(self) -> m.MAVLink_message:
        """A GPS receiver's own measurement."""
        x, y, z, _ = self._sim.p
        latitude, longitude, height = frames.geodetic(*self._sensors.gps((x, y, z), self._sim.t))
        north, east, _ = self._velocity_ned()
        speed, course = frames.course(east, north)
        return m.MAVLink_gps_raw_int_message(
            boot_us(self._sim),
            m.GPS_FIX_TYPE_3D_FIX,
            round(latitude * 1e7),
            round(longitude * 1e7),
            round(height * 1e3),
            80,
            120,
            min(round(speed * 1e2), 0xFFFF),
            round(course * 1e2),
            14,
        )

    def attitude(self) -> m.MAVLink_message:
        """Euler angles."""
        return m.MAVLink_attitude_message(boot_ms(self._sim), *self._angles(), *self._rates())

    def attitude_quaternion(self) -> m.MAVLink_message:
        """The same as a quaternion."""
        turn = frames.quaternion(*self._angles())
        return m.MAVLink_attitude_quaternion_message(boot_ms(self._sim), *turn, *self._rates())

    def local_position_ned(self) -> m.MAVLink_message:
        """Position and velocity."""
        x, y, z, _ = self._sim.p
        return m.MAVLink_local_position_ned_message(
            boot_ms(self._sim), *frames.ned(x, y, z), *self._velocity_ned()
        )

    def global_position_int(self) -> m.MAVLink_message:
        """Position and velocity on the globe."""
        x, y, z, yaw = self._sim.p
        latitude, longitude, height = frames.geodetic(x, y, z)
        north, east, down = (_int16(100.0 * component) for component in self._velocity_ned())
        return m.MAVLink_global_position_int_message(
            boot_ms(self._sim),
            round(latitude * 1e7),
            round(longitude * 1e7),
            round(height * 1e3),
            round((z - self._sim.autopilot.home[2]) * 1e3),
            north,
            east,
            down,
            round(frames.compass(yaw) * 100.0) % 36000,
        )

    def vfr_hud(self) -> m.MAVLink_message:
        """What a pilot's display wants."""
        north, east, down = self._velocity_ned()
        speed = hypot(north, east)
        height = frames.ORIGIN[2] + self._sim.p[2]
        throttle = 50 if self._sim.autopilot.armed else 0
        return m.MAVLink_vfr_hud_message(
            speed, speed, round(frames.compass(self._sim.p[3])) % 360, throttle, height, -down
        )

    def highres_imu(self) -> m.MAVLink_message:
        """The inertial unit, magnetometer and barometer."""
        force = frames.frd(*self._sim.attitude.specific_force())
        field = frames.frd(*self._sim.attitude.onto_axes(self._field_on_heading()))
        return m.MAVLink_highres_imu_message(
            boot_us(self._sim),
            *self._sensors.accelerometer(force),
            *self._sensors.gyro(self._rates()),
            *field,
            self._pressure(),
            0.0,
            frames.ORIGIN[2] + self._sim.p[2],
            20.0,
            0x1FFF,
        )

    def scaled_pressure(self) -> m.MAVLink_message:
        """Barometer."""
        return m.MAVLink_scaled_pressure_message(boot_ms(self._sim), self._pressure(), 0.0, 2000)

    def distance_sensor(self) -> m.MAVLink_message:
        """A rangefinder that looks down."""
        x, y, z, _ = self._sim.p
        below = self._sim.world.ray((x, y, z), (0.0, 0.0, -1.0), z)
        lowest, highest = (round(100.0 * metres) for metres in _RANGE_M)
        measured = max(lowest, min(highest, round(100.0 * below)))
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

    def altitude(self) -> m.MAVLink_message:
        """Height in all its meanings."""
        z = self._sim.p[2]
        above = z - self._sim.autopilot.home[2]
        height = frames.ORIGIN[2] + z
        return m.MAVLink_altitude_message(boot_us(self._sim), height, height, z, above, 0.0, z)

    def odometry(self) -> m.MAVLink_message:
        """Position in the world, velocity on the body."""
        x, y, z, _ = self._sim.p
        forward, left, up, _ = self._sim.v
        velocity = frames.frd(*self._sim.attitude.onto_axes((forward, left, up)))
        return m.MAVLink_odometry_message(
            boot_us(self._sim),
            m.MAV_FRAME_LOCAL_NED,
            m.MAV_FRAME_BODY_FRD,
            *frames.ned(x, y, z),
            frames.quaternion(*self._angles()),
            *velocity,
            *self._rates(),
            _NO_COVARIANCE,
            _NO_COVARIANCE,
            0,
            m.MAV_ESTIMATOR_TYPE_AUTOPILOT,
            100,
        )

    def _velocity_ned(self) -> Vector3:
        east, north, up, _ = world_rates(self._sim.p[3], self._sim.v)
        return frames.ned(east, north, up)

    def _angles(self) -> Vector3:
        """Roll, pitch and heading as the wire has them: FRD in NED."""
        attitude = self._sim.attitude
        return attitude.roll, -attitude.pitch, frames.heading(self._sim.p[3])

    def _rates(self) -> Vector3:
        """Body rates, FRD, for a small lean."""
        attitude = self._sim.attitude
        return attitude.roll_rate, -attitude.pitch_rate, -self._sim.v[3]

    def _pressure(self) -> float:
        """Pressure of the standard atmosphere, hPa (ICAO Doc 7488, troposphere)."""
        height = frames.ORIGIN[2] + self._sim.p[2]
        return 1013.25 * (1.0 - 2.25577e-5 * height) ** 5.25588

    def _field_on_heading(self) -> Vector3:
        """Return the earth's magnetic field on the heading's level axes, FLU, gauss."""
        north, east, down = _FIELD
        angle = frames.heading(self._sim.p[3])
        c, s = cos(angle), sin(angle)
        return c * north + s * east, s * north - c * east, -down


def boot_ms(simulator: Simulator) -> int:
    """Return milliseconds since start, as the wire's 32 bits hold them."""
    return int(simulator.t * 1e3) & 0xFFFFFFFF


def boot_us(simulator: Simulator) -> int:
    """Return microseconds since start."""
    return int(simulator.t * 1e6)


def _int16(value: float) -> int:
    return max(-32768, min(32767, round(value)))
