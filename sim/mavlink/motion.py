"""What the vehicle tells of its motion: its own estimate, one builder a message, in NED and FRD."""

from __future__ import annotations

from collections.abc import Callable
from math import hypot, nan

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.kinematics import Vector3, world_rates
from sim.models.motion import GRAVITY
from sim.simulator import Simulator

# None where there is nothing to tell now.
Builder = Callable[[], m.MAVLink_message | None]

# Percent, as PX4 takes it (MPC_THR_HOVER).
_HOVER_THROTTLE = 50.0
_NO_COVARIANCE = (nan,) + (0.0,) * 20


class Motion:
    """Builds the messages on position, velocity and attitude.

    Args:
        simulator: The vehicle.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._sim = simulator
        self.builders: dict[int, Builder] = {
            m.MAVLINK_MSG_ID_ATTITUDE: self.attitude,
            m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: self.attitude_quaternion,
            m.MAVLINK_MSG_ID_LOCAL_POSITION_NED: self.local_position_ned,
            m.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: self.global_position_int,
            m.MAVLINK_MSG_ID_VFR_HUD: self.vfr_hud,
            m.MAVLINK_MSG_ID_ALTITUDE: self.altitude,
            m.MAVLINK_MSG_ID_ODOMETRY: self.odometry,
        }

    def attitude(self) -> m.MAVLink_message:
        """Euler angles."""
        return m.MAVLink_attitude_message(boot_ms(self._sim), *self._angles(), *self._rates())

    def attitude_quaternion(self) -> m.MAVLink_message:
        """The same as a quaternion."""
        turn = frames.quaternion(*self._angles())
        return m.MAVLink_attitude_quaternion_message(boot_ms(self._sim), *turn, *self._rates())

    def local_position_ned(self) -> m.MAVLink_message:
        """Position and velocity."""
        x, y, z, _ = self._sim.estimate.p
        return m.MAVLink_local_position_ned_message(
            boot_ms(self._sim), *frames.ned(x, y, z), *self._velocity_ned()
        )

    def global_position_int(self) -> m.MAVLink_message:
        """Position and velocity on the globe."""
        x, y, z, yaw = self._sim.estimate.p
        latitude, longitude, height = frames.geodetic(x, y, z)
        north, east, down = (int16(100.0 * component) for component in self._velocity_ned())
        return m.MAVLink_global_position_int_message(
            boot_ms(self._sim),
            int32(latitude * 1e7),
            int32(longitude * 1e7),
            int32(height * 1e3),
            int32((z - self._sim.autopilot.home[2]) * 1e3),
            north,
            east,
            down,
            round(frames.compass(yaw) * 100.0) % 36000,
        )

    def vfr_hud(self) -> m.MAVLink_message:
        """What a pilot's display wants."""
        north, east, down = self._velocity_ned()
        speed = hypot(north, east)
        height = frames.ORIGIN[2] + self._sim.estimate.p[2]
        throttle = round(_HOVER_THROTTLE * self._lift()) if self._sim.autopilot.armed else 0
        return m.MAVLink_vfr_hud_message(
            speed,
            speed,
            round(frames.compass(self._sim.estimate.p[3])) % 360,
            min(throttle, 100),
            height,
            -down,
        )

    def altitude(self) -> m.MAVLink_message:
        """Height in all its meanings."""
        z = self._sim.estimate.p[2]
        above = z - self._sim.autopilot.home[2]
        height = frames.ORIGIN[2] + z
        return m.MAVLink_altitude_message(boot_us(self._sim), height, height, z, above, 0.0, z)

    def odometry(self) -> m.MAVLink_message:
        """Position in the world, velocity on the body."""
        x, y, z, _ = self._sim.estimate.p
        forward, left, up, _ = self._sim.estimate.v
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

    def _lift(self) -> float:
        """Return the thrust as a share of the weight, by what an accelerometer feels; none on the ground."""
        if self._sim.grounded:
            return 0.0
        return hypot(*self._sim.attitude.specific_force()) / GRAVITY

    def _velocity_ned(self) -> Vector3:
        estimate = self._sim.estimate
        east, north, up, _ = world_rates(estimate.p[3], estimate.v)
        return frames.ned(east, north, up)

    def _angles(self) -> Vector3:
        """Roll, pitch and heading as the wire has them: FRD in NED."""
        attitude = self._sim.attitude
        return attitude.roll, -attitude.pitch, frames.heading(self._sim.estimate.p[3])

    def _rates(self) -> Vector3:
        return body_rates(self._sim)


def body_rates(simulator: Simulator) -> Vector3:
    """Return the vehicle's turning, FRD, rad/s, for a small lean."""
    attitude = simulator.attitude
    return attitude.roll_rate, -attitude.pitch_rate, -simulator.v[3]


def boot_ms(simulator: Simulator) -> int:
    """Return milliseconds since start, as the wire's 32 bits hold them."""
    return int(simulator.t * 1e3) & 0xFFFFFFFF


def boot_us(simulator: Simulator) -> int:
    """Return microseconds since start."""
    return int(simulator.t * 1e6)


def int16(value: float) -> int:
    """Return a number as the wire's 16 bits hold it."""
    return max(-32768, min(32767, round(value)))


def int32(value: float) -> int:
    """Return a number as the wire's 32 bits hold it."""
    return max(-0x80000000, min(0x7FFFFFFF, round(value)))
