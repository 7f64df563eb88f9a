"""A run's folder goes with the last process in it, and what dead programs left goes with the next start."""

import os
import signal
import subprocess
import sys
import time

import pytest

from groundstation import run_folder as module
from groundstation.run_folder import Stay, new_run_id, run_folder, sweep_dead_runs
from groundstation.terminal import give_back


@pytest.fixture(autouse=True)
def temporary_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(module.tempfile, "gettempdir", lambda: str(tmp_path))
    return tmp_path


STAY = """
import sys, tempfile, time
tempfile.gettempdir = lambda: sys.argv[1]
from groundstation.run_folder import Stay
stay = Stay(sys.argv[2])
print("in", flush=True)
time.sleep(60)
"""


@pytest.fixture
def other(tmp_path):
    """Another process that stays in a run."""
    run_id = new_run_id()
    process = subprocess.Popen(
        [sys.executable, "-c", STAY, str(tmp_path), run_id], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "in\n"
    process.run_id = run_id
    yield process
    process.kill()
    process.wait()
    process.stdout.close()


def test_only_the_last_to_leave_is_last(other):
    stay = Stay(other.run_id)
    assert not stay.end()
    again = Stay(other.run_id)
    other.send_signal(signal.SIGKILL)
    other.wait()
    assert again.end()


def test_a_run_somebody_is_in_is_not_swept_and_a_dead_one_is(other):
    sweep_dead_runs()
    assert run_folder(other.run_id).is_dir()
    other.send_signal(signal.SIGKILL)
    other.wait()
    sweep_dead_runs()
    assert not run_folder(other.run_id).exists()


def test_a_folder_without_a_lock_is_left_alone_while_it_is_young():
    young, old = run_folder(new_run_id()), run_folder(new_run_id())
    young.mkdir()
    old.mkdir()
    long_ago = time.time() - 3600
    os.utime(old, (long_ago, long_ago))
    sweep_dead_runs()
    assert young.is_dir()
    assert not old.exists()


def test_another_folder_of_ours_that_is_looked_at_for_long_is_left_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(module.tempfile, "gettempdir", lambda: str(tmp_path))
    ours = tmp_path / "groundstation-compare-1x2y3z"
    ours.mkdir()
    os.utime(ours, (0, 0))
    sweep_dead_runs()
    assert ours.is_dir()


def test_a_file_of_that_name_is_none_of_ours(tmp_path):
    stray = tmp_path / "groundstation-1-x"
    stray.write_text("keep")
    sweep_dead_runs()
    assert stray.read_text() == "keep"


class TestAnotherUser:
    """Who makes folders that are named like ours where all keep their temporary files."""

    @pytest.fixture
    def theirs(self, monkeypatch):
        folder = run_folder(new_run_id())
        folder.mkdir()
        ours = os.geteuid()
        monkeypatch.setattr(module.os, "geteuid", lambda: ours + 1)
        return folder

    def test_a_pipe_for_a_lock_holds_nobody_up_and_no_folder_of_theirs_is_touched(self, theirs):
        os.mkfifo(theirs / "alive")
        (theirs / "precious").touch()
        os.utime(theirs, (0, 0))
        sweep_dead_runs()
        assert module.living_runs() == []
        assert (theirs / "precious").exists()

    def test_a_run_is_not_begun_in_their_folder(self, theirs):
        with pytest.raises(PermissionError, match="another user's"):
            Stay(theirs.name.removeprefix("groundstation-"))
        assert list(theirs.iterdir()) == []

    def test_what_a_link_leads_to_is_left_alone(self, tmp_path):
        home = tmp_path / "home"
        home.mkdir()
        os.utime(home, (0, 0))
        link = run_folder(new_run_id())
        link.symlink_to(home)
        sweep_dead_runs()
        assert home.is_dir()
        assert link.is_symlink()
        with pytest.raises(PermissionError):
            Stay(link.name.removeprefix("groundstation-"))


def test_giving_back_a_terminal_leaves_the_alternate_screen_and_shows_the_cursor():
    import pty

    controller, terminal = pty.openpty()
    give_back(os.ttyname(terminal))
    said = os.read(controller, 1000)
    os.close(controller)
    os.close(terminal)
    assert b"\x1b[?1049l" in said
    assert b"\x1b[?25h" in said
    assert b"\x1b[?1000l" in said


def test_a_terminal_that_has_gone_needs_nothing():
    give_back("")
    give_back("/nowhere/tty")
