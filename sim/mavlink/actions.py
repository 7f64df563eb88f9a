"""Commands that do something to the vehicle: what they mean for the autopilot, and how it went."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite

from pymavlink.dialects.v20 import common as m

from sim import frames
from sim.autopilot.autopilot import Autopilot
from sim.autopilot.modes import Mode
from sim.autopilot.notices import Severity, Verdict
from sim.kinematics import Vector3
from sim.mavlink.modes import MODES, STANDARD_MODES, refusal
from sim.mavlink.request import Request
from sim.mavlink.shared import Shared
from sim.simulator import Unit

# The value that makes arming forced, and disarming a kill (MAVLink, MAV_CMD_COMPONENT_ARM_DISARM).
FORCE = 21196
_RELATIVE = (m.MAV_FRAME_GLOBAL_RELATIVE_ALT, m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
_ABSOLUTE = (m.MAV_FRAME_GLOBAL, m.MAV_FRAME_GLOBAL_INT)
_UNITS: dict[int, Unit] = {m.FAILURE_UNIT_SENSOR_GPS: "gps", m.FAILURE_UNIT_SYSTEM_BATTERY: "battery"}
# Heights beyond it are no heights, m.
_HIGHEST = 1e5


class Actions:
    """Carries out commands; each handler returns a MAV_RESULT.

    Args:
        shared: The vehicle.
    """

    def __init__(self, shared: Shared) -> None:
        self._shared = shared
        self._sim = shared.simulator
        self._autopilot: Autopilot = shared.simulator.autopilot
        self.handlers: dict[int, Callable[[Request], int]] = {
            m.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            m.MAV_CMD_RUN_PREARM_CHECKS: self._check,
            m.MAV_CMD_DO_SET_MODE: self._set_mode,
            m.MAV_CMD_DO_SET_STANDARD_MODE: self._set_standard_mode,
            m.MAV_CMD_NAV_TAKEOFF: self._take_off,
            m.MAV_CMD_NAV_LAND: lambda _: self._mode(Mode.LAND),
            m.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: self._mode(Mode.RETURN),
            m.MAV_CMD_NAV_LOITER_UNLIM: lambda _: self._mode(Mode.HOLD),
            m.MAV_CMD_MISSION_START: self._start_mission,
            m.MAV_CMD_DO_SET_MISSION_CURRENT: self._set_mission_current,
            m.MAV_CMD_DO_PAUSE_CONTINUE: self._pause_or_continue,
            m.MAV_CMD_DO_FLIGHTTERMINATION: self._terminate,
            m.MAV_CMD_DO_REPOSITION: self._reposition,
            m.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
            m.MAV_CMD_DO_SET_HOME: self._set_home,
            m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: self._reboot,
            m.MAV_CMD_PREFLIGHT_STORAGE: self._store,
            m.MAV_CMD_INJECT_FAILURE: self._inject,
        }

    def choose_mode(self, base: int, main: int, sub: int) -> int:
        """Change the mode to a custom one; without the custom flag, PX4 goes by the old base modes."""
        if not base & m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            main, sub = _from_base(base)
        mode = MODES.get((main, sub))
        if mode is None:
            name, why = refusal(main, sub)
            self._autopilot.say(Severity.CRITICAL, f"{name} denied: {why}")
            return m.MAV_RESULT_TEMPORARILY_REJECTED
        return self._mode(mode)

    def _mode(self, mode: Mode) -> int:
        if mode is Mode.TAKEOFF:
            return _result(self._autopilot.take_off())
        return _result(self._autopilot.set_mode(mode))

    def _arm_disarm(self, request: Request) -> int:
        arm, forced = request.whole(1), request.whole(2) == FORCE
        if arm == 1:
            return _result(self._autopilot.arm(force=forced))
        if arm == 0:
            return _result(self._autopilot.kill() if forced else self._autopilot.disarm())
        return m.MAV_RESULT_DENIED

    def _check(self, _: Request) -> int:
        """Say what forbids arming, if anything does."""
        if not self._autopilot.armed and (why := self._autopilot.arming_obstacle()):
            self._autopilot.say(Severity.CRITICAL, f"Preflight Fail: {why}")
        return m.MAV_RESULT_ACCEPTED

    def _set_mode(self, request: Request) -> int:
        base, main, sub = request.whole(1), request.whole(2), request.whole(3)
        if base is None or main is None:
            return m.MAV_RESULT_DENIED
        return self.choose_mode(base, main, sub or 0)

    def _set_standard_mode(self, request: Request) -> int:
        mode = STANDARD_MODES.get(request.whole(1) or 0)
        return m.MAV_RESULT_UNSUPPORTED if mode is None else self._mode(mode)

    def _take_off(self, request: Request) -> int:
        """Climb to a height; one too low is raised to MIS_TAKEOFF_ALT and said, as PX4 does."""
        altitude, least = request.params[6], self._autopilot.parameters["MIS_TAKEOFF_ALT"]
        if not isfinite(altitude):
            return _result(self._autopilot.take_off())
        height = altitude
        if request.frame not in _RELATIVE:
            height -= frames.ORIGIN[2] + self._autopilot.home[2]
        if height > _HIGHEST:
            self._autopilot.say(Severity.CRITICAL, f"Takeoff denied: {altitude:.0f} m is out of range")
            return m.MAV_RESULT_DENIED
        if height < least:
            self._autopilot.say(Severity.CRITICAL, f"Using minimum takeoff altitude: {least:.2f} m")
            height = least
        return _result(self._autopilot.take_off(height))

    def _start_mission(self, request: Request) -> int:
        """Fly the mission, from an item if one is given; arm for it, as PX4 does."""
        first, plan = request.whole(1), self._autopilot.plan
        if first is None or not -1 <= first < len(plan.mission):
            self._autopilot.say(Severity.CRITICAL, "Mission start denied: no such item")
            return m.MAV_RESULT_DENIED
        if first > 0:
            self._autopilot.set_mission_index(first)
        verdict = self._autopilot.set_mode(Mode.MISSION)
        return _result(self._autopilot.arm() if verdict.ok else verdict)

    def _set_mission_current(self, request: Request) -> int:
        index = request.whole(1)
        if index is None or index < 0:
            return m.MAV_RESULT_DENIED
        taken = self._autopilot.set_mission_index(index)
        return m.MAV_RESULT_ACCEPTED if taken.ok else m.MAV_RESULT_DENIED

    def _pause_or_continue(self, request: Request) -> int:
        chosen = {0: Mode.HOLD, 1: Mode.MISSION}.get(-1 if (asked := request.whole(1)) is None else asked)
        return m.MAV_RESULT_DENIED if chosen is None else self._mode(chosen)

    def _terminate(self, request: Request) -> int:
        if request.whole(1) != 1:
            return m.MAV_RESULT_DENIED
        return _result(self._autopilot.terminate())

    def _reposition(self, request: Request) -> int:
        """Fly to a place; what is NaN stays as it is. Yaw is a heading, rad."""
        if request.frame not in _RELATIVE + _ABSOLUTE:
            return m.MAV_RESULT_UNSUPPORTED
        place = self._place(request)
        if place is None:
            return m.MAV_RESULT_DENIED
        angle = request.params[3]
        return _result(self._autopilot.reposition(place, frames.heading(angle) if isfinite(angle) else None))

    def _place(self, request: Request) -> Vector3 | None:
        """Return where a request points to, world, m; its NaN stay where the vehicle is. None is nowhere."""
        latitude, longitude, altitude = request.params[4:]
        x, y, z, _ = self._sim.estimate.p
        if isfinite(latitude) and isfinite(longitude):
            if abs(latitude) > 90.0 or abs(longitude) > 180.0:
                return None
            x, y = frames.local(latitude, longitude)
        if isfinite(altitude):
            if abs(altitude) > _HIGHEST:
                return None
            z = altitude + (self._autopilot.home[2] if request.frame in _RELATIVE else -frames.ORIGIN[2])
        return x, y, z

    def _change_speed(self, request: Request) -> int:
        """Fly automatic modes faster or slower; a speed that is not above 0 is the usual one, as PX4 takes it."""
        speed = request.params[1]
        if not isfinite(speed):
            return m.MAV_RESULT_DENIED
        return _result(self._autopilot.change_speed(speed if speed > 0.0 else -1.0))

    def _set_home(self, request: Request) -> int:
        """Make a place, or where the vehicle is, its home."""
        if request.whole(1) == 1:
            place = self._sim.estimate.p[:3]
        elif all(isfinite(value) for value in request.params[4:]):
            place = self._place(request)
        else:
            place = None
        if place is None:
            return m.MAV_RESULT_DENIED
        return _result(self._autopilot.set_home((*place, self._sim.estimate.p[3])))

    def _reboot(self, request: Request) -> int:
        """Begin anew; not in flight. Nothing to do is done, switching off is not possible."""
        asked = request.whole(1)
        if asked == 0:
            return m.MAV_RESULT_ACCEPTED
        if asked not in (1, 3):
            return m.MAV_RESULT_UNSUPPORTED
        if self._autopilot.armed:
            self._autopilot.say(Severity.CRITICAL, "Reboot denied: armed")
            return m.MAV_RESULT_TEMPORARILY_REJECTED
        self._shared.reboot_asked = True
        return m.MAV_RESULT_ACCEPTED

    def _store(self, request: Request) -> int:
        """Parameters are kept while the vehicle runs: there is nothing to load or save."""
        return m.MAV_RESULT_ACCEPTED if request.whole(1) in (0, 1) else m.MAV_RESULT_UNSUPPORTED

    def _inject(self, request: Request) -> int:
        """Let a unit fail, in whatever way, or work again."""
        unit, kind = _UNITS.get(request.whole(1) or 0), request.whole(2)
        if unit is None or kind is None:
            return m.MAV_RESULT_UNSUPPORTED
        self._sim.inject(unit, kind != m.FAILURE_TYPE_OK)
        return m.MAV_RESULT_ACCEPTED


def _from_base(base: int) -> tuple[int, int]:
    """Return the custom mode that PX4 takes a plain base mode for."""
    if base & m.MAV_MODE_FLAG_AUTO_ENABLED:
        return 4, 4
    if base & m.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED and base & m.MAV_MODE_FLAG_GUIDED_ENABLED:
        return 3, 0
    return (7, 0) if base & m.MAV_MODE_FLAG_STABILIZE_ENABLED else (1, 0)


def _result(verdict: Verdict) -> int:
    return m.MAV_RESULT_ACCEPTED if verdict.ok else m.MAV_RESULT_TEMPORARILY_REJECTED
