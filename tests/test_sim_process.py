"""`python -m sim` as a process: connections, errors a user can make, signals, and keeping time."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import common as m

from sim.mavlink.wire import Inbox
from sim.pacing import CATCH_UP_S, Pacer
from sim.transport import TcpIn, TransportError, UdpIn, UdpOut, open_transport

PATIENCE_S = 20.0


class GroundStation:
    """A bound UDP socket that a vehicle speaks to."""

    def __init__(self, port=0):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.socket.settimeout(PATIENCE_S)
        self.port = self.socket.getsockname()[1]
        self.inbox = Inbox()
        self.packer = m.MAVLink(None, srcSystem=245, srcComponent=190)
        self.peer = None

    def hear(self, kind):
        """Return the next message of a kind."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            data, self.peer = self.socket.recvfrom(65536)
            for message in self.inbox.messages(data, whole=True):
                if message.get_type() == kind:
                    return message
        pytest.fail(f"no {kind}")

    def send(self, message):
        self.socket.sendto(message.pack(self.packer), self.peer)


@pytest.fixture
def station():
    station = GroundStation()
    yield station
    station.socket.close()


@contextlib.contextmanager
def vehicle(*options, **popen):
    process = subprocess.Popen(
        [sys.executable, "-m", "sim", *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **popen,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def test_it_speaks_first_answers_and_ends_cleanly_when_told(station):
    with vehicle("--connect", f"udpout://127.0.0.1:{station.port}") as process:
        assert station.hear("HEARTBEAT").autopilot == m.MAV_AUTOPILOT_PX4
        station.send(m.MAVLink_command_long_message(1, 1, m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, *[0] * 6))
        assert station.hear("COMMAND_ACK").result == m.MAV_RESULT_ACCEPTED
        process.terminate()
        out, err = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0
        assert f"DJI Matrice 100, udpout port {station.port}; Ctrl-C ends it." in out
        assert "Hold" in out
        assert "battery 100%" in out
        assert err == ""


def test_quiet_is_quiet_and_an_interrupt_is_no_error(station):
    with vehicle("--quiet", "--connect", f"udpout://127.0.0.1:{station.port}") as process:
        station.hear("HEARTBEAT")
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=PATIENCE_S) == ("", "")
        assert process.returncode == 0


def test_nobody_listening_is_no_reason_to_end():
    """The vehicle's datagrams are refused for a while; then a ground station comes."""
    early = GroundStation()
    early.socket.close()
    with vehicle("--connect", f"udpout://127.0.0.1:{early.port}") as process:
        assert process.stdout.read(5)
        time.sleep(0.5)
        late = GroundStation(early.port)
        assert late.hear("HEARTBEAT").get_srcSystem() == 1
        late.socket.close()
        assert process.poll() is None


def test_it_ends_with_its_parent(station):
    """A parent that starts a vehicle and is killed: the vehicle's last datagram is not long after."""
    url = f"udpout://127.0.0.1:{station.port}"
    code = (
        "import subprocess, sys, time\n"
        f"child = subprocess.Popen([sys.executable, '-m', 'sim', '--quiet', '--with-parent', '--connect', {url!r}])\n"
        "print(child.pid, flush=True)\n"
        "time.sleep(60)\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
        try:
            station.hear("HEARTBEAT")
            parent.kill()
            parent.wait()
            deadline = time.monotonic() + PATIENCE_S
            while time.monotonic() < deadline and is_running(child):
                time.sleep(0.05)
            assert not is_running(child)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)


def is_running(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii")
    except FileNotFoundError:
        return False
    return state.rpartition(")")[2].split()[0] != "Z"


def run_to_the_end(*options):
    command = [sys.executable, "-m", "sim", *options]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)


BAD_MISSION = 'schema = 1\n[[obstacle]]\nshape = "cone"\nname = "x"\n'


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--connect", "udp://127.0.0.1:14540"), "is not a connection"),
        (("--connect", "udpout://127.0.0.1:99999"), "is not a port"),
        (("--connect", "udpout://127.0.0.1:x"), "is not a port"),
        (("--connect", "udpout://:14540"), "names nobody"),
        (("--connect", "udpin://192.0.2.1:0"), "cannot be opened"),
        (("--airframe", "phantom"), "no such airframe; give a .toml file or one of: matrice_100, x500."),
        (("--mission", "no/such/file.toml"), "cannot be read"),
        (("--mission", "{bad}"), "shape"),
    ],
)
def test_what_a_user_gives_wrong_is_one_sentence_and_exit_2(tmp_path, options, sentence):
    bad = tmp_path / "bad.toml"
    bad.write_text(BAD_MISSION, encoding="utf-8")
    options = [option.replace("{bad}", str(bad)) for option in options]
    done = run_to_the_end(*options)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""


def test_help_has_examples_and_does_not_wait_for_the_wire():
    done = run_to_the_end("--help")
    assert done.returncode == 0
    assert "examples:" in done.stdout
    assert "--with-parent" in done.stdout


# Transports


def test_udpin_answers_who_spoke_last():
    transport = open_transport("udpin://0")
    assert isinstance(transport, UdpIn)
    transport.send(b"to nobody")
    stations = [GroundStation(), GroundStation()]
    for number, station in enumerate(stations):
        station.peer = ("127.0.0.1", transport.port)
        station.socket.sendto(b"hello", station.peer)
        assert wait_for(transport) == [b"hello"]
        transport.send(b"you are %d" % number)
        assert station.socket.recv(100) == b"you are %d" % number
        station.socket.close()
    transport.close()


def test_udpin_listens_on_this_machine_only_unless_told():
    transport = open_transport("udpin://0")
    assert transport._socket.getsockname()[0] == "127.0.0.1"
    transport.close()
    transport = open_transport("udpin://0.0.0.0:0")
    assert transport._socket.getsockname()[0] == "0.0.0.0"
    transport.close()


def test_udpout_hears_only_whom_it_speaks_to(station):
    transport = open_transport(f"udpout://127.0.0.1:{station.port}")
    assert isinstance(transport, UdpOut)
    transport.send(b"hello")
    data, address = station.socket.recvfrom(100)
    assert data == b"hello"
    stranger = GroundStation()
    stranger.socket.sendto(b"mine", address)
    stranger.socket.close()
    station.socket.sendto(b"yours", address)
    assert wait_for(transport) == [b"yours"]
    transport.close()


def test_tcp_takes_one_client_after_the_other():
    transport = open_transport("tcpin://0")
    assert isinstance(transport, TcpIn)
    transport.send(b"to nobody")
    for _ in range(2):
        with socket.create_connection(("127.0.0.1", transport.port), timeout=PATIENCE_S) as client:
            client.sendall(b"hello")
            assert b"".join(wait_for(transport)) == b"hello"
            transport.send(b"welcome")
            assert client.recv(100) == b"welcome"
    assert list(transport.receive()) == []
    transport.send(b"to nobody")
    transport.close()


def test_a_tcp_client_that_does_not_read_is_let_go():
    transport = open_transport("tcpin://0")
    with socket.create_connection(("127.0.0.1", transport.port), timeout=PATIENCE_S) as client:
        client.sendall(b"hello")
        wait_for(transport)
        for _ in range(10_000):
            transport.send(bytes(10_000))
            if transport._client is None:
                break
        assert transport._client is None
    transport.close()


def test_a_port_in_use_is_said():
    taken = open_transport("tcpin://0")
    with pytest.raises(TransportError, match="in use"):
        open_transport(f"tcpin://{taken.port}")
    taken.close()


def wait_for(transport):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if data := list(transport.receive()):
            return data
        time.sleep(0.01)
    pytest.fail("nothing came")


# Pacing


class Clock:
    """Time that passes only when somebody sleeps or works."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        assert seconds > 0.0
        self.now += seconds


def test_work_does_not_stretch_the_period():
    clock = Clock()
    pacer = Pacer(0.004, clock, clock.sleep)
    for _ in range(250):
        clock.now += 0.003
        pacer.wait()
    assert clock.now == pytest.approx(101.0)


def test_a_late_tick_is_caught_up():
    clock = Clock()
    pacer = Pacer(0.004, clock, clock.sleep)
    clock.now += 0.05
    for _ in range(250):
        pacer.wait()
    assert clock.now == pytest.approx(101.0)


def test_after_a_long_stop_no_more_than_the_limit_is_caught_up():
    clock = Clock()
    pacer = Pacer(0.004, clock, clock.sleep)
    clock.now += 30.0
    resumed, ticks = clock.now, 0
    while clock.now == resumed:
        pacer.wait()
        ticks += 1
    assert ticks * 0.004 == pytest.approx(CATCH_UP_S, abs=0.009)
