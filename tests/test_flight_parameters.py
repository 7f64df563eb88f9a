"""The vehicle's parameters through all processes: read by themselves, all on demand, set and guarded."""

import pytest

from bench.rig import Program
from groundstation.messages import CommandKind, Phase
from groundstation.vehicle.parameters import cannot_be_set
from groundstation.vehicle.px4 import JUDGED
from sim.autopilot.parameters import NAMES


@pytest.mark.flight
@pytest.mark.timeout(120)
def test_failsafes_are_read_by_themselves_and_a_dangerous_one_keeps_the_hand_off(tmp_path):
    program = Program("--sim", "--logs", str(tmp_path))
    say = program.console.command

    def answered(kind, ok):
        return program.until(
            lambda view: any(each.kind == kind and bool(each.ok) is ok for each in view.answers),
            10,
            f"{kind.name} answered",
        )

    try:
        view = program.until(
            lambda view: {each.name for each in JUDGED} <= set(view.parameters), 30, "failsafes read"
        )
        assert view.parameters["COM_OF_LOSS_T"].value == 1.0
        say(CommandKind.SET_PARAMETER, name="MPC_XY_CRUISE", amount=8.0)
        answered(CommandKind.SET_PARAMETER, ok=False)
        say(CommandKind.PARAMETERS)
        view = answered(CommandKind.PARAMETERS, ok=True)
        assert set(NAMES) <= set(view.parameters)
        assert view.parameters["MPC_XY_CRUISE"].count == len(view.parameters)
        say(CommandKind.SET_PARAMETER, name="COM_OBL_RC_ACT", amount=6.0)
        program.until(lambda view: b"COM_OBL_RC_ACT = 6" in view.status.unsafe, 5, "called unsafe")
        say(CommandKind.SET_PARAMETER, name="COM_OBL_RC_ACT", amount=99.0)
        answered(CommandKind.SET_PARAMETER, ok=False)
        say(CommandKind.ARM)
        program.until(lambda view: view.status.armed, 20, "armed")
        say(CommandKind.SET_PARAMETER, name="COM_OBL_RC_ACT", amount=5.0)
        answered(CommandKind.SET_PARAMETER, ok=False)
        say(CommandKind.TAKEOFF)
        program.until(lambda view: view.vehicle.position[2] > 1.5, 20, "in the air")
        say(CommandKind.ENGAGE)
        why = b"Engage refused: COM_OBL_RC_ACT = 6"
        program.until(lambda view: any(why in each.text for each in view.events), 10, "refused for that")
        assert view.pilot.phase == Phase.DISENGAGED
    finally:
        program.close()
    assert program.process.returncode == 143


@pytest.mark.parametrize(
    ("amount", "whole", "armed", "words"),
    [
        (1.0, True, False, ""),
        (0.5, False, False, ""),
        (0.5, True, False, "whole"),
        (1.0, True, True, "armed"),
        (float("nan"), False, False, "no number"),
        (float("inf"), True, False, "no number"),
        (3e9, True, False, "no number"),
    ],
)
def test_what_cannot_be_set_is_refused_with_its_reason(amount, whole, armed, words):
    said = cannot_be_set(amount, whole=whole, armed=armed)
    assert words in said
    assert bool(said) is bool(words)
