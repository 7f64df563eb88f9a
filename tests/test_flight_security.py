"""A signed flight between two processes that share a key, what a stranger on the wire can do, who can reach us."""

import socket
import time
from pathlib import Path

import pytest
from flight_support import Stage, another_station, asked, hears
from pymavlink.dialects.v20 import common as mavlink

from bench.fuzz_link import besieged
from bench.rig import Program
from groundstation.messages import Phase
from groundstation.run_folder import run_folder
from sim.process.signing_key import read_key

pytestmark = [pytest.mark.flight, pytest.mark.timeout(180)]

PASSPHRASE = "correct horse battery staple"


@pytest.fixture(scope="module")
def key(tmp_path_factory):
    path = tmp_path_factory.mktemp("key") / "signing.key"
    path.write_text(f"{PASSPHRASE}\n", encoding="utf-8")
    path.chmod(0o600)
    return path


def of_the_vehicle(key: bytes | None = None) -> bytes:
    """Return a vehicle's word that it has been taken over, signed or not."""
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    if key:
        link.signing.secret_key, link.signing.sign_outgoing = key, True
        link.signing.timestamp = int((time.time() - 1_420_070_400) * 1e5)
    return bytes(link.heartbeat_encode(2, 12, 0x81, 4 << 16 | 3 << 24, 4).pack(link))


def test_a_signed_flight_hears_and_obeys_only_who_has_the_key(tmp_path, key):
    stage = Stage(tmp_path, "--signing-key", str(key), vehicle_options=("--signing-key", str(key)))
    try:
        flight = stage.coupled()
        tap, program = flight.tap, flight.program
        reader = mavlink.MAVLink(None)
        reader.signing.secret_key = read_key(key)
        reader.signing.allow_unsigned_callback = lambda *_: False
        overheard = [data for _, data in tap.said[-20:]]
        assert {reader.parse_buffer(data)[0].get_signed() for data in overheard} == {True}
        assert any(asked(data)[0] for _, data in tap.setpoints)

        # Forged, and true once but heard before: neither ends the flight.
        began = time.monotonic()
        replayed = [data for _, data in tap.heard[:400]]
        for data in (of_the_vehicle(), of_the_vehicle(bytes(32)), *replayed):
            tap.say(data)
        flight.told("not signed with this key were refused", began)
        time.sleep(1.2)
        assert program.console.snapshot().pilot.phase == Phase.ENGAGED
        # Nor does the vehicle obey what is not signed, or what the operator said a while ago.
        disarm = another_station().command_long_encode(1, 1, 400, 0, 0, 21196, 0, 0, 0, 0, 0)
        tap.inject(bytes(disarm.pack(another_station())))
        arming = next(data for _, data in tap.said if data[7:10] == (76).to_bytes(3, "little"))
        tap.inject(arming)
        time.sleep(0.5)
        assert program.console.snapshot().pilot.phase == Phase.ENGAGED
        # The same words, signed, are heard.
        tap.say(of_the_vehicle(read_key(key)))
        flight.uncoupled()
    finally:
        stage.close()
    # The key is nowhere that is kept.
    secrets = (PASSPHRASE.encode(), read_key(key), read_key(key).hex().encode())
    kept = [path for path in stage.logs.rglob("*") if path.is_file()]
    assert {path.suffix for path in kept} >= {".rrd", ".tlog"}
    for path in kept:
        assert not any(secret in path.read_bytes() for secret in secrets)


def test_a_vehicle_without_the_key_is_not_heard_and_it_is_said(tmp_path, key):
    stage = Stage(tmp_path, "--signing-key", str(key))
    try:
        program = stage.start_program()
        stage.told("see that the vehicle has the same key", 0.0, 20)
        assert not program.console.snapshot().status.connected
        for folder in (run_folder(f"{program.process.pid}-").parent).glob(
            f"groundstation-{program.process.pid}-*"
        ):
            assert PASSPHRASE not in (folder / "run.json").read_text()
    finally:
        stage.close()


def sockets_of(pid: int) -> set[str]:
    found = set()
    for descriptor in Path(f"/proc/{pid}/fd").iterdir():
        try:
            target = str(descriptor.readlink())
        except OSError:
            continue
        if target.startswith("socket:["):
            found.add(target[8:-1])
    return found


def reachable(pid: int) -> dict[str, str]:
    """Return protocol and local address of each internet socket a process waits at."""
    ours = sockets_of(pid)
    found = {}
    for protocol in ("tcp", "tcp6", "udp", "udp6"):
        for line in Path(f"/proc/{pid}/net/{protocol}").read_text().splitlines()[1:]:
            words = line.split()
            # 0A is TCP's LISTEN; a UDP socket (07) is one that anybody may send to.
            if words[9] in ours and words[3] in ("0A", "07"):
                found[f"{protocol} {words[1]}"] = words[1].rpartition(":")[0]
    return found


def test_a_simulated_flight_waits_at_the_loopback_address_only(tmp_path):
    program = Program("--sim", "--mission", "hover", "--logs", str(tmp_path), columns=80, rows=24)
    try:
        program.until(hears, 40, "the vehicle is heard")
        pids = program.pids() | {"screen": program.process.pid}
        assert set(pids) >= {"sim", "link", "pilot", "recorder", "screen"}
        waiting = {
            f"{role} {name}": address
            for role, pid in pids.items()
            for name, address in reachable(pid).items()
        }
        assert any(name.startswith("link udp ") for name in waiting)
        loopback = socket.inet_aton("127.0.0.1")[::-1].hex().upper()
        assert {name: address for name, address in waiting.items() if address != loopback} == {}
    finally:
        program.close()


def test_a_link_under_fire_lives_and_lets_nothing_out_that_is_not_meant():
    """The short form of `python -m bench fuzz_link`, which raises where it finds something."""
    heard = besieged(5_000, seed=1)
    assert heard.frames >= 5_000
    assert heard.states > 20
    assert heard.commands > 20
