"""A flight in virtual time: what crosses the link, what the ground measures, and that the loop is bilateral."""

import itertools
import math

import pytest
from evaluation_support import STEP, task

from drivers.arm import STIFFNESS
from drivers.scripted import INFO
from groundstation.evaluation.flight import Setup, VirtualFlight
from groundstation.evaluation.hands import CENTRE, Adversary
from groundstation.evaluation.local_site import handle_at
from groundstation.evaluation.trial import fly, scenario_of
from groundstation.messages import Phase
from groundstation.pilot.mapping import Displacement
from groundstation.pilot.passivity.gains import physical_damping
from sim.channel import Conditions
from sim.environment.world import World
from sim.scenario import Wind


class Forward:
    """A hand that pushes forward until a time, and then rests."""

    def __init__(self, until=math.inf):
        self.until = until
        self.asked = []

    def decide(self, t, vehicle):
        self.asked.append(t)
        return Displacement((0.06, 0.0, 0.0), 0.0) if t < self.until else CENTRE


def flight(hand, seconds, observers=(), **setup):
    setup = {"rate": 250.0, "altitude": 1.0} | setup
    made = VirtualFlight(Setup(scenario_of(STEP, Wind()), **setup), lambda mapping, device: hand, observers)
    made.fly(seconds)
    return made


def test_the_vehicle_follows_the_hand_and_the_hand_feels_the_vehicle():
    seen = []
    flight(Forward(), 2.0, (seen.append,))
    engaged = [sample for sample in seen if sample.phase is Phase.ENGAGED]
    assert engaged[-1].p[0] > 0.5
    assert engaged[-1].v[0] > 0.3
    assert min(sample.outputs.force[0] for sample in engaged) < -0.2
    # The arm yields: pressed back, the handle is not where the hand wants it.
    last = engaged[-1]
    assert last.handle.position[0] - 0.06 == pytest.approx(last.outputs.force[0] / STIFFNESS, rel=0.3)


def test_samples_come_with_every_setpoint_from_take_off_on():
    seen = []
    flight(Forward(), 1.0, (seen.append,))
    steps = {round(b.t - a.t, 6) for a, b in itertools.pairwise(seen)}
    assert steps == {0.02}
    assert seen[0].t > 1.0
    assert seen[-1].clearance == pytest.approx(3.0 - 0.2 - 0.5 - seen[-1].p[0], abs=0.01)


@pytest.mark.parametrize("rate", [250.0, 1000.0])
def test_round_trip_and_loss_are_measured_not_told(rate):
    way = Conditions(delay=0.15, loss=0.2)
    found = flight(Forward(), 6.0, rate=rate, up=way, down=way, seed=3).local.end
    assert found.round_trip == pytest.approx(0.3, abs=0.03)
    assert found.loss == pytest.approx(0.2, abs=0.08)


def test_before_the_first_answer_the_round_trip_is_not_known():
    way = Conditions(delay=1.0)
    assert math.isnan(flight(Forward(), 0.5, up=way, down=way).local.end.round_trip)


def test_the_vehicle_moves_a_delay_after_the_hand():
    def begins(delay):
        seen, hand, way = [], Forward(), Conditions(delay=delay)
        flight(hand, 3.0, (seen.append,), up=way, down=way)
        moved = next(sample.t for sample in seen if abs(sample.v[0]) > 0.05)
        decided = next(sample.t for sample in seen if sample.phase is Phase.ENGAGED)
        return moved - decided

    assert begins(0.2) - begins(0.0) == pytest.approx(0.2, abs=0.05)


def test_a_silent_vehicle_uncouples_the_hand_which_couples_again_when_it_is_heard():
    seen, hand = [], Forward()
    down = Conditions(blackouts=((7.0, 8.5),))
    made = flight(hand, 9.0, (seen.append,), down=down)
    coupling = made.local.coupling
    assert coupling.losses == 1
    assert "old" in coupling.reason
    phases = [sample.phase for sample in seen if sample.state_age > 0.6]
    assert phases
    assert set(phases) == {Phase.DISENGAGED}
    assert seen[-1].phase is Phase.ENGAGED
    silent = [sample for sample in seen if sample.state_age > 1.4]
    # Told to hold, it stands.
    assert max(abs(sample.v[0]) for sample in silent) < 0.6
    assert all(sample.outputs.force == (0.0, 0.0, 0.0) for sample in silent)


def test_the_hand_wants_nothing_while_it_is_not_coupled():
    hand = Forward()
    seen = []
    flight(hand, 0.3, (seen.append,), up=Conditions(delay=0.5))
    assert {sample.phase for sample in seen} <= {Phase.DISENGAGED, Phase.ENGAGING}
    assert hand.asked == []
    assert {sample.handle.position for sample in seen} == {(0.0, 0.0, 0.0)}


def test_the_same_seed_flies_the_same_to_the_last_digit():
    lossy = {"delay": 0.1, "loss": 0.1, "jitter": 0.02, "wind": "1"}

    def figures(seed):
        found = fly(task(seed=seed, **lossy)).outcome
        return found.rms_error, found.time, found.max_force, found.hand_work

    first = figures(1)
    assert figures(1) == first
    assert figures(2) != first


def test_work_of_the_hand_is_what_the_account_of_the_port_holds():
    class Swing:
        def decide(self, t, vehicle):
            return Displacement((0.08 * math.sin(2.0 * t), 0.0, 0.0), 0.0)

    local = flight(Swing(), 4.0, rate=1000.0).local
    port = local.outputs.port
    assert local.given == pytest.approx(port.energy, abs=1e-4)
    assert abs(local.given) > 1e-3


def test_a_handle_served_less_often_keeps_its_mechanics():
    assert physical_damping(handle_at(250.0)) == pytest.approx(physical_damping(INFO))
    assert handle_at(1000.0) == INFO


def test_an_adversary_is_at_full_stick_and_wants_the_same_with_the_same_seed():
    class Mapping:
        @staticmethod
        def displacement_for(wish, yaw):
            size = math.hypot(*wish[:3])
            return Displacement(tuple(0.1 * part / size for part in wish[:3]), 0.0)

    def wants(seed):
        adversary = Adversary(Mapping, 0.1, 1.0, ((5.0, 0.0, 1.0),), seed)
        vehicle = type("Seen", (), {"position": (0.0, 0.0, 1.0, 0.0)})
        return [adversary.decide(0.02 * tick, vehicle) for tick in range(1000)]

    wanted = wants(1)
    assert all(math.hypot(*each.position) == pytest.approx(0.1) for each in wanted)
    assert len(set(wanted)) > 5
    assert wants(1) == wanted
    assert wants(2) != wanted
    assert any(each.position == pytest.approx((0.1, 0.0, 0.0)) for each in wanted), (
        "never went for the obstacle"
    )


def test_fields_are_as_their_seed_and_leave_the_pad_free():
    from groundstation.evaluation.fields import COUNT, FREE_AROUND_PAD, middles, obstacle_field

    assert obstacle_field(1) == obstacle_field(1) != obstacle_field(2)
    for seed in range(50):
        field = obstacle_field(seed)
        assert len({obstacle.name for obstacle in field}) == COUNT
        world = World(field)
        assert all(world.clearance((0.0, 0.0, 0.5 * z))[0] > FREE_AROUND_PAD - 1e-6 for z in range(12))
        assert all(
            World((one,)).clearance(at)[0] < 0.0 for one, at in zip(field, middles(field), strict=True)
        )
