"""Failsafes: every row of the table, what becomes of it over time, and whole flights."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sim_flight import DT, Flight

from sim.autopilot.conduct import WATCH_S
from sim.autopilot.failsafe import Act, Level, Row, Situation, Takeover, possible, rows
from sim.autopilot.guard import Guard
from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import SPECS, Parameters
from sim.autopilot.sticks import CENTRED, Sticks
from sim.scenario import Wind

ALL = frozenset(Mode)
BLIND = frozenset((Mode.ALTITUDE, Mode.DESCEND))
FINE = Situation(Mode.HOLD, ALL, sticks_lost=False)


def parameters(**values):
    made = Parameters()
    for name, value in values.items():
        assert made.set(name, value), name
    return made


def row(values=None, **situation):
    """Return the one row there is, or None."""
    found = rows(FINE._replace(**situation), parameters(**(values or {})))
    assert len(found) <= 1
    return found[0] if found else None


def act(values=None, **situation):
    found = row(values, **situation)
    return found.act if found else None


def test_nothing_wrong_no_row():
    assert row() is None


@pytest.mark.parametrize(
    ("action", "expected"),
    [(1, Act.HOLD), (2, Act.RETURN), (3, Act.LAND), (5, Act.TERMINATE), (6, Act.DISARM)],
)
def test_lost_sticks_and_station(action, expected):
    assert act({"NAV_RCL_ACT": action}, sticks_lost=True, sticks_needed=True) is expected
    assert act({"NAV_DLL_ACT": action}, station_lost=True) is expected


def test_lost_links_that_do_not_count():
    lost = {"sticks_lost": True, "sticks_needed": True}
    assert act(**lost) is Act.RETURN
    assert act(sticks_lost=True) is None
    assert act(station_lost=True) is None
    assert act({"NAV_DLL_ACT": 2}, station_lost=True, mode=Mode.LAND) is None
    for bit, mode in ((1, Mode.MISSION), (2, Mode.HOLD), (2, Mode.RETURN), (4, Mode.OFFBOARD)):
        assert act({"COM_RCL_EXCEPT": bit}, **lost, mode=mode) is None
        assert act({"COM_RCL_EXCEPT": 7 - bit}, **lost, mode=mode) is Act.RETURN
        assert act({"COM_DLL_EXCEPT": bit, "NAV_DLL_ACT": 2}, station_lost=True, mode=mode) is None
        assert act({"COM_DLL_EXCEPT": 7 - bit, "NAV_DLL_ACT": 2}, station_lost=True, mode=mode) is Act.RETURN


@pytest.mark.parametrize(
    ("action", "expected"),
    [(0, None), (1, Act.WARN), (2, Act.HOLD), (3, Act.RETURN), (4, Act.TERMINATE), (5, Act.LAND)],
)
def test_the_fence(action, expected):
    assert act({"GF_ACTION": action}, breach="outside") is expected


@pytest.mark.parametrize(
    ("action", "critical", "emergency"),
    [(0, Act.WARN, Act.WARN), (2, Act.LAND, Act.LAND), (3, Act.RETURN, Act.LAND)],
)
def test_the_battery(action, critical, emergency):
    set_to = {"COM_LOW_BAT_ACT": action}
    assert act(set_to, battery=Level.LOW) is Act.WARN
    assert act(set_to, battery=Level.CRITICAL) is critical
    assert act(set_to, battery=Level.EMERGENCY) is emergency
    assert act(set_to, battery=Level.CRITICAL, battery_at_arming=Level.CRITICAL) is Act.WARN
    assert act(set_to, battery=Level.EMERGENCY, battery_at_arming=Level.CRITICAL) is emergency


@pytest.mark.parametrize(
    ("action", "expected"),
    [
        (0, Act.POSITION),
        (1, Act.ALTITUDE),
        (3, Act.RETURN),
        (4, Act.LAND),
        (5, Act.HOLD),
        (6, Act.TERMINATE),
        (7, Act.DISARM),
    ],
)
def test_the_offboard_stream(action, expected):
    lost = {"mode": Mode.OFFBOARD, "stream_lost": True}
    assert act({"COM_OBL_RC_ACT": action}, **lost) is expected
    assert act({"COM_OBL_RC_ACT": action}, stream_lost=True) is None
    # Modes flown by sticks need sticks.
    without = act({"COM_OBL_RC_ACT": action, "NAV_RCL_ACT": 3}, **lost, sticks_lost=True)
    assert without is (Act.LAND if action < 3 else expected)


def test_a_lost_position():
    assert act(flyable=BLIND) is Act.RETURN
    assert act(flyable=BLIND, mode=Mode.POSITION) is Act.ALTITUDE
    assert act({"COM_POSCTL_NAVL": 1}, flyable=BLIND, mode=Mode.POSITION) is Act.LAND
    assert act(flyable=BLIND, mode=Mode.ALTITUDE) is None
    assert possible(Act.RETURN, BLIND) is Act.DESCEND
    assert possible(Act.POSITION, BLIND) is Act.ALTITUDE
    assert possible(Act.HOLD, ALL) is Act.HOLD
    assert possible(Act.LAND, frozenset()) is Act.TERMINATE


def test_attitude_and_flight_time():
    assert act(tilted=True) is Act.WARN
    assert act({"CBRK_FLIGHTTERM": 0}, tilted=True) is Act.TERMINATE
    assert act({"CBRK_FLIGHTTERM": 0}, tilted=True, just_armed=True) is Act.DISARM
    assert act(overtime=True) is Act.RETURN


SITUATIONS = st.builds(
    Situation,
    mode=st.sampled_from(Mode),
    flyable=st.sampled_from((ALL, BLIND)),
    sticks_lost=st.booleans(),
    sticks_needed=st.booleans(),
    station_lost=st.booleans(),
    stream_lost=st.booleans(),
    breach=st.sampled_from(("", "outside")),
    battery=st.sampled_from(Level),
    battery_at_arming=st.just(Level.FINE),
    overtime=st.booleans(),
    tilted=st.booleans(),
    just_armed=st.booleans(),
)
GOVERNING = (
    "NAV_RCL_ACT",
    "NAV_DLL_ACT",
    "GF_ACTION",
    "COM_LOW_BAT_ACT",
    "COM_OBL_RC_ACT",
    "COM_POSCTL_NAVL",
    "CBRK_FLIGHTTERM",
    "COM_RCL_EXCEPT",
    "COM_DLL_EXCEPT",
)


@st.composite
def governed(draw):
    made = Parameters()
    for name in GOVERNING:
        spec = SPECS[name]
        choices = spec.among or (spec.lowest, spec.highest)
        assert made.set(name, draw(st.sampled_from(choices)))
    assert made.set("COM_FAIL_ACT_T", draw(st.sampled_from((0.0, 0.5, 5.0))))
    return made


@given(SITUATIONS, governed())
def test_what_is_decided_can_be_flown_and_is_the_worst_there_is(situation, governing):
    guard = Guard(governing)
    found = rows(situation, governing)
    decision = guard.update(situation, 0.0)
    assert decision.act >= Act.DISARM or decision.mode in situation.flyable
    worst = max((row.act for row in found), default=Act.NONE)
    if decision.act is not Act.WARN or worst <= Act.WARN:
        assert max(decision.act, decision.then) >= min(worst, possible(worst, situation.flyable))


@given(st.lists(st.tuples(SITUATIONS, st.booleans(), st.booleans()), max_size=20), governed())
def test_termination_ends_everything_and_any_history_is_taken(history, governing):
    guard = Guard(governing)
    terminated = False
    for situation, switched, moved in history:
        decision = guard.update(situation, 0.3, switched=switched, sticks_moved=moved)
        terminated |= decision.act is Act.TERMINATE
        assert decision.mode in situation.flyable or decision.act >= Act.DISARM
        if terminated:
            break


# Over time


def test_an_action_waits_in_hold_and_the_sticks_then_may_take_over():
    guard = Guard(parameters(NAV_DLL_ACT=3))
    lost = FINE._replace(mode=Mode.MISSION, station_lost=True)
    decision = guard.update(lost, 0.02)
    assert (decision.act, decision.then, decision.mode) == (Act.HOLD, Act.LAND, Mode.HOLD)
    assert decision.news
    decision = guard.update(lost, 4.0, sticks_moved=True)
    assert (decision.act, decision.wanted) == (Act.HOLD, Mode.MISSION)
    decision = guard.update(lost, 1.0)
    assert (decision.act, decision.mode) == (Act.LAND, Mode.LAND)
    decision = guard.update(lost, 0.02, sticks_moved=True)
    assert (decision.act, decision.mode, decision.wanted) == (Act.WARN, Mode.POSITION, Mode.POSITION)
    decision = guard.update(lost._replace(mode=Mode.POSITION), 60.0)
    assert (decision.act, decision.mode) == (Act.WARN, Mode.POSITION)


def test_without_delay_only_another_mode_ends_an_action():
    guard = Guard(parameters(NAV_DLL_ACT=2, COM_FAIL_ACT_T=0.0))
    lost = FINE._replace(station_lost=True)
    assert guard.update(lost, 0.02).act is Act.RETURN
    assert guard.update(lost, 0.02, sticks_moved=True).act is Act.RETURN
    decision = guard.update(lost._replace(mode=Mode.POSITION), 0.02, switched=True)
    assert (decision.act, decision.mode) == (Act.WARN, Mode.POSITION)


def test_a_lost_link_that_is_back_stays_acted_on_until_the_mode_is_changed():
    guard = Guard(parameters(NAV_DLL_ACT=2, COM_FAIL_ACT_T=0.0))
    guard.update(FINE._replace(station_lost=True), 0.02)
    assert guard.update(FINE, 0.02).mode is Mode.RETURN
    assert guard.update(FINE, 0.02, switched=True).act is Act.NONE
    assert guard.update(FINE, 0.02).mode is Mode.HOLD


def test_a_worse_condition_takes_the_operator_over_again():
    guard = Guard(parameters(NAV_DLL_ACT=1, COM_FAIL_ACT_T=0.0, COM_LOW_BAT_ACT=2))
    lost = FINE._replace(station_lost=True, mode=Mode.POSITION)
    assert guard.update(lost, 0.02).mode is Mode.HOLD
    assert guard.update(lost, 0.02, switched=True).mode is Mode.POSITION
    decision = guard.update(lost._replace(battery=Level.CRITICAL), 0.02)
    assert (decision.mode, decision.cause) == (Mode.LAND, "Critical battery level, land now")


def test_nothing_ends_a_termination():
    guard = Guard(parameters(GF_ACTION=4))
    out = FINE._replace(breach="outside")
    assert guard.update(out, 0.02).act is Act.TERMINATE
    assert guard.update(out._replace(mode=Mode.POSITION), 0.02, switched=True, sticks_moved=True).act is (
        Act.TERMINATE
    )


def test_a_vehicle_that_lands_is_not_sent_home():
    guard = Guard(parameters(COM_FAIL_ACT_T=0.0))
    decision = guard.update(FINE._replace(mode=Mode.LAND, overtime=True), 0.02)
    assert (decision.act, decision.mode) == (Act.WARN, Mode.LAND)


def test_the_most_severe_wins():
    guard = Guard(parameters(GF_ACTION=2, COM_LOW_BAT_ACT=3, COM_FAIL_ACT_T=0.0))
    situation = FINE._replace(breach="outside", battery=Level.CRITICAL, mode=Mode.MISSION)
    assert guard.update(situation, 0.02).mode is Mode.RETURN
    assert guard.update(situation._replace(battery=Level.EMERGENCY), 0.02).mode is Mode.LAND


def test_rows_are_told_apart_by_their_cause():
    causes = {
        row.cause
        for breach, battery in itertools.product(("", "a", "b"), Level)
        for row in rows(FINE._replace(breach=breach, battery=battery), Parameters())
    }
    assert len(causes) == 4
    assert Row("x", Act.WARN).takeover is Takeover.DELAYED


# Whole flights


def test_a_lost_ground_station_is_ignored_by_default_and_acted_on_where_asked():
    flight = Flight().take_off()
    flight.autopilot.hear_ground_station()
    flight.run(12)
    assert flight.mode is Mode.HOLD
    flight.set("NAV_DLL_ACT", 3)
    flight.run(0.1)
    assert flight.mode is Mode.HOLD
    assert "Ground station lost: Hold for 5 s, then Land" in flight.texts
    flight.run(5)
    assert flight.mode is Mode.LAND
    assert flight.autopilot.failsafe_reason == "Ground station lost"
    flight.until(lambda: not flight.autopilot.armed, 15)
    assert not flight.autopilot.failsafe


def test_a_draining_battery_warns_then_returns_then_lands_then_falls():
    flight = Flight().set("COM_LOW_BAT_ACT", 3, "COM_FAIL_ACT_T", 0.0).take_off(12.0)
    flight.autopilot.reposition((20.0, 0.0, 12.0), None)
    flight.run(8)
    for left, text, mode in (
        (0.149, "Low battery level, return advised", Mode.HOLD),
        (0.069, "Critical battery level, land now: Return", Mode.RETURN),
        (0.049, "Emergency battery level, land immediately: Land", Mode.LAND),
    ):
        flight.sim.battery.remaining = left
        flight.run(0.5)
        assert flight.texts[-1] == text
        assert flight.mode is mode
    flight.sim.battery.remaining = 1e-7
    flight.run(0.1)
    assert not flight.autopilot.armed
    assert "Battery empty: motors stopped" in flight.texts


def test_armed_on_a_low_battery_it_only_warns_of_what_was_accepted():
    flight = Flight().set("COM_LOW_BAT_ACT", 2)
    flight.sim.battery.remaining = 0.0695
    assert flight.autopilot.arm(force=True).ok
    flight.autopilot.take_off(10.0)
    flight.run(3)
    assert flight.mode is Mode.TAKEOFF
    assert "Critical battery level, land now" in flight.texts


def test_a_lost_position_sinks_and_one_that_is_back_is_used_again():
    flight = Flight(wind=Wind(mean=(0.5, 0.0, 0.0))).take_off(12.0)
    flight.sim.inject("gps", failed=True)
    flight.until(lambda: flight.mode is not Mode.HOLD, 10)
    assert flight.mode is Mode.DESCEND
    assert flight.texts[-1] == "Position lost: Descend"
    assert not flight.autopilot.set_mode(Mode.HOLD).ok
    z = flight.sim.p[2]
    flight.run(3)
    assert flight.sim.p[2] - z == pytest.approx(-2.1, abs=0.4)
    flight.sim.inject("gps", failed=False)
    flight.run(0.1)
    assert flight.mode is Mode.HOLD
    assert flight.texts[-1] == "Failsafe over: Hold"
    flight.sim.inject("gps", failed=True)
    flight.until(lambda: not flight.autopilot.armed, 40)
    assert flight.sim.p[2] == 0.0
    assert not flight.sim.collisions
    assert flight.autopilot.arm().why == "no valid position estimate"


def test_position_mode_without_position_goes_on_by_the_sticks():
    flight = Flight("kinematic").set("COM_RC_LOSS_T", 30.0)
    flight.autopilot.sticks(CENTRED)
    flight.take_off()
    flight.autopilot.sticks(CENTRED)
    assert flight.autopilot.set_mode(Mode.POSITION).ok
    flight.sim.inject("gps", failed=True)
    flight.run(6, lambda: flight.autopilot.sticks(CENTRED))
    assert flight.mode is Mode.ALTITUDE
    flight.run(2, lambda: flight.autopilot.sticks(Sticks(up=0.5, forward=0.5)))
    assert flight.sim.v[0] > 0.5
    assert flight.sim.v[2] > 0.2


def test_overtime_and_attitude_in_flight():
    flight = Flight().set("COM_FLT_TIME_MAX", 20, "COM_FAIL_ACT_T", 0.0).take_off()
    flight.until(lambda: flight.mode is Mode.RETURN, 30)
    assert flight.autopilot.t - flight.autopilot.took_off_t == pytest.approx(20.0, abs=0.05)
    flight = Flight().set("CBRK_FLIGHTTERM", 0, "FD_FAIL_P", 1, "FD_FAIL_R", 0).take_off()
    flight.autopilot.offboard(Target(velocity=(3.0, 0.0, 0.0)))
    flight.autopilot.set_mode(Mode.OFFBOARD)
    flight.until(
        lambda: flight.autopilot.terminated,
        3,
        lambda: flight.autopilot.offboard(Target(velocity=(3.0, 0.0, 0.0))),
    )


@pytest.mark.parametrize("share", [0.1, 0.7])
def test_the_watch_keeps_its_pace_whatever_the_step(share):
    """Loss is noticed within a watch of its time, at steps short and long."""
    flight = Flight("kinematic").set("COM_OF_LOSS_T", 0.5).take_off()
    flight.autopilot.offboard(Target(velocity=(0.0, 0.0, 0.0)))
    flight.autopilot.set_mode(Mode.OFFBOARD)
    since, step = flight.sim.t, share * WATCH_S
    while flight.mode is Mode.OFFBOARD:
        flight.sim.step(step)
    assert 0.5 <= flight.sim.t - since <= 0.5 + WATCH_S + step + 1e-6


def test_a_crash_stops_the_motors_and_is_told():
    flight = Flight("kinematic").take_off(6.0)
    flight.autopilot.crash("mast", 4.2)
    flight.run(DT)
    assert not flight.autopilot.armed
    assert flight.texts[-1] == "Crashed into mast at 4.2 m/s: motors stopped"
