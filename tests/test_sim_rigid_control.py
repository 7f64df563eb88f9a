"""The rigid body under its own control, every preset that has one: it flies as asked, within its limits."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.airframe import MODELS, load_airframe
from sim.kinematics import ZERO3, ZERO4
from sim.models.dynamic import respond
from sim.models.motion import GRAVITY
from sim.models.rigid.constants import Limits, gains
from sim.models.rigid.control import control

DT = 0.004
PRESETS = ("crazyflie", "f450", "hummingbird", "phantom", "x500")
HIGH = (0.0, 0.0, 40.0, 0.4)
X500 = load_airframe("x500")
KEEPING = gains(X500.body, Limits(math.radians(X500.tilt_deg), X500.yaw_rate), DT)
ANGLES = st.floats(-math.pi, math.pi)
SPEEDS = st.tuples(*[st.floats(-20, 20)] * 3)


def hovering(name, p=HIGH):
    motion = MODELS["rigid_body"](load_airframe(name))
    return motion, *motion.hover(p)


def flown(motion, p, v, v_ref, seconds, wind=ZERO3, each=lambda p, v: None):
    for _ in range(round(seconds / DT)):
        p, v = motion.step(p, v, v_ref, wind, DT)
        each(p, v)
    return p, v


def tilt(motion):
    return math.acos(math.cos(motion.attitude.roll) * math.cos(motion.attitude.pitch))


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("axis", range(4))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_velocity_asked_for_is_reached_soon_with_little_overshoot(name, axis, sign):
    airframe = load_airframe(name)
    sizes = (
        min(airframe.horizontal_speed, 3.0),
        min(airframe.horizontal_speed, 3.0),
        airframe.climb_speed if sign > 0.0 else airframe.descent_speed,
        airframe.yaw_rate,
    )
    v_ref = tuple(sign * size if own == axis else 0.0 for own, size in enumerate(sizes))
    motion, p, v = hovering(name)
    shares, others, tilts = [], [], []

    def note(p, v):
        shares.append(v[axis] / v_ref[axis])
        others.append(max(abs(v[own]) for own in range(4) if own != axis))
        tilts.append(tilt(motion))

    flown(motion, p, v, v_ref, 6.0, each=note)
    assert max(shares) < 1.1
    assert min(shares[600:]) > 0.85
    assert shares[-1] == pytest.approx(1.0, abs=0.05)
    assert max(others) < 0.2
    assert max(tilts) < math.radians(airframe.tilt_deg) * 1.1
    # It does not ring: once near, it does not cross again and again.
    late = [share - shares[-1] for share in shares[500:]]
    assert sum(a * b < -1e-8 for a, b in pairwise(late)) <= 2


@pytest.mark.parametrize("name", PRESETS)
def test_steady_wind_is_leant_against_and_no_velocity_is_left(name):
    motion, p, v = hovering(name)
    worst = []
    p, v = flown(
        motion, p, v, ZERO4, 30.0, wind=(4.0, 2.0, 0.5), each=lambda p, v: worst.append(math.hypot(*v[:3]))
    )
    assert max(worst) < 1.0
    assert math.hypot(*v[:3]) < 0.01
    # It leans against the drag: the thrust's horizontal part is the drag's.
    lean = math.atan2(math.tan(motion.attitude.pitch), 1.0), math.tan(motion.attitude.roll)
    assert math.hypot(math.tan(lean[0]), lean[1]) * GRAVITY == pytest.approx(
        load_airframe(name).body.drag[0] / load_airframe(name).body.mass * math.hypot(4.0, 2.0), rel=0.1
    )


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("degrees", [60.0, 120.0, 179.0])
def test_upset_in_mid_air_it_rights_itself(name, degrees):
    motion, *_ = hovering(name)
    half = math.radians(degrees) / 2.0
    turned = (math.cos(half), 0.8 * math.sin(half), 0.6 * math.sin(half), 0.0)
    p, v = motion.place((*motion.state[:6], *turned, 1.0, -1.0, 0.5, *motion.state[13:]))
    rates = []
    p, v = flown(motion, p, v, ZERO4, 2.0, each=lambda p, v: rates.append(max(map(abs, motion.state[10:12]))))
    assert max(rates) < math.radians(220.0) * 1.1
    assert tilt(motion) < math.radians(12.0)
    p, v = flown(motion, p, v, ZERO4, 6.0)
    assert tilt(motion) < math.radians(2.0)
    assert math.hypot(*v[:3]) < 0.15
    assert p[2] > HIGH[2] - 7.0


@pytest.mark.parametrize("name", PRESETS)
def test_a_reference_far_beyond_it_saturates_and_is_recovered_from(name):
    airframe = load_airframe(name)
    motion, p, v = hovering(name, (0.0, 0.0, 400.0, 0.0))
    tilts, commands = [], []

    def note(p, v):
        tilts.append(tilt(motion))
        commands.append(max(motion.state[13:]))

    p, v = flown(motion, p, v, (60.0, -40.0, 30.0, 9.0), 5.0, each=note)
    assert max(tilts) < math.radians(airframe.tilt_deg) + 0.1
    assert max(commands) <= 1.0
    assert v[3] <= airframe.yaw_rate * 1.05
    p, v = flown(motion, p, v, ZERO4, 12.0)
    assert math.hypot(*v[:3]) < 0.2
    assert abs(v[3]) < 0.01


@pytest.mark.parametrize("name", PRESETS)
def test_the_airframes_own_velocity_response_describes_its_rigid_body(name):
    """χ, where it was fitted to the body or estimated, explains most of what the body does."""
    airframe = load_airframe(name)
    motion, p, v = hovering(name, (0.0, 0.0, 60.0, 0.0))
    sizes = (0.3 * min(airframe.horizontal_speed, 4.0), 0.3 * min(airframe.horizontal_speed, 4.0), 0.3, 0.3)
    simple = ((0.0, 0.0, 60.0, 0.0), ZERO4)
    chi = tuple(getattr(airframe.chi, key) for key in airframe.chi.__struct_fields__)
    truth, told = [], []
    for step in range(round(40.0 / DT)):
        t = step * DT
        v_ref = tuple(
            size * (math.sin(0.6 * t + own) + math.sin(1.5 * t + 2.0 * own)) for own, size in enumerate(sizes)
        )
        p, v = motion.step(p, v, v_ref, ZERO3, DT)
        simple = respond(*simple, v_ref, ZERO3, (chi, 0.0, DT))
        truth.append(v)
        told.append(simple[1])
    for own in range(4):
        spread = sum(a[own] ** 2 for a in truth)
        assert 1.0 - sum((a[own] - b[own]) ** 2 for a, b in zip(truth, told, strict=True)) / spread > 0.97


@given(ANGLES, SPEEDS, SPEEDS, st.floats(-4, 4))
def test_it_flies_the_same_whatever_its_heading(turn, velocity, wanted, yaw_rate):
    """The world turned about its vertical, nothing else changes: neither commands nor the turned integral."""
    c, s = math.cos(turn), math.sin(turn)
    w, x, y, z = 0.9, 0.2, -0.3, math.sqrt(1.0 - 0.81 - 0.04 - 0.09)
    rest = (0.4, -0.2, 0.7, 0.5, 0.6, 0.4, 0.7)
    v_ref = (*wanted, yaw_rate)
    command, integral = control(
        (0.0, 0.0, 9.0, *velocity, w, x, y, z, *rest), (0.3, -0.2, 0.1), v_ref, KEEPING
    )
    ch, sh = math.cos(turn / 2.0), math.sin(turn / 2.0)
    turned = (ch * w - sh * z, ch * x - sh * y, ch * y + sh * x, ch * z + sh * w)
    there = (c * velocity[0] - s * velocity[1], s * velocity[0] + c * velocity[1], velocity[2])
    again, after = control(
        (0.0, 0.0, 9.0, *there, *turned, *rest),
        (c * 0.3 + s * 0.2, s * 0.3 - c * 0.2, 0.1),
        v_ref,
        KEEPING,
    )
    assert again == pytest.approx(command, abs=1e-6)
    # The integral's limits are by axis: below them it turns with the world.
    assert after[2] == pytest.approx(integral[2], abs=1e-9)


@given(SPEEDS, SPEEDS, st.tuples(*[st.floats(-9, 9)] * 3), st.tuples(*[st.floats(0, 1)] * 4), ANGLES, ANGLES)
def test_commands_are_shares_of_the_largest_speed_whatever_is_asked(
    velocity, wanted, rates, speeds, roll, pitch
):
    a, b = math.cos(roll / 2.0), math.sin(roll / 2.0)
    c, d = math.cos(pitch / 2.0), math.sin(pitch / 2.0)
    now = (0.0, 0.0, 9.0, *velocity, a * c, b * c, a * d, -b * d, *rates, *speeds)
    command, integral = control(now, (50.0, 0.0, -50.0), (*wanted, 3.0), KEEPING)
    assert all(0.0 <= speed <= 1.0 for speed in command)
    assert all(abs(part) <= KEEPING[4] for part in integral)


def test_upright_or_not_a_climb_never_costs_the_attitude():
    """Saturated upward, roll still has its full torque: the sum gives way, not the difference."""
    climbing = (0.0, 0.0, 9.0, 0.0, 0.0, -20.0, 1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.9, 0.9, 0.9, 0.9)
    (n1, n2, n3, n4), _ = control(climbing, ZERO3, (0.0, 0.0, 20.0, 0.0), KEEPING)
    level = (*climbing[:5], 0.0, *climbing[6:])
    (m1, m2, m3, m4), _ = control(level, ZERO3, ZERO4, KEEPING)
    assert n2 * n2 + n3 * n3 - n1 * n1 - n4 * n4 == pytest.approx(m2 * m2 + m3 * m3 - m1 * m1 - m4 * m4)
    assert max(n1, n2, n3, n4) == pytest.approx(1.0)


@pytest.mark.parametrize("name", PRESETS)
@pytest.mark.parametrize("axis", [0, 1])
def test_a_knock_dies_away_without_ringing(name, axis):
    """2 rad/s about forward or left, hovering: over soon, with one swing back and no more."""
    motion, *_ = hovering(name)
    knocked = [*motion.state]
    knocked[10 + axis] = 2.0
    p, v = motion.place(tuple(knocked))
    rates = []
    flown(motion, p, v, ZERO4, 1.5, each=lambda p, v: rates.append(motion.state[10 + axis]))
    assert -0.8 < min(rates) < 0.0
    assert max(rates[100:]) < 0.1
    assert max(map(abs, rates[200:])) < 0.05


@given(ANGLES, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-1, 1))
def test_a_leaning_turn_in_trim_asks_for_no_torque(heading, roll, pitch, yaw_rate):
    """Leaning as wanted, turning about the world's up at the rate wanted: the four commands are one."""
    q = times((math.cos(heading / 2.0), 0.0, 0.0, math.sin(heading / 2.0)), lean_of(roll, pitch))
    w, x, y, z = q
    # The body's up in the world, and the world's up on the body: the quaternion's matrix by hand.
    up = (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y))
    onto = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), up[2])
    integral = (GRAVITY * up[0] / up[2], GRAVITY * up[1] / up[2], 0.0)
    now = (0.0, 0.0, 9.0, 0.0, 0.0, 0.0, *q, *(part * yaw_rate for part in onto), 0.7, 0.7, 0.7, 0.7)
    command, _ = control(now, integral, (0.0, 0.0, 0.0, yaw_rate), KEEPING)
    assert command == pytest.approx([command[0]] * 4, abs=1e-9)
    thrust = 4.0 * command[0] ** 2 * X500.body.rotor_thrust / X500.body.mass
    assert thrust == pytest.approx(GRAVITY / up[2])


def lean_of(roll, pitch):
    a, b = math.cos(roll / 2.0), math.sin(roll / 2.0)
    c, d = math.cos(pitch / 2.0), math.sin(pitch / 2.0)
    return a * c, b * c, a * d, -b * d


def times(first, second):
    w, x, y, z = first
    a, b, c, d = second
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )


def test_yaw_comes_last_it_costs_neither_thrust_nor_tilt():
    hover_state = (0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -9.0, *[0.768] * 4)
    command, _ = control(hover_state, ZERO3, (0.0, 0.0, 0.0, 1.0), KEEPING)
    n1, n2, n3, n4 = (speed * speed for speed in command)
    assert n1 + n2 + n3 + n4 == pytest.approx(X500.body.mass * GRAVITY / X500.body.rotor_thrust)
    assert (n2 + n3 - n1 - n4, n2 + n4 - n1 - n3) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert n3 == pytest.approx(1.0)
