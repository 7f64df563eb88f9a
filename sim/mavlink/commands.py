"""MAV_CMD_*: each one accepted, refused with a reason, or cleanly unsupported; every one acknowledged."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite, nan
from typing import NamedTuple

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.autopilot import Autopilot, Severity, Verdict
from sim.autopilot.navigator import Mode
from sim.mavlink.modes import MODES, refusal
from sim.mavlink.streams import Streams
from sim.mavlink.wire import Outbox
from sim.simulator import Simulator

# The value that makes arming forced, and disarming a kill (MAVLink, MAV_CMD_COMPONENT_ARM_DISARM).
FORCE = 21196
_UNSET = 0x7FFFFFFF
_RELATIVE = (
    m.MAV_FRAME_GLOBAL_RELATIVE_ALT,
    m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
)
_ABSOLUTE = (m.MAV_FRAME_GLOBAL, m.MAV_FRAME_GLOBAL_INT)


class Request(NamedTuple):
    """A command, whether it came as COMMAND_LONG or COMMAND_INT.

    Attributes:
        params: Parameters 1 to 7; NaN where unset. 5 and 6 are degrees where they are a place.
        frame: MAV_FRAME of the place.
    """

    params: tuple[float, ...]
    frame: int

    def whole(self, number: int) -> int | None:
        """Return parameter `number` as an integer, or None where it is none."""
        value = self.params[number - 1]
        return int(value) if isfinite(value) and value == int(value) else None


Handler = Callable[[Request], int]


class Commands:
    """Carries out commands.

    Args:
        simulator: The vehicle.
        streams: Its telemetry.
        outbox: Where acknowledgements go.
    """

    def __init__(self, simulator: Simulator, streams: Streams, outbox: Outbox) -> None:
        self._sim = simulator
        self._autopilot: Autopilot = simulator.autopilot
        self._streams = streams
        self._outbox = outbox
        self._wanted: int | None = None
        self._handlers: dict[int, Handler] = {
            m.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            m.MAV_CMD_DO_SET_MODE: self._set_mode,
            m.MAV_CMD_NAV_TAKEOFF: self._take_off,
            m.MAV_CMD_NAV_LAND: lambda _: _result(self._autopilot.set_mode(Mode.LAND)),
            m.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: _result(self._autopilot.set_mode(Mode.RETURN)),
            m.MAV_CMD_DO_FLIGHTTERMINATION: self._terminate,
            m.MAV_CMD_DO_REPOSITION: self._reposition,
            m.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
            m.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_interval,
            m.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_interval,
            m.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            m.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._request_capabilities,
        }

    def long(self, message: m.MAVLink_command_long_message) -> None:
        """Carry out a COMMAND_LONG."""
        params = tuple(float(getattr(message, f"param{number}")) for number in range(1, 8))
        self._carry_out(message, Request(params, m.MAV_FRAME_GLOBAL))

    def int(self, message: m.MAVLink_command_int_message) -> None:
        """Carry out a COMMAND_INT."""
        x, y = (nan if value == _UNSET else value * 1e-7 for value in (message.x, message.y))
        params = (message.param1, message.param2, message.param3, message.param4, x, y, message.z)
        self._carry_out(message, Request(params, message.frame))

    def old_set_mode(self, message: m.MAVLink_set_mode_message) -> None:
        """Carry out SET_MODE, the message that MAV_CMD_DO_SET_MODE replaced; it has no acknowledgement."""
        if message.base_mode & m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            self._switch(message.custom_mode >> 16 & 0xFF, message.custom_mode >> 24 & 0xFF)

    def _carry_out(
        self, message: m.MAVLink_command_long_message | m.MAVLink_command_int_message, request: Request
    ) -> None:
        handler = self._handlers.get(message.command)
        self._wanted = None
        result = handler(request) if handler else m.MAV_RESULT_UNSUPPORTED
        self._outbox.send(
            m.MAVLink_command_ack_message(
                message.command,
                result,
                target_system=message.get_srcSystem(),
                target_component=message.get_srcComponent(),
            )
        )
        if self._wanted is not None:
            self._streams.send_once(self._wanted)

    def _arm_disarm(self, request: Request) -> int:
        arm, forced = request.whole(1), request.whole(2) == FORCE
        if arm == 1:
            return _result(self._autopilot.arm(force=forced))
        if arm == 0:
            return _result(self._autopilot.kill() if forced else self._autopilot.disarm())
        return m.MAV_RESULT_DENIED

    def _set_mode(self, request: Request) -> int:
        base, main, sub = request.whole(1), request.whole(2), request.whole(3)
        if base is None or main is None or not base & m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return m.MAV_RESULT_DENIED
        return self._switch(main, sub or 0)

    def _switch(self, main: int, sub: int) -> int:
        mode = MODES.get((main, sub))
        if mode is None:
            name, why = refusal(main, sub)
            self._autopilot.say(Severity.CRITICAL, f"{name} denied: {why}")
            return m.MAV_RESULT_TEMPORARILY_REJECTED
        if mode is Mode.TAKEOFF:
            return _result(self._autopilot.take_off())
        return _result(self._autopilot.set_mode(mode))

    def _take_off(self, request: Request) -> int:
        altitude = request.params[6]
        if not isfinite(altitude):
            return _result(self._autopilot.take_off())
        height = altitude - frames.ORIGIN[2] - self._autopilot.home[2]
        if height <= 0.0:
            why = f"{altitude:.0f} m above sea level is below the ground"
            self._autopilot.say(Severity.CRITICAL, f"Takeoff denied: {why}")
            return m.MAV_RESULT_DENIED
        return _result(self._autopilot.take_off(height))

    def _terminate(self, request: Request) -> int:
        if request.whole(1) != 1:
            return m.MAV_RESULT_DENIED
        return _result(self._autopilot.terminate())

    def _reposition(self, request: Request) -> int:
        """Fly to a place; what is NaN stays as it is. Yaw is a heading, rad."""
        _, _, _, angle, latitude, longitude, altitude = request.params
        if request.frame not in _RELATIVE + _ABSOLUTE:
            return m.MAV_RESULT_UNSUPPORTED
        x, y, z, _ = self._sim.p
        if isfinite(latitude) and isfinite(longitude):
            x, y = frames.local(latitude, longitude)
        if isfinite(altitude):
            relative = request.frame in _RELATIVE
            z = altitude + (self._autopilot.home[2] if relative else -frames.ORIGIN[2])
        yaw = frames.heading(angle) if isfinite(angle) else None
        return _result(self._autopilot.reposition((x, y, z), yaw))

    def _change_speed(self, request: Request) -> int:
        taken = self._autopilot.parameters.set("MPC_XY_CRUISE", request.params[1])
        return m.MAV_RESULT_ACCEPTED if taken else m.MAV_RESULT_DENIED

    def _set_interval(self, request: Request) -> int:
        message_id, interval = request.whole(1), request.params[1]
        if message_id is None or not isfinite(interval):
            return m.MAV_RESULT_DENIED
        taken = self._streams.set_interval(message_id, interval, self._sim.t)
        return m.MAV_RESULT_ACCEPTED if taken else m.MAV_RESULT_DENIED

    def _get_interval(self, request: Request) -> int:
        message_id = request.whole(1)
        interval = None if message_id is None else self._streams.interval_us(message_id)
        if message_id is None or interval is None:
            return m.MAV_RESULT_DENIED
        self._outbox.send(m.MAVLink_message_interval_message(message_id, interval))
        return m.MAV_RESULT_ACCEPTED

    def _request_message(self, request: Request) -> int:
        message_id = request.whole(1)
        if message_id is None or self._streams.interval_us(message_id) is None:
            return m.MAV_RESULT_DENIED
        self._wanted = message_id
        return m.MAV_RESULT_ACCEPTED

    def _request_capabilities(self, _: Request) -> int:
        self._wanted = m.MAVLINK_MSG_ID_AUTOPILOT_VERSION
        return m.MAV_RESULT_ACCEPTED


def _result(verdict: Verdict) -> int:
    return m.MAV_RESULT_ACCEPTED if verdict.ok else m.MAV_RESULT_TEMPORARILY_REJECTED
