"""Pilot.step in virtual time: by itself, and closed round a plain first-order plant."""

from collections.abc import Callable
from itertools import pairwise
from math import atanh, dist, exp, hypot, inf, isfinite, nan, pi, sin, tau

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceInfo, HandleState
from groundstation.config import Control, Mapping, Settings
from groundstation.messages import Phase
from groundstation.pilot.controller import position_error, world_rates
from groundstation.pilot.passivity.port import Port
from groundstation.pilot.pilot import Inputs, Memory, Outputs, Pilot
from groundstation.pilot.sight import VehicleSample

DT = 0.001
INFO = DeviceInfo("test", "", 4, 0.1, 10.0, 1000.0, 1000.0, "force")
SETTINGS = Settings()


def hand(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0) -> HandleState:
    return HandleState((x, y, z), ZERO3, yaw, 0, homed=True, device_time=0.0)


class Flight:
    """A drone whose velocity follows the setpoint with a lag of 0.3 s, seen at 50 Hz; and wind; and walls."""

    LAG, TELEMETRY = 0.3, 20

    def __init__(self, settings: Settings = SETTINGS, yaw: float = 0.0) -> None:
        self.pilot = Pilot(settings, INFO)
        self.memory = Memory()
        self.p = (1.0, -2.0, 3.0, yaw)
        self.v = (0.0, 0.0, 0.0, 0.0)
        self.wind = (0.0, 0.0, 0.0, 0.0)
        self.blocked = False
        self.telemetry = True
        self.phase = Phase.ENGAGED
        self.cut = False
        self.age = 0.0
        self.sample = VehicleSample(self.p, (0.0, 0.0, 0.0, 0.0))
        self.tick = 0

    def step(self, handle: HandleState) -> Outputs:
        if self.telemetry and self.tick % self.TELEMETRY == 0:
            moving = tuple(a + b for a, b in zip(world_rates(self.v, self.p[3]), self.wind, strict=True))
            self.sample, self.age = VehicleSample(self.p, (0.0,) * 4 if self.blocked else moving), 0.0
        handle = handle._replace(device_time=self.tick * DT)
        inputs = Inputs(DT, self.phase, self.cut, handle, self.sample, self.age)
        self.memory, outputs = self.pilot.step(self.memory, inputs)
        self.v = tuple(
            v + (1 - exp(-DT / self.LAG)) * (r - v) for v, r in zip(self.v, outputs.setpoint, strict=True)
        )
        if not self.blocked:
            rates = world_rates(self.v, self.p[3])
            self.p = tuple(p + (r + w) * DT for p, r, w in zip(self.p, rates, self.wind, strict=True))
        self.tick += 1
        self.age += DT
        return outputs

    def run(self, seconds: float, handle: HandleState | Callable[[float], HandleState]) -> list[Outputs]:
        ticks = range(round(seconds / DT))
        return [self.step(handle(tick * DT) if callable(handle) else handle) for tick in ticks]


def test_the_drone_follows_the_hand_and_settles_where_p_h_stops() -> None:
    flight = Flight()
    start = flight.p
    flying = flight.run(4.0, hand(x=0.05))[-1]
    # Half the travel: (0.5 − 0.05)/0.95 past the deadband, with expo 0.3, of 2 m/s.
    s = 0.45 / 0.95
    speed = 2.0 * (0.7 * s + 0.3 * s**3)
    assert flying.p_h_rate == pytest.approx((speed, 0.0, 0.0, 0.0))
    assert world_rates(flight.v, flight.p[3])[0] == pytest.approx(speed, rel=0.02)
    settled = flight.run(6.0, hand())[-1]
    assert settled.error == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=5e-3)
    assert flight.v == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=5e-3)
    assert settled.force == pytest.approx(ZERO3, abs=0.02)
    assert flight.p[0] - start[0] == pytest.approx(4.0 * speed, abs=0.05)


def test_turning_the_handle_turns_the_drone_through_the_seam_of_the_yaw() -> None:
    flight = Flight(yaw=pi - 0.2)
    flight.run(2.0, hand(yaw=1.0))
    settled = flight.run(6.0, hand())[-1]
    assert settled.error[3] == pytest.approx(0.0, abs=5e-3)
    assert flight.p[3] == pytest.approx(pi - 0.2 + 2.0 * 0.8, abs=0.05)
    assert settled.p_h[3] == pytest.approx(flight.p[3] - tau, abs=0.01)


def test_wind_is_held_and_felt_in_its_own_direction() -> None:
    flight = Flight()
    flight.wind = (0.6, 0.0, 0.0, 0.0)
    held = flight.run(12.0, hand())[-1]
    # At rest K₁ tanh(p̃) = −wind: p̃ = −atanh(0.6/1.2) = −0.549 m, so f = −4 · −0.549 = +2.197 N.
    assert held.error[0] == pytest.approx(-atanh(0.5), abs=2e-3)
    assert held.position_force[0] == pytest.approx(4.0 * atanh(0.5), abs=1e-2)
    assert held.force == pytest.approx((4.0 * atanh(0.5), 0.0, 0.0), abs=1e-2)


def test_in_the_heading_frame_the_hand_feels_the_same_wind_from_the_side() -> None:
    flight = Flight(Settings(mapping=Mapping(frame="heading")), yaw=pi / 2)
    flight.wind = (0.6, 0.0, 0.0, 0.0)
    force = flight.run(12.0, hand())[-1].force
    # Looking north, a wind to the east blows to the right: −y of the handle.
    assert force == pytest.approx((0.0, -4.0 * atanh(0.5), 0.0), abs=1e-2)
    world = Flight(Settings(mapping=Mapping(frame="world")), yaw=pi / 2)
    world.wind = flight.wind
    assert world.run(12.0, hand())[-1].force == pytest.approx((4.0 * atanh(0.5), 0.0, 0.0), abs=1e-2)


def test_a_blocked_drone_gives_a_growing_then_constant_force_and_winds_nothing_up() -> None:
    flight = Flight()
    flight.blocked = True
    pushing = flight.run(5.0, hand(x=0.1))
    forces = [outputs.force[0] for outputs in pushing]
    assert all(after <= before + 1e-9 for before, after in pairwise(forces))
    leash = SETTINGS.mapping.leash
    assert forces[-1] == forces[-1000] == pytest.approx(-4.0 * leash)
    assert pushing[-1].on_leash
    assert dist(pushing[-1].p_h[:3], flight.p[:3]) == pytest.approx(leash)
    # Giving way is felt at once: nothing has to be unwound first.
    yielding = flight.run(0.1, hand(x=-0.1))
    assert not yielding[-1].on_leash
    assert yielding[-1].force[0] > forces[-1] + 0.5


def test_on_engaging_p_h_starts_at_p_and_the_force_comes_in_from_zero() -> None:
    flight = Flight()
    flight.phase = Phase.ENGAGING
    waiting = flight.run(0.5, hand(x=0.1))[-1]
    assert waiting.setpoint == waiting.v_ref == (0.0, 0.0, 0.0, 0.0)
    assert waiting.force == ZERO3
    assert waiting.p_h == waiting.p
    flight.phase = Phase.ENGAGED
    first = flight.step(hand())
    assert first.error == (0.0, 0.0, 0.0, 0.0)
    assert first.setpoint == (0.0, 0.0, 0.0, 0.0)


def test_the_ramp_holds_the_force_back_for_its_time() -> None:
    flight = Flight()
    flight.step(hand())
    reference = flight.memory.reference._replace(p_h=(0.0, -2.0, 3.0, 0.0))
    flight.memory = flight.memory._replace(reference=reference, presence=0.0)
    flight.blocked = True
    forces = [hypot(*outputs.force) for outputs in flight.run(0.2, hand())]
    for tick, force in enumerate(forces[:100]):
        assert force <= 4.0 * (tick + 1) / 100 + 1e-9
    assert forces[-1] == pytest.approx(4.0)


def pulled() -> Flight:
    flight = Flight()
    flight.blocked = True
    flight.run(3.0, hand(x=0.1))
    assert hypot(*flight.memory.port.force) > 5.0
    return flight


def test_a_stale_state_lets_the_force_fade_within_100_ms_and_come_back_gently() -> None:
    flight = pulled()
    flight.age = 0.0
    flight.telemetry = False
    forces = [hypot(*outputs.force) for outputs in flight.run(0.3, hand(x=0.1))]
    assert forces[95] == pytest.approx(6.0, abs=0.01)
    assert forces[202:] == [0.0] * 98
    assert all(abs(b - a) <= SETTINGS.limits.force_slew * DT + 1e-9 for a, b in pairwise(forces))
    flight.telemetry = True
    flight.tick = 0
    back = [hypot(*outputs.force) for outputs in flight.run(0.2, hand(x=0.1))]
    assert back[0] < 0.1
    assert back[-1] == pytest.approx(6.0, abs=0.01)


def test_disengaging_stops_the_setpoint_at_once_and_lets_the_force_go_within_100_ms() -> None:
    flight = pulled()
    flight.phase = Phase.DISENGAGED
    outputs = flight.run(0.1, hand(x=0.1))
    assert all(output.setpoint == (0.0, 0.0, 0.0, 0.0) for output in outputs)
    assert 0.0 < hypot(*outputs[0].force) < 6.0
    assert outputs[-1].force == ZERO3


@pytest.mark.parametrize("phase", list(Phase))
def test_a_cut_leaves_no_force_in_the_very_same_tick(phase: Phase) -> None:
    flight = pulled()
    flight.phase, flight.cut = phase, True
    assert flight.step(hand(x=0.1)).force == ZERO3


def test_what_is_not_finite_flies_nothing_and_presses_on_nothing() -> None:
    for phase in Phase:
        flight = Flight()
        flight.phase = phase
        for broken in (hand(x=nan), hand(yaw=inf), hand(y=-inf)):
            held = flight.step(broken)
            assert held.setpoint == (0.0, 0.0, 0.0, 0.0)
            assert held.force == ZERO3
            assert held.fault == "the handle gave a number that is not finite"
        flight.sample = VehicleSample((0.0, nan, 0.0, 0.0))
        flight.telemetry = False
        assert flight.step(hand(x=0.1)).fault == "the vehicle gave a number that cannot be"
        # What came before is not spoilt: the next sound tick flies again.
        flight.telemetry, flight.tick = True, 0
        sound = flight.run(0.5, hand(x=0.1))[-1]
        assert not sound.fault
        assert all(map(isfinite, (*sound.setpoint, *sound.force, *sound.p_h)))
        assert (sound.setpoint[0] > 0.5) is (phase is Phase.ENGAGED)


def test_a_position_too_old_to_fly_by_gives_a_zero_setpoint() -> None:
    flight = Flight()
    assert flight.run(1.0, hand(x=0.1))[-1].setpoint[0] > 0.5
    flight.telemetry = False
    old = flight.run(0.6, hand(x=0.1))
    assert old[400].setpoint[0] > 0.5
    assert old[-1].setpoint == (0.0, 0.0, 0.0, 0.0)
    assert old[-1].force == ZERO3
    assert old[-1].fault == "the vehicle's position is 0.6 s old"


def test_a_gain_that_is_not_positive_is_refused_on_building() -> None:
    with pytest.raises(ValueError, match=r"control\.stiffness\[1\]"):
        Pilot(Settings(control=Control(stiffness=(1.0, 0.0, 1.0))), INFO)


def line_near_50_hz(forces: list[float]) -> float:
    """Return the largest line of the last 2 s within 5 Hz of 50 Hz, N."""
    spectrum = np.abs(np.fft.rfft(np.array(forces[-2000:]) * np.hanning(2000))) / 500.0
    frequency = np.fft.rfftfreq(2000, DT)
    return float(spectrum[(frequency > 45) & (frequency < 55)].max())


def test_the_force_has_no_line_at_the_telemetry_rate() -> None:
    pilot, memory, sample = Pilot(SETTINGS, INFO), Memory(), VehicleSample()
    felt, stairs = [], []
    for tick in range(4000):
        t = tick * DT
        if tick % 20 == 0:
            # The drone swings by half a metre at 0.5 Hz, the hand rests: f = 4 N/m times the position.
            speed = 0.5 * pi * sin(pi * t + pi / 2)
            sample = VehicleSample((0.5 * sin(pi * t), 0.0, 2.0, 0.0), (speed, 0.0, 0.0, 0.0))
        inputs = Inputs(
            DT,
            Phase.ENGAGED,
            cut=False,
            hand=hand()._replace(device_time=tick * DT),
            vehicle=sample,
            state_age=tick % 20 * DT,
        )
        memory, outputs = pilot.step(memory, inputs)
        felt.append(outputs.force[0])
        stairs.append(4.0 * sample.position[0])
    assert max(felt) == pytest.approx(2.0, abs=0.02)
    assert line_near_50_hz(stairs) > 0.01
    assert line_near_50_hz(felt) < 0.02 * line_near_50_hz(stairs)


handles = st.builds(
    HandleState,
    position=st.tuples(*[st.floats(-0.2, 0.2)] * 3),
    velocity=st.tuples(*[st.floats(-3, 3)] * 3),
    yaw=st.floats(-pi, pi),
    buttons=st.just(0),
    homed=st.just(True),
    device_time=st.just(0.0),
)
samples = st.builds(
    VehicleSample,
    st.tuples(*[st.floats(-100, 100)] * 3, st.floats(-pi, pi)),
    st.tuples(*[st.floats(-10, 10)] * 4),
)
scenes = st.lists(
    st.tuples(handles, samples, st.floats(0, 0.6), st.sampled_from(Phase), st.integers(1, 40)), max_size=8
)


@given(scenes, st.sampled_from(["world", "heading"]))
@settings(deadline=None)
def test_whatever_hand_and_vehicle_do_every_limit_holds(scenes: list, frame: str) -> None:
    settings = Settings(mapping=Mapping(frame=frame), control=Control(passivity="off"))
    pilot, memory = Pilot(settings, INFO), Memory()
    limits, mapping = SETTINGS.limits, SETTINGS.mapping
    force, velocity, coupled = ZERO3, (0.0, 0.0, 0.0, 0.0), False
    for handle, sample, age, phase, ticks in scenes:
        for _ in range(ticks):
            memory, out = pilot.step(
                memory, Inputs(DT, phase, cut=False, hand=handle, vehicle=sample, state_age=age)
            )
            assert hypot(*out.force) <= INFO.force_limit * (1 + 1e-9)
            assert dist(out.force, force) <= limits.force_slew * DT * (1 + 1e-9)
            error = position_error(out.p_h, out.p)
            assert hypot(*error[:3]) <= mapping.leash + 1e-9
            assert abs(error[3]) <= mapping.leash_yaw + 1e-9
            if phase is Phase.ENGAGED and age <= SETTINGS.safety.state_stale_s:
                before = velocity if coupled else (0.0, 0.0, 0.0, 0.0)
                assert dist(out.setpoint[:2], before[:2]) <= limits.acceleration * DT * (1 + 1e-9)
                assert hypot(*out.setpoint[:2]) <= limits.horizontal_speed * (1 + 1e-9)
                assert abs(out.setpoint[2]) <= limits.vertical_speed * (1 + 1e-9)
                assert abs(out.setpoint[3]) <= limits.yaw_rate * (1 + 1e-9)
            else:
                assert out.setpoint == (0.0, 0.0, 0.0, 0.0)
            force, velocity = out.force, out.setpoint
            coupled = phase is Phase.ENGAGED and not out.fault


@pytest.mark.parametrize("force_limit", [0.0, 3.0, 20.0])
def test_the_strongest_force_is_gone_within_100_ms_on_any_device(force_limit: float) -> None:
    info = DeviceInfo("test", "", 4, 0.1, force_limit, 1000.0, 1000.0, "force")
    pilot = Pilot(SETTINGS, info)
    memory = Memory(port=Port(force=(force_limit, 0.0, 0.0)))
    out = None
    for _ in range(100):
        memory, out = pilot.step(memory, Inputs(DT, Phase.DISENGAGED, False, hand(), VehicleSample(), 0.0))
    assert out is not None
    assert out.force == ZERO3
