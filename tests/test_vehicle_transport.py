"""Transports over real sockets and a pty: there and back, peers, silence, breaks."""

import os
import pty
import socket
import subprocess
import sys
import time

import pytest
import serial
from hypothesis import given
from hypothesis import strategies as st
from serial.tools.list_ports_common import ListPortInfo

from groundstation.messages import Severity
from groundstation.vehicle import usb_port
from groundstation.vehicle.open_transport import open_transport
from groundstation.vehicle.serial_port import SerialPort
from groundstation.vehicle.transport import TransportError, Url, UrlError, parse_url


def received(transport, within_s=5.0) -> bytes:
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        if data := transport.receive():
            return data
    return b""


def udp(port=0):
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", port))
    sock.settimeout(5)
    return sock


@pytest.mark.parametrize(
    ("text", "url"),
    [
        ("udpin://0.0.0.0:14540", Url("udpin", "0.0.0.0", 14540)),
        ("udpout://127.0.0.1:14550", Url("udpout", "127.0.0.1", 14550)),
        ("tcpout://vehicle.local:5760", Url("tcpout", "vehicle.local", 5760)),
        ("serial:///dev/ttyUSB0:57600", Url("serial", "/dev/ttyUSB0", 57600)),
        ("serial://COM3:115200", Url("serial", "COM3", 115200)),
    ],
)
def test_urls_by_hand(text, url):
    assert parse_url(text) == url


@pytest.mark.parametrize(
    "text",
    ["", "udp://1.2.3.4:5", "udpin://", "udpin://0.0.0.0", "udpin://0.0.0.0:0", "udpin://0.0.0.0:70000",
     "tcpout://a b:5", "serial:///dev/ttyUSB0", "serial:///dev/ttyUSB0:fast", "http://x:80", "udpin://h:1/path"],
)  # fmt: skip
def test_what_is_no_url_is_told_with_what_is(text):
    with pytest.raises(UrlError, match="udpin://0.0.0.0:14540|does not exist"):
        parse_url(text)


@given(st.text(max_size=40))
def test_any_text_parses_or_is_told(text):
    try:
        parse_url(text)
    except UrlError as error:
        assert str(error).endswith(".")


def test_udpin_answers_who_spoke_first_and_ignores_others():
    vehicle, stranger = udp(), udp()
    probe = udp()
    port = probe.getsockname()[1]
    probe.close()
    transport = open_transport(parse_url(f"udpin://127.0.0.1:{port}"))
    try:
        transport.send(b"to nobody yet")
        vehicle.sendto(b"hello", ("127.0.0.1", port))
        assert received(transport) == b"hello"
        stranger.sendto(b"mine!", ("127.0.0.1", port))
        vehicle.sendto(b"again", ("127.0.0.1", port))
        assert received(transport) == b"again"
        transport.send(b"answer")
        assert vehicle.recv(100) == b"answer"
    finally:
        transport.close()
        vehicle.close()
        stranger.close()


def test_udpin_on_a_port_in_use_is_told():
    other = udp()
    try:
        with pytest.raises(TransportError, match="cannot listen"):
            open_transport(Url("udpin", "127.0.0.1", other.getsockname()[1]))
    finally:
        other.close()


def test_udpout_speaks_first_and_survives_a_closed_port():
    vehicle = udp()
    transport = open_transport(Url("udpout", "127.0.0.1", vehicle.getsockname()[1]))
    try:
        transport.send(b"hello")
        data, peer = vehicle.recvfrom(100)
        assert data == b"hello"
        vehicle.sendto(b"answer", peer)
        assert received(transport) == b"answer"
        vehicle.close()
        for _ in range(3):
            transport.send(b"lost")
            assert transport.receive() == b""
    finally:
        transport.close()


def test_tcpout_reconnects():
    server = socket.create_server(("127.0.0.1", 0))
    server.settimeout(5)
    told = []
    transport = open_transport(
        Url("tcpout", "127.0.0.1", server.getsockname()[1]),
        lambda severity, words: told.append((severity, words)),
    )
    try:
        connection, _ = server.accept()
        transport.send(b"hello")
        assert connection.recv(100) == b"hello"
        connection.close()
        received(transport, within_s=0.3)
        received(transport, within_s=1.5)
        connection, _ = server.accept()
        connection.sendall(b"back")
        assert received(transport) == b"back"
        connection.close()
        (alarm, lost), (info, back) = told
        assert (alarm, info) == (Severity.ALARM, Severity.INFO)
        assert "has hung up" in lost
        assert "answers again" in back
    finally:
        transport.close()
        server.close()


# A network of its own, whose loopback is switched off and on again: packets are lost, as in the air.
AIR = """
import ctypes, fcntl, os, socket, struct, sys, time
from groundstation.vehicle.open_transport import open_transport
from groundstation.vehicle.transport import Url

NEW_NETWORK, SET_FLAGS, UP, LOOPBACK = 0x40000000, 0x8914, 1, 8

def loopback(flags):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SET_FLAGS, struct.pack("16sh14x", b"lo", flags))

if ctypes.CDLL(None).unshare(NEW_NETWORK):
    sys.exit(77)
loopback(LOOPBACK | UP)
server = socket.create_server(("127.0.0.1", 0))
told = []
way = open_transport(Url("tcpout", "127.0.0.1", server.getsockname()[1]), lambda _, words: told.append(words))
vehicle = server.accept()[0]
loopback(LOOPBACK)
lost_t = time.monotonic()
while not told and time.monotonic() < lost_t + 30.0:
    way.send(b"old")
    way.receive()
print(f"{time.monotonic() - lost_t:.1f}", told[0])
loopback(LOOPBACK | UP)
server.settimeout(0.01)
vehicle = None
while vehicle is None and time.monotonic() < lost_t + 30.0:
    way.receive()
    try:
        vehicle = server.accept()[0]
    except TimeoutError:
        pass
way.send(b"new")
print(vehicle.recv(100).decode(), told[1])
"""


def test_a_tcp_connection_that_nobody_answers_is_given_up_and_called_anew_and_nothing_old_comes_through():
    with subprocess.Popen([sys.executable, "-c", AIR], stdout=subprocess.PIPE, text=True) as process:
        said, _ = process.communicate(timeout=60)
    if process.returncode == 77:
        pytest.skip("a network of its own needs more rights")
    lost, found = said.splitlines()
    assert "has hung up" in lost
    assert float(lost.split()[0]) < 10.0
    assert found.startswith("new ")
    assert "answers again" in found


def test_tcpout_without_a_server_is_told():
    server = socket.create_server(("127.0.0.1", 0))
    port = server.getsockname()[1]
    server.close()
    with pytest.raises(TransportError, match="no answer"):
        open_transport(Url("tcpout", "127.0.0.1", port))


def test_serial_over_a_pty_there_back_and_unplugged():
    controller, device = pty.openpty()
    transport = open_transport(Url("serial", os.ttyname(device), 57600))
    os.close(device)
    try:
        os.write(controller, b"hello")
        # A serial port gives what is there, in as many pieces as it likes.
        got = b""
        while len(got) < 5 and (piece := received(transport)):
            got += piece
        assert got == b"hello"
        transport.send(b"answer")
        assert os.read(controller, 100) == b"answer"
        os.close(controller)
        for _ in range(3):
            assert transport.receive() == b""
            transport.send(b"lost")
    finally:
        transport.close()


def test_what_would_leave_a_slow_serial_port_too_late_is_lost_and_told_once(monkeypatch):
    """A pseudo-terminal takes everything at once: how much waits is put in."""
    waiting = iter([0, 800, 801, 864, 0])
    monkeypatch.setattr(serial.Serial, "out_waiting", property(lambda _: next(waiting)))
    told = []
    controller, device = pty.openpty()
    way = open_transport(Url("serial", os.ttyname(device), 57_600), lambda *said: told.append(said))
    for letter in "abcde":
        way.send(letter.encode() * 64)
    way.close()
    assert {*os.read(controller, 1000)} == {*b"abe"}
    ((severity, words),) = told
    assert severity is Severity.WARNING
    assert "57600 baud" in words
    os.close(controller)
    os.close(device)


def test_a_serial_port_that_is_not_there_is_told():
    with pytest.raises(TransportError, match="dialout"):
        open_transport(Url("serial", "/dev/ttyNOSUCH9", 57600))


def usb(device, serial="A1", vendor=0x0403, product=0x6015) -> ListPortInfo:
    """Return a USB serial port as pyserial lists it."""
    port = ListPortInfo(device, skip_link_detection=True)
    port.vid, port.pid, port.serial_number = vendor, product, serial
    return port


RADIO = usb_port.Identity(0x0403, 0x6015, "A1")


@pytest.mark.parametrize(
    ("ports", "found"),
    [
        ([], ""),
        ([usb("/dev/ttyUSB0")], "/dev/ttyUSB0"),
        ([usb("/dev/ttyUSB1")], "/dev/ttyUSB1"),
        ([usb("/dev/ttyUSB0", serial="B2")], ""),  # a stranger at its place
        ([usb("/dev/ttyUSB0", serial="B2"), usb("/dev/ttyUSB1")], "/dev/ttyUSB1"),  # they have swapped
        ([usb("/dev/ttyUSB1"), usb("/dev/ttyUSB2")], ""),  # two that call themselves alike
        ([usb("/dev/ttyUSB0"), usb("/dev/ttyUSB2")], "/dev/ttyUSB0"),
        ([ListPortInfo("/dev/ttyUSB0", skip_link_detection=True)], ""),
    ],
)
def test_a_port_is_where_its_device_is(ports, found):
    assert usb_port.find("/dev/ttyUSB0", RADIO, ports) == found
    assert usb_port.find("/dev/ttyUSB0", None, ports) == "/dev/ttyUSB0"


def test_a_port_by_another_name_is_the_same_port(tmp_path):
    by_id = tmp_path / "usb-radio"
    by_id.symlink_to("/dev/ttyUSB0")
    assert usb_port.identity(str(by_id), [usb("/dev/ttyUSB0")]) == RADIO
    assert usb_port.find(str(by_id), RADIO, [usb("/dev/ttyUSB0")]) == str(by_id)
    assert usb_port.identity("/dev/ttyS0", [ListPortInfo("/dev/ttyS0", skip_link_detection=True)]) is None


def test_a_radio_that_comes_back_under_another_number_is_found_and_a_stranger_at_its_place_is_not_spoken_to():
    first, second, stranger = pty.openpty(), pty.openpty(), pty.openpty()
    names = [os.ttyname(end[1]) for end in (first, second, stranger)]
    there = [usb(names[0])]
    told = []
    transport = SerialPort(Url("serial", names[0], 57600), lambda _, words: told.append(words), lambda: there)
    try:
        there[:] = [usb(names[2], serial="B2")]
        for end in first:
            os.close(end)
        received(transport, within_s=1.5)
        assert told == [f"Serial port {names[0]} is gone; plug it in again."]
        there.append(usb(names[1]))
        received(transport, within_s=2.5)
        os.write(second[0], b"hello")
        assert received(transport)
        assert told[1:] == [f"Serial port {names[0]} is back, as {names[1]}."]
        transport.send(b"answer")
        assert os.read(second[0], 100).endswith(b"answer")
        os.set_blocking(stranger[0], False)
        with pytest.raises(BlockingIOError):
            os.read(stranger[0], 100)
    finally:
        transport.close()
        for end in (*second, *stranger):
            os.close(end)
