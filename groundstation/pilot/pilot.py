"""One tick of the operator's side of the paper (section 3.1), pure: no clock, no devices, no bus.

Memory and inputs go in, memory and outputs come out. The servo calls it in real time, an evaluation in
virtual time, and both fly the same.
"""

from __future__ import annotations

from typing import NamedTuple

from drivers.device import ZERO3, DeviceInfo, HandleState, Vector3
from drivers.vectors import slewed
from groundstation.config import Settings
from groundstation.frames import Vector4
from groundstation.messages import Phase
from groundstation.pilot.controller import check_gains, position_error, velocity_reference
from groundstation.pilot.feedback import hand_force, position_force, scaled
from groundstation.pilot.limits import SetpointLimiter, SetpointMotion
from groundstation.pilot.mapping import RateMapping, advance, leashed
from groundstation.pilot.passivity import Port, observed, passive, passive_gains, physical_damping
from groundstation.pilot.sight import ZERO4, Sight, VehicleSample, look

# A force that must go is gone after this, whatever the device's limit: safely within 100 ms.
FADE_S = 0.08


class Inputs(NamedTuple):
    """What one tick is made from; all numbers finite, as the engagement sees to.

    Attributes:
        dt: Since the last tick, s.
        phase: How far the hand is coupled.
        cut: No force from this very tick on, not even a fading one.
        hand: The handle.
        vehicle: The newest sample of the vehicle.
        state_age: Its age, s.
    """

    dt: float
    phase: Phase
    cut: bool
    hand: HandleState
    vehicle: VehicleSample
    state_age: float


class Memory(NamedTuple):
    """What one tick leaves to the next.

    Attributes:
        sight: Of the vehicle.
        p_h: Where the hand wants the drone, world, m and rad.
        motion: Of the setpoint, within limits.
        presence: Share of the force that is rendered; it grows after engaging.
        port: Account of the haptic port's energy; with the force on the hand.
        coupled: The last tick was an engaged one.
    """

    sight: Sight = Sight()
    p_h: Vector4 = ZERO4
    motion: SetpointMotion = SetpointMotion()
    presence: float = 0.0
    port: Port = Port()
    coupled: bool = False


class Outputs(NamedTuple):
    """What one tick says and does.

    Attributes:
        setpoint: For the vehicle: v_ref within limits, vehicle's axes, m/s and rad/s.
        port: The haptic port with the force for the hand.
        p: Where the vehicle is at this tick, world, m and rad; see `groundstation.pilot.sight`.
        p_h, p_h_rate, error, v_ref: The terms of equation (4).
        position_force: Equation (5) as it stands, world, N.
        on_leash: p_h wanted to go further from the vehicle than it may.
    """

    setpoint: Vector4
    port: Port
    p: Vector4
    p_h: Vector4
    p_h_rate: Vector4
    error: Vector4
    v_ref: Vector4
    position_force: Vector3
    on_leash: bool

    @property
    def force(self) -> Vector3:
        """For the hand, handle frame, N: within the device's limit, slewed, ramped and passive."""
        return self.port.force


class Pilot:
    """The controller with its settings; it keeps no state of its own.

    Args:
        settings: Mapping, gains, limits, staleness.
        device: The device in hand.

    Attributes:
        gains: Stiffness and damping as set, or less where the device does not render so much passively.

    Raises:
        ValueError: A gain is not positive and finite.
    """

    def __init__(self, settings: Settings, device: DeviceInfo) -> None:
        check_gains("control.k1", settings.control.k1)
        check_gains("control.stiffness", settings.control.stiffness)
        self.mapping = RateMapping(settings.mapping, device.workspace)
        self._limiter = SetpointLimiter(settings.limits)
        self._settings = settings
        self._force_limit = device.force_limit
        self._passive = settings.control.passivity and device.renders == "force"
        self._damping_limit = physical_damping(device)
        self.gains = passive_gains(settings, device)

    def step(self, memory: Memory, inputs: Inputs) -> tuple[Memory, Outputs]:
        """Run one tick.

        While not engaged, p_h stays with the vehicle, the setpoint is zero and the force fades. The limiter
        begins at zero, for that is the setpoint the vehicle has been given until then, however it may drift.

        Args:
            memory: Of the tick before; `Memory()` at the start.
            inputs: Of this tick.

        Returns:
            Memory for the next tick, and what to do in this one.

        Raises:
            ValueError: An input that an engaged tick depends on is not finite.
        """
        sight, p = look(memory.sight, inputs.vehicle, inputs.state_age, inputs.dt)
        port = observed(memory.port, inputs.hand.position)
        if inputs.phase is not Phase.ENGAGED:
            port = self._held(port, self._faded(port.force, inputs.dt), inputs)
            idle = Outputs(ZERO4, port, p, p, ZERO4, ZERO4, ZERO4, ZERO3, on_leash=False)
            return Memory(sight, p_h=p, port=port), idle
        mapping, hand, yaw = self._settings.mapping, inputs.hand, p[3]
        rate = self.mapping.rate(hand.position, hand.yaw, yaw)
        wished = advance(memory.p_h if memory.coupled else p, rate, inputs.dt)
        p_h, on_leash = leashed(wished, p, mapping.leash, mapping.leash_yaw)
        error = position_error(p_h, p)
        v_ref = velocity_reference(rate, error, yaw, self._settings.control.k1)
        motion, setpoint = self._limiter.step(memory.motion, v_ref, inputs.dt)
        pull = position_force(error, self.gains.stiffness)
        presence, wanted = self._rendered(memory.presence, port.force, inputs, pull, yaw)
        port = self._held(port, wanted, inputs)
        outputs = Outputs(setpoint, port, p, p_h, rate, error, v_ref, pull, on_leash)
        return Memory(sight, p_h, motion, presence, port, coupled=True), outputs

    def _rendered(
        self, presence: float, force: Vector3, inputs: Inputs, pull: Vector3, vehicle_yaw: float
    ) -> tuple[float, Vector3]:
        """Return the force's presence and the force: it comes in gently and leaves with a stale state."""
        dt, settings = inputs.dt, self._settings
        if not inputs.state_age <= settings.safety.force_stale_s:
            return 0.0, self._faded(force, dt)
        presence = min(1.0, presence + dt / settings.limits.force_ramp_s)
        turn = self.mapping.turn(vehicle_yaw)
        wanted = hand_force(pull, turn, inputs.hand.velocity, self.gains.damping, self._force_limit)
        return presence, slewed(force, scaled(wanted, presence), settings.limits.force_slew * dt)

    def _held(self, port: Port, wanted: Vector3, inputs: Inputs) -> Port:
        """Return the port with the force that the hand is given until the next tick."""
        if inputs.cut:
            return port._replace(force=ZERO3)
        if not self._passive:
            return port._replace(force=wanted)
        return passive(port, wanted, inputs.hand.velocity, inputs.dt, self._damping_limit)

    def _faded(self, force: Vector3, dt: float) -> Vector3:
        """Let a force go, at a rate that takes the device's strongest to nothing in `FADE_S`."""
        return force if force == ZERO3 else slewed(force, ZERO3, self._force_limit * dt / FADE_S)
