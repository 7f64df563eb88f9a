from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import HandleState
from drivers.virtual import INFO
from groundstation.config import Safety
from groundstation.messages import FlightMode, Phase, Severity, Stream
from groundstation.pilot.engagement import (
    Conditions,
    Engagement,
    advance,
    believable,
    centred,
    disengage,
    engage,
    refusal,
)

SAFETY = Safety()
READY = Conditions(
    t=10.0,
    gap=0.001,
    believable=True,
    present=True,
    homed=True,
    centred=True,
    handle_age=0.0,
    connected=True,
    armed=True,
    in_air=True,
    mode=FlightMode.HOLD,
    streaming=Stream.IDLE,
    state_age=0.02,
    state_valid=True,
    boots=0,
)
FLYING = READY._replace(t=11.0, mode=FlightMode.OFFBOARD, streaming=Stream.FLYING)
ENGAGING = Engagement(Phase.ENGAGING, 10.0, FlightMode.HOLD, 0)
ENGAGED = Engagement(Phase.ENGAGED, 11.0, FlightMode.HOLD, 0, streamed=True)

HAND_FAULTS = [
    ({"present": False}, "no haptic device"),
    ({"homed": False}, "not homed"),
    ({"believable": False}, "number"),
    ({"enabled": False}, "enable control is not held"),
    ({"squeezed": True}, "squeezed through"),
    ({"handle_age": 0.11}, "0.11 s old"),
    ({"handle_age": nan}, "old"),
    ({"gap": 0.151}, "servo stood still"),
    ({"gap": nan}, "servo stood still"),
]
VEHICLE_FAULTS = [
    ({"connected": False}, "not heard"),
    ({"state_age": 0.51}, "0.5 s old"),
    ({"state_age": inf}, "not told its position"),
    ({"state_age": nan}, "position"),
    ({"state_valid": False}, "trust"),
    ({"armed": False}, "not armed"),
    ({"in_air": False}, "on the ground"),
    ({"speed": 5.6, "speed_limit": 3.0}, "5.6 m/s"),
    ({"climb": 3.3, "climb_limit": 1.5}, "far over its limit"),
]


def test_all_conditions_met_it_engages_on_the_operators_act() -> None:
    assert refusal(READY, SAFETY) == ""
    assert engage(Engagement(), READY, SAFETY) == (ENGAGING, "")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        *HAND_FAULTS,
        *VEHICLE_FAULTS,
        ({"centred": False}, "centre"),
        ({"streaming": Stream.STARTING}, "last stream"),
        ({"streaming": Stream.FLYING}, "last stream"),
        ({"unsafe": "GF_ACTION = 4 (Terminate)"}, "GF_ACTION = 4"),
    ],
)
def test_each_condition_missing_refuses_with_its_reason(change: dict, words: str) -> None:
    engagement, why = engage(Engagement(), READY._replace(**change), SAFETY)
    assert engagement.phase is Phase.DISENGAGED
    assert words in why


@pytest.mark.parametrize("engagement", [ENGAGING, ENGAGED])
def test_engaging_again_changes_nothing(engagement: Engagement) -> None:
    assert engage(engagement, FLYING, SAFETY) == (engagement, "")


@pytest.mark.parametrize(("change", "words"), HAND_FAULTS)
@pytest.mark.parametrize(("engagement", "conditions"), [(ENGAGING, READY), (ENGAGED, FLYING)])
def test_a_fault_of_the_hand_ends_it_and_cuts_the_force(
    engagement: Engagement, conditions: Conditions, change: dict, words: str
) -> None:
    after, ending = advance(engagement, conditions._replace(**change), SAFETY)
    assert after == Engagement()
    assert ending is not None
    assert words in ending.words
    assert ending.cut
    assert ending.severity is (Severity.WARNING if "enable control is not" in words else Severity.ALARM)


@pytest.mark.parametrize(("change", "words"), [*VEHICLE_FAULTS, ({"boots": 1}, "rebooted")])
@pytest.mark.parametrize(("engagement", "conditions"), [(ENGAGING, READY), (ENGAGED, FLYING)])
def test_a_fault_of_the_vehicle_ends_it_and_lets_the_force_fade(
    engagement: Engagement, conditions: Conditions, change: dict, words: str
) -> None:
    after, ending = advance(engagement, conditions._replace(**change), SAFETY)
    assert after == Engagement()
    assert ending is not None
    assert words in ending.words
    assert not ending.cut
    assert ending.severity is Severity.ALARM


def test_it_is_engaged_once_the_vehicle_confirms_offboard_for_our_stream() -> None:
    engagement = ENGAGING
    for conditions in (
        READY,
        READY._replace(t=10.1, streaming=Stream.STARTING),
        READY._replace(t=10.9, mode=FlightMode.OFFBOARD, streaming=Stream.STARTING),
    ):
        engagement, ending = advance(engagement, conditions, SAFETY)
        assert ending is None
        assert engagement.phase is Phase.ENGAGING
    engagement, ending = advance(engagement, FLYING, SAFETY)
    assert ending is None
    assert engagement.phase is Phase.ENGAGED


def test_a_handle_away_from_its_centre_is_what_flying_is() -> None:
    assert advance(ENGAGED, FLYING._replace(centred=False), SAFETY) == (ENGAGED, None)


def test_offboard_not_confirmed_in_three_seconds_ends_it() -> None:
    engagement, ending = advance(ENGAGING, READY._replace(t=13.0), SAFETY)
    assert ending is None
    engagement, ending = advance(engagement, READY._replace(t=13.01), SAFETY)
    assert engagement == Engagement()
    assert ending is not None
    assert "did not confirm Offboard within 3 s" in ending.words


@pytest.mark.parametrize("mode", [mode for mode in FlightMode if mode is not FlightMode.OFFBOARD])
def test_whoever_takes_the_vehicle_keeps_it(mode: FlightMode) -> None:
    engagement, ending = advance(ENGAGED, FLYING._replace(mode=mode), SAFETY)
    assert ending is not None
    assert mode.name in ending.words
    for conditions in (FLYING, READY, FLYING._replace(t=99.0)):
        engagement, again = advance(engagement, conditions, SAFETY)
        assert engagement.phase is Phase.DISENGAGED
        assert again is None


@pytest.mark.parametrize(
    ("mode", "ends"),
    [
        (FlightMode.HOLD, False),
        (FlightMode.OFFBOARD, False),
        (FlightMode.TAKEOFF, False),
        (FlightMode.RETURN, True),
        (FlightMode.LAND, True),
        (FlightMode.POSITION, True),
    ],
)
def test_a_mode_taken_by_another_while_engaging_is_not_overridden(mode: FlightMode, ends: bool) -> None:
    from_takeoff = ENGAGING._replace(mode=FlightMode.TAKEOFF)
    _, ending = advance(from_takeoff, READY._replace(mode=mode), SAFETY)
    assert (ending is not None) == ends


@pytest.mark.parametrize("state", [Stream.IDLE, Stream.ENDED])
def test_a_stream_that_the_link_ended_ends_it(state: Stream) -> None:
    engagement, _ = advance(ENGAGING, READY._replace(streaming=Stream.STARTING), SAFETY)
    for coupled in (engagement, ENGAGED):
        after, ending = advance(coupled, FLYING._replace(streaming=state), SAFETY)
        assert after == Engagement()
        assert ending is not None
        assert "link stopped" in ending.words


def test_the_last_streams_end_does_not_end_the_next() -> None:
    engagement, ending = advance(ENGAGING, READY._replace(streaming=Stream.ENDED), SAFETY)
    assert (engagement.phase, ending) == (Phase.ENGAGING, None)


def test_the_operators_act_ends_it_without_alarm() -> None:
    for coupled in (ENGAGING, ENGAGED):
        after, ending = disengage(coupled, "the operator commanded Hold")
        assert after == Engagement()
        assert ending is not None
        assert ending.severity is Severity.INFO
        assert not ending.cut
    assert disengage(Engagement(), "again") == (Engagement(), None)


ages = st.one_of(st.floats(0, 1), st.just(nan), st.just(inf))
conditions = st.builds(
    Conditions,
    t=st.floats(0, 100),
    gap=ages,
    believable=st.booleans(),
    present=st.booleans(),
    homed=st.booleans(),
    centred=st.booleans(),
    handle_age=ages,
    connected=st.booleans(),
    armed=st.booleans(),
    in_air=st.booleans(),
    mode=st.sampled_from(FlightMode),
    streaming=st.sampled_from(Stream),
    state_age=ages,
    state_valid=st.booleans(),
    boots=st.integers(0, 1),
)


@given(st.lists(conditions))
def test_without_an_act_nothing_ever_engages(sequence: list[Conditions]) -> None:
    engagement = Engagement()
    for seen in sequence:
        engagement, ending = advance(engagement, seen, SAFETY)
        assert engagement.phase is Phase.DISENGAGED
        assert ending is None


@given(st.sampled_from([ENGAGING, ENGAGED]), conditions)
def test_whatever_stays_coupled_has_every_condition_that_flight_needs(
    coupled: Engagement, seen: Conditions
) -> None:
    after, ending = advance(coupled, seen, SAFETY)
    assert (after.phase is Phase.DISENGAGED) == (ending is not None)
    if ending is None:
        assert all((seen.believable, seen.present, seen.homed, seen.connected, seen.armed, seen.in_air))
        assert seen.state_age <= SAFETY.state_stale_s
        assert seen.handle_age <= SAFETY.handle_stale_s
        assert seen.gap <= 0.15
    if after.phase is Phase.ENGAGED:
        assert seen.mode is FlightMode.OFFBOARD


def test_centred_is_within_15_percent_of_travel_and_of_rotation() -> None:
    def handle(x: float, yaw: float) -> HandleState:
        return HandleState((x, 0.0, 0.0), (0.0, 0.0, 0.0), yaw, 0, homed=True, device_time=0.0)

    assert centred(handle(0.15 * INFO.workspace, 0.15), INFO, 1.0)
    assert not centred(handle(0.16 * INFO.workspace, 0.0), INFO, 1.0)
    assert not centred(handle(0.0, -0.16), INFO, 1.0)
    assert not centred(handle(nan, 0.0), INFO, 1.0)


@pytest.mark.parametrize("bad", [nan, inf, -inf, 1e6, -1e300])
def test_what_cannot_be_is_not_believed(bad: float) -> None:
    assert believable((0.0, -5.0, 999_999.0))
    assert not believable((0.0, bad, 1.0))


def test_failsafes_that_turn_dangerous_in_flight_do_not_uncouple() -> None:
    assert advance(ENGAGED, FLYING._replace(unsafe="GF_ACTION = 4"), SAFETY) == (ENGAGED, None)
