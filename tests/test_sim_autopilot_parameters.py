"""Parameters: what they may be, and that each of them does in flight what it is there for."""

import itertools
import math

import pytest
from sim_flight import DT, Flight

from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import NAMES, SPECS, Parameters
from sim.autopilot.sticks import CENTRED, Sticks
from sim.scenario import Wind


def test_every_default_is_one_that_may_be_set():
    parameters = Parameters()
    assert all(parameters.set(name, SPECS[name].default) for name in NAMES)
    assert parameters.changed == len(NAMES)
    assert list(NAMES) == sorted(NAMES)
    assert all(len(name) <= 16 for name in NAMES)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("MIS_TAKEOFF_ALT", -0.1),
        ("MIS_TAKEOFF_ALT", math.nan),
        ("COM_OF_LOSS_T", math.inf),
        ("COM_OBL_RC_ACT", 2.0),
        ("COM_OBL_RC_ACT", 4.5),
        ("NAV_DLL_ACT", 4.0),
        ("SIM_UP_LOSS", 1.1),
    ],
)
def test_what_a_parameter_cannot_be_is_not_taken(name, value):
    parameters = Parameters()
    before = parameters[name]
    assert not parameters.set(name, value)
    assert parameters[name] == before
    assert parameters.changed == 0


def fastest(flight, seconds, axis):
    """Return the greatest speed along an axis of the vehicle."""
    speeds = []
    flight.run(seconds, lambda: speeds.append(abs(flight.sim.v[axis])))
    return max(speeds)


def repositioned(flight, x, y, z, yaw=None):
    flight.take_off(4.0)
    assert flight.autopilot.reposition((x, y, z), yaw).ok
    return flight


def climbing(flight):
    flight.autopilot.arm()
    flight.autopilot.take_off(8.0)
    return fastest(flight, 4, 2)


def rising(flight):
    return fastest(repositioned(flight, 0, 0, 20.0), 4, 2)


def sinking(flight):
    repositioned(flight, 0, 0, 20.0).run(15)
    flight.autopilot.reposition((0.0, 0.0, 5.0), None)
    return fastest(flight, 4, 2)


def landing(height):
    def measure(flight):
        flight.take_off(height)
        flight.autopilot.set_mode(Mode.LAND)
        return fastest(flight, 2.5, 2)

    return measure


def turning(flight):
    repositioned(flight, 0, 0, 4.0, 3.0)
    return fastest(flight, 2, 3)


def turned(flight):
    repositioned(flight, 0, 0, 4.0, 0.3).run(0.5)
    return flight.sim.p[3]


def gathering_speed(axis, *place):
    def measure(flight):
        repositioned(flight, *place).run(0.4)
        return abs(flight.sim.v[axis])

    return measure


def approaching(axis, *place):
    """Return the speed a second after being sent near."""

    def measure(flight):
        repositioned(flight, *place).run(1)
        return abs(flight.sim.v[axis])

    return measure


def by_stick(axis, **stick):
    """Return the speed after three seconds of a stick."""

    def measure(flight):
        flight.set("COM_RC_LOSS_T", 35.0)
        flight.autopilot.sticks(CENTRED)
        flight.take_off(3.0)
        flight.autopilot.sticks(CENTRED)
        assert flight.autopilot.set_mode(Mode.POSITION).ok
        flight.run(3, lambda: flight.autopilot.sticks(Sticks(**stick)))
        return abs(flight.sim.v[axis])

    return measure


# Name, two values, what is measured; the second gives more, or where `exact`, it is what was measured.
MORE = [
    ("MPC_XY_P", 0.3, 0.95, approaching(0, 2, 0, 4)),
    ("MPC_Z_P", 0.3, 1.0, approaching(2, 0, 0, 5)),
    ("MPC_XY_VEL_P_ACC", 1.2, 4.0, gathering_speed(0, 2, 0, 4)),
    ("MPC_Z_VEL_P_ACC", 2.0, 8.0, gathering_speed(2, 0, 0, 5)),
    ("MPC_ACC_HOR_MAX", 2.0, 6.0, gathering_speed(0, 30, 0, 4)),
    ("MC_YAW_P", 0.5, 2.8, turned),
    ("MPC_XY_MAN_EXPO", 1.0, 0.0, by_stick(0, forward=0.5)),
    ("MPC_Z_MAN_EXPO", 1.0, 0.0, by_stick(2, up=0.5)),
    ("MPC_YAW_EXPO", 1.0, 0.0, by_stick(3, yaw=0.5)),
    ("MPC_HOLD_DZ", 0.5, 0.1, by_stick(0, forward=0.6)),
    ("MPC_LAND_ALT1", 6.0, 30.0, lambda flight: -landing(8.0)(flight)),
    ("MPC_LAND_ALT2", 1.0, 7.0, lambda flight: -landing(8.0)(flight)),
]


@pytest.mark.parametrize(("name", "less", "more", "measure"), MORE, ids=[entry[0] for entry in MORE])
def test_more_of_it_gives_more(name, less, more, measure):
    low, high = (measure(Flight().set(name, value)) for value in (less, more))
    assert high - low > 0.02


EXACT = [
    ("MPC_TKO_SPEED", 1.2, climbing),
    ("MPC_Z_V_AUTO_UP", 2.0, rising),
    ("MPC_Z_V_AUTO_DN", 1.0, sinking),
    ("MPC_Z_VEL_MAX_UP", 1.0, by_stick(2, up=1.0)),
    ("MPC_Z_VEL_MAX_DN", 0.5, by_stick(2, up=-1.0)),
    ("MPC_LAND_SPEED", 1.1, landing(4.5)),
]


@pytest.mark.parametrize(("name", "value", "measure"), EXACT, ids=[entry[0] for entry in EXACT])
def test_a_speed_is_what_it_says(name, value, measure):
    assert measure(Flight("kinematic").set(name, value)) == pytest.approx(value, rel=0.02)


def test_the_turn_rate_of_setpoints_is_limited_too():
    flight = (
        Flight("kinematic").set("MC_YAWRATE_MAX", 25.0).take_off().fly((0.0, 0.0, 0.0), 1.0, yaw_rate=-2.0)
    )
    assert flight.sim.v[3] == pytest.approx(-math.radians(25.0), rel=0.01)


def test_the_turn_rate_is_limited():
    assert turning(Flight("kinematic").set("MPC_YAWRAUTO_MAX", 20.0)) == pytest.approx(
        math.radians(20), rel=0.01
    )


@pytest.mark.parametrize(
    ("name", "axis", "wind", "seconds"),
    [("MPC_XY_VEL_I_ACC", 0, (1.0, 0.0, 0.0), 15), ("MPC_Z_VEL_I_ACC", 2, (0.0, 0.0, 1.5), 3)],
)
def test_the_integrator_is_what_holds_against_wind(name, axis, wind, seconds):
    errors = []
    for value in (SPECS[name].lowest, SPECS[name].default):
        flight = Flight(wind=Wind(mean=wind)).set(name, value).take_off(3.0)
        assert flight.autopilot.reposition((0.0, 0.0, 3.0), None).ok
        flight.run(seconds)
        errors.append(abs(flight.sim.p[axis] - (0.0, 0.0, 3.0)[axis]))
    assert errors[0] > 2.0 * errors[1]


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("BAT_LOW_THR", 0.4, "Low battery level, return advised"),
        ("BAT_CRIT_THR", 0.4, "Critical battery level, land now"),
        ("BAT_EMERGEN_THR", 0.4, "Emergency battery level, land immediately"),
    ],
)
def test_battery_thresholds(name, value, text):
    flight = Flight().set(name, value).take_off()
    flight.sim.battery.remaining = 0.41
    flight.run(0.1)
    assert text not in flight.texts
    flight.sim.battery.remaining = 0.39
    flight.run(0.1)
    assert flight.texts[-1] == text


def test_how_long_a_ground_station_may_be_silent():
    flight = Flight().set("NAV_DLL_ACT", 1, "COM_DL_LOSS_T", 20).take_off()
    flight.autopilot.hear_ground_station()
    since = flight.sim.t
    flight.until(lambda: flight.autopilot.failsafe, 30)
    assert flight.sim.t - since == pytest.approx(20.0, abs=0.05)


def leaning(seconds, **values):
    """Fly off fast, leaning by more than a degree, at once after arming."""
    flight = Flight("kinematic").set("CBRK_FLIGHTTERM", 0)
    for name, value in values.items():
        flight.set(name, value)
    flight.autopilot.arm()
    velocity = itertools.cycle(((3.0, 0.0, 1.0), (0.0, 3.0, 1.0)))
    flight.autopilot.offboard(Target(velocity=next(velocity)))
    flight.autopilot.set_mode(Mode.OFFBOARD)
    for _ in range(round(seconds / 0.1)):
        target = Target(velocity=next(velocity))
        flight.run(0.1, lambda target=target: flight.autopilot.offboard(target))
    return flight


def test_leaning_too_far_too_long():
    both = {"FD_FAIL_P": 1, "FD_FAIL_R": 1}
    assert not leaning(2.0).autopilot.terminated
    flight = leaning(2.0, **both, FD_FAIL_P_TTRI=0.05, COM_LKDOWN_TKO=-1.0)
    assert flight.autopilot.terminated
    flight = leaning(2.0, **both, FD_FAIL_R_TTRI=0.05, COM_LKDOWN_TKO=-1.0)
    assert flight.autopilot.terminated
    flight = leaning(2.0, **both, FD_FAIL_P_TTRI=0.05, COM_LKDOWN_TKO=5.0)
    assert not flight.autopilot.terminated
    assert not flight.autopilot.armed
    assert "Attitude failure: motors stopped" in flight.texts
    flight = leaning(2.0, **both, FD_FAIL_P_TTRI=5.0, FD_FAIL_R_TTRI=5.0)
    assert flight.autopilot.armed


def test_changed_in_flight_it_counts_within_a_moment():
    flight = repositioned(Flight("kinematic"), 60, 0, 4)
    flight.run(3)
    assert flight.sim.v[0] == pytest.approx(5.0, rel=0.01)
    flight.set("MPC_XY_CRUISE", 2.0).run(0.02 + DT)
    flight.run(1.5)
    assert flight.sim.v[0] == pytest.approx(2.0, rel=0.02)
