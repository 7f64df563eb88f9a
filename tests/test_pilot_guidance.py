"""Guidance to a mission's way: bounded, nothing within the tube, never outward, never without the hand, passive."""

from __future__ import annotations

from itertools import pairwise
from math import dist, hypot, inf, isnan, nan, pi

import pytest
from haptic_loop import DEVICE, DT, LOOSE
from hypothesis import assume, given
from hypothesis import strategies as st

from drivers.arm import ArmState, stop
from drivers.device import ZERO3, HandleState
from groundstation.config import Cues, Settings
from groundstation.messages import Cue, MappingMode, Phase, Preset
from groundstation.pilot.choices import GUIDED_CUES, Choices
from groundstation.pilot.guidance import CENTRE, NOWHERE, Guidance, Tube, segments_of
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.pilot import Memory, Pilot
from groundstation.pilot.sight import ZERO4, VehicleSample
from groundstation.pilot.surroundings import NOTHING_KNOWN

STRAIGHT = ((0.0, 0.0, 2.0), (10.0, 0.0, 2.0))
TUBE = Tube(stiffness=6.0, radius=0.25, limit=3.0)
GUIDANCE = Guidance(STRAIGHT, TUBE, workspace=0.1)
GUIDED = Choices(cues=GUIDED_CUES)
metres = st.floats(-20, 20)
places = st.tuples(metres, metres, metres)
small = st.floats(-0.1, 0.1)
handles = st.tuples(small, small, small)


def at(x: float, y: float, z: float) -> tuple[float, float, float, float]:
    return (x, y, z, 0.0)


def pilot(guidance: float) -> Pilot:
    return Pilot(Settings(), DEVICE, NOTHING_KNOWN._replace(way=STRAIGHT, guidance=guidance))


def tick(
    which: Pilot,
    place,
    hand=ZERO3,
    choices: Choices = GUIDED,
    *,
    memory: Memory | None = None,
    dt: float = DT,
):
    handle = HandleState(hand, ZERO3, 0.0, 0, homed=True, device_time=0.0)
    sample = VehicleSample(place, ZERO4)
    return which.step(
        memory or Memory(), Inputs(dt, Phase.ENGAGED, False, handle, sample, 0.0, choices=choices)
    )


def test_it_is_worked_by_hand() -> None:
    # 1 m beside the way, 0.75 m outside of the tube, 6 N a metre but 3 N at most, back to the way.
    _, force = GUIDANCE.towards(NOWHERE, at(4.0, 1.0, 2.0), ZERO4)
    assert force == pytest.approx((0.0, -3.0, 0.0))
    station, force = GUIDANCE.towards(NOWHERE, at(4.0, 0.0, 2.5), ZERO4)
    assert force == pytest.approx((0.0, 0.0, -1.5))
    assert station == pytest.approx(4.0)
    # 0.5 m/s away from it for 0.4 s.
    _, force = GUIDANCE.towards(NOWHERE, at(4.0, 0.25, 2.0), (0.0, 0.5, 0.0, 0.0))
    assert force == pytest.approx((0.0, -1.2, 0.0))


@given(places, places)
def test_it_is_bounded_continuous_and_nothing_within_the_tube(place, other) -> None:
    (x, y, z), _ = place, other
    _, force = GUIDANCE.towards(NOWHERE, at(x, y, z), ZERO4)
    nearest = (min(max(x, 0.0), 10.0), 0.0, 2.0)
    away = dist(place, nearest)
    assert hypot(*force) == pytest.approx(min(max(6.0 * (away - 0.25), 0.0), 3.0), abs=1e-9)
    if away <= 0.25:
        assert force == ZERO3
    toward = sum(f * (n - p) for f, n, p in zip(force, nearest, place, strict=True))
    assert toward == pytest.approx(hypot(*force) * away)


@given(places, handles)
def test_it_never_leads_outward_and_is_nothing_at_the_centre(force, displacement) -> None:
    turned = GUIDANCE.turned(force, displacement)
    out = hypot(*displacement)
    assert hypot(*turned) <= hypot(*force) + 1e-9
    if out <= CENTRE * 0.1:
        assert turned == ZERO3
    outward = sum(f * x for f, x in zip(turned, displacement, strict=True))
    assert outward <= 1e-9


def test_where_a_way_crosses_itself_the_other_branch_does_not_pull() -> None:
    # There and back, 3 m to the left; then across the first leg.
    path = ((0.0, 0.0, 2.0), (10.0, 0.0, 2.0), (10.0, 3.0, 2.0), (5.0, 3.0, 2.0), (5.0, -5.0, 2.0))
    guidance = Guidance(path, TUBE, 0.1)
    station = NOWHERE
    for step in range(101):
        x = step / 10.0
        station, force = guidance.towards(station, at(x, 0.0, 2.0), ZERO4)
        assert station == pytest.approx(x)
        assert force == ZERO3
    assert segments_of((*path, path[-1]))[-1].station == pytest.approx(18.0)


def test_a_way_that_ends_where_it_begins_is_begun_at_its_beginning() -> None:
    path = ((0.0, 0.0, 2.0), (6.0, 0.0, 2.0), (6.0, 5.0, 2.0), (0.0, 5.0, 2.0), (0.0, 0.0, 2.0))
    guidance, station = Guidance(path, TUBE, 0.1), NOWHERE
    for step in range(61):
        station, force = guidance.towards(station, at(step / 10.0, 0.01, 2.0), ZERO4)
        assert station == pytest.approx(step / 10.0, abs=0.02)
        assert force == ZERO3


def test_who_has_gone_far_from_the_way_is_guided_to_what_is_nearest_again() -> None:
    path = ((0.0, 0.0, 2.0), (20.0, 0.0, 2.0), (20.0, 20.0, 2.0))
    guidance, station = Guidance(path, TUBE, 0.1), NOWHERE
    # Across the corner.
    for step in range(201):
        along = step / 200.0
        station, force = guidance.towards(station, at(5.0 + 15.0 * along, 15.0 * along, 2.0), ZERO4)
    assert station == pytest.approx(35.0)
    assert force == ZERO3


@given(st.lists(places, min_size=2, max_size=6), places)
def test_a_station_lies_on_the_way(path, place) -> None:
    assume(all(dist(a, b) > 0.01 for a, b in pairwise(path)))
    station, _ = Guidance(path, TUBE, 0.1).towards(NOWHERE, (*place, 0.0), ZERO4)
    assume(not isnan(station))
    assert 0.0 <= station <= sum(dist(a, b) for a, b in pairwise(path)) + 1e-6


def test_strength_scales_it_and_none_is_the_pilot_as_it_is_without_to_the_last_bit() -> None:
    hand = (0.08, 0.0, 0.0)
    beside = at(4.0, 0.5, 2.0)
    forces = {strength: tick(pilot(strength), beside, hand)[1].cues.guidance for strength in (0.0, 0.5, 1.0)}
    assert forces[0.0] == ZERO3
    assert forces[1.0][1] == pytest.approx(2 * forces[0.5][1])
    assert forces[1.0][1] < -1.0
    without, none = Pilot(Settings(), DEVICE), pilot(0.0)
    memories = [Memory(), Memory()]
    for step in range(200):
        moved = (0.0004 * step, -0.0002 * step, 0.0)
        results = [
            tick(which, at(0.01 * step, 0.5, 2.0), moved, memory=memory)
            for which, memory in zip((without, none), memories, strict=True)
        ]
        memories = [memory for memory, _ in results]
        # NaN stations are the same object only; all else is compared bit for bit.
        assert repr(results[0]) == repr(results[1])


@pytest.mark.parametrize(
    "choices",
    [
        GUIDED._replace(cues=GUIDED_CUES & ~Cue.GUIDANCE),
        GUIDED._replace(preset=Preset.PAPER),
        GUIDED._replace(preset=Preset.TRANSPARENT),
        GUIDED._replace(mapping=MappingMode.POSITION),
        GUIDED._replace(clutched=True),
    ],
)
def test_it_can_be_off(choices: Choices) -> None:
    assert tick(pilot(1.0), at(4.0, 2.0, 2.0), (0.08, 0.0, 0.0), choices)[1].cues.guidance == ZERO3
    assert tick(pilot(1.0), at(4.0, 2.0, 2.0), (0.08, 0.0, 0.0))[1].cues.guidance != ZERO3


def test_where_the_hand_is_not_coupled_or_the_way_is_none_there_is_none() -> None:
    which = pilot(1.0)
    idle = Inputs(
        DT, Phase.DISENGAGED, False, HandleState(ZERO3, ZERO3, 0.0, 0, True, 0.0), VehicleSample(), 0.0
    )
    _, outputs = which.step(Memory(), idle)
    assert outputs.force == ZERO3
    bare = Pilot(Settings(), DEVICE, NOTHING_KNOWN._replace(guidance=1.0))
    assert tick(bare, at(4.0, 2.0, 2.0), (0.08, 0.0, 0.0))[1].cues.guidance == ZERO3


@given(places, handles, st.floats(0, 1), st.floats(-pi, pi))
def test_the_cue_is_within_its_share_of_the_devices_force(place, hand, strength, yaw) -> None:
    which = pilot(strength)
    x, y, z = place
    _, outputs = tick(which, (x, y, z, yaw), hand)
    assert hypot(*outputs.cues.guidance) <= strength * 0.3 * DEVICE.force_limit + 1e-9
    assert hypot(*outputs.force) <= DEVICE.force_limit + 1e-9


def test_a_state_that_cannot_be_gives_no_force_that_cannot() -> None:
    for broken in (nan, inf):
        _, force = GUIDANCE.towards(NOWHERE, at(broken, 0.0, 2.0), ZERO4)
        assert force == ZERO3


def hovering(strength: float, hand_reach: float, passivity: str = "observer"):
    """Let a loose hand hold a handle 1 m beside the way for 3 s: intention, arm, servo, and a vehicle with a lag."""
    settings = Settings(cues=Cues(guidance=20.0))
    which = Pilot(settings, DEVICE, NOTHING_KNOWN._replace(way=STRAIGHT, guidance=strength))
    memory, arm, p, v = Memory(), ArmState(), [4.0, 1.0, 2.0, 0.0], [0.0] * 4
    energy = least = furthest = 0.0
    for step in range(3000):
        wanted = (hand_reach, 0.0, 0.0) if step > 200 else ZERO3
        handle = HandleState(arm.position, arm.velocity, 0.0, 0, homed=True, device_time=step * DT)
        sample = VehicleSample(tuple(p), tuple(v))
        memory, out = which.step(
            memory, Inputs(DT, Phase.ENGAGED, False, handle, sample, 0.0, choices=GUIDED)
        )
        moved = stop(LOOSE.step(arm, DT, wanted, 0.0, out.force), DEVICE.workspace)
        energy -= sum(f * (b - a) for f, a, b in zip(out.force, arm.position, moved.position, strict=True))
        least = min(least, energy)
        furthest = max(furthest, hypot(*moved.position))
        arm = moved
        v = [a + DT / 0.4 * (b - a) for a, b in zip(v, out.setpoint, strict=True)]
        p = [a + DT * b for a, b in zip(p, v, strict=True)]
    return least, furthest, p


def test_it_gives_the_hand_no_net_energy() -> None:
    least, _, _ = hovering(1.0, 0.06)
    assert least >= -1e-3


def test_a_handle_that_is_left_at_its_centre_stays_there_and_so_does_the_vehicle() -> None:
    _, furthest, p = hovering(1.0, 0.0)
    assert furthest < CENTRE * DEVICE.workspace
    assert dist(p[:3], (4.0, 1.0, 2.0)) < 0.01


def test_a_hand_that_pushes_on_is_turned_to_the_way() -> None:
    _, _, guided = hovering(1.0, 0.06)
    _, _, alone = hovering(0.0, 0.06)
    assert guided[1] < alone[1] - 0.2
