"""A controller of the user's own: found or refused, and whatever it does, a hold and no force when it fails."""

import sys
from math import hypot, tanh
from pathlib import Path

import pytest

from drivers.device import ZERO3, DeviceInfo, HandleState
from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.messages import Phase
from groundstation.pilot.controller import PaperController, View
from groundstation.pilot.guest import load_controller
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.pilot import Memory, Pilot
from groundstation.pilot.sight import VehicleSample

INFO = DeviceInfo("test", "", 4, 0.1, 10.0, 1000.0, 1000.0, "force")
SETTINGS = Settings()
EXAMPLE = "docs.examples.soft_spring:SoftSpring"
STILL = (0.0, 0.0, 0.0, 0.0)

MODULE = '''
class Counts:
    """Sends the number of ticks since it was coupled."""

    def __init__(self, settings):
        self.settings = settings

    def start(self):
        return 0

    def step(self, state, view):
        from groundstation.pilot.controller import Law
        return state + 1, Law((0.001 * (state + 1), 0.0, 0.0, 0.0), (1.0, 0.0, 0.0))

class Breaks(Counts):
    def step(self, state, view):
        if state == 500:
            raise RuntimeError("out of ideas")
        return super().step(state, view)

class SaysNaN(Counts):
    def step(self, state, view):
        from groundstation.pilot.controller import Law
        return state, Law((0.0, float("nan"), 0.0, 0.0), (0.0, 0.0, 0.0))

class SaysNonsense(Counts):
    def step(self, state, view):
        return "well"

class CannotStart(Counts):
    def start(self):
        return self.nothing

class NeedsMore:
    def __init__(self, settings, more): ...

class IsNone:
    def __init__(self, settings): ...

wants = 3
'''


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    name = f"guest_{tmp_path.name.replace('-', '_')}"
    (tmp_path / f"{name}.py").write_text(MODULE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return name


def fly(spec: str, ticks: int = 1000) -> list:
    pilot, memory = Pilot(SETTINGS, INFO, controller=load_controller(spec, SETTINGS)), Memory()
    seen = []
    for tick in range(ticks):
        hand = HandleState((0.05, 0.0, 0.0), ZERO3, 0.0, 0, homed=True, device_time=0.001 * tick)
        memory, outputs = pilot.step(memory, Inputs(0.001, Phase.ENGAGED, False, hand, VehicleSample(), 0.0))
        seen.append(outputs)
    return seen


def test_the_paper_is_the_default_and_is_equations_4_and_5() -> None:
    controller = load_controller("paper", SETTINGS)
    assert isinstance(controller, PaperController)
    error = (0.5, -0.2, 0.1, 0.3)
    view = View(
        0.001,
        STILL,
        (1.0, 0.0, 0.0, 0.0),
        STILL,
        STILL,
        error,
        0.1,
        (1.2, 1.2, 1.2, 1.0),
        (4.0, 4.0, 4.0),
        STILL,
        ZERO3,
    )
    _, law = controller.step(controller.start(), view)
    assert law.v_ref == pytest.approx((1.0 + 1.2 * tanh(0.5), 1.2 * tanh(-0.2), 1.2 * tanh(0.1), tanh(0.3)))
    assert law.force == pytest.approx((-2.0, 0.8, -0.4))


def test_a_class_of_one_s_own_flies_with_its_state_and_within_the_limits(module: str) -> None:
    flown = fly(f"{module}:Counts", 6000)
    assert flown[0].v_ref[0] == pytest.approx(0.001)
    assert flown[-1].v_ref[0] == pytest.approx(6.0)
    assert flown[-1].setpoint[0] == pytest.approx(SETTINGS.limits.horizontal_speed)
    assert flown[-1].force[0] == pytest.approx(1.0)
    assert not any(outputs.fault for outputs in flown)


def test_its_state_begins_anew_with_every_coupling(module: str) -> None:
    pilot, memory = Pilot(SETTINGS, INFO, controller=load_controller(f"{module}:Counts", SETTINGS)), Memory()
    hand = HandleState(ZERO3, ZERO3, 0.0, 0, homed=True, device_time=0.0)
    for phase, expected in (
        (Phase.ENGAGED, 0.001),
        (Phase.ENGAGED, 0.002),
        (Phase.DISENGAGED, 0.0),
        (Phase.ENGAGED, 0.001),
    ):
        memory, outputs = pilot.step(memory, Inputs(0.001, phase, False, hand, VehicleSample(), 0.0))
        assert outputs.v_ref[0] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("Breaks", "failed (RuntimeError: out of ideas)"),
        ("SaysNaN", "answered a number that is not finite"),
        ("SaysNonsense", "failed (ValueError"),
        ("CannotStart", "failed (AttributeError"),
    ],
)
def test_whatever_goes_wrong_in_it_ends_in_a_hold_without_force(module: str, name: str, words: str) -> None:
    flown = fly(f"{module}:{name}", 501)
    assert flown[-1].setpoint == STILL
    assert words in flown[-1].fault
    assert f"{module}:{name}" in flown[-1].fault
    assert hypot(*flown[-1].force) <= max(0.0, hypot(*flown[-2].force) - 0.1)


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("neither", "neither 'paper' nor MODULE:CLASS"),
        ("no_such_module:It", "no module 'no_such_module'"),
        ("{module}:NoSuchClass", "has no NoSuchClass"),
        ("{module}:NeedsMore", "cannot be made (TypeError"),
        ("{module}:IsNone", "has no start and step"),
        ("{module}:wants", "cannot be made (TypeError"),
    ],
)
def test_what_cannot_fly_is_refused_in_a_sentence(module: str, spec: str, words: str) -> None:
    with pytest.raises(InputError, match="controller") as refused:
        load_controller(spec.format(module=module), SETTINGS)
    assert words in str(refused.value)


def test_the_example_of_the_docs_flies() -> None:
    flown = fly(EXAMPLE, 3000)
    assert flown[-1].setpoint[0] > 0.5
    assert flown[-1].force[0] < -0.5
    assert not any(outputs.fault for outputs in flown)
