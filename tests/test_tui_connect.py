"""Connect: what there is to fly, what is chosen, and what the command line would be."""

from __future__ import annotations

import socket
import struct
import threading

import pytest
from textual.widgets import OptionList

from drivers.discovery import Found
from groundstation.config import Buttons
from groundstation.connections import Connection, recent, remember
from groundstation.tui.connect import Chosen, Connect, Offers
from groundstation.tui.screens.dialog import Typed
from groundstation.vehicle.finding import Place, heartbeat_words, listen, usb_words

PLACES = (
    Place("udpin://0.0.0.0:14540", "system 1, PX4 heard", heard=True),
    Place("udpin://0.0.0.0:14550", "nobody heard yet"),
    Place("serial:///dev/ttyACM0:115200", "PX4 FMU v5.x (26ac:0032, 0)"),
)
DEVICES = (
    Found("falcon", "falcon", "Novint Falcon", "F1", "/dev/ttyUSB1", "force", 1000.0),
    Found("inverse3", "inverse3", "Inverse3", "", "", "force", 1000.0, False, "in use", "end that program"),
)
MISSIONS = (("hover", "Hover: take off, hold a point, land"), ("paper", "The paper's experiment"))
RECENT = (Connection("tcpout://10.0.0.7:5760", "falcon", "paper", "2026-11-20"),)
OFFERS = Offers(lambda: PLACES, lambda: DEVICES, MISSIONS, RECENT, Buttons())
SIZES = [(80, 24), (120, 40), (200, 60)]


async def settled(pilot) -> None:
    """Wait until vehicles and devices have been looked for."""
    while pilot.app.query_one("#vehicle", OptionList).option_count < 6 or pilot.app.workers._workers:
        await pilot.pause(0.01)
    await pilot.pause()


async def chosen(*keys: str, offers: Offers = OFFERS, **wanted: str) -> Chosen | None:
    app = Connect(offers, **wanted)
    async with app.run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        await pilot.press(*keys)
        await pilot.pause()
    return app.return_value


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        (("enter",), Chosen("", "", "")),
        (("down", "enter"), Chosen("udpin://0.0.0.0:14540", "", "")),
        (("down", "down", "down", "down", "enter"), Chosen("tcpout://10.0.0.7:5760", "", "")),
        (("tab", "down", "tab", "down", "down", "enter"), Chosen("", "falcon", "paper")),
        (("q",), None),
        (("escape",), None),
        (("ctrl+c",), None),
    ],
)
async def test_keys_choose_and_enter_starts(keys, expected):
    assert await chosen(*keys) == expected


async def test_what_the_command_line_asked_for_is_chosen_already():
    assert await chosen("enter", device="emulated:falcon", mission="paper") == Chosen(
        "", "emulated:falcon", "paper"
    )


async def test_another_address_is_typed_and_checked():
    app = Connect(OFFERS)
    async with app.run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        await pilot.press("o", "end", "x", "enter")
        assert isinstance(app.screen, Typed)
        await pilot.press("backspace", "backspace", "1", "enter")
        await pilot.pause()
        assert app.choice().connect == "udpin://0.0.0.0:14541"
        await pilot.press("enter")
    assert app.return_value == Chosen("udpin://0.0.0.0:14541", "", "")


async def test_what_is_looked_for_again_leaves_the_choice_alone():
    app = Connect(OFFERS)
    async with app.run_test(size=(80, 24)) as pilot:
        await settled(pilot)
        await pilot.press("down", "down", "u")
        await settled(pilot)
        assert app.choice().connect == "udpin://0.0.0.0:14550"


async def test_a_device_that_cannot_be_used_says_why_and_is_not_chosen():
    app = Connect(OFFERS)
    async with app.run_test(size=(200, 60)) as pilot:
        await settled(pilot)
        devices = app.query_one("#device", OptionList)
        option = devices.get_option_at_index(2)
        assert option.disabled
        assert "in use; end that program" in str(option.prompt)


def test_the_choice_as_a_command():
    assert Chosen("", "", "").command() == "groundstation --sim"
    assert Chosen("udpin://0.0.0.0:1", "falcon", "a b").command() == (
        "groundstation --connect udpin://0.0.0.0:1 --device falcon --mission 'a b'"
    )


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_the_picture(snap_compare, size):
    async def look(pilot) -> None:
        await settled(pilot)
        await pilot.press("down")
        await pilot.pause()

    assert snap_compare(Connect(OFFERS, mission="paper"), terminal_size=size, run_before=look)


# What there is.


def heartbeat(version: int, autopilot: int, system: int = 7) -> bytes:
    payload = struct.pack("<IBBBBB", 0, 2, autopilot, 0, 4, 3)
    if version == 2:
        return bytes((0xFD, len(payload), 0, 0, 0, system, 1, 0, 0, 0)) + payload + b"\0\0"
    return bytes((0xFE, len(payload), 0, system, 1, 0)) + payload + b"\0\0"


@pytest.mark.parametrize("version", [1, 2])
def test_a_heartbeat_says_who_it_is(version):
    assert heartbeat_words(heartbeat(version, 12)) == "system 7, PX4 heard"
    assert heartbeat_words(heartbeat(version, 3)) == "system 7, ArduPilot heard"
    assert heartbeat_words(heartbeat(version, 0)) == "system 7, an autopilot heard"
    assert heartbeat_words(heartbeat(version, 8)) == ""


@pytest.mark.parametrize(
    "data", [b"", b"\xfd", b"hello", b"\xfd\x01\x00\x00\x00\x07\x01\x1e\x00\x00\x00\x00\x00"]
)
def test_what_is_no_heartbeat_is_nobody(data):
    assert heartbeat_words(data) == ""


def test_vehicles_are_heard_on_udp_and_a_port_that_is_taken_says_so():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("0.0.0.0", 0))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            free = probe.getsockname()[1]
        over = threading.Event()

        def speak() -> None:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
                while not over.wait(0.02):
                    vehicle.sendto(heartbeat(2, 12), ("127.0.0.1", free))

        thread = threading.Thread(target=speak)
        thread.start()
        try:
            heard, other = listen((taken.getsockname()[1], free), seconds=5.0)
        finally:
            over.set()
            thread.join()
    assert heard == Place(f"udpin://0.0.0.0:{free}", "system 7, PX4 heard", heard=True)
    assert other.words.startswith("taken: ")


def test_usb_ports_are_told_by_identity():
    assert usb_words("PX4 FMU v5.x", 0x26AC, 0x32, "0") == "PX4 FMU v5.x (26ac:0032, 0)"
    assert usb_words(None, 0x403, 0x6015, None) == "USB serial port (0403:6015)"


def test_connections_are_kept_newest_first_once_each_and_not_for_ever(tmp_path):
    assert recent(tmp_path) == []
    for number in range(8):
        remember(tmp_path, Connection(f"udpin://0.0.0.0:{number}"))
    remember(tmp_path, Connection("udpin://0.0.0.0:4", mission="paper"))
    kept = recent(tmp_path)
    assert kept[0] == Connection("udpin://0.0.0.0:4", mission="paper")
    assert [each.url[-1] for each in kept] == list("476532")
    (tmp_path / "connections.json").write_text("{")
    assert recent(tmp_path) == []
