"""The supervisor with real processes: deaths are told once, silence is told, nothing is left behind."""

import os
import signal
import sys
import time
from pathlib import Path

import pytest

from groundstation.bus import Bus
from groundstation.config import Settings
from groundstation.messages import EVENT
from groundstation.processes import Process, State, Supervisor, free_port, table
from groundstation.run import Run, read_run, write_run
from groundstation.run_folder import new_run_id, run_folder, sweep

CHILD = """
import sys, time
from groundstation.child import run_child
def body(run, bus, lifeline):
    while lifeline.holds():
        time.sleep(0.01)
run_child("child", body)
"""


@pytest.fixture
def run(tmp_path):
    it = Run(
        run_id=new_run_id(),
        url="udpin://127.0.0.1:14999",
        simulated=True,
        device="virtual:/tmp/none",
        mission=None,
        mission_path="",
        settings=Settings(),
        log=str(tmp_path / "log"),
        viewer_url="",
        started="2026-01-01T00:00:00.000+00:00",
    )
    yield it
    sweep(it.run_id)


@pytest.fixture
def bus(run):
    write_run(run)
    it = Bus(run.run_id, "test")
    yield it
    it.close()


def child(run) -> Process:
    return Process("child", (sys.executable, "-c", CHILD, str(run_folder(run.run_id) / "run.json")))


def until(condition, within_s=20.0):
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if result := condition():
            return result
        time.sleep(0.02)
    pytest.fail("did not happen in time")


def gone(pid: int) -> bool:
    return not Path(f"/proc/{pid}").exists()


def pid_of(supervisor) -> int:
    return supervisor._watched[0].popen.pid


def test_a_run_file_reads_back_as_it_was(run):
    assert read_run(write_run(run)) == run


def test_a_process_starts_runs_and_ends(run, bus):
    supervisor = Supervisor(run, (child(run),), bus)
    assert supervisor.states() == {"child": State.STARTING}
    until(lambda: not supervisor.poll() and supervisor.states()["child"] is State.RUNNING)
    pid = pid_of(supervisor)
    supervisor.stop()
    assert gone(pid)
    assert supervisor.states() == {"child": State.ENDED}


def test_a_killed_process_is_told_once_with_the_signal(run, bus):
    events = bus.subscriber(EVENT)
    supervisor = Supervisor(run, (child(run),), bus)
    until(lambda: not supervisor.poll() and supervisor.states()["child"] is State.RUNNING)
    os.kill(pid_of(supervisor), signal.SIGKILL)
    (news,) = until(supervisor.poll)
    assert "child" in news
    assert "SIGKILL" in news
    assert supervisor.poll() == []
    assert news.encode() in [event.text for event in events.drain()]
    supervisor.stop()


@pytest.mark.parametrize(
    ("said", "told"),
    [("the port is taken.", "the port is taken."), ("it is \\x1b[1mtaken", "it is ?[1mtaken.")],
)
def test_a_process_that_ends_badly_leaves_its_last_words_which_move_no_cursor(run, bus, said, told):
    process = Process("child", (sys.executable, "-c", f"raise SystemExit('{said}')"))
    supervisor = Supervisor(run, (process,), bus)
    (news,) = until(supervisor.poll)
    assert news == f"The child process has died (exit code 1): {told}"
    supervisor.stop()


def test_what_a_killed_process_said_last_is_not_taken_for_the_reason(run, bus):
    script = "import sys, time; print('all is \\x1b[1mwell', flush=True); time.sleep(60)"
    supervisor = Supervisor(run, (Process("child", (sys.executable, "-c", script), beats=False),), bus)
    log = run_folder(run.run_id) / "child.log"
    until(log.read_bytes)
    os.kill(pid_of(supervisor), signal.SIGKILL)
    (news,) = until(supervisor.poll)
    assert news == "The child process has died (killed by SIGKILL)."
    supervisor.stop()


def test_a_stopped_process_is_told_silent_and_still_ends(run, bus):
    supervisor = Supervisor(run, (child(run),), bus)
    until(lambda: not supervisor.poll() and supervisor.states()["child"] is State.RUNNING)
    pid = pid_of(supervisor)
    os.kill(pid, signal.SIGSTOP)
    events = bus.subscriber(EVENT)
    until(lambda: supervisor.poll() or supervisor.states()["child"] is State.SILENT)
    assert any(b"does not answer" in event.text for event in events.drain())
    assert supervisor.states()["child"] is State.SILENT
    supervisor.stop()
    assert gone(pid)


SUPERVISE = """
import sys, time
from pathlib import Path
from groundstation.bus import Bus
from groundstation.processes import Process, Supervisor
from groundstation.run import read_run
run = read_run(Path(sys.argv[1]))
bus = Bus(run.run_id, "screen")
supervisor = Supervisor(run, (Process("child", (sys.executable, "-c", sys.argv[2], sys.argv[1])),), bus)
while not supervisor.states()["child"] == "running":
    supervisor.poll(); time.sleep(0.02)
print(supervisor._watched[0].popen.pid, flush=True)
time.sleep(60)
"""


def test_children_end_when_their_supervisor_is_killed(run, bus):
    import subprocess

    path = str(run_folder(run.run_id) / "run.json")
    supervisor = subprocess.Popen(
        [sys.executable, "-c", SUPERVISE, path, CHILD], stdout=subprocess.PIPE, text=True
    )
    pid = int(supervisor.stdout.readline())
    supervisor.kill()
    supervisor.wait()
    supervisor.stdout.close()
    until(lambda: gone(pid))


def test_the_table_has_a_simulator_only_when_simulated(run):
    roles = [process.role for process in table(run, Path("run.json"))]
    assert roles == ["sim", "recorder", "link", "pilot"]
    import msgspec

    real = msgspec.structs.replace(run, simulated=False)
    assert [process.role for process in table(real, Path("run.json"))] == ["recorder", "link", "pilot"]


def test_free_ports_are_free():
    import socket

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", free_port()))
