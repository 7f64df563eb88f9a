"""MAVLink's distances: sectors, frames and units by hand, and nothing invalid passes."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.messages import RING_SECTORS
from groundstation.vehicle.distances import (
    NO_RING,
    SECTOR,
    Beam,
    DistanceError,
    Way,
    beam_from,
    merged,
    nearer,
    scan_from,
)

UNKNOWN = 0xFFFF
WHOLE = {
    "distances": [UNKNOWN] * RING_SECTORS, "min_distance": 20, "max_distance": 1200, "increment": 5,
    "increment_f": 5.0, "angle_offset": 0.0, "frame": 12, "sensor_type": 0, "time_usec": 1,
}  # fmt: skip
SONAR = {
    "current_distance": 155, "min_distance": 10, "max_distance": 4000, "id": 0, "orientation": 25,
    "horizontal_fov": 0.0, "signal_quality": 0, "vertical_fov": 0.0, "type": 0, "covariance": 255,
    "quaternion": [0.0, 0.0, 0.0, 0.0], "time_boot_ms": 5,
}  # fmt: skip


def scan(yaw=math.nan, **changed):
    return scan_from(json.dumps(WHOLE | changed), yaw)


def beam(**changed):
    return beam_from(json.dumps(SONAR | changed))


def known(ring) -> dict[int, float]:
    return {sector: distance for sector, distance in enumerate(ring) if not math.isnan(distance)}


def test_the_wire_counts_clockwise_and_we_count_the_other_way():
    distances = [UNKNOWN] * RING_SECTORS
    distances[0], distances[18], distances[54], distances[71] = 300, 150, 250, 400
    ring, limit = scan(distances=distances)
    assert limit == 12.0
    # 90° clockwise is right: sector 54 counter-clockwise.
    assert known(ring) == {0: 3.0, 54: 1.5, 18: 2.5, 1: 4.0}


def test_more_than_the_limit_is_nothing_the_limit_is_something_and_unknown_stays_unknown():
    ring, _ = scan(distances=[1200, 1201, UNKNOWN, 0, 19])
    assert ring[0] == 12.0
    assert ring[71] == math.inf
    assert math.isnan(ring[70])
    assert ring[69] == 0.0
    # Nearer than the sensor measures: something is there.
    assert ring[68] == 0.19


def test_a_ring_from_north_is_turned_by_the_vehicles_yaw():
    ring, _ = scan(yaw=math.pi / 2, frame=0, distances=[300])
    assert known(ring) == {0: 3.0}
    ring, _ = scan(yaw=0.0, frame=1, distances=[300])
    # Heading east, north is on the left.
    assert known(ring) == {18: 3.0}
    with pytest.raises(DistanceError, match="heading is not known"):
        scan(yaw=math.nan, frame=0, distances=[300])


def test_an_offset_turns_the_ring_clockwise_and_a_negative_increment_runs_the_other_way():
    ring, _ = scan(angle_offset=90.0, increment_f=-5.0, distances=[100, 200])
    assert known(ring) == {54: 1.0, 55: 2.0}


def test_without_a_fine_increment_the_whole_degrees_count():
    ring, _ = scan(increment_f=0.0, increment=10, angle_offset=10.0, distances=[100])
    # 10° clockwise and 10° wide: the sectors at −15° (its edge), −10°; −5° is the next one's.
    assert set(known(ring)) == {69, 70}


def test_narrow_elements_keep_the_nearest_in_a_sector():
    ring, _ = scan(increment_f=0.5, angle_offset=-1.0, distances=[500, 300, UNKNOWN, 400, 1201])
    assert known(ring) == {0: 3.0}


@given(
    st.floats(-360, 360), st.floats(0.1, 90) | st.floats(-90, -0.1), st.integers(0, 71), st.integers(0, 1200)
)
def test_a_reading_is_found_where_it_was_measured(offset, width, place, centimetres):
    distances = [UNKNOWN] * RING_SECTORS
    distances[place] = centimetres
    ring, _ = scan(angle_offset=offset, increment_f=width, distances=distances)
    angle = -math.radians(offset + place * width)
    found = known(ring)
    assert set(found.values()) == {centimetres / 100.0}
    furthest = max(abs(math.remainder(sector * SECTOR - angle, math.tau)) for sector in found)
    assert furthest <= max(math.radians(abs(width)), SECTOR) / 2 + 1e-6
    assert len(found) <= abs(width) / 5.0 + 1


BAD_NUMBERS = [None, "5", True, [], {}, -1, 70_000, 1.5, 10**30]


@pytest.mark.parametrize("field", ["max_distance", "increment", "frame"])
@pytest.mark.parametrize("value", BAD_NUMBERS, ids=str)
def test_a_ring_with_a_number_that_cannot_be_is_not_used(field, value):
    with pytest.raises(DistanceError):
        scan(**{field: value}, distances=[100])


@pytest.mark.parametrize("field", ["increment_f", "angle_offset"])
@pytest.mark.parametrize("value", [None, "1", 361.0, -1e30, 1e300, [1.0]], ids=str)
def test_a_ring_with_an_angle_that_cannot_be_is_not_used(field, value):
    with pytest.raises(DistanceError):
        scan(**{field: value}, distances=[100])


@pytest.mark.parametrize(
    "distances", [[], [1] * 73, [None], [-1], [70_000], [1.5], ["1"], 5, None, [[1]]], ids=str
)
def test_a_ring_with_distances_that_cannot_be_is_not_used(distances):
    with pytest.raises(DistanceError):
        scan(distances=distances)


@pytest.mark.parametrize("frame", [2, 8, 20, 255])
def test_a_ring_in_another_frame_is_refused_by_its_number(frame):
    with pytest.raises(DistanceError, match=f"frame {frame} "):
        scan(frame=frame, distances=[100])


def test_a_ring_of_no_width_is_not_used():
    with pytest.raises(DistanceError, match="increment"):
        scan(increment=0, increment_f=0.0, distances=[100])


@pytest.mark.parametrize(
    "field", ["distances", "max_distance", "increment", "increment_f", "angle_offset", "frame"]
)
def test_a_ring_without_a_field_is_not_used(field):
    fields = {name: value for name, value in WHOLE.items() if name != field}
    with pytest.raises(DistanceError, match=field):
        scan_from(json.dumps(fields), 0.0)


ANYTHING = (
    st.none() | st.booleans() | st.floats() | st.integers() | st.sampled_from(["", "1", "NaN", [], [[5]], {}])
)


@given(st.dictionaries(st.sampled_from([*WHOLE, *SONAR]), ANYTHING), st.floats())
@settings(max_examples=60)
def test_whatever_a_message_says_it_gives_distances_or_words(said, yaw):
    try:
        ring, limit = scan_from(json.dumps(WHOLE | said), yaw)
    except DistanceError as refused:
        assert str(refused)
    else:
        assert all(math.isnan(distance) or distance >= 0.0 for distance in ring)
        assert 0.0 < limit < 656.0
    try:
        found = beam_from(json.dumps(SONAR | said))
    except DistanceError as refused:
        assert str(refused)
    else:
        assert found is None or math.isnan(found.distance) or found.distance >= 0.0


def test_json_without_end_is_refused():
    for fields in ("[" * 100_000, '{"a":' * 100_000, "", "\x00", "{}"):
        with pytest.raises(DistanceError):
            scan_from(fields, 0.0)


@pytest.mark.parametrize(
    ("orientation", "angle_deg"), [(0, 0), (2, -90), (4, 180), (6, 90), (7, 45), (1, -45)]
)
def test_a_level_beam_looks_clockwise_in_steps_of_45_degrees(orientation, angle_deg):
    found = beam(orientation=orientation)
    assert found.way is Way.LEVEL
    assert math.isclose(math.remainder(found.angle - math.radians(angle_deg), math.tau), 0.0, abs_tol=1e-12)
    assert found.distance == 1.55


def test_beams_up_and_down_are_told_apart_and_others_look_askew():
    assert beam(orientation=24).way is Way.UP
    assert beam(orientation=25).way is Way.DOWN
    assert [beam(orientation=other) for other in (8, 23, 26, 100, 255)] == [None] * 5


def test_a_beam_at_its_limit_sees_nothing_and_an_invalid_signal_is_not_known():
    assert beam(current_distance=3999).distance == 39.99
    assert beam(current_distance=4000).distance == math.inf
    assert beam(current_distance=UNKNOWN).distance == math.inf
    assert math.isnan(beam(signal_quality=1).distance)
    assert beam(signal_quality=100).distance == 1.55


@pytest.mark.parametrize("field", ["current_distance", "max_distance", "id", "orientation", "signal_quality"])
@pytest.mark.parametrize("value", BAD_NUMBERS, ids=str)
def test_a_beam_with_a_number_that_cannot_be_is_not_used(field, value):
    with pytest.raises(DistanceError):
        beam(**{field: value})


@pytest.mark.parametrize("value", [None, -0.1, 7.0, 1e30], ids=str)
def test_a_beam_with_a_width_that_cannot_be_is_not_used(value):
    with pytest.raises(DistanceError):
        beam(horizontal_fov=value)


def a_beam(angle, width, distance):
    return Beam(Way.LEVEL, angle, width, distance, 40.0, (0, 0))


def test_level_beams_go_into_the_ring_where_they_look_and_the_nearer_counts():
    ring = [math.nan] * RING_SECTORS
    ring[0], ring[1] = 2.0, 5.0
    together = merged(tuple(ring), [a_beam(0.0, 0.0, 3.0), a_beam(math.pi / 2, math.radians(15), 1.0)])
    assert known(together) == {0: 2.0, 1: 5.0, 17: 1.0, 18: 1.0, 19: 1.0}
    assert known(merged(NO_RING, [a_beam(math.pi, 0.0, math.inf)])) == {36: math.inf}


def test_the_widest_beam_fills_the_ring_once():
    assert known(merged(NO_RING, [a_beam(0.3, math.tau, 1.0)])) == dict.fromkeys(range(RING_SECTORS), 1.0)


def test_what_is_known_stands_against_what_is_not():
    assert nearer(math.nan, 2.0) == 2.0
    assert nearer(2.0, math.nan) == 2.0
    assert nearer(math.inf, 2.0) == 2.0
    assert nearer(math.inf, math.nan) == math.inf
    assert math.isnan(nearer(math.nan, math.nan))
