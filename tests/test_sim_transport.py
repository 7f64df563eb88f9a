"""The vehicle's links on real sockets and a real pseudo-terminal, and their URLs beside the ground station's."""

import os
import pty
import socket
import time
import tty

import pytest

from groundstation.vehicle.open_transport import open_transport as open_ground
from groundstation.vehicle.transport import parse_url as ground_url
from sim.process.transport import (
    PEER_S,
    REFUSED_S,
    TcpIn,
    TcpOut,
    TransportError,
    UdpIn,
    UdpOut,
    Url,
    open_transport,
    parse_url,
)

PATIENCE_S = 20.0


class Clock:
    """Time that passes only when told."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def opened(text):
    return open_transport(parse_url(text))


def wait_for(transport):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if data := b"".join(transport.receive()):
            return data
        time.sleep(0.005)
    pytest.fail("nothing came")


def wait_until(condition, what):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.005)
    pytest.fail(f"did not happen: {what}")


def ground_socket():
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.bind(("127.0.0.1", 0))
    udp.settimeout(PATIENCE_S)
    return udp


@pytest.fixture
def station():
    with ground_socket() as udp:
        yield udp


@pytest.fixture
def stranger():
    with ground_socket() as udp:
        yield udp


# URLs


@pytest.mark.parametrize(
    ("text", "url"),
    [
        ("udpout://127.0.0.1:14540", Url("udpout", "127.0.0.1", 14540)),
        ("udpin://14540", Url("udpin", "127.0.0.1", 14540)),
        ("udpin://:14540", Url("udpin", "127.0.0.1", 14540)),
        ("tcpin://0.0.0.0:0", Url("tcpin", "0.0.0.0", 0)),
        ("tcpout://host.example:5760", Url("tcpout", "host.example", 5760)),
        ("serial:///dev/ttyUSB0:57600", Url("serial", "/dev/ttyUSB0", 57600)),
    ],
)
def test_urls_are_parsed(text, url):
    assert parse_url(text) == url
    assert parse_url(str(url)) == url


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is not a connection"),
        ("14540", "is not a connection"),
        ("udp://127.0.0.1:14540", "is not a connection"),
        ("udpout:127.0.0.1:14540", "is not a connection"),
        ("udpin://a:b:1", "is not a connection"),
        ("serial://ttyUSB0", "is not a connection"),
        ("udpin://127.0.0.1:", "'' is not a port"),
        ("udpin://127.0.0.1:٣", "is not a port"),
        ("udpout://127.0.0.1:65536", "'65536' is not a port"),
        ("udpout://14540", "names nobody"),
        ("tcpout://:5760", "names nobody"),
        ("udpout://127.0.0.1:0", "names nobody"),
    ],
)
def test_what_is_no_url_is_said(text, says):
    with pytest.raises(TransportError) as caught:
        parse_url(text)
    assert says in str(caught.value)


def test_ports_count_up_from_vehicle_to_vehicle():
    url = parse_url("udpout://127.0.0.1:14540")
    assert [url.shifted(number).number for number in range(3)] == [14540, 14541, 14542]
    assert parse_url("tcpin://0").shifted(3).number == 0
    with pytest.raises(TransportError, match="vehicle 2 would need port 65536"):
        parse_url("udpin://65535").shifted(1)
    with pytest.raises(TransportError, match="carries one vehicle"):
        parse_url("serial:///dev/ttyUSB0:57600").shifted(1)


# UDP


def test_udpout_hears_only_whom_it_speaks_to(station, stranger):
    transport = opened(f"udpout://127.0.0.1:{station.getsockname()[1]}")
    assert isinstance(transport, UdpOut)
    transport.send(b"hello")
    data, address = station.recvfrom(100)
    assert data == b"hello"
    stranger.sendto(b"mine", address)
    station.sendto(b"yours", address)
    assert wait_for(transport) == b"yours"
    transport.close()


def test_a_closed_port_is_noticed_and_so_is_its_opening():
    with ground_socket() as early:
        port = early.getsockname()[1]
    clock = Clock()
    transport = UdpOut(Url("udpout", "127.0.0.1", port), clock)
    assert transport.heard
    transport.send(b"is anybody there?")
    wait_until(lambda: list(transport.receive()) == [] and not transport.heard, "the refusal")
    clock.now += 1.0
    transport.send(b"heartbeat")
    wait_until(lambda: list(transport.receive()) == [] and transport._refused_t == clock.now, "refused again")
    clock.now += REFUSED_S - 0.1
    assert not transport.heard
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as late:
        late.bind(("127.0.0.1", port))
        late.settimeout(PATIENCE_S)
        transport.send(b"heartbeat")
        data, address = late.recvfrom(100)
        assert data == b"heartbeat"
        late.sendto(b"hello", address)
        assert wait_for(transport) == b"hello"
        assert transport.heard
    transport.close()


def test_a_port_that_is_open_again_is_heard_though_it_says_nothing():
    with ground_socket() as early:
        port = early.getsockname()[1]
    clock = Clock()
    transport = UdpOut(Url("udpout", "127.0.0.1", port), clock)
    transport.send(b"is anybody there?")
    wait_until(lambda: list(transport.receive()) == [] and not transport.heard, "the refusal")
    clock.now += REFUSED_S + 0.1
    assert transport.heard
    transport.close()


def test_udpin_answers_all_who_spoke_lately(station, stranger):
    clock = Clock()
    transport = UdpIn(parse_url("udpin://0"), clock)
    transport.send(b"to nobody")
    assert not transport.heard
    address = ("127.0.0.1", transport.url.number)
    for udp in (station, stranger):
        udp.sendto(b"hello", address)
        assert wait_for(transport) == b"hello"
    transport.send(b"to both")
    assert station.recv(100) == stranger.recv(100) == b"to both"
    clock.now += PEER_S - 1.0
    station.sendto(b"still here", address)
    wait_for(transport)
    clock.now += 2.0
    list(transport.receive())
    transport.send(b"to one")
    assert station.recv(100) == b"to one"
    stranger.settimeout(0.1)
    with pytest.raises(TimeoutError):
        stranger.recv(100)
    clock.now += PEER_S
    list(transport.receive())
    assert not transport.heard
    transport.close()


def test_udpin_remembers_no_more_than_eight():
    clock = Clock()
    transport = UdpIn(parse_url("udpin://0"), clock)
    peers = [ground_socket() for _ in range(10)]
    for udp in peers:
        clock.now += 0.1
        udp.sendto(b"hello", ("127.0.0.1", transport.url.number))
        wait_for(transport)
    assert set(transport._peers) == {udp.getsockname() for udp in peers[2:]}
    for udp in peers:
        udp.close()
    transport.close()


@pytest.mark.parametrize("scheme", ["udpin", "tcpin"])
def test_this_machine_only_unless_told(scheme):
    for text, address in ((f"{scheme}://0", "127.0.0.1"), (f"{scheme}://0.0.0.0:0", "0.0.0.0")):
        transport = opened(text)
        bound = transport._socket if scheme == "udpin" else transport._listener
        assert bound.getsockname() == (address, transport.url.number)
        transport.close()


# TCP


def test_tcp_takes_one_client_after_the_other():
    transport = opened("tcpin://0")
    assert isinstance(transport, TcpIn)
    transport.send(b"to nobody")
    assert not transport.heard
    for _ in range(2):
        with socket.create_connection(("127.0.0.1", transport.url.number), timeout=PATIENCE_S) as client:
            client.sendall(b"hello")
            assert wait_for(transport) == b"hello"
            assert transport.heard
            transport.send(b"welcome")
            assert client.recv(100) == b"welcome"
    wait_until(lambda: list(transport.receive()) == [] and not transport.heard, "the client has gone")
    transport.send(b"to nobody")
    transport.close()


def test_a_tcp_client_that_does_not_read_is_let_go():
    transport = opened("tcpin://0")
    with socket.create_connection(("127.0.0.1", transport.url.number), timeout=PATIENCE_S) as client:
        client.sendall(b"hello")
        wait_for(transport)
        for _ in range(10_000):
            transport.send(bytes(10_000))
            if not transport.heard:
                break
        assert not transport.heard
    transport.close()


def test_tcpout_waits_for_its_ground_station_and_for_its_return():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    clock = Clock()
    transport = TcpOut(Url("tcpout", "127.0.0.1", port), clock)
    for _ in range(2):
        assert list(transport.receive()) == []
        clock.now += 1.1
        assert list(transport.receive()) == []
        transport.send(b"to nobody")
        assert not transport.heard
        with socket.create_server(("127.0.0.1", port), reuse_port=False) as listener:
            listener.settimeout(PATIENCE_S)
            clock.now += 1.1
            wait_until(
                lambda: _tick(clock) or (list(transport.receive()) == [] and transport.heard), "connected"
            )
            client, _ = listener.accept()
            with client:
                client.settimeout(PATIENCE_S)
                transport.send(b"hello")
                assert client.recv(100) == b"hello"
                client.sendall(b"welcome")
                assert wait_for(transport) == b"welcome"
        wait_until(lambda: list(transport.receive()) == [] and not transport.heard, "it has gone")
    transport.close()


def _tick(clock):
    clock.now += 0.5


def test_a_name_that_nobody_has_is_said():
    with pytest.raises(TransportError, match="cannot be opened"):
        opened("tcpout://no-such-host.invalid:5760")
    with pytest.raises(TransportError, match="cannot be opened"):
        opened("udpout://no-such-host.invalid:14540")


@pytest.mark.parametrize("scheme", ["udpin", "tcpin"])
def test_a_port_in_use_is_said(scheme):
    taken = opened(f"{scheme}://0")
    with pytest.raises(TransportError, match="in use"):
        opened(f"{scheme}://{taken.url.number}")
    taken.close()


# Serial ports


@pytest.fixture
def cable():
    """Return a pseudo-terminal: what we hold of it, and the name of the end a program opens."""
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    yield ours, os.ttyname(theirs)
    for end in (ours, theirs):
        os.close(end)


def test_a_serial_port_carries_bytes_both_ways(cable):
    ours, name = cable
    transport = opened(f"serial://{name}:57600")
    assert transport.heard
    assert list(transport.receive()) == []
    os.write(ours, b"hello")
    assert wait_for(transport) == b"hello"
    transport.send(b"welcome")
    assert os.read(ours, 100) == b"welcome"
    transport.close()


def test_a_full_serial_port_loses_whole_datagrams_and_never_waits(cable):
    ours, name = cable
    transport = opened(f"serial://{name}:57600")
    datagrams = [number.to_bytes(4, "big") * 25 for number in range(2000)]
    for data in datagrams:
        transport.send(data)
    os.set_blocking(ours, False)
    heard = b""
    for _ in range(2000):
        try:
            heard += os.read(ours, 65536)
        except BlockingIOError:
            if not transport._waiting:
                break
            transport.send(b"")
    numbers = [int.from_bytes(heard[at : at + 4], "big") for at in range(0, len(heard), 100)]
    assert heard == b"".join(datagrams[number] for number in numbers)
    assert 10 < len(numbers) < 2000
    transport.close()


def test_a_serial_port_that_is_not_there_is_said():
    with pytest.raises(TransportError, match="check the cable, the name"):
        opened("serial:///dev/ttyNOT0:57600")


def test_a_serial_port_that_goes_is_no_error_and_comes_back(tmp_path):
    from sim.process.serial_port import SerialPort

    clock = Clock()
    ours, theirs = pty.openpty()
    link = tmp_path / "port"
    link.symlink_to(os.ttyname(theirs))
    transport = SerialPort(Url("serial", str(link), 57600), clock)
    os.close(theirs)
    os.close(ours)
    wait_until(
        lambda: transport.send(b"x") or (list(transport.receive()) == [] and not transport.heard), "gone"
    )
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    link.unlink()
    link.symlink_to(os.ttyname(theirs))
    list(transport.receive())
    clock.now += 1.1
    list(transport.receive())
    assert transport.heard
    transport.send(b"back")
    assert os.read(ours, 100) == b"back"
    transport.close()
    os.close(ours)
    os.close(theirs)


# The other side: what `groundstation --connect` is given to match


@pytest.mark.parametrize(
    ("vehicle", "station"),
    [("udpout", "udpin"), ("udpin", "udpout"), ("tcpin", "tcpout")],
)
def test_the_ground_stations_urls_match(vehicle, station):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    if station == "udpin":
        there = open_ground(ground_url(f"udpin://0.0.0.0:{port}"))
        here = opened(f"{vehicle}://127.0.0.1:{port}")
    else:
        here = opened(f"{vehicle}://{port}")
        there = open_ground(ground_url(f"{station}://127.0.0.1:{port}"))
        there.send(b"hello")
        assert wait_for(here) == b"hello"
    here.send(b"from the vehicle")
    wait_until(lambda: there.receive() == b"from the vehicle", "heard by the ground station")
    there.send(b"from the ground")
    assert wait_for(here) == b"from the ground"
    here.close()
    there.close()
