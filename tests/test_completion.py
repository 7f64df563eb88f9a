"""Completion by the shells themselves: the script is loaded into a real one, which is asked what it would offer."""

import shutil
import subprocess
import sys

import pytest

ASK_BASH = r"""
. "$1"
COMP_LINE="$2" COMP_POINT=${#2}
# As bash itself hands it over: words parted at colons and equals signs, too.
COMP_WORDS=() COMP_CWORD=0
_groundstation_whole_words 2>/dev/null
printf '%s\n' "${COMPREPLY[@]}"
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with a settings file, a mission, and two recordings in logs."""
    (tmp_path / "logs").mkdir()
    for name in (
        "mine.toml",
        "notes.txt",
        "old.rrd",
        "logs/2026-01-01_paper.rrd",
        "logs/2026-01-01_paper.tlog",
    ):
        (tmp_path / name).touch()
    return tmp_path


@pytest.fixture(scope="module")
def bash_script(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "groundstation"
    path.write_text(printed("bash"))
    return path


def printed(shell):
    command = [sys.executable, "-m", "groundstation.cli", "completion", shell]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def offered(bash_script, folder, line):
    done = subprocess.run(
        ["bash", "--norc", "-c", ASK_BASH, "bash", str(bash_script), line],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert not done.stderr, done.stderr
    return set(done.stdout.split())


@pytest.mark.parametrize(
    ("typed", "offers"),
    [
        ("--sim --mission sl", {"slalom"}),
        ("--mission=delay-", {"delay-100", "delay-300", "delay-600"}),
        ("--sim --mission mi", {"mine.toml"}),
        ("--airframe x", {"x500"}),
        ("--connect udpin://0.0.0.0:14540 --mission wi", {"wind"}),
        ("--device emulated:f", {"falcon"}),
        ("--device joy", {"joystick"}),
        ("replay --preset as", {"assisted"}),
        ("evaluate --guard ris", {"risk_field"}),
        ("evaluate --operator ex", {"expert"}),
        ("missions show check", {"check-ride"}),
        ("missions check mi", {"mine.toml"}),
        ("review ol", {"old.rrd"}),
        ("review 2026", {"logs/2026-01-01_paper.rrd"}),
        ("export logs/2026", {"logs/2026-01-01_paper.rrd"}),
        ("report --logs lo", {"logs"}),
        ("--config ", {"mine.toml", "logs"}),
        ("devices emulate fal", {"falcon"}),
        ("progress cert", {"certificate"}),
        ("completion z", {"zsh"}),
    ],
)
def test_bash_offers_what_an_option_takes(bash_script, folder, typed, offers):
    assert offered(bash_script, folder, f"groundstation {typed}") == offers


def test_all_missions_are_offered_at_once_and_no_folder_hides_them(bash_script, folder):
    from groundstation.training.mission import MISSIONS_FOLDER

    assert offered(bash_script, folder, "groundstation --mission ") == {
        path.stem for path in MISSIONS_FOLDER.glob("*.toml")
    }


def test_a_script_holds_its_names_and_starts_no_program():
    script = printed("bash")
    assert "slalom" in script
    assert "hummingbird" in script
    assert "emulated:falcon" in script
    assert "$(groundstation" not in script
    assert "python" not in script


@pytest.mark.parametrize("shell", ["zsh", "tcsh"])
def test_the_other_shells_read_their_script(shell, folder):
    if not shutil.which(shell):
        pytest.skip(f"{shell} is not installed")
    script = folder / "script"
    script.write_text(printed(shell))
    done = subprocess.run([shell, "-f", "-n", str(script)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_zsh_is_told_of_values_without_a_colon_in_their_names():
    script = printed("zsh")
    assert r":NAME[\:ADDRESS]:_groundstation_devices" in script
    assert "NAME[:ADDRESS]" not in script
