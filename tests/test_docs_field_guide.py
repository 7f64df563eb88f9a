"""docs/field-guide.md can be followed: its commands, settings, parameters, keys and quoted words are true."""

import re
import shlex
import tomllib
from pathlib import Path

import msgspec
import pytest
from pymavlink.dialects.v20 import common as m
from servo_bench import make_run

from groundstation.cli import build_parser
from groundstation.config import Link, Settings
from groundstation.messages import CommandKind, Severity
from groundstation.processes import table
from groundstation.tui.acts import ACTS
from groundstation.vehicle.px4 import JUDGED, SINCE, SPEEDS
from sim.autopilot.parameters import SPECS
from sim.process.cli import build_parser as build_sim_parser

ROOT = Path(__file__).resolve().parents[1]
DOC = (ROOT / "docs" / "field-guide.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", DOC, re.MULTILINE | re.DOTALL)
PROSE = re.sub(r"^```.*?^```", "", DOC, flags=re.MULTILINE | re.DOTALL)
INLINE = [code.replace("\n", " ") for code in re.findall(r"`([^`]+)`", PROSE)]
COMMANDS = [
    line.partition("#")[0].strip()
    for line in (*(line for kind, block in BLOCKS if not kind for line in block.splitlines()), *INLINE)
    if line.startswith(("groundstation ", "python ", "sudo ", "pkill "))
]
# What PX4 has and is not judged here, with what the guide says of it.
NOT_JUDGED = {
    "COM_DISARM_PRFLT", "COM_DL_LOSS_T", "COM_RC_LOSS_T", "COM_RC_STICK_OV", "GF_MAX_HOR_DIST", "GF_MAX_VER_DIST",
    "MAV_0_CONFIG", "MAV_0_FORWARD", "MAV_0_MODE", "MAV_0_RATE", "MAV_PROTO_VER", "MAV_SYS_ID", "RTL_RETURN_ALT",
    "SER_TEL1_BAUD", "SER_TEL1_PROTO",
}  # fmt: skip
ADVISED = {
    "COM_OF_LOSS_T": ("0.5 to 1.0 s", (0.5, 1.0)),
    "COM_OBL_RC_ACT": ("5 (Hold), with a good position; else 4 (Land)", (5, 4)),
    "COM_RC_OVERRIDE": ("3", (3,)), "COM_RCL_EXCEPT": ("0", (0,)),
    "NAV_RCL_ACT": ("1 (Hold), 2 (Return) or 3 (Land)", (1, 2, 3)), "NAV_DLL_ACT": ("1, 2 or 3; 10 s", (1, 2, 3)),
    "COM_LOW_BAT_ACT": ("3 (Return, then Land) or 2 (Land)", (3, 2)), "GF_ACTION": ("2 (Hold); ", (2,)),
}  # fmt: skip


def rows() -> dict[str, tuple[str, str]]:
    """Return what stands in the tables of parameters: value and reason, by name."""
    cells = [line.strip("|").split(" | ") for line in DOC.splitlines() if line.startswith("| `")]
    return {
        name: (cell[1].strip(), cell[2].strip())
        for cell in cells
        if len(cell) == 3
        for name in re.findall(r"`([A-Z][A-Z0-9_]+)`", cell[0])
    }


def test_there_is_something_to_follow():
    assert len(COMMANDS) > 12
    assert any(command.startswith("python -m sim") for command in COMMANDS)
    assert any("preflight" in command for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_one(command):
    words = shlex.split(command.replace("NAME", "falcon").replace("$USER", "me").partition(">")[0])
    if words[0] == "groundstation":
        build_parser().parse_args(words[1:])
    elif words[0] == "python":
        assert words[1:3] == ["-m", "sim"]
        build_sim_parser().parse_args(words[3:])
    elif words[0] == "pkill":
        assert words[1] in {"-STOP", "-CONT"}
        processes = table(make_run("1-abcdef", ""), Path("run.json"))
        matched = [each.role for each in processes if re.search(words[3], " ".join(each.command))]
        assert matched == [words[3].partition(".")[0].replace("vehicle", "link")]
    else:
        assert words[1] in {"usermod", "systemctl"}


def test_the_settings_are_ones_that_can_be_flown_and_all_go_together():
    shown = [tomllib.loads(block) for kind, block in BLOCKS if kind == "toml"]
    assert len(shown) == 2
    together: dict[str, object] = {}
    for each in shown:
        assert not together.keys() & each.keys()
        together |= each
    settings = msgspec.convert(together, Settings)
    assert settings.limits.horizontal_speed == 1.0
    assert settings.shield.fence > settings.limits.horizontal_speed
    # Two setpoints in a row may be lost, and the third is not kept back for its age.
    assert 3.0 / settings.rates.setpoint <= settings.safety.setpoint_stale_s + 1e-9


def test_the_radios_arithmetic_is_right():
    head_and_checksum = 12
    setpoint = m.MAVLink_set_position_target_local_ned_message.unpacker.size + head_and_checksum
    state = sum(
        each.unpacker.size + head_and_checksum
        for each in (m.MAVLink_local_position_ned_message, m.MAVLink_attitude_message)
    )
    usual = Settings().rates
    assert f"A setpoint is {setpoint} bytes, and position with attitude {state}" in " ".join(DOC.split())
    assert usual.setpoint == usual.telemetry == 50.0
    assert f"that is {50 * (setpoint + state)}" in DOC
    assert f"({20 * (setpoint + state)} bytes;" in DOC


def test_every_judged_parameter_is_there_and_what_is_advised_is_well():
    found = rows()
    judged = {each.name: each for each in JUDGED}
    assert found.keys() - judged.keys() == NOT_JUDGED - {"COM_RC_LOSS_T"}
    assert judged.keys() - found.keys() == {"COM_RC_IN_MODE"}
    for name, (words, values) in ADVISED.items():
        assert found[name][0].startswith(words), name
        for value in values:
            assert judged[name].judge(value).severity is Severity.INFO, name
    assert set(SPEEDS) <= found.keys()
    for name in ("COM_RC_STICK_OV", "COM_DISARM_PRFLT"):
        assert f"{SPECS[name].default:g}" in " ".join(found[name])


def test_the_numbers_of_the_link_and_of_the_firmware_are_the_programs():
    link = Link()
    text = " ".join(DOC.split())
    for words in (
        f"under {link.good_loss:.0%}".replace("%", " %"),
        f"under {link.good_delay_s:g} s leave all gains",
        f"from {link.poor_delay_s:g} s or {link.poor_loss:.0%}".replace("%", " %"),
        f"from {link.hold_delay_s:g} s or {link.hold_loss:.0%} the vehicle holds".replace("%", " %"),
        f"older than {SINCE[0]}.{SINCE[1]}",
    ):
        assert words in text


def test_the_cards_keys_are_the_acts():
    keys = {act.kind: (act.key, act.everywhere.upper()) for act in ACTS}
    card = DOC.partition("## Card")[2]
    for kind, words in (
        (CommandKind.DISENGAGE, "`{}` or `{}`: it holds"),
        (CommandKind.HOLD, "`{}`/`{}` hold"),
        (CommandKind.LAND, "`{}`/`{}` land"),
        (CommandKind.RETURN, "`{}`/`{}` return"),
        (CommandKind.KILL, "`{}`/`{}`, then `y`"),
    ):
        assert words.format(*keys[kind]) in card


def test_words_in_italics_are_the_screens():
    code = "\n".join(
        re.sub(r'"\s*\n\s*f?"', "", file.read_text(encoding="utf-8"))
        for file in sorted((ROOT / "groundstation").rglob("*.py"))
    )
    # What QGroundControl calls its page, and emphasis, are not ours.
    quoted = set(re.findall(r"(?<!\*)\*([^*\n]+)\*(?!\*)", PROSE)) - {"Actuators", "events"}
    assert len(quoted) >= 5
    for words in quoted:
        for part in filter(None, (part.strip(" %.:") for part in words.split("…"))):
            assert part.removeprefix("link ").lower() in code.lower(), words
