"""From the controller's v_ref to the setpoint: guard, limits, and compensation of the vehicle's response."""

from __future__ import annotations

from math import hypot, radians
from typing import NamedTuple

from drivers.device import Vector3
from groundstation.config import Settings
from groundstation.frames import Vector4
from groundstation.messages import Preset
from groundstation.pilot.compensation import Compensation, lagged
from groundstation.pilot.forecast import Forecast
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.limits import SetpointLimiter, SetpointMotion
from groundstation.pilot.link_state import Shares
from groundstation.pilot.margin import COMPENSATED, USUAL_LAGS, Lags, Loop, lags_of, loop_for
from groundstation.pilot.presets import Assistance
from groundstation.pilot.shield.barrier import Barrier
from groundstation.pilot.shield.guard import Guard, Off, Situation
from groundstation.pilot.shield.nearby import Candidates, Near, Neighbourhood
from groundstation.pilot.shield.risk_field import RiskField
from groundstation.pilot.sight import ZERO4
from groundstation.pilot.surroundings import Surroundings

# Gains are reckoned anew when the delay has changed by more, s.
_CHANGED_S = 0.002
# Beside the round trip: a setpoint waits for its turn, and so does telemetry, half of each period on average.
_SAMPLING_S = 0.02


class Terms(NamedTuple):
    """Under which a tick is flown.

    Attributes:
        told: What they follow from: round trip, s, loss and preset.
        delay: Round trip, s: measured, or what is assumed until then.
        assistance: The preset's.
        loop: Gains that the delay leaves.
        link: What the link leaves of gains and speeds.
        speed: Share of the speeds that link and preset leave, 0 to 1.
    """

    told: tuple[float, float, Preset]
    delay: float
    assistance: Assistance
    loop: Loop
    link: Shares
    speed: float


class Commanding(NamedTuple):
    """What one tick leaves to the next.

    Attributes:
        motion: Of v_c, within limits.
        then: v_c about a round trip ago.
        candidates: What may be near.
    """

    motion: SetpointMotion = SetpointMotion()
    then: Vector4 = ZERO4
    candidates: Candidates = Candidates()


class Commanded(NamedTuple):
    """What becomes of v_ref; vehicle's axes, m/s and rad/s.

    Attributes:
        safe: After the guard.
        meant: v_c, that within limits: the velocity that the vehicle is meant to have.
        setpoint: What is sent, so that it has it.
        then: v_c about a round trip ago: what the vehicle was told as it was last seen.
        by: What the guard keeps away from, or "".
        near: What is near where the vehicle will be.
        loop: Gains that the delay leaves.
        compensated: The vehicle's response is compensated.
    """

    safe: Vector4 = ZERO4
    meant: Vector4 = ZERO4
    setpoint: Vector4 = ZERO4
    then: Vector4 = ZERO4
    by: str = ""
    near: tuple[Near, ...] = ()
    loop: Loop | None = None
    compensated: bool = False


class SetpointMaker:
    """Makes setpoints.

    Args:
        settings: Shield, limits, gains.
        surroundings: What is known of vehicle and world.
    """

    def __init__(self, settings: Settings, surroundings: Surroundings) -> None:
        self._control = settings.control
        self._margin = radians(settings.control.phase_margin_deg)
        self._limiter = SetpointLimiter(settings.limits)
        self._acceleration = settings.limits.acceleration
        chi = surroundings.chi
        wanted = chi if settings.control.compensation else None
        self._compensation = Compensation(wanted, settings.control.k4) if wanted else None
        bare = lags_of(chi) if chi else USUAL_LAGS
        self._lags: dict[bool, Lags] = {False: bare, True: COMPENSATED}
        self._guards = {on: _guard(settings, lags) for on, lags in self._lags.items()}
        self._neighbourhood = Neighbourhood(surroundings, settings.shield)
        self._felt = settings.cues.reach
        self._off = Off()

    def loop(self, before: Terms | None, delay: float, assistance: Assistance) -> Loop:
        """Return the gains that a delay leaves.

        Args:
            before: Of the tick before, if it was flown.
            delay: Round trip, s.
            assistance: Whether the response is compensated.
        """
        total = delay + _SAMPLING_S
        compensated = self._compensates(assistance)
        same = before is not None and compensated is self._compensates(before.assistance)
        if before and same and abs(before.loop.delay - total) < _CHANGED_S:
            return before.loop
        control = self._control
        return loop_for(total, control.k1, control.k3, self._margin, self._lags[compensated])

    def step(
        self, before: Commanding, v_ref: Vector4, forecast: Forecast, inputs: Inputs, terms: Terms
    ) -> tuple[Commanding, Commanded]:
        """Make the setpoint of a tick.

        Args:
            before: Of the tick before.
            v_ref: The controller's, vehicle's axes, m/s and rad/s.
            forecast: Where the vehicle will be as it arrives.
            inputs: Of the tick.
            terms: Under which it is flown.
        """
        _, _, assistance, loop, _, speed = terms
        compensates = self._compensates(assistance)
        guard = self._guards[compensates] if assistance.guard else self._off
        velocity = forecast.velocity
        # What pushes the vehicle makes it no faster than by that much a second, within a lag.
        speed_now = max(hypot(*velocity), hypot(v_ref[0], v_ref[1], v_ref[2])) + hypot(*forecast.push)
        reach = max(guard.reach(speed_now), self._felt * (assistance.weights.environment > 0.0))
        candidates, near = self._neighbourhood.look(before.candidates, forecast.p[:3], inputs.seen, reach)
        safe, by = guard.guard(v_ref, Situation(near, velocity, forecast.p[3], forecast.push))
        # Limits are on the motion in space, which stays as it is while the vehicle turns.
        motion = self._limiter.turned(before.motion, forecast.v[3] * inputs.dt)
        motion, meant = self._limiter.step(motion, safe, inputs.dt, speed)
        then = lagged(before.then, meant, loop.delay, inputs.dt) if assistance.weights.mismatch else meant
        setpoint = self._compensated(motion, meant, forecast, loop) if compensates else meant
        after = Commanding(motion, then, candidates)
        return after, Commanded(safe, meant, setpoint, then, by, near, loop, compensates)

    def stop(self, forecast: Forecast, *, compensated: bool) -> Vector3:
        """Return where a vehicle that is told to stop now comes to rest, world, m."""
        x, y, z = forecast.velocity
        slowest = max(lag.time for lag in self._lags[compensated][:3])
        way = slowest + hypot(x, y, z) / (2.0 * self._acceleration)
        return forecast.p[0] + way * x, forecast.p[1] + way * y, forecast.p[2] + way * z

    def _compensates(self, assistance: Assistance) -> bool:
        return assistance.compensation and self._compensation is not None

    def _compensated(self, motion: SetpointMotion, meant: Vector4, forecast: Forecast, loop: Loop) -> Vector4:
        """Return the reference that gives the vehicle the velocity it is meant to have, within the speed limits."""
        assert self._compensation is not None
        (plane, up, yaw), (u, v, w, yaw_rate) = motion, forecast.v
        error = (meant[0] - u, meant[1] - v, meant[2] - w, meant[3] - yaw_rate)
        # On axes that turn, a velocity changes by −ω × v beside what accelerates it in space.
        push = plane.acceleration - complex(0.0, yaw_rate) * plane.velocity
        acceleration = (push.real, push.imag, up.acceleration.real, yaw.acceleration.real)
        reference = self._compensation.reference(meant, acceleration, error, yaw_rate, loop.k3)
        return self._limiter.capped(reference)


def _guard(settings: Settings, lags: Lags) -> Guard:
    if settings.shield.guard == "barrier":
        return Barrier(settings.shield, settings.limits, lags)
    return RiskField(settings.shield, settings.limits) if settings.shield.guard == "risk_field" else Off()
