"""The command line as a user meets it: help at once, one sentence and exit 2 for what is wrong."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from groundstation.cli import build_parser, main

CONNECT = "udpin://127.0.0.1:14998"


def run(*arguments, **options):
    return subprocess.run(
        [sys.executable, "-m", "groundstation.cli", *arguments],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=60,
        check=False,
        **options,
    )


def test_help_names_every_way_to_start_and_imports_nothing_heavy():
    code = (
        "import sys\n"
        "from groundstation.cli import build_parser\n"
        "text = build_parser().format_help()\n"
        "assert '--sim' in text and '--connect' in text and 'review' in text\n"
        "heavy = {'numpy', 'textual', 'rerun', 'mavsdk', 'pymavlink', 'iceoryx2', 'msgspec'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_simulators_models_may_be_asked_for():
    from typing import get_args

    from sim.airframe import Model

    action = next(action for action in build_parser()._actions if action.dest == "model")
    assert action.choices == get_args(Model)


def test_version_and_help_end_well():
    assert run("--version").stdout.startswith("groundstation ")
    done = run("--help")
    assert done.returncode == 0
    assert "examples:" in done.stdout


def test_nothing_asked_prints_help_and_is_bad_input():
    done = run()
    assert done.returncode == 2
    assert "usage:" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--sim", "--headless"], "needs a --mission"),
        (["--sim", "--headless", "--mission", "nowhere"], "no such mission"),
        (["--sim", "--headless", "--mission", "/nowhere/m.toml"], "cannot be read"),
        (["--sim", "--mission", "paper"], "needs a terminal"),
        (["--connect", "udp://wrong"], "needs a terminal"),
        (
            ["--connect", "nonsense", "--headless", "--mission", "paper", "--confirm-real"],
            "not a vehicle's URL",
        ),
        (["--connect", "udpin://0.0.0.0:14540", "--headless", "--mission", "paper"], "--confirm-real"),
        (["--sim", "--connect", "udpin://0.0.0.0:14540"], "not allowed with"),
        (["--sim", "--json"], "add --headless"),
        (["--sim", "--headless", "--mission", "hover", "--device", "falcon"], "leave --device out"),
        (["--connect", "udpin://0.0.0.0:1", "--airframe", "x"], "the simulator's"),
        (["--sim", "--headless", "--mission", "hover", "--config", "/nowhere.toml"], "cannot be read"),
        (["--sim", "--headless", "--mission", "hover", "--airframe", "zeppelin"], "zeppelin"),
        (
            ["--sim", "--headless", "--mission", "hover", "--model", "rigid_body"],
            "choose kinematic or dynamic",
        ),
        (
            ["--sim", "--headless", "--mission", "hover", "--channel", "loss=2"],
            "--channel: loss=2: '2' is not",
        ),
        (["--connect", "udpin://0.0.0.0:1", "--channel", "delay=1"], "the simulator's"),
        (["--sim", "--headless", "--mission", "hover", "--config", "PLACE"], "flies by rate"),
        (["evaluate", "--config", "PLACE"], "flies by rate"),
        (["--sim", "--headless", "--mission", "hover", "--controller", "odd"], "nor MODULE:CLASS"),
        (["--sim", "--headless", "--mission", "hover", "--controller", "odd:It"], "no module 'odd'"),
        (["report"], "no recorded flights"),
        (["--sim", "--headless", "--mission", "hover", "--logs", "/proc/nowhere"], "logs"),
        (["--sim", "--bogus"], "unrecognized"),
        (["--connect", CONNECT, "--headless", "--mission", "ODD", "--confirm-real"], "no such airframe"),
        (["review", "/nowhere.rrd"], "/nowhere.rrd"),
        (["missions", "check", "/nowhere.toml"], "cannot be read"),
        (["missions", "show", "FOLDER"], "no such mission"),
        (["report", ""], "is a folder"),
        (["export", "--to", "csv", "FOLDER"], "is a folder"),
        (["replay", "EMPTY"], "is not a Rerun recording"),
        (["identify", "/nowhere.csv"], "check the path"),
        (["identify", "FOLDER"], "is none of"),
        (["progress", "--logs", "EMPTY"], "is no folder"),
        (["progress", "certificate", "Nobody"], "has no flights"),
        (["evaluate", "--seeds", "0"], "--seeds 0"),
        (["evaluate", "--mission", "free"], "no target"),
        (["devices", "test", "theremin"], "no such haptic device"),
        (["devices", "emulate", "theremin"], "no such emulator"),
        (["excite", "--sim", "--band", "1,0.1"], "must rise"),
        (["excite"], "say which"),
        (["instruct", "--run", "nobody-flies-this", "status"], "flight"),
        (["school"], "needs a terminal"),
        (["completion", "fish"], "invalid choice"),
        (["--sim", "--headless", "--mission", "hover", "--config", "BINARY"], "not UTF-8"),
    ],
)
def test_what_is_wrong_gets_one_sentence_and_exit_2(tmp_path, arguments, words):
    odd = tmp_path / "odd.toml"
    odd.write_text('schema = 1\nname = "odd"\ntitle = "t"\n[vehicle]\nairframe = "zeppelin"\n')
    place = tmp_path / "place.toml"
    place.write_text('[mapping]\nmode = "position"\n')
    folder, empty, binary = tmp_path / "folder", tmp_path / "empty.rrd", tmp_path / "binary.toml"
    folder.mkdir()
    empty.touch()
    binary.write_bytes(b"\xff\xfe")
    named = {"ODD": odd, "PLACE": place, "FOLDER": folder, "EMPTY": empty, "BINARY": binary}
    done = run(*(str(named.get(word, word)) for word in arguments), cwd=tmp_path)
    assert done.returncode == 2, done
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    # What is begun is told without a terminal, too; then comes the sentence.
    told = [line for line in done.stderr.strip().splitlines() if not line.startswith("reading ")]
    assert len(told) == 1


@pytest.mark.parametrize(
    "arguments", [["missions", "list"], ["progress"], ["completion", "bash"], ["devices"]]
)
def test_no_room_for_the_output_is_said_in_one_sentence(tmp_path, arguments):
    command = [sys.executable, "-m", "groundstation.cli", *arguments]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path, check=False
        )
    assert done.returncode == 1
    assert "No space left on device" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_a_temporary_folder_that_is_gone_is_told_before_anything_starts(tmp_path):
    done = run(
        "--sim", "--headless", "--mission", "hover", cwd=tmp_path, env=os.environ | {"TMPDIR": "/nowhere"}
    )
    assert done.returncode == 2
    assert "unset TMPDIR" in done.stderr


def test_without_a_home_what_needs_none_goes_on(tmp_path):
    for arguments in (["missions", "list"], ["progress"], ["devices", "list"]):
        for environment in ({}, {"HOME": "/dev/null"}):
            done = run(*arguments, cwd=tmp_path, env=environment)
            assert (done.returncode, done.stderr) == (0, ""), arguments


@pytest.mark.parametrize(("term", "code"), [("dumb", False), ("xterm-256color", True)])
def test_a_terminal_that_cannot_redraw_is_none(monkeypatch, term, code):
    from groundstation import terminal

    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    assert terminal.has_screen({"TERM": term}) is code


def test_missions_list_and_check(capsys):
    with pytest.raises(SystemExit) as end:
        main(["missions", "list"])
    assert end.value.code == 0
    assert "paper" in capsys.readouterr().out


@pytest.mark.parametrize("shell", ["bash", "zsh", "tcsh"])
def test_completion_scripts_know_the_options(shell, capsys):
    with pytest.raises(SystemExit) as end:
        main(["completion", shell])
    assert end.value.code == 0
    assert "headless" in capsys.readouterr().out


def test_a_reader_that_leaves_early_is_no_error():
    code = f"{sys.executable} -m groundstation.cli completion bash | head -n 1"
    done = subprocess.run(["/bin/sh", "-c", code], capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr


def test_help_takes_little_processor_time():
    # Not a timed assertion on wall clock: the processor's own account, with a margin of three over the 0.3 s bar.
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run("--help")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 0.9


def test_every_option_has_help():
    for action in build_parser()._actions:
        assert action.help or action.dest == "command"


@pytest.mark.parametrize(
    ("device", "settings", "says"),
    [("theremin", "", "theremin"), ("falcon", "[devices.falcon]\nfrimware = 'x'\n", "frimware")],
)
def test_a_device_or_setting_that_no_driver_knows_is_told_before_anything_starts(
    tmp_path, device, settings, says
):
    # The screen needs a terminal, so this runs in one.
    import os
    import pty

    config = tmp_path / "settings.toml"
    config.write_text(settings)
    controller, terminal = pty.openpty()
    command = [
        sys.executable,
        "-m",
        "groundstation.cli",
        "--sim",
        "--device",
        device,
        "--config",
        str(config),
    ]
    done = subprocess.run(
        command, stdin=terminal, stdout=terminal, stderr=subprocess.PIPE, text=True, timeout=60, check=False
    )
    os.close(controller)
    os.close(terminal)
    assert done.returncode == 2
    assert says in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
