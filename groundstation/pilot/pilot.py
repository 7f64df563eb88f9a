"""One tick of the operator's side of the paper (section 3.1), pure: no clock, no devices, no bus.

Memory and inputs go in, memory and outputs come out. The servo calls it in real time, an evaluation in
virtual time, and both fly the same.
"""

from __future__ import annotations

from math import isfinite
from typing import Any, NamedTuple

from drivers.device import ZERO3, DeviceInfo, Vector3
from drivers.vectors import slewed
from groundstation.config import Settings
from groundstation.failsafe import late
from groundstation.frames import Vector4
from groundstation.messages import MappingMode, Phase
from groundstation.pilot.controller import (
    Controller,
    Law,
    PaperController,
    View,
    check_gains,
    position_error,
    world_rates,
)
from groundstation.pilot.feedback import CueForces, Feedback, Felt, hand_force, scaled
from groundstation.pilot.forecast import Forecast, Forecaster, noted
from groundstation.pilot.guest import ControllerError
from groundstation.pilot.guidance import NOWHERE, guidance_for
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.link_state import shares
from groundstation.pilot.passivity.choice import passivity_named
from groundstation.pilot.passivity.gains import Gains, passive_gains
from groundstation.pilot.passivity.port import Port, looked
from groundstation.pilot.presets import PRESETS
from groundstation.pilot.reference import Reference, ReferenceGenerator
from groundstation.pilot.setpoint import Commanded, Commanding, SetpointMaker, Terms
from groundstation.pilot.shield.nearby import nearest
from groundstation.pilot.sight import ZERO4, Sight, VehicleSample, look
from groundstation.pilot.surroundings import NOTHING_KNOWN, Surroundings

# A force that must go is gone after this, whatever the device's limit: safely within 100 ms.
FADE_S = 0.08
# No vehicle is further from where it was armed, m, nor flies or turns faster, m/s and rad/s.
_FURTHEST, _FASTEST = 1e6, 100.0


class Memory(NamedTuple):
    """What one tick leaves to the next.

    Attributes:
        sight: Of the vehicle.
        forecast: Of it.
        reference: p_h and ṗ_h.
        state: The controller's own.
        terms: Under which the last tick was flown.
        commanding: Of guard, limits and compensation.
        presence: Share of the force that is rendered; it grows after engaging.
        port: Account of the haptic port's energy; with the force on the hand.
        station: How far along the mission's way the vehicle is, m.
        coupled: The last tick was an engaged one.
    """

    sight: Sight = Sight()
    forecast: Forecast = Forecast()
    reference: Reference = Reference()
    state: Any = None
    terms: Terms | None = None
    commanding: Commanding = Commanding()
    presence: float = 0.0
    port: Port = Port()
    station: float = NOWHERE
    coupled: bool = False


class Outputs(NamedTuple):
    """What one tick says and does.

    Attributes:
        setpoint: For the vehicle, vehicle's axes, m/s and rad/s.
        port: The haptic port with the force for the hand.
        p: Where the vehicle is seen at this tick, world, m and rad; see `groundstation.pilot.sight`.
        reference: p_h and ṗ_h.
        error: p̃, world, m and rad.
        law: What the controller answers: v_ref and force, equations (4) and (5).
        commanded: What guard, limits and compensation make of v_ref.
        cues: The parts of the force.
        forecast: Where the vehicle will be.
        terms: Gains, delay and shares that this tick is flown with; None while it is not flown.
        fault: Why this tick could not be flown, in words; then the setpoint is zero and the force fades.
    """

    setpoint: Vector4
    port: Port
    p: Vector4
    reference: Reference
    error: Vector4 = ZERO4
    law: Law = Law(ZERO4, ZERO3)
    commanded: Commanded = Commanded()
    cues: CueForces = CueForces()
    forecast: Forecast = Forecast()
    terms: Terms | None = None
    fault: str = ""

    @property
    def force(self) -> Vector3:
        """For the hand, handle frame, N: within the device's limit, slewed, ramped and passive."""
        return self.port.force

    @property
    def p_h(self) -> Vector4:
        """Where the hand wants the drone, world, m and rad."""
        return self.reference.p_h

    @property
    def p_h_rate(self) -> Vector4:
        """ṗ_h, world, m/s and rad/s."""
        return self.reference.rate

    @property
    def on_leash(self) -> bool:
        """p_h wanted to go further from the vehicle than it may."""
        return self.reference.on_leash

    @property
    def v_ref(self) -> Vector4:
        """What the controller asks for, vehicle's axes, m/s and rad/s."""
        return self.law.v_ref

    @property
    def v_safe(self) -> Vector4:
        """The same after the guard."""
        return self.commanded.safe

    @property
    def position_force(self) -> Vector3:
        """Equation (5) as it stands, world, N."""
        return self.law.force


class Pilot:
    """The controller with its settings; it keeps no state of its own.

    Args:
        settings: Mapping, gains, limits, staleness.
        device: The device in hand.
        surroundings: What is known of vehicle and world.
        controller: The paper's unless given.

    Attributes:
        gains: Of each `MappingMode` as set, or less where the device does not render so much passively.

    Raises:
        ValueError: A gain is not positive and finite.
    """

    def __init__(
        self,
        settings: Settings,
        device: DeviceInfo,
        surroundings: Surroundings = NOTHING_KNOWN,
        controller: Controller | None = None,
    ) -> None:
        check_gains("control.k1", settings.control.k1)
        check_gains("control.stiffness", settings.control.stiffness)
        self._settings = settings
        self._force_limit = device.force_limit
        self._passivity = passivity_named(settings.control.passivity, device)
        self.gains: tuple[Gains, ...] = tuple(passive_gains(settings, device, mode) for mode in MappingMode)
        self._feedback = tuple(Feedback(settings.cues, gains.damping) for gains in self.gains)
        self._references = ReferenceGenerator(settings.mapping, settings.limits, device.workspace)
        self._forecaster = Forecaster(surroundings.chi)
        self._controller: Controller = controller or PaperController()
        self._setpoints = SetpointMaker(settings, surroundings)
        self._guidance = guidance_for(settings, surroundings, device)

    def step(self, memory: Memory, inputs: Inputs) -> tuple[Memory, Outputs]:
        """Run one tick.

        While not engaged, or where anything that the tick depends on is not a finite number or too old, p_h stays
        with the vehicle, the setpoint is zero and the force fades. The limiter begins at zero, for that is the
        setpoint the vehicle has been given until then, however it may drift.

        Args:
            memory: Of the tick before; `Memory()` at the start.
            inputs: Of this tick.

        Returns:
            Memory for the next tick, and what to do in this one.
        """
        port = self._passivity.observed(memory.port, inputs.hand.position)
        port = looked(port, inputs.hand.device_time, inputs.dt)
        fault = self._fault(inputs, memory.sight.sample)
        sight, p = memory.sight, memory.reference.p_h
        if not fault:
            sight, p = look(sight, inputs.vehicle, inputs.state_age, inputs.dt)
            if inputs.phase is Phase.ENGAGED:
                try:
                    return self._flown(memory, inputs, sight, p, port)
                except ControllerError as error:
                    fault = str(error)
        port = self._held(port, self._faded(port.force, inputs.dt), inputs)
        reference = self._references.begun(p, inputs.hand, inputs.choices)
        idle = Outputs(ZERO4, port, p, reference, forecast=Forecast(p=p), fault=fault)
        return Memory(sight, reference=reference, port=port), idle

    def stop(self, outputs: Outputs) -> Vector3:
        """Return where the vehicle would come to rest if the handle went to its centre now, world, m."""
        return self._setpoints.stop(outputs.forecast, compensated=outputs.commanded.compensated)

    def _fault(self, inputs: Inputs, seen: VehicleSample | None) -> str:
        """Return in words why nothing can be flown on these inputs, or "".

        Args:
            inputs: Of the tick.
            seen: The last sample that was sound.
        """
        (x, y, z), (u, v, w), yaw, *_ = inputs.hand
        # What is not finite stays so in a sum.
        if not isfinite(x + y + z + u + v + w + yaw + inputs.dt):
            return "the handle gave a number that is not finite"
        if inputs.vehicle is not seen and not _can_be(inputs.vehicle):
            return "the vehicle gave a number that cannot be"
        if inputs.phase is Phase.ENGAGED and not inputs.state_age <= self._settings.safety.state_stale_s:
            return f"the vehicle's position is {inputs.state_age:.1f} s old"
        return ""

    def _flown(
        self, memory: Memory, inputs: Inputs, sight: Sight, p: Vector4, port: Port
    ) -> tuple[Memory, Outputs]:
        """Run an engaged tick."""
        choices = inputs.choices
        terms = self._terms(memory, inputs)
        begin = memory.reference if memory.coupled else self._references.begun(p, inputs.hand, choices)
        reference = self._references.step(begin, inputs.hand, choices, p, dt=inputs.dt, share=terms.speed)
        forecast = self._forecaster.look(
            memory.forecast, inputs.vehicle, inputs.state_age, terms.delay, inputs.dt
        )
        view = self._view(inputs, reference, p, forecast, terms)
        state = memory.state if memory.coupled else self._controller.start()
        state, law = self._controller.step(state, view)
        commanding, commanded = self._setpoints.step(memory.commanding, law.v_ref, forecast, inputs, terms)
        cues, station = self._cues(inputs, law, commanded, p[3], terms), NOWHERE
        if self._guidance is not None:
            station, guidance = self._guided(memory.station, inputs, reference, p, terms)
            cues = cues._replace(guidance=guidance)
        presence, wanted = self._rendered(memory.presence, port.force, inputs, cues, p[3])
        port = self._held(port, wanted, inputs)
        forecast = noted(forecast, commanded.setpoint)
        outputs = Outputs(
            commanded.setpoint, port, p, reference, view.error, law, commanded, cues, forecast, terms
        )
        return Memory(
            sight, forecast, reference, state, terms, commanding, presence, port, station, coupled=True
        ), outputs

    def _terms(self, memory: Memory, inputs: Inputs) -> Terms:
        """Return the terms under which this tick is flown; they change with the link and the preset only."""
        known, preset = memory.terms, inputs.choices.preset
        if known and known.told == (inputs.delay, inputs.loss, preset):
            return known
        link = self._settings.link
        delay = inputs.delay if isfinite(inputs.delay) else link.assumed_delay_s
        assistance = PRESETS[preset]
        left = shares(inputs.delay, inputs.loss, link)
        loop = self._setpoints.loop(known, delay, assistance)
        told = (inputs.delay, inputs.loss, preset)
        return Terms(told, delay, assistance, loop, left, left.speed * assistance.speed)

    def _view(
        self, inputs: Inputs, reference: Reference, p: Vector4, forecast: Forecast, terms: Terms
    ) -> View:
        return View(
            inputs.dt,
            reference.p_h,
            reference.rate,
            p,
            inputs.vehicle.velocity,
            position_error(reference.p_h, p),
            terms.delay,
            terms.loop.k1,
            scaled(self.gains[inputs.choices.mapping].stiffness, terms.link.gain),
            forecast.p,
            forecast.velocity,
        )

    def _cues(self, inputs: Inputs, law: Law, commanded: Commanded, yaw: float, terms: Terms) -> CueForces:
        """Return the parts of the force. The link's share is in equation (5) already, by its stiffness."""
        choices, vehicle, weights = inputs.choices, inputs.vehicle, terms.assistance.weights
        guarded = mismatch = ZERO3
        if commanded.by:
            (a, b, c, d), (e, f, g, h) = commanded.safe, law.v_ref
            x, y, z, _ = world_rates((a - e, b - f, c - g, d - h), yaw)
            guarded = (x, y, z)
        if weights.mismatch:
            x, y, z, _ = world_rates(commanded.then, vehicle.position[3])
            u, v, w, _ = vehicle.velocity
            mismatch = (u - x, v - y, w - z)
        felt = Felt(law.force, nearest(commanded.near), mismatch, guarded, inputs.hand.velocity)
        share = terms.link.gain * self.gains[choices.mapping].share
        return self._feedback[choices.mapping].cues(felt, weights, choices.cues, share)

    def _guided(
        self, station: float, inputs: Inputs, reference: Reference, p: Vector4, terms: Terms
    ) -> tuple[float, Vector3]:
        """Return how far along the mission's way the vehicle is, and what of the force leads there."""
        assert self._guidance is not None
        turn = self._references.by_rate.turn(p[3])
        share = terms.assistance.weights.guidance * terms.link.gain * self.gains[inputs.choices.mapping].share
        return self._guidance.look(station, inputs, p, turn, 0.0 if reference.waiting else share)

    def _rendered(
        self, presence: float, force: Vector3, inputs: Inputs, cues: CueForces, vehicle_yaw: float
    ) -> tuple[float, Vector3]:
        """Return the force's presence and the force: it comes in gently and leaves with a stale state."""
        dt, settings = inputs.dt, self._settings
        if late(inputs.state_age, settings.safety):
            return 0.0, self._faded(force, dt)
        presence = min(1.0, presence + dt / settings.limits.force_ramp_s)
        wanted = hand_force(cues, self._references.by_rate.turn(vehicle_yaw), self._force_limit)
        return presence, slewed(force, scaled(wanted, presence), settings.limits.force_slew * dt)

    def _held(self, port: Port, wanted: Vector3, inputs: Inputs) -> Port:
        """Return the port with the force that the hand is given until the next tick."""
        if inputs.cut:
            return port._replace(force=ZERO3)
        return self._passivity.rendered(port, wanted, inputs.hand.velocity, inputs.dt, inputs.delay)

    def _faded(self, force: Vector3, dt: float) -> Vector3:
        """Let a force go, at a rate that takes the device's strongest to nothing in `FADE_S`."""
        return force if force == ZERO3 else slewed(force, ZERO3, self._force_limit * dt / FADE_S)


def _can_be(sample: VehicleSample) -> bool:
    """Say whether a sample's numbers are ones that a vehicle can mean. Comparisons with what is none are false."""
    position, velocity = sample
    return all(abs(place) <= _FURTHEST for place in position) and all(
        abs(rate) <= _FASTEST for rate in velocity
    )
