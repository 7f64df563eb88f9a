"""The rigid body's equations of motion against closed forms and conservation laws."""

import math
from functools import partial
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.airframe import load_airframe
from sim.kinematics import ZERO3, ZERO4
from sim.models.motion import GRAVITY
from sim.models.rigid.constants import Limits, Physique, gains, hover, inertias, rotors
from sim.models.rigid.control import control
from sim.models.rigid.dynamics import advance, derivative, pulls

DT = 0.004
X500 = load_airframe("x500").body
PRESETS = ("crazyflie", "f450", "hummingbird", "phantom", "x500")
# No symmetry, no drag: what is conserved must be so of itself.
BARE = Physique(
    mass=1.3,
    inertia=(0.011, 0.017, 0.024),
    arm=0.2,
    rotor_radius=0.1,
    rotor_height=0.1,
    rotor_thrust=7.0,
    torque_ratio=0.02,
    motor_up_s=0.03,
    motor_down_s=0.05,
    drag=(0.0, 0.0),
)
RATES = st.tuples(*[st.floats(-6, 6)] * 3)
UNIT = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


def changed(physique, **values):
    return Physique(
        **{name: values.get(name, getattr(physique, name)) for name in physique.__struct_fields__}
    )


def state(
    position=(0.0, 0.0, 50.0), velocity=ZERO3, quaternion=(1.0, 0.0, 0.0, 0.0), rates=ZERO3, speeds=ZERO4
):
    size = math.hypot(*quaternion)
    return (*position, *velocity, *(part / size for part in quaternion), *rates, *speeds)


def flown(physique, start, seconds, command=ZERO4, wind=ZERO3, dt=DT):
    turning, body = rotors(physique, dt), inertias(physique)
    now = start
    for step in range(round(seconds / dt)):
        now = advance(now, command(step * dt) if callable(command) else command, wind, turning, body)
    return now


def onto_world(quaternion, vector):
    """By hand: q v q*."""
    w, *q = quaternion
    t = [2.0 * c for c in cross(q, vector)]
    return [v + w * a + b for v, a, b in zip(vector, t, cross(q, t), strict=True)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def accelerations(physique, now, wind=ZERO3):
    """The rates of velocity, quaternion and body rates."""
    moving = (*(v - w for v, w in zip(now[3:6], wind, strict=True)), *now[6:13])
    return derivative(now[2], moving, pulls(now[13:], rotors(physique, DT)), inertias(physique))


def test_with_rotors_stopped_a_drag_free_fall_is_the_closed_form():
    end = flown(BARE, state((1.0, 2.0, 90.0), (3.0, -1.0, 2.0), rates=(1.0, 2.0, 3.0)), 4.0)
    t = 4.0
    assert end[:3] == pytest.approx((1 + 3 * t, 2 - t, 90 + 2 * t - GRAVITY * t * t / 2), abs=1e-9)
    assert end[3:6] == pytest.approx((3.0, -1.0, 2.0 - GRAVITY * t), abs=1e-9)


@pytest.mark.parametrize("drag", [0.1, 0.5, 2.0])
def test_with_rotors_stopped_a_fall_in_drag_and_wind_is_the_closed_form(drag):
    physique = changed(BARE, drag=(drag, drag))
    wind, d, t = (4.0, -2.0, 1.0), drag / physique.mass, 4.0
    end = flown(physique, state(velocity=(1.0, 0.0, 3.0), rates=(1.0, 2.0, 3.0)), t, wind=wind)
    last = [4.0, -2.0, 1.0 - GRAVITY / d]
    left = math.exp(-d * t)
    wanted = [a + (b - a) * left for a, b in zip(last, (1.0, 0.0, 3.0), strict=True)]
    moved = [a * t + (b - a) * (1.0 - left) / d for a, b in zip(last, (1.0, 0.0, 3.0), strict=True)]
    assert end[3:6] == pytest.approx(wanted, abs=1e-6)
    assert [end[0], end[1], end[2] - 50.0] == pytest.approx(moved, abs=1e-6)


def test_drag_pulls_by_the_bodys_axes_against_the_motion_through_the_air():
    physique = changed(BARE, drag=(0.4, 0.9))
    rolled = state(quaternion=(math.cos(math.pi / 4), math.sin(math.pi / 4), 0.0, 0.0))
    pull = accelerations(physique, rolled, wind=(2.0, 3.0, 5.0))
    # Rolled by 90°, the rotors' axes lie along the world's -y: that wind meets the larger drag.
    assert pull[:3] == pytest.approx((0.4 / 1.3 * 2.0, 0.9 / 1.3 * 3.0, 0.4 / 1.3 * 5.0 - GRAVITY))


LOW = changed(X500, rotor_height=0.03)


@pytest.mark.parametrize(
    ("physique", "height", "climb"), [(X500, 0.4, 0.5), (LOW, 0.1, 4.0)], ids=["tumbling", "off the floor"]
)
def test_the_integrator_is_of_fourth_order(physique, height, climb):
    """All terms at work, commands that hold for 20 ms; errors by halving the step."""
    start = state((0.0, 0.0, height), (1.0, 2.0, climb), rates=(3.0, -2.0, 4.0), speeds=(0.3, 0.9, 0.6, 0.5))
    command = partial(wobble, period=0.02)
    fly = partial(flown, physique, start, 0.4, command, (3.0, -2.0, 1.0))
    true = fly(dt=0.00125 / 4)[:13]
    errors = [math.dist(fly(dt=dt)[:13], true) for dt in (0.01, 0.005, 0.0025)]
    for coarse, fine in pairwise(errors):
        assert 3.7 < math.log2(coarse / fine) < 4.4
    assert errors[2] < 1e-6


def wobble(t, period):
    step = math.floor(t / period + 1e-9)
    return tuple(0.6 + 0.3 * math.sin(1.7 * step + rotor) for rotor in range(4))


def test_six_seconds_at_250_hz_are_within_micrometres():
    start = state((0.0, 0.0, 60.0), rates=(0.3, -0.2, 0.4), speeds=(0.7,) * 4)
    command = lambda t: tuple(0.77 + 0.01 * part for part in wobble(t, 0.02))  # noqa: E731
    coarse = flown(X500, start, 6.0, command, (1.0, 2.0, 0.0))
    fine = flown(X500, start, 6.0, command, (1.0, 2.0, 0.0), dt=0.0005)
    assert math.dist(coarse[:3], fine[:3]) < 1e-5


def test_rotors_follow_their_exponentials_exactly_up_and_down_at_any_step():
    start = state(speeds=(0.2, 0.9, 0.5, 0.0))
    command = (0.8, 0.1, 0.5, 1.0)
    for dt in (0.001, 0.004, 0.1):
        end = flown(BARE, start, 0.1, command, dt=dt)
        up, down = math.exp(-0.1 / 0.03), math.exp(-0.1 / 0.05)
        assert end[13:] == pytest.approx((0.8 - 0.6 * up, 0.1 + 0.8 * down, 0.5, 1.0 - up), abs=1e-12)


def test_each_rotor_lifts_its_corner_and_turns_against_itself():
    turning = rotors(X500, DT)
    lever = X500.arm / math.sqrt(2.0)
    signs = {0: (-1, -1, -1), 1: (1, 1, -1), 2: (1, -1, 1), 3: (-1, 1, 1)}
    for rotor, (roll, pitch, yaw) in signs.items():
        thrust, *torques = pulls(tuple(float(rotor == one) for one in range(4)), turning)
        assert thrust == pytest.approx(X500.rotor_thrust / X500.mass)
        levers = (roll * lever, pitch * lever, yaw * X500.torque_ratio)
        wanted = [X500.rotor_thrust * arm / i for arm, i in zip(levers, X500.inertia, strict=True)]
        assert torques == pytest.approx(wanted)


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("height", [0.0, 0.3, 50.0])
def test_hover_is_a_trim_and_stays_one(name, height):
    airframe = load_airframe(name)
    limits = Limits(math.radians(airframe.tilt_deg), airframe.yaw_rate)
    turning, body = rotors(airframe.body, DT), inertias(airframe.body)
    keeping = gains(airframe.body, limits, DT)
    start, integral = hover((1.0, 2.0, height, 0.7), turning, body)
    assert max(map(abs, accelerations(airframe.body, start))) < 1e-9
    now = start
    for _ in range(1000):
        command, integral = control(now, integral, ZERO4, keeping)
        assert command == pytest.approx(start[13:], abs=1e-9)
        now = advance(now, command, ZERO3, turning, body)
    assert now == pytest.approx(start, abs=1e-9)


@given(RATES, UNIT)
def test_free_of_torque_angular_momentum_energy_and_the_quaternions_norm_are_kept(rates, quaternion):
    start = state(quaternion=quaternion, rates=rates)
    end = flown(BARE, start, 2.0)

    def momentum(now):
        return onto_world(now[6:10], [i * rate for i, rate in zip(BARE.inertia, now[10:13], strict=True)])

    def energy(now):
        return sum(i * rate * rate / 2.0 for i, rate in zip(BARE.inertia, now[10:13], strict=True))

    assert momentum(end) == pytest.approx(momentum(start), abs=1e-6)
    assert energy(end) == pytest.approx(energy(start), abs=1e-6)
    assert math.hypot(*end[6:10]) == pytest.approx(1.0, abs=1e-14)


def test_energy_is_kept_in_a_ballistic_flight():
    start = state((0.0, 0.0, 90.0), (5.0, 2.0, 8.0), rates=(2.0, -1.0, 3.0))

    def energy(now):
        return BARE.mass * (sum(v * v for v in now[3:6]) / 2.0 + GRAVITY * now[2])

    now = start
    for _ in range(1000):
        now = flown(BARE, now, DT)
        assert energy(now) == pytest.approx(energy(start), abs=1e-8)


def test_a_steady_spin_about_up_turns_the_quaternion_at_that_rate():
    end = flown(BARE, state(rates=(0.0, 0.0, 2.0)), 1.0)
    assert end[6:10] == pytest.approx((math.cos(1.0), 0.0, 0.0, math.sin(1.0)), abs=1e-9)
    assert end[10:13] == pytest.approx((0.0, 0.0, 2.0), abs=1e-12)


def test_near_the_floor_the_same_rotors_lift_more_as_cheeseman_and_bennett_say():
    speeds = (0.7,) * 4
    free = accelerations(X500, state((0.0, 0.0, 1e6), speeds=speeds))[2] + GRAVITY
    for z in (0.0, 0.1, 1.0):
        above = z + X500.rotor_height
        lifted = accelerations(X500, state((0.0, 0.0, z), speeds=speeds))[2] + GRAVITY
        assert lifted / free == pytest.approx(1.0 / (1.0 - (X500.rotor_radius / (4.0 * above)) ** 2))
    low = changed(X500, rotor_height=0.01)
    lifted = accelerations(low, state((0.0, 0.0, 0.0), speeds=speeds))[2] + GRAVITY
    assert lifted / free == pytest.approx(4.0 / 3.0)


def test_near_the_floor_rotors_tilt_more_too_but_turn_no_more():
    speeds = (0.5, 0.7, 0.6, 0.9)
    free = accelerations(LOW, state((0.0, 0.0, 1e6), speeds=speeds))[7:]
    low = accelerations(LOW, state((0.0, 0.0, 0.07), speeds=speeds))[7:]
    more = 1.0 / (1.0 - (LOW.rotor_radius / 0.4) ** 2)
    assert low == pytest.approx((more * free[0], more * free[1], free[2]))
    assert more > 1.1


@given(st.lists(st.tuples(*[st.floats(0, 1)] * 4), min_size=1, max_size=20), RATES, UNIT)
def test_whatever_the_rotors_do_the_state_stays_a_state(commands, rates, quaternion):
    now = state(quaternion=quaternion, rates=rates, speeds=(0.5,) * 4)
    for command in commands:
        now = flown(X500, now, 0.02, command, wind=(5.0, -3.0, 1.0))
        assert all(map(math.isfinite, now))
        assert math.hypot(*now[6:10]) == pytest.approx(1.0, abs=1e-12)
        assert all(0.0 <= speed <= 1.0 for speed in now[13:])
