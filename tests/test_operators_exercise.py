"""Missions flown by simulated operators in virtual time: stays, headings, the pad, and what happens on the way."""

import math

import pytest
from operators_support import HOP, flown, hop

from groundstation.operators.exercise import NOBODY, Exercise, _Outing
from groundstation.training.director import Stage
from groundstation.training.events import (
    BatteryLeft,
    Delay,
    DeviceLoss,
    GpsLoss,
    GustNow,
    LinkLoss,
    Loss,
    WindChange,
)
from groundstation.training.mission import Criteria, Target, Waypoint
from sim.people import PEOPLE


class Watched(_Outing):
    """A flight that is looked at with every setpoint, once the vehicle was heard."""

    def __init__(self, mission, look, operator="expert"):
        self.look = look
        super().__init__(Exercise(mission, operator, 0))

    def _look(self, sample):
        super()._look(sample)
        if self.flight.local.end.report:
            self.look(self, sample)


def seen(mission, what, operator="expert"):
    """Fly; return what `what` says of the flight at each sample, what it lacks, and how often it was uncoupled."""
    told = []
    outing = Watched(mission, lambda outing, sample: told.append(what(outing, sample)), operator)
    outing.fly()
    return told, outing.measurer.director.shortcomings(), outing.flight.local.coupling.losses


@pytest.mark.parametrize("operator", PEOPLE)
def test_everybody_flies_stays_headings_and_lands_on_the_pad(operator):
    found = flown(operator=operator)
    assert found.shortcomings == ()
    assert found.measures.reached == 1.0
    assert found.measures.landing_error_m < 0.3
    assert found.measures.time_s == pytest.approx(found.flown, abs=1.0)
    assert found.uncoupled == 0


def test_the_nose_is_turned_where_the_mission_wants_it():
    yaws, *_ = seen(HOP, lambda outing, _: (outing.measurer.director.stage, outing.flight.vehicle.p[3]))
    staying = [yaw for stage, yaw in yaws if stage is Stage.STAYING]
    assert staying
    assert all(abs(yaw - math.radians(60.0)) < math.radians(20.0) for yaw in staying)


def test_a_hand_that_does_nothing_fails_and_lands_only_where_nothing_else_is_asked():
    idle = flown(operator=NOBODY)
    assert idle.shortcomings
    assert idle.measures.reached == 0.0
    by_itself = hop(route=(), landing=None, target=Target((0.0, 0.0, 1.2), radius=0.5, hold_s=1.0))
    assert flown(by_itself, NOBODY).shortcomings == ()


def test_the_same_seed_flies_the_same_and_another_does_not():
    first, again, other = flown(seed=3), flown(seed=3), flown(seed=4)
    assert (first.measures, first.track) == (again.measures, again.track)
    assert first.measures != other.measures


def test_the_track_begins_on_the_ground_and_ends_on_the_pad():
    track = flown().track
    assert math.dist(track.points[0], (0.0, 0.0, 0.0)) < 0.3
    assert math.dist(track.points[-1], (3.0, 1.5, 0.0)) < 0.6
    assert len(track.points) == pytest.approx(flown().measures.time_s / track.every_s, abs=2)


def test_a_point_that_was_passed_too_far_off_is_flown_to_again():
    narrow = hop(
        route=(Waypoint((1.5, 0.0, 1.2), radius=0.12), Waypoint((1.5, 1.5, 1.2), radius=0.4, hold_s=0.5)),
        criteria=Criteria(time_limit_s=90.0),
    )
    assert flown(narrow, "average").shortcomings == ()


def test_the_servo_at_a_quarter_of_its_rate_measures_the_same():
    slow, fast = flown().measures, flown(rate=1000.0).measures
    assert slow.time_s == pytest.approx(fast.time_s, abs=1.0)
    assert slow.path_error_m == pytest.approx(fast.path_error_m, abs=0.03)


# What happens on the way.


def test_a_handle_that_is_gone_uncouples_and_is_taken_again_when_it_is_back():
    lost = hop(event=(DeviceLoss(leg=1, duration_s=3.0),))
    coupled, lacks, losses = seen(
        lost, lambda outing, sample: (outing.flight.local.coupling.present, sample.phase.name)
    )
    gone = [phase for present, phase in coupled if not present]
    # It is looked at with the next setpoint.
    assert set(gone[1:]) == {"DISENGAGED"}
    assert len(gone) == pytest.approx(150, abs=2)
    assert (lacks, losses) == ([], 1)


def test_people_differ_in_how_soon_they_couple_again():
    lost = hop(event=(DeviceLoss(leg=1, duration_s=3.0),))

    def cost(operator):
        return flown(lost, operator).measures.time_s - flown(operator=operator).measures.time_s

    assert cost("novice") > cost("expert") + 1.0


def test_a_silent_link_uncouples_and_the_vehicle_does_by_itself_what_px4_does():
    silent = hop(event=(LinkLoss(leg=1, duration_s=5.0),))
    modes, lacks, losses = seen(
        silent, lambda outing, sample: (sample.state_age, outing.flight.vehicle.autopilot.mode.value)
    )
    # COM_OF_LOSS_T later it returns, as there are no sticks either (NAV_RCL_ACT).
    assert {mode for age, mode in modes if age > 1.2} == {"Return"}
    assert max(age for age, _ in modes) == pytest.approx(5.0, abs=0.3)
    assert (lacks, losses) == ([], 1)


def test_a_link_can_get_slow_and_lossy_on_the_way():
    bad = hop(event=(Delay(leg=1, round_trip_s=0.3), Loss(leg=1, share=0.2)))
    told, lacks, _ = seen(
        bad, lambda outing, _: (outing.flight.local.end.round_trip, outing.flight.local.end.loss)
    )
    assert told[20][0] < 0.05
    assert told[-1][0] == pytest.approx(0.3, abs=0.06)
    assert max(loss for _, loss in told) > 0.1
    assert lacks == []


def test_wind_rises_and_a_gust_passes():
    gust = GustNow(at_s=8.0, velocity=(0.0, 3.0, 0.0), duration_s=2.0)
    windy = hop(event=(WindChange(at_s=4.0, velocity=(1.0, 0.0, 0.0)), gust))
    winds, lacks, _ = seen(windy, lambda _, sample: (sample.t, sample.wind))
    assert all(wind == (0.0, 0.0, 0.0) for t, wind in winds if t < 3.9)
    assert {wind[0] for t, wind in winds if t > 4.1} == {1.0}
    assert max(wind[1] for t, wind in winds if 8.0 < t < 10.2) == pytest.approx(3.0, abs=0.1)
    assert {wind[1] for t, wind in winds if t > 10.2} == {0.0}
    assert lacks == []


def test_a_battery_that_sinks_is_told_and_landed_with():
    low = hop(event=(BatteryLeft(leg=2, remaining=0.1),))
    told, lacks, _ = seen(low, lambda outing, _: outing.flight.local.end.report.battery)
    assert told[0] > 0.9
    assert 0.05 < told[-1] < 0.1
    assert lacks == []


def test_a_position_that_is_not_trusted_uncouples_until_it_is_again():
    blind = hop(event=(GpsLoss(leg=1, duration_s=8.0),), criteria=Criteria(time_limit_s=120.0))
    told, lacks, losses = seen(
        blind, lambda outing, sample: (outing.flight.local.end.report.trusted, sample.phase.name)
    )
    lost = [phase for trusted, phase in told if not trusted]
    assert set(lost[1:]) == {"DISENGAGED"}
    assert losses == 1
    assert lacks == []
