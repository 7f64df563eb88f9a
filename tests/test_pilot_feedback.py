from math import hypot, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.device import ZERO3
from groundstation.config import Cues
from groundstation.messages import Cue, Preset
from groundstation.pilot.choices import ALL_CUES
from groundstation.pilot.controller import position_force
from groundstation.pilot.feedback import CueForces, Feedback, Felt, hand_force
from groundstation.pilot.presets import PRESETS, Weights
from groundstation.pilot.shield.nearby import Near

vectors = st.tuples(*[st.floats(-100, 100)] * 3)
EACH = Weights(1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
CUES = Cues(environment=5.0, reach=1.2, mismatch=0.8, guard=2.5, part_limit=6.0)


def felt(**other) -> Felt:
    nothing = {"force": ZERO3, "nearest": None, "mismatch": ZERO3, "guarded": ZERO3, "velocity": ZERO3}
    return Felt(**(nothing | other))


def cues(of: Felt, weights: Weights = EACH, on: int = ALL_CUES, share: float = 1.0) -> CueForces:
    return Feedback(CUES, damping=0.4).cues(of, weights, on, share)


def wall(gap: float) -> Near:
    return Near(gap, (-1.0, 0.0, 0.0), "wall", solid=True)


def test_equation_5_worked_by_hand() -> None:
    # p̃ = (0.5, −0.25, 1), K = diag(4, 2, 3): f = (−2, 0.5, −3); yaw has no part in it.
    assert position_force((0.5, -0.25, 1.0, 2.0), (4.0, 2.0, 3.0)) == (-2.0, 0.5, -3.0)


def test_a_blocked_drone_pushes_the_hand_back() -> None:
    assert position_force((1.0, 0.0, 0.0, 0.0), (4.0, 4.0, 4.0))[0] < 0.0


def test_each_cue_worked_by_hand() -> None:
    assert cues(felt(force=(-2.0, 0.5, -3.0))).position == (-2.0, 0.5, -3.0)
    # 0.2 m nearer than the reach, 5 N a metre, away from the wall.
    assert cues(felt(nearest=wall(1.0))).environment == pytest.approx((-1.0, 0.0, 0.0))
    assert cues(felt(mismatch=(0.5, 0.0, -1.0))).mismatch == pytest.approx((0.4, 0.0, -0.8))
    assert cues(felt(guarded=(-0.4, 0.2, 0.0))).guard == pytest.approx((-1.0, 0.5, 0.0))
    assert cues(felt(velocity=(0.1, 0.0, -0.2))).damping == pytest.approx((-0.04, 0.0, 0.08))


def test_what_is_further_than_the_reach_is_not_felt_and_no_cue_but_equation_5_passes_its_bound() -> None:
    assert cues(felt(nearest=wall(1.3))).environment == ZERO3
    assert cues(felt(nearest=wall(-3.0))).environment == pytest.approx((-6.0, 0.0, 0.0))
    assert hypot(*cues(felt(guarded=(30.0, 40.0, 0.0))).guard) == pytest.approx(6.0)
    assert hypot(*cues(felt(mismatch=(30.0, 40.0, 0.0))).mismatch) == pytest.approx(6.0)
    assert cues(felt(force=(9.0, 0.0, 0.0))).position == (9.0, 0.0, 0.0)


@pytest.mark.parametrize("cue", [cue for cue in Cue if cue & ALL_CUES])
def test_every_cue_can_be_switched_off_by_itself(cue: Cue) -> None:
    everything = felt(
        force=(1.0, 0.0, 0.0), nearest=wall(0.5), mismatch=(1.0, 0.0, 0.0), guarded=(1.0, 0.0, 0.0),
        velocity=(0.1, 0.0, 0.0),
    )  # fmt: skip
    both = cues(everything), cues(everything, on=ALL_CUES & ~cue)
    for name, with_it, without in zip(CueForces._fields[:5], *(each[:5] for each in both), strict=True):
        assert without == (ZERO3 if name.upper() == cue.name else with_it)
        assert with_it != ZERO3


def test_a_poor_link_softens_the_cues_and_a_preset_weighs_them() -> None:
    assert cues(felt(nearest=wall(1.0)), share=0.5).environment == pytest.approx((-0.5, 0.0, 0.0))
    training = PRESETS[Preset.TRAINING].weights
    assert cues(felt(nearest=wall(1.0)), training).environment == pytest.approx((-1.5, 0.0, 0.0))
    paper = PRESETS[Preset.PAPER].weights
    everything = felt(
        force=(1.0, 2.0, 3.0), nearest=wall(0.1), guarded=(1.0, 0.0, 0.0), velocity=(1.0, 0.0, 0.0)
    )
    assert cues(everything, paper) == CueForces(position=(1.0, 2.0, 3.0))


def test_in_the_heading_frame_the_force_is_turned_to_the_hand_but_not_the_damping() -> None:
    # A drone that looks north and lags behind to the south: the hand is pushed back along its own x.
    parts = CueForces(position=(0.0, -3.0, 1.0), damping=(0.0, 0.5, 0.0))
    assert hand_force(parts, pi / 2, 10.0) == pytest.approx((-3.0, 0.5, 1.0))


@given(st.builds(CueForces, *[vectors] * 6), st.floats(-7, 7), st.floats(0.01, 20))
def test_no_force_is_stronger_than_the_device_and_a_clipped_one_keeps_its_direction(
    parts: CueForces, turn: float, limit: float
) -> None:
    free, clipped = hand_force(parts, turn, 1e9), hand_force(parts, turn, limit)
    assert hypot(*clipped) <= limit * (1 + 1e-12)
    share = min(1.0, limit / hypot(*free)) if any(free) else 1.0
    assert clipped == pytest.approx(tuple(share * part for part in free), abs=1e-9)
