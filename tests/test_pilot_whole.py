"""The pilot as a whole, with all that stands around the equations, and whatever comes in."""

from math import dist, hypot, inf, isfinite, nan, tanh

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.device import ZERO3, DeviceInfo, HandleState
from groundstation.config import Control, Mapping, Settings
from groundstation.messages import MappingMode, Phase, Preset
from groundstation.pilot.choices import ALL_CUES, Choices
from groundstation.pilot.controller import vehicle_rates, world_rates
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.pilot import Memory, Outputs, Pilot
from groundstation.pilot.sight import VehicleSample
from groundstation.pilot.surroundings import Surroundings
from sim.airframe import load_airframe
from sim.models.dynamic import Chi, respond
from sim.scenario import Box, Cylinder, Sphere

DT = 0.004
INFO = DeviceInfo("test", "", 4, 0.1, 10.0, 1000.0, 250.0, "force")
SETTINGS = Settings()
AIRFRAME = load_airframe("matrice_100")
CONSTANTS = (tuple(getattr(AIRFRAME.chi, name) for name in Chi.__struct_fields__), 0.0, DT)
WALL = Box("wall", (6.0, 0.0, 2.0), (1.0, 20.0, 8.0))
KNOWN = Surroundings((WALL,), 0.5, AIRFRAME.chi)


class Flight:
    """The identified Matrice 100 on a wire without delay, told of at 50 Hz."""

    def __init__(self, preset: Preset, known: Surroundings = KNOWN, config: Settings = SETTINGS) -> None:
        self.pilot, self.memory = Pilot(config, INFO, known), Memory()
        self.choices = Choices(preset=preset)
        self.p, self.v = (0.0, 0.0, 2.0, 0.0), (0.0, 0.0, 0.0, 0.0)
        self.tick, self.sample = 0, VehicleSample()
        self.delay, self.loss, self.seen = 0.0, 0.0, ()

    def step(self, place=ZERO3, velocity=ZERO3) -> Outputs:
        if self.tick % 5 == 0:
            self.sample = VehicleSample(self.p, world_rates(self.v, self.p[3]))
        hand = HandleState(place, velocity, 0.0, 0, homed=True, device_time=0.0)
        age = self.tick % 5 * DT
        inputs = Inputs(
            DT, Phase.ENGAGED, False, hand, self.sample, age, self.delay, self.loss, self.choices, self.seen
        )
        self.memory, outputs = self.pilot.step(self.memory, inputs)
        self.p, self.v = respond(self.p, self.v, outputs.setpoint, ZERO3, CONSTANTS)
        self.tick += 1
        return outputs

    def run(self, seconds: float, place=ZERO3) -> list[Outputs]:
        return [self.step(place) for _ in range(round(seconds / DT))]


def test_the_paper_s_preset_is_exactly_equations_4_and_5() -> None:
    flight = Flight(Preset.PAPER)
    for outputs in flight.run(6.0, (0.07, 0.02, 0.0))[50:]:
        error, yaw = outputs.error, outputs.p[3]
        k1 = outputs.terms.loop.k1
        rates = tuple(rate + k * tanh(e) for rate, k, e in zip(outputs.p_h_rate, k1, error, strict=True))
        assert outputs.v_ref == pytest.approx(vehicle_rates(rates, yaw))
        assert outputs.v_safe == outputs.v_ref
        assert outputs.setpoint == outputs.commanded.meant
        assert outputs.cues.position == pytest.approx(tuple(-4.0 * e for e in error[:3]))
        assert outputs.cues._replace(position=ZERO3) == type(outputs.cues)()
    # It flies into the wall, as nothing keeps it from that.
    assert flight.p[0] > WALL.center[0] - 0.5


@pytest.mark.parametrize("preset", [Preset.ASSISTED, Preset.TRANSPARENT, Preset.TRAINING])
def test_with_the_shield_on_full_stick_ends_before_the_wall_and_says_so(preset: Preset) -> None:
    flight = Flight(preset)
    pushed = flight.run(10.0, (0.1, 0.0, 0.0))
    gap = WALL.center[0] - 0.5 - flight.p[0] - KNOWN.radius
    assert gap == pytest.approx(SETTINGS.shield.margin, abs=0.1)
    assert hypot(*flight.v[:3]) < 0.02
    assert pushed[-1].commanded.by == "wall"
    assert not pushed[0].commanded.by


def test_the_hand_feels_the_wall_the_guard_and_that_the_drone_does_not_follow() -> None:
    flight = Flight(Preset.ASSISTED)
    cues = flight.run(10.0, (0.1, 0.0, 0.0))[-1].cues
    assert cues.position[0] == pytest.approx(-4.0 * SETTINGS.mapping.leash, rel=0.01)
    assert cues.environment[0] == pytest.approx(
        -5.0 * (SETTINGS.cues.reach - SETTINGS.shield.margin), rel=0.15
    )
    assert cues.guard[0] < -2.0
    flight.choices = flight.choices._replace(cues=0)
    assert flight.run(0.5, (0.1, 0.0, 0.0))[-1].force == pytest.approx(ZERO3)


def test_an_obstacle_that_only_the_sensors_see_is_kept_away_from_too() -> None:
    flight = Flight(Preset.ASSISTED, Surroundings((), 0.5, AIRFRAME.chi))
    flight.seen = ((5.5, 0.0, 2.0),)
    stopped = flight.run(10.0, (0.1, 0.0, 0.0))[-1]
    assert stopped.commanded.by == "sensor"
    assert 5.5 - flight.p[0] - 0.5 == pytest.approx(SETTINGS.shield.margin, abs=0.1)
    assert stopped.cues.environment[0] < -1.0


def test_nor_does_it_sink_below_the_floor_nor_leave_the_fence() -> None:
    shield = msgspec.structs.replace(SETTINGS.shield, fence=4.0, ceiling=3.0)
    config = msgspec.structs.replace(SETTINGS, shield=shield)
    for place, by, reached in (
        ((0.0, 0.0, -0.1), "floor", lambda p: p[2] - shield.floor),
        ((0.0, 0.0, 0.1), "ceiling", lambda p: shield.ceiling - p[2]),
        ((-0.07, 0.07, 0.0), "fence", lambda p: shield.fence - hypot(p[0], p[1]) - 0.5),
    ):
        flight = Flight(Preset.ASSISTED, Surroundings((), 0.5, AIRFRAME.chi), config)
        assert flight.run(12.0, place)[-1].commanded.by == by
        assert reached(flight.p) == pytest.approx(0.0, abs=0.05)


def test_presets_switch_in_flight_without_a_jump_of_setpoint_or_force() -> None:
    flight = Flight(Preset.PAPER)
    before = flight.run(2.0, (0.05, 0.0, 0.0))[-1]
    for preset in (Preset.ASSISTED, Preset.TRANSPARENT, Preset.TRAINING, Preset.PAPER):
        flight.choices = flight.choices._replace(preset=preset)
        for outputs in flight.run(0.3, (0.05, 0.0, 0.0)):
            meant, was = outputs.commanded.meant, before.commanded.meant
            assert dist(meant, was) < 2.0 * SETTINGS.limits.acceleration * DT
            assert dist(outputs.force, before.force) <= SETTINGS.limits.force_slew * DT * (1 + 1e-9)
            before = outputs


def test_a_poor_link_takes_gain_and_speed_and_a_good_one_gives_them_back() -> None:
    flight = Flight(Preset.ASSISTED, Surroundings((), 0.5, AIRFRAME.chi))
    full = flight.run(3.0, (0.1, 0.0, 0.0))[-1]
    flight.loss = 0.5
    poor = flight.run(3.0, (0.1, 0.0, 0.0))[-1]
    assert hypot(*full.commanded.meant[:3]) > 1.9
    assert hypot(*poor.commanded.meant[:3]) < 0.35 * SETTINGS.limits.horizontal_speed
    assert poor.p_h_rate[0] == pytest.approx(SETTINGS.link.least_speed * 2.0)
    assert poor.terms.link.gain == pytest.approx(SETTINGS.link.least_gain)
    flight.loss = 0.0
    assert flight.run(3.0, (0.1, 0.0, 0.0))[-1].commanded.meant[0] > 1.9


def test_gains_and_margin_follow_the_measured_round_trip() -> None:
    flight = Flight(Preset.ASSISTED, Surroundings((), 0.5, AIRFRAME.chi))
    near = flight.step().terms.loop
    flight.delay = 0.7
    far = flight.step().terms.loop
    assert near.k1 == SETTINGS.control.k1
    assert far.k1[0] < near.k1[0]
    assert far.margin < near.margin
    flight.delay = nan
    assert flight.step().terms.delay == SETTINGS.link.assumed_delay_s


numbers = st.floats(-1e6, 1e6)
anything = st.floats(allow_nan=True, allow_infinity=True)
small = st.floats(-0.15, 0.15)
handles = st.builds(
    HandleState, st.tuples(small, small, small), st.tuples(*[st.floats(-3, 3)] * 3), st.floats(-3, 3),
    st.just(0), st.just(True), st.just(0.0),
)  # fmt: skip
places = st.tuples(*[st.floats(-12, 12)] * 3, st.floats(-3, 3))
samples = st.builds(VehicleSample, places, st.tuples(*[st.floats(-6, 6)] * 4))
broken_handles = st.builds(
    HandleState, st.tuples(anything, anything, anything), st.tuples(anything, anything, anything), anything,
    st.just(0), st.just(True), st.just(0.0),
)  # fmt: skip
broken_samples = st.builds(VehicleSample, st.tuples(*[anything] * 4), st.tuples(*[anything] * 4))
choices = st.builds(
    Choices, st.sampled_from(MappingMode), st.booleans(), st.booleans(), st.sampled_from([-1, 0, 1]),
    st.sampled_from(Preset), st.integers(0, ALL_CUES),
)  # fmt: skip
delays = st.one_of(st.just(nan), st.floats(0, 2))
scenes = st.lists(
    st.tuples(handles, samples, st.floats(0, 0.6), delays, st.floats(0, 1), choices, st.integers(1, 15)),
    max_size=6,
)
CROWD = Surroundings(
    (Box("box", (3.0, 0.0, 2.0), (1.0, 2.0, 4.0), 30.0), Cylinder("mast", (0.0, 3.0, 2.0), 0.3, 4.0),
     Sphere("ball", (-2.0, 0.0, 2.0), 0.5)), 0.4, AIRFRAME.chi,
)  # fmt: skip


@given(
    scenes, st.sampled_from(["observer", "wave", "tank"]), st.sampled_from(["barrier", "risk_field", "off"])
)
@settings(max_examples=25)
def test_whatever_comes_in_no_limit_of_speed_and_force_is_passed(
    scenes: list, passivity: str, guard: str
) -> None:
    shield = msgspec.structs.replace(SETTINGS.shield, guard=guard)
    config = Settings(control=Control(passivity=passivity), shield=shield)
    pilot, memory, limits = Pilot(config, INFO, CROWD), Memory(), SETTINGS.limits
    for hand, sample, age, delay, loss, chosen, ticks in scenes:
        for _ in range(ticks):
            memory, out = pilot.step(
                memory,
                Inputs(DT, Phase.ENGAGED, False, hand, sample, age, delay, loss, chosen, ((1.0, 1.0, 1.0),)),
            )
            assert hypot(*out.force) <= INFO.force_limit * (1 + 1e-9)
            for told in (out.setpoint, out.commanded.meant):
                assert hypot(*told[:2]) <= limits.horizontal_speed * (1 + 1e-9)
                assert abs(told[2]) <= limits.vertical_speed * (1 + 1e-9)
                assert abs(told[3]) <= limits.yaw_rate * (1 + 1e-9)
            assert dist(out.p_h[:3], out.p[:3]) <= SETTINGS.mapping.leash + 1e-6
            if age > SETTINGS.safety.state_stale_s:
                assert out.fault
                assert out.setpoint == (0.0, 0.0, 0.0, 0.0)


@given(
    st.lists(
        st.tuples(st.one_of(handles, broken_handles), st.one_of(samples, broken_samples), anything),
        max_size=12,
    ),
    st.sampled_from(["observer", "wave", "tank", "off"]),
)
@settings(max_examples=60)
def test_any_nan_in_gives_hold_out_and_leaves_nothing_spoilt(scenes: list, passivity: str) -> None:
    pilot, memory = Pilot(Settings(control=Control(passivity=passivity)), INFO, CROWD), Memory()
    for hand, sample, age in scenes:
        memory, out = pilot.step(memory, Inputs(DT, Phase.ENGAGED, False, hand, sample, age))
        assert all(map(isfinite, (*out.setpoint, *out.force)))
        fine = (*hand.position, *hand.velocity, hand.yaw, *sample.position, *sample.velocity)
        if not all(map(isfinite, fine)) or not age <= SETTINGS.safety.state_stale_s:
            assert out.setpoint == (0.0, 0.0, 0.0, 0.0)
            assert out.fault
    hand = HandleState(ZERO3, ZERO3, 0.0, 0, homed=True, device_time=0.0)
    for _ in range(3):
        memory, out = pilot.step(memory, Inputs(DT, Phase.ENGAGED, False, hand, VehicleSample(), 0.0))
    assert not out.fault
    assert all(map(isfinite, (*out.setpoint, *out.force, *out.p_h, *out.forecast.p, *out.forecast.push)))


@pytest.mark.parametrize("age", [inf, nan, 0.51])
def test_a_state_of_no_or_too_great_age_is_not_flown_by(age: float) -> None:
    pilot, memory = Pilot(SETTINGS, INFO), Memory()
    hand = HandleState((0.1, 0.0, 0.0), ZERO3, 0.0, 0, homed=True, device_time=0.0)
    for _ in range(50):
        memory, out = pilot.step(memory, Inputs(DT, Phase.ENGAGED, False, hand, VehicleSample(), age))
    assert out.setpoint == (0.0, 0.0, 0.0, 0.0)
    assert out.force == ZERO3


def test_in_position_mode_the_gains_stay_passive_at_the_handle() -> None:
    """k · scale is the spring at the handle: with 500 N/m asked for, the device's 100 N/m bound the gain."""
    soft = DeviceInfo("soft", "", 4, 0.1, 10.0, 100.0, 250.0, "force")
    config = Settings(
        control=Control(stiffness=(20.0, 20.0, 20.0)), mapping=Mapping(scale=(20.0, 20.0, 20.0))
    )
    gains = Pilot(config, soft).gains
    assert gains[MappingMode.RATE].stiffness == (20.0, 20.0, 20.0)
    assert (
        gains[MappingMode.POSITION].stiffness[0] + 5.0 * gains[MappingMode.POSITION].share
    ) * 20 == pytest.approx(100)
