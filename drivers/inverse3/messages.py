"""What Haply's Inverse Service says and understands (docs.haply.co, "WebSocket Protocol").

On connecting the service sends a snapshot of all devices, and from then on exactly one state for each message it
gets. A force is told in one of two dialects: under the name `vector` since version 3.1, under `values` before.
Its frame is x right, y forward, z up; the handle frame's x is its y, and y its −x.

What comes is checked here: what is not JSON, lacks a field or has one of another type, or holds a number that is
none or that no such device can measure, is no message.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import msgspec

from drivers.device import DeviceError, Vector3
from drivers.vectors import inside

# No device of this family reaches farther from its base, m, and no hand is faster, m/s.
_FARTHEST = 0.5
_FASTEST = 10.0


class Dialect(StrEnum):
    """The name under which a force is told."""

    VECTOR = "vector"
    VALUES = "values"


class Xyz(msgspec.Struct):
    """A vector in the service's frame."""

    x: float
    y: float
    z: float


class State(msgspec.Struct):
    """Where the cursor, which is the handle, is, m, and how it moves, m/s."""

    cursor_position: Xyz
    cursor_velocity: Xyz


class Status(msgspec.Struct):
    """Of the device; a service that does not say whether it is calibrated calibrates it by itself."""

    calibrated: bool = True


class Config(msgspec.Struct):
    """Of the device, in the snapshot only; `preset` names where the origin is, if the service has such."""

    type: str = "inverse3"
    preset: str | None = None
    extended_device_id: str = ""


class Device(msgspec.Struct):
    """An Inverse3 or one of its family."""

    device_id: str
    state: State | None = None
    status: Status | None = None
    config: Config | None = None


class GripState(msgspec.Struct):
    """Of a VerseGrip, the handle's pen; a wired one has a single button."""

    buttons: dict[str, bool] = {}
    button: bool = False


class Grip(msgspec.Struct):
    """A VerseGrip."""

    state: GripState | None = None


class Message(msgspec.Struct):
    """A snapshot, or a state."""

    inverse3: list[Device] = []
    wireless_verse_grip: list[Grip] = []
    verse_grip: list[Grip] = []


class Service(msgspec.Struct):
    """The service's answer to `GET /version`."""

    project_version: str = ""


class Sample(NamedTuple):
    """A measurement in the handle's axes: m and m/s, from the origin of the service's frame."""

    position: Vector3
    velocity: Vector3


_messages = msgspec.json.Decoder(Message)


def decode(text: str | bytes) -> Message | None:
    """Return a message of the service, or None where it is not one."""
    try:
        return _messages.decode(text)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return None


def sample(state: State) -> Sample | None:
    """Return what a state says, or None where no such device can measure it."""
    position, velocity = _turned(state.cursor_position), _turned(state.cursor_velocity)
    if inside(position, _FARTHEST) and inside(velocity, _FASTEST):
        return Sample(position, velocity)
    return None


def buttons(message: Message) -> int:
    """Return the pen's buttons: a, b, c as bits 0 to 2; a wired pen's only one as bit 0."""
    bits = 0
    for grip in (*message.wireless_verse_grip, *message.verse_grip):
        if grip.state is not None:
            pressed = grip.state.buttons
            bits |= pressed.get("a", grip.state.button)
            bits |= pressed.get("b", False) << 1 | pressed.get("c", False) << 2
    return bits


def dialect_of(answer: bytes) -> Dialect | None:
    """Return the dialect of the service whose answer to `GET /version` this is, or None where it tells none."""
    try:
        version = msgspec.json.decode(answer, type=Service).project_version
        major, minor = (int(part) for part in version.split(".")[:2])
    except (msgspec.DecodeError, ValueError):
        return None
    return Dialect.VECTOR if (major, minor) >= (3, 1) else Dialect.VALUES


class Speaker:
    """Makes the messages for one device.

    Args:
        device_id: Its id.
        dialect: What its service understands.
    """

    def __init__(self, device_id: str, dialect: Dialect) -> None:
        self._id = _quoted(device_id)
        head = f'{{"inverse3":[{{"device_id":{self._id},"commands":{{"set_cursor_force":{{"{dialect}":'
        self._force = head.replace("%", "%%") + '{"x":%.4f,"y":%.4f,"z":%.4f}}}}]}'

    def force(self, force: Vector3) -> str:
        """Return the message that renders a force, N, handle frame."""
        x, y, z = force
        return self._force % (-y, x, z)

    def centre(self) -> str:
        """Return the message that lays the origin into the middle of the device's reach."""
        configure = '"configure":{"preset":"arm_front_centered"}'
        return f'{{"inverse3":[{{"device_id":{self._id},{configure}}}]}}'


def find(message: Message, device_id: str) -> Device:
    """Return the device with this id, or the first one for "".

    Raises:
        DeviceError: There is none.
    """
    for device in message.inverse3:
        if device_id in {"", device.device_id}:
            return device
    if not message.inverse3:
        raise DeviceError("The Inverse Service has no Inverse3; plug it in and switch it on.")
    others = ", ".join(device.device_id for device in message.inverse3)
    raise DeviceError(f"{device_id}: no Inverse3 with this id; the Inverse Service has: {others}.")


def _turned(vector: Xyz) -> Vector3:
    return vector.y, -vector.x, vector.z


def _quoted(text: str) -> str:
    return msgspec.json.encode(text).decode()
