"""What the source must never do with what comes from outside, and that names from outside lead nowhere else."""

from __future__ import annotations

import ast
import datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.cli import main
from groundstation.config import load_settings
from groundstation.errors import InputError
from groundstation.fly import log_stem
from groundstation.shown import shown
from groundstation.training.mission import MissionError, load_mission

ROOT = Path(__file__).parents[1]
SOURCES = [
    path for name in ("groundstation", "sim", "drivers") for path in sorted((ROOT / name).rglob("*.py"))
]
CALLS = {
    "eval",
    "exec",
    "compile",
    "__import__",
    "os.system",
    "os.popen",
    "yaml.load",
    "marshal.loads",
}
MODULES = {"pickle", "marshal", "shelve", "dill", "cloudpickle", "telnetlib", "ftplib", "xmlrpc", "xml"}
NOW = datetime.datetime(2026, 1, 2, 3, 4, 5, tzinfo=datetime.UTC)
MISSION = """
schema = 1
name = "{name}"
title = "x"
[target]
position = [0.0, 0.0, 2.0]
hold_s = 1.0
[criteria]
time_limit_s = 2.0
"""


def opens(name: str, word: ast.keyword) -> bool:
    """Say whether a keyword lets a shell or a pickle in."""
    off = isinstance(word.value, ast.Constant) and not word.value.value
    return not off and (
        word.arg == "allow_pickle" or (word.arg == "shell" and name.startswith("subprocess."))
    )


def faults(tree: ast.AST) -> list[str]:
    """Return what a source does that it must not; a `noqa` is no excuse."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            found += [name] if name in CALLS else []
            found += [f"{name}({word.arg}=…)" for word in node.keywords if opens(name, word)]
        elif isinstance(node, ast.Import):
            found += [each.name for each in node.names if each.name.partition(".")[0] in MODULES]
        elif isinstance(node, ast.ImportFrom):
            found += [node.module] if (node.module or "").partition(".")[0] in MODULES else []
    return found


def test_no_shell_no_pickle_no_code_out_of_data():
    found = {path: faults(ast.parse(path.read_text(encoding="utf-8"))) for path in SOURCES}
    assert len(found) > 100
    assert {path: done for path, done in found.items() if done} == {}


@pytest.mark.parametrize(
    "source",
    ["eval(x)", "import pickle", "from pickle import loads", "subprocess.run(x, shell=True)", "os.system(x)",
     "np.load(x, allow_pickle=flag)"],
)  # fmt: skip
def test_it_would_be_seen(source):
    assert faults(ast.parse(source))


@pytest.mark.parametrize("name", ["../evil", "a/b", "/etc/x", "a\\\\b", "..\\\\x", "a\\u0000b", ""])
def test_a_mission_whose_name_is_a_path_is_refused(tmp_path, name):
    path = tmp_path / "mission.toml"
    path.write_text(MISSION.format(name=name))
    with pytest.raises(MissionError):
        load_mission(path)


@given(name=st.from_regex(r"\A[\w .\-]{1,48}\Z"))
def test_a_recording_stays_in_its_folder_whatever_the_mission_is_called(tmp_path_factory, name):
    folder = tmp_path_factory.getbasetemp() / "logs"
    stem = log_stem(folder, NOW, name)
    assert stem.parent == folder.resolve()
    assert Path(f"{stem}.rrd").resolve().parent == folder.resolve()


def written(folder, text):
    path = folder / "given.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "text",
    ["level = " + "9" * 5000, "level = 0x" + "f" * 6000, "x = " + "[" * 50_000, "a." * 20_000 + "b = 1",
     "x = 1" + "0" * 400],
    ids=["digits", "hex", "nested", "dotted", "long"],
)  # fmt: skip
@pytest.mark.parametrize("load", [load_mission, load_settings])
def test_a_file_made_to_break_its_reader_is_refused_in_a_sentence(tmp_path, text, load):
    with pytest.raises(InputError, match=r"given\.toml: "):
        load(written(tmp_path, f"{text}\n"))


@pytest.mark.parametrize("evil", ["\\u001b[2J", "\\u0007", "\\u009b2J"])
def test_a_mission_that_would_command_a_terminal_is_refused(tmp_path, evil):
    with pytest.raises(MissionError, match="title: has a control character"):
        load_mission(written(tmp_path, MISSION.format(name="m").replace('"x"', f'"x{evil}"')))


def test_an_error_shows_what_was_given_and_commands_no_terminal(tmp_path, capsys):
    path = written(tmp_path, '"\\u001b[2Jx" = 1\n')
    with pytest.raises(SystemExit) as end:
        main(["missions", "show", str(path)])
    assert end.value.code == 2
    told = capsys.readouterr().err
    assert "?[2Jx" in told
    assert "\x1b" not in told


@given(st.text())
def test_what_is_shown_is_text_of_the_same_length(text):
    assert len(shown(text)) == len(text)
    assert shown(text).translate({10: " ", 9: " "}).isprintable()
