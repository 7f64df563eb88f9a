"""`python -m sim` as a process: options, errors a user can make, signals, the status line, and keeping time."""

import contextlib
import fcntl
import os
import pty
import re
import select
import signal
import socket
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import common as m

from sim.conditions import IDEAL_BOTH_WAYS
from sim.mavlink.wire import Inbox
from sim.process import cli
from sim.process.pacing import CATCH_UP_S, Pacer
from sim.process.signing_key import KeyFileError, read_key
from sim.process.status_line import MOST_LINES, StatusLine, _writer, line, on_stdout, pace
from sim.process.transport import Url
from sim.process.vehicle import Vehicle
from sim.scenario import Scenario
from sim.simulator import build

PATIENCE_S = 20.0


class GroundStation:
    """A bound UDP socket that a vehicle speaks to."""

    def __init__(self, port=0):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.socket.settimeout(PATIENCE_S)
        self.port = self.socket.getsockname()[1]
        self.url = f"udpout://127.0.0.1:{self.port}"
        self.inbox = Inbox()
        self.packer = m.MAVLink(None, srcSystem=245, srcComponent=190)
        self.peer = None

    def hear(self, kind, such_that=lambda message: True):
        """Return the next message of a kind."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            data, self.peer = self.socket.recvfrom(65536)
            for message in self.inbox.messages(data, whole=True):
                if message.get_type() == kind and such_that(message):
                    return message
        pytest.fail(f"no {kind}")

    def send(self, message):
        self.socket.sendto(message.pack(self.packer), self.peer)

    def command(self, command, *params, system=1):
        """Send a command and return its acknowledgement's result."""
        params = [*params, *[0.0] * (7 - len(params))]
        self.send(m.MAVLink_command_long_message(system, 1, command, 0, *params))
        return self.hear("COMMAND_ACK", lambda ack: ack.command == command).result

    def parameter(self, name):
        self.send(m.MAVLink_param_request_read_message(1, 1, name.encode(), -1))
        return self.hear("PARAM_VALUE", lambda value: value.param_id == name).param_value


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
    with vehicle("--connect", station.url) as process:
        assert station.hear("HEARTBEAT").autopilot == m.MAV_AUTOPILOT_PX4
        assert station.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0) == m.MAV_RESULT_ACCEPTED
        process.terminate()
        out, err = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0
        assert "Holybro X500, as PX4's x500" in out
        assert f"system 1: {station.url}. Ctrl-C ends it." in out
        assert "Hold" in out
        assert "battery 100%" in out
        assert "\x1b" not in out
        assert "\r" not in out
        assert err == ""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_quiet_is_quiet_and_an_interrupt_is_no_error(station, number):
    with vehicle("--quiet", "--connect", station.url) as process:
        station.hear("HEARTBEAT")
        process.send_signal(number)
        assert process.communicate(timeout=PATIENCE_S) == ("", "")
        assert process.returncode == 0


def test_without_standard_output_it_flies_all_the_same(station):
    command = f"exec {sys.executable} -m sim --connect {station.url} >&-"
    with subprocess.Popen(["sh", "-c", command], stderr=subprocess.PIPE, text=True) as process:
        station.hear("HEARTBEAT")
        station.hear("SYS_STATUS")
        process.terminate()
        assert process.communicate(timeout=PATIENCE_S)[1] == ""
        assert process.returncode == 0


def test_under_nohup_it_stays_when_the_terminal_goes(station):
    code = (
        "import os, signal, sys\n"
        "signal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
        "os.execv(sys.executable, [sys.executable, '-m', 'sim', '--quiet', '--connect', sys.argv[1]])\n"
    )
    with subprocess.Popen([sys.executable, "-c", code, station.url]) as process:
        station.hear("HEARTBEAT")
        process.send_signal(signal.SIGHUP)
        later = station.hear("SYSTEM_TIME").time_boot_ms + 1000
        station.hear("SYSTEM_TIME", lambda told: told.time_boot_ms >= later)
        assert process.poll() is None
        process.terminate()
        assert process.wait(PATIENCE_S) == 0


def test_nobody_listening_is_no_reason_to_end():
    """The vehicle's datagrams are refused for a while; then a ground station comes."""
    early = GroundStation()
    early.socket.close()
    with vehicle("--connect", early.url) as process:
        assert process.stdout.read(5)
        time.sleep(0.5)
        late = GroundStation(early.port)
        assert late.hear("HEARTBEAT").get_srcSystem() == 1
        assert late.hear("ATTITUDE")
        late.socket.close()
        assert process.poll() is None


def test_it_ends_with_its_parent(station):
    """A parent that starts a vehicle and is killed: the vehicle's last datagram is not long after."""
    code = (
        "import subprocess, sys, time\n"
        "command = [sys.executable, '-m', 'sim', '--quiet', '--with-parent']\n"
        f"child = subprocess.Popen([*command, '--connect', {station.url!r}])\n"
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


def test_two_ground_stations_on_two_links(station):
    other = GroundStation()
    with vehicle("--connect", station.url, "--connect", other.url):
        for each in (station, other):
            each.hear("HEARTBEAT")
            assert each.command(m.MAV_CMD_REQUEST_MESSAGE, 148) == m.MAV_RESULT_ACCEPTED
    other.socket.close()


def test_several_vehicles_on_consecutive_ports():
    stations = consecutive(3)
    with vehicle("--instances", "3", "--system-id", "7", "--connect", stations[0].url) as process:
        for number, each in enumerate(stations):
            assert each.hear("HEARTBEAT").get_srcSystem() == 7 + number
        assert stations[1].command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, system=8) == m.MAV_RESULT_ACCEPTED
        armed = m.MAV_MODE_FLAG_SAFETY_ARMED
        assert stations[1].hear("HEARTBEAT", lambda beat: beat.base_mode & armed)
        for each in (stations[0], stations[2]):
            assert not each.hear("HEARTBEAT").base_mode & armed
        process.terminate()
        out, _ = process.communicate(timeout=PATIENCE_S)
        assert "systems 7 to 9; the first:" in out
        assert re.search(r"^  8 Hold .* armed", out, re.MULTILINE)
    for each in stations:
        each.socket.close()


def consecutive(count):
    """Return ground stations on ports that follow one another."""
    for _ in range(100):
        stations = [GroundStation()]
        try:
            for _ in range(count - 1):
                stations.append(GroundStation(stations[-1].port + 1))
        except OSError:
            for each in stations:
                each.socket.close()
        else:
            return stations
    pytest.fail("no consecutive ports are free")


def test_time_passes_faster_when_asked(station):
    """Half a minute of flight within the patience of this test, on a clock that follows."""
    with vehicle("--quiet", "--speed", "20", "--connect", station.url):
        first = station.hear("SYSTEM_TIME")
        later = station.hear("SYSTEM_TIME", lambda told: told.time_boot_ms > 30_000)
        passed_ms = (later.time_unix_usec - first.time_unix_usec) / 1e3
        assert passed_ms == pytest.approx(later.time_boot_ms - first.time_boot_ms, abs=2)


def test_the_channel_is_the_one_asked_for(station):
    with vehicle("--quiet", "--channel", "up.delay=0.25,down.jitter=0.01", "--connect", station.url):
        station.hear("HEARTBEAT")
        assert station.parameter("SIM_UP_DELAY") == 0.25
        assert station.parameter("SIM_DN_DELAY") == 0.0
        assert station.parameter("SIM_DN_JITTER") == pytest.approx(0.01)


def test_with_a_key_all_is_signed_and_the_unsigned_is_not_heard(station, tmp_path):
    path = tmp_path / "key"
    path.write_text("correct horse battery staple\n", encoding="utf-8")
    path.chmod(0o600)
    with vehicle("--quiet", "--signing-key", str(path), "--connect", station.url):
        station.hear("HEARTBEAT")
        data, _ = station.socket.recvfrom(65536)
        assert data[0] == 0xFD
        assert data[2] == 1
        request = m.MAVLink_command_long_message(1, 1, m.MAV_CMD_REQUEST_MESSAGE, 0, 148, *[0.0] * 6)
        station.send(request)
        for _ in range(3):
            station.hear("SYS_STATUS")
        signing = station.packer.signing
        signing.secret_key, signing.sign_outgoing = read_key(path), True
        signing.timestamp = int((time.time() - 1_420_070_400) * 1e5)
        acks = []
        station.send(request)
        acks.append(station.hear("COMMAND_ACK"))
        assert acks[0].result == m.MAV_RESULT_ACCEPTED


def test_a_restart_over_the_wire(station):
    with vehicle("--quiet", "--speed", "5", "--connect", station.url):
        station.hear("ATTITUDE", lambda told: told.time_boot_ms > 3000)
        assert station.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == m.MAV_RESULT_ACCEPTED
        station.hear("ATTITUDE", lambda told: told.time_boot_ms < 2000)


def run_to_the_end(*options):
    command = [sys.executable, "-m", "sim", *options]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)


BAD_MISSION = 'schema = 1\n[[obstacle]]\nshape = "cone"\nname = "x"\n'


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--connect", "udp://127.0.0.1:14540"), "is not a connection"),
        (("--connect", "udpout://127.0.0.1:99999"), "is not a port"),
        (("--connect", "udpin://192.0.2.1:0"), "cannot be opened"),
        (("--connect", "udpin://0", "--connect", "serial:///dev/ttyNOT0:57600"), "check the cable"),
        (("--connect", "udpout://127.0.0.1:65535", "--instances", "2"), "would need port 65536"),
        (("--airframe", "no_such"), "no such airframe; give a .toml file or one of: "),
        (("--mission", "no/such/file.toml"), "cannot be read"),
        (("--mission", "{bad}"), "shape"),
        (("--channel", "loss=2"), "--channel: loss=2: '2' is not a number from 0 to 0.95."),
        (("--signing-key", "{bad}"), "others may read this key"),
        (("--signing-key", "{key}", "--speed", "2"), "signatures carry the clock's time; leave --speed out."),
        (("--instances", "0"), "'0' is not a whole number from 1 to 250"),
        (("--instances", "200", "--system-id", "100"), "--system-id: the last vehicle's would be above 250"),
        (("--speed", "nan"), "'nan' is not a number from 0.01 to 1000"),
        (("--model", "teleport"), "invalid choice: 'teleport'"),
        (("--teleport",), "unrecognized arguments: --teleport"),
    ],
)
def test_what_a_user_gives_wrong_is_one_sentence_and_exit_2(tmp_path, options, sentence):
    bad = tmp_path / "bad.toml"
    bad.write_text(BAD_MISSION, encoding="utf-8")
    bad.chmod(0o644)
    key = key_file(tmp_path, bytes(32))
    options = [option.replace("{bad}", str(bad)).replace("{key}", str(key)) for option in options]
    done = run_to_the_end(*options)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""


def test_help_has_examples_and_does_not_wait_for_the_wire():
    done = run_to_the_end("--help")
    assert done.returncode == 0
    for part in ("examples:", "--with-parent", "rigid_body", "SIM_NET_BLACK", "udpin://0.0.0.0:PORT"):
        assert part in done.stdout
    assert max(len(line) for line in done.stdout.splitlines()) <= 110


def test_airframes_and_version_are_told():
    done = run_to_the_end("--list-airframes")
    assert done.returncode == 0
    assert re.search(r"^matrice_100 +DJI Matrice 100: kinematic, dynamic$", done.stdout, re.MULTILINE)
    done = run_to_the_end("--version")
    assert re.fullmatch(r"groundstation sim \d+\.\d+\.\d+\n", done.stdout)


def test_numpy_is_not_loaded():
    """It would cost a third of the start; only batches use it."""
    code = "import sys, sim.process.cli, sim.process.fleet, sim.mavlink.endpoint; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# What is made of what was asked


def test_without_a_connection_it_does_as_px4_does():
    urls = [cli._urls(None, number) for number in range(12)]
    assert [str(url) for url in urls[0]] == ["udpout://127.0.0.1:14540", "udpout://127.0.0.1:14550"]
    assert [str(url) for url in urls[2]] == ["udpout://127.0.0.1:14542", "udpout://127.0.0.1:14550"]
    assert [str(url) for url in urls[11]] == ["udpout://127.0.0.1:14549", "udpout://127.0.0.1:14550"]


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0])
def test_vehicles_stand_side_by_side_and_have_seeds_of_their_own(tmp_path, yaw_deg):
    mission = tmp_path / "mission.toml"
    mission.write_text(f"schema = 1\n[vehicle]\nyaw_deg = {yaw_deg}\n", encoding="utf-8")
    asked = cli.build_parser().parse_args(
        ["--instances", "3", "--connect", "udpin://0", "--mission", str(mission), "--seed", "5"]
    )
    vehicles = cli.make_vehicles(asked, 0.0)
    apart = max(2.0, 4.0 * vehicles[0].simulator.airframe.radius)
    for number, each in enumerate(vehicles):
        x, y, z, _ = each.simulator.p
        right = (0.0, -number * apart) if yaw_deg == 0.0 else (number * apart, 0.0)
        assert (x, y, z) == pytest.approx((*right, 0.0), abs=1e-9)
        each.close()
    assert [each.system_id for each in vehicles] == [1, 2, 3]
    assert [each._seed for each in vehicles] == [5, 6, 7]


def test_nothing_stays_open_when_one_link_cannot_be_opened():
    taken = GroundStation()
    first = f"udpin://{taken.port - 1}"
    asked = cli.build_parser().parse_args(["--connect", first, "--connect", f"udpin://{taken.port}"])
    with pytest.raises(cli.TransportError, match="in use"):
        cli.make_vehicles(asked, 0.0)
    taken.socket.close()


# Keys


def key_file(tmp_path, data, mode=0o600):
    path = tmp_path / "key"
    path.write_bytes(data)
    path.chmod(mode)
    return path


def test_a_key_is_32_bytes_or_the_hash_of_a_passphrase(tmp_path):
    assert read_key(key_file(tmp_path, bytes(range(32)))) == bytes(range(32))
    # SHA-256 of "password": a published test value.
    digest = bytes.fromhex("5e884898da28047151d0e56f8dc6292773603d0d6aabbdd62a11ef721d1542d8")
    assert read_key(key_file(tmp_path, b"password")) == digest
    assert read_key(key_file(tmp_path, b"password\n")) == digest
    assert read_key(key_file(tmp_path, b"password\r\n")) == digest


@pytest.mark.parametrize(
    ("data", "mode", "says"),
    [
        (bytes(32), 0o640, "others may read"),
        (bytes(32), 0o604, "others may read"),
        (b"short\n", 0o600, "8 characters or more"),
        (b"\xff\xfe" * 10, 0o600, "neither 32 bytes nor a passphrase"),
    ],
)
def test_a_key_file_that_cannot_be_used_is_said(tmp_path, data, mode, says):
    with pytest.raises(KeyFileError, match=says):
        read_key(key_file(tmp_path, data, mode))
    with pytest.raises(KeyFileError, match="cannot be read"):
        read_key(tmp_path / "none")


# The status line


class Nowhere:
    """A transport without an other end."""

    url = Url("udpin", "test", 1)
    whole = True

    def __init__(self, *, heard=True):
        self.heard = heard

    def receive(self):
        return iter(())

    def send(self, data):
        pass

    def close(self):
        pass


def parked(system_id=1, *, heard=True):
    return Vehicle(
        lambda: build(Scenario()), [Nowhere(heard=heard)], both=IDEAL_BOTH_WAYS, system_id=system_id
    )


def written(columns=None, *, colour=False):
    texts = []
    return StatusLine(texts.append, None if columns is None else lambda: columns, colour=colour), texts


def test_a_line_says_how_the_vehicle_is():
    one = parked(heard=False)
    assert line(one, number=False).startswith("Hold      disarmed")
    assert "nobody listens" in line(one, number=False)
    one.simulator.autopilot.arm()
    assert line(parked(3), number=True).startswith("  3 Hold      disarmed")
    assert "  armed" in f" {line(one, number=False)}"
    assert "nobody" not in line(parked(), number=False)


def test_on_a_terminal_lines_are_rewritten_and_never_wrap():
    status, texts = written(columns=60)
    fleet = [parked(number + 1) for number in range(3)]
    status.show(fleet, 1.0, None)
    status.show(fleet, 1.0, 1.0)
    assert texts[0].startswith("\r  1 Hold")
    assert texts[1].startswith("\x1b[2A\r  1 Hold")
    for shown in texts[1].removeprefix("\x1b[2A\r").split("\n"):
        assert shown.endswith("\x1b[K")
        assert len(shown.removesuffix("\x1b[K")) <= 59
    status.end()
    assert texts[-1] == "\n"


def test_many_vehicles_are_counted_not_listed():
    status, texts = written(columns=200)
    status.show([parked(number + 1) for number in range(MOST_LINES + 4)], 1.0, None)
    assert texts[0].count("\n") == MOST_LINES
    assert "and 4 more" in texts[0]


def test_colour_only_where_wanted():
    fleet = [parked()]
    fleet[0].simulator.autopilot.arm()
    for colour in (True, False):
        status, texts = written(columns=200, colour=colour)
        status.show(fleet, 1.0, None)
        assert ("\x1b[32m" in texts[0]) is colour


def test_where_lines_stay_only_changes_are_told():
    status, texts = written()
    fleet = [parked()]
    for _ in range(3):
        status.show(fleet, 1.0, 1.0)
    assert len(texts) == 1
    fleet[0].simulator.autopilot.arm()
    status.show(fleet, 1.0, 1.0)
    assert len(texts) == 2
    assert " armed" in texts[1]
    status.show(fleet, 1.0, 0.9)
    assert len(texts) == 2
    for _ in range(10):
        status.show(fleet, 1.0, 0.5)
    for _ in range(10):
        status.show(fleet, 1.0, 1.0)
    assert [re.sub(r"0\.\d+", "…", text) for text in texts[2:]] == [
        "speed …, behind: 1 asked\n",
        "in real time again\n",
    ]
    status.end()
    assert len(texts) == 4


def test_the_pace_is_told_unless_it_is_real_time():
    assert pace(1.0, None) == pace(1.0, 0.99) == ""
    assert pace(5.0, None) == pace(5.0, 4.9) == "speed 5"
    assert pace(5.0, 3.21) == "speed 3.21, behind: 5 asked"
    assert pace(1.0, 0.8) == "speed 0.80, behind: 1 asked"


def test_a_reader_that_does_not_read_stops_nothing():
    """A full pipe, or Ctrl-S on a terminal, must not stop a vehicle that flies."""
    reader, writer = os.pipe()
    write = _writer(writer)
    for _ in range(1000):
        write("x" * 1000)
    assert len(os.read(reader, 10_000_000)) > 0
    os.close(reader)
    write("nobody reads")
    write("nobody reads")
    os.close(writer)


@pytest.mark.parametrize(
    ("environment", "coloured"), [({}, True), ({"NO_COLOR": "1"}, False), ({"TERM": "dumb"}, False)]
)
def test_on_a_real_terminal(station, environment, coloured):
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 70, 0, 0))
    command = [sys.executable, "-m", "sim", "--connect", station.url]
    kept = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "COLUMNS")}
    process = subprocess.Popen(command, stdout=theirs, env=kept | {"TERM": "xterm"} | environment)
    try:
        station.hear("HEARTBEAT")
        station.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1)
        seen = b""
        deadline = time.monotonic() + PATIENCE_S
        while b" armed" not in seen.replace(b"\x1b[32m", b"") and time.monotonic() < deadline:
            if select.select([ours], [], [], 0.1)[0]:
                seen += os.read(ours, 65536)
        assert (b"\x1b[32m" in seen) is coloured
        assert (b"\x1b[K" in seen) is (environment.get("TERM") != "dumb")
        shown = [text for text in re.split(rb"[\r\n]+", re.sub(rb"\x1b\[\w+", b"", seen)) if b"Hold" in text]
        assert shown
        if environment.get("TERM") != "dumb":
            assert max(len(text.decode(errors="replace")) for text in shown) <= 69
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE_S) == 0
        os.close(ours)
        os.close(theirs)


def test_standard_output_that_is_no_terminal_gets_no_codes(monkeypatch, tmp_path):
    with (tmp_path / "out").open("w") as out:
        monkeypatch.setattr(sys, "stdout", out)
        status = on_stdout({"TERM": "xterm"})
        status.show([parked()], 1.0, None)
    text = (tmp_path / "out").read_text(encoding="utf-8")
    assert text.startswith("Hold")
    assert "\x1b" not in text


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


def test_a_reader_of_the_list_that_goes_is_no_error():
    """As `python -m sim --list-airframes | head -1` does."""
    with subprocess.Popen(
        [sys.executable, "-m", "sim", "--list-airframes"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as listing:
        listing.stdout.close()
        assert listing.stderr.read() == b""
        assert listing.wait(20) == 0
