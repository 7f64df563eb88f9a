"""Haply's Inverse Service with one Inverse3: a WebSocket server on this machine, and a hand on its device."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable, Sequence
from typing import Any

import wsproto
from wsproto.events import AcceptConnection, CloseConnection, Ping, Request, TextMessage
from wsproto.utilities import RemoteProtocolError

from drivers.device import ZERO3, HandleState, Vector3
from drivers.emulators.hand import EmulatedHand
from drivers.inverse3.driver import CENTRE, WORKSPACE
from drivers.inverse3.messages import Dialect

DEVICE_ID = "049D"
PENS = {"a": 1, "b": 2, "c": 4}
_VERSIONS = {Dialect.VECTOR: "3.5.0.0", Dialect.VALUES: "3.0.5.0"}
_MOST_BYTES = 1 << 16

Json = dict[str, Any]


class Inverse3Emulator:
    """The service, with an Inverse3 and a VerseGrip, for one program at a time.

    Args:
        hand: Whose hand.
        clock: Monotonic seconds.
        dialect: What it understands, which also says how old it is: one that takes "values" has no presets.

    Attributes:
        calibrated: What its device says of itself.
        silent: It takes messages and does not answer.
        plugged: Its device is there.
        spoil: Changes what it says, for tests of what a bad service does.
        force: What its device presses with now, N, handle frame.
    """

    WORKSPACE = WORKSPACE

    def __init__(
        self, hand: EmulatedHand, clock: Callable[[], float], dialect: Dialect = Dialect.VECTOR
    ) -> None:
        self._hand = hand
        self._clock = clock
        self._dialect = dialect
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(0.0)
        self._port = int(self._listener.getsockname()[1])
        self._clients: list[_Client] = []
        self._origin = CENTRE
        self.calibrated = True
        self.silent = False
        self.plugged = True
        self.spoil: Callable[[str], str] = str
        self.force: Vector3 = ZERO3

    @property
    def uri(self) -> str:
        """What to give to `--device`."""
        return f"inverse3:127.0.0.1:{self._port}"

    def descriptors(self) -> Sequence[int]:
        """Return the sockets'."""
        if self._listener.fileno() < 0:
            return ()
        return (self._listener.fileno(), *(client.fileno() for client in self._clients))

    def turn(self) -> None:
        """Take what came, move the hand, answer."""
        if self._listener.fileno() < 0:
            return
        state = self._hand.step(self._clock(), self.force)
        self._accept()
        for client in list(self._clients):
            for text in client.receive(self._version(), lambda: self._say(state, snapshot=True)):
                self._obey(json.loads(text))
                if not self.silent:
                    client.send(self._say(state))
            if client.gone:
                self._clients.remove(client)
                if client.upgraded:
                    self.force = ZERO3

    def close(self) -> None:
        """End the service."""
        for client in self._clients:
            client.close()
        self._clients.clear()
        self._listener.close()
        self._hand.close()

    def _accept(self) -> None:
        try:
            connection, _ = self._listener.accept()
        except BlockingIOError:
            return
        self._origin = CENTRE
        self._clients.append(_Client(connection))

    def _version(self) -> str:
        return json.dumps(
            {"project_name": "haply-inverse-service", "project_version": _VERSIONS[self._dialect]}
        )

    def _obey(self, message: Json) -> None:
        for device in message.get("inverse3", ()):
            if device.get("device_id") != DEVICE_ID:
                continue
            force = device.get("commands", {}).get("set_cursor_force", {}).get(self._dialect.value)
            if force is not None:
                self.force = (force["y"], -force["x"], force["z"])
            preset = device.get("configure", {}).get("preset")
            if preset is not None and self._dialect is Dialect.VECTOR:
                self._origin = ZERO3 if preset == "arm_front_centered" else CENTRE

    def _say(self, state: HandleState, *, snapshot: bool = False) -> str:
        """Return a state, with all that is known of the devices in a snapshot."""
        device: Json = {"device_id": DEVICE_ID, "state": self._state(state)}
        pen = {name: bool(state.buttons & bit) for name, bit in PENS.items()}
        message: Json = {
            "inverse3": [device] if self.plugged else [],
            "wireless_verse_grip": [{"device_id": "61576", "state": {"buttons": pen}}],
        }
        device["status"] = {"calibrated": self.calibrated, "in_use": False, "power_supply": True}
        if snapshot:
            device["config"] = {"type": "inverse3", "handedness": "right", "port": "/dev/ttyACM0"}
            if self._dialect is Dialect.VECTOR:
                message["session_id"] = 7
                device["config"]["preset"] = "defaults"
        return self.spoil(json.dumps(message))

    def _state(self, state: HandleState) -> Json:
        x, y, z = (a + b for a, b in zip(state.position, self._origin, strict=True))
        return {
            "cursor_position": _xyz((x, y, z)),
            "cursor_velocity": _xyz(state.velocity),
            "current_cursor_force": _xyz(self.force),
            "control_mode": "idle",
        }


class _Client:
    """One connection: a program that speaks WebSocket, or one that only asks for the version."""

    def __init__(self, connection: socket.socket) -> None:
        connection.settimeout(0.0)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connection
        self._protocol = wsproto.WSConnection(wsproto.ConnectionType.SERVER)
        self.upgraded = False
        self.gone = False

    def fileno(self) -> int:
        return self._socket.fileno()

    def receive(self, version: str, snapshot: Callable[[], str]) -> list[str]:
        """Return the messages that came; greet a program that connects."""
        try:
            data = self._socket.recv(_MOST_BYTES)
        except BlockingIOError:
            return []
        except OSError:
            data = b""
        if not data:
            self.close()
            return []
        if not self.upgraded and b"upgrade: websocket" not in data.lower():
            head = (
                f"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: {len(version)}\r\n\r\n"
            )
            self._push((head + version).encode())
            return []
        self.upgraded = True
        try:
            self._protocol.receive_data(data)
            return self._answered(snapshot)
        except RemoteProtocolError:
            self.close()
            return []

    def _answered(self, snapshot: Callable[[], str]) -> list[str]:
        texts: list[str] = []
        for event in self._protocol.events():
            if isinstance(event, Request):
                self._push(self._protocol.send(AcceptConnection()))
                self.send(snapshot())
            elif isinstance(event, TextMessage):
                texts.append(event.data)
            elif isinstance(event, Ping):
                self._push(self._protocol.send(event.response()))
            elif isinstance(event, CloseConnection):
                self._push(self._protocol.send(event.response()))
                self.close()
        return texts

    def send(self, text: str) -> None:
        if not self.gone:
            self._push(self._protocol.send(TextMessage(text)))

    def close(self) -> None:
        self.gone = True
        self._socket.close()

    def _push(self, data: bytes) -> None:
        try:
            self._socket.send(data)
        except OSError:
            self.close()


def _xyz(vector: Vector3) -> Json:
    """Return a vector of the handle frame in the service's: x right, y forward, z up."""
    x, y, z = vector
    return {"x": -y, "y": x, "z": z}
