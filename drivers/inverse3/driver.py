"""Haply Inverse3 (and Inverse3x, Minverse) behind its maker's Inverse Service; messages in `messages`.

The service answers each message with one state. So each `write_force` sends one and the `read` of the next tick
takes the answer: a tick of latency, no waiting. No more than three are under way at once, so that a service that is
slower than the servo gives newer states and not a queue of old ones.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState, Vector3
from drivers.discovery import Found, unusable
from drivers.inverse3 import messages
from drivers.inverse3.messages import Dialect, Speaker
from drivers.inverse3.service import connect, parse, version
from drivers.inverse3.websocket import REMEDY, WebSocket
from drivers.vectors import finite, inside, within

NAME = "Haply Inverse3"
CENTRE: Vector3 = (-0.12, 0.0, 0.15)
"""Middle of the reach from the base, m, handle's axes, for a service that cannot lay its origin there."""

REACH = {"minverse": 0.04}
WORKSPACE = 0.15
FORCE_LIMIT = 10.0
STIFFNESS_LIMIT = 1000.0
RATE = 1000.0

SILENCE_S = 0.05
LOOK_S = 0.15
"""Longest wait for a service that is only looked for."""
MOST_UNDER_WAY = 3


class Inverse3:
    """An Inverse3.

    Args:
        address: "" for the first device of the service on this machine, a device's id, `HOST:PORT`, or
            `HOST:PORT/ID`.
        clock: Monotonic seconds.
        dialect: How the service is told a force: "vector", "values", or "auto" to go by its version.
        centre: Where the handle's centre is for a service before 3.5: m from the device's base, in the
            handle's axes.

    Attributes:
        refused: Messages that were not believed since it was opened.

    Raises:
        DeviceError: The address, the dialect or the centre is none.
    """

    def __init__(
        self,
        address: str,
        clock: Callable[[], float] = time.monotonic,
        *,
        dialect: str = "auto",
        centre: object = CENTRE,
    ) -> None:
        self._address = parse(address)
        self._dialect = _chosen(dialect)
        self._base_centre = _vector(centre)
        self._clock = clock
        self._socket: WebSocket | None = None
        self._info = _info("", "inverse3")
        self._rest()

    @property
    def info(self) -> DeviceInfo:
        """What the device is."""
        return self._info

    def open(self) -> None:
        """Connect to the service, choose the device and the dialect, and lay the origin into the centre.

        Raises:
            DeviceError: There is no service, it has no such device, or `wsproto` is missing.
        """
        self.close()
        self._rest()
        where, connection, snapshot = connect(self._address)
        self._socket = connection
        try:
            self._begin(where, messages.find(snapshot, self._address.device_id))
        except DeviceError:
            self.close()
            raise

    def read(self) -> HandleState:
        """Return where the handle is.

        Raises:
            DeviceError: It is silent or says nothing that can be believed for 50 ms, is gone, or not open.
        """
        connection = self._opened()
        now = self._clock()
        unasked = not self._under_way
        for text in connection.receive():
            self._take(text)
        if unasked:
            self._send(ZERO3)
        if now - self._newest_t > SILENCE_S:
            raise DeviceError(
                f"{NAME}: the Inverse Service is silent about it; check its cable and the service."
            )
        if self._sample is None:
            raise DeviceError(f"{NAME}: no state yet; it was only just opened.")
        position, velocity = self._sample
        x, y, z = self._centre
        place = within((position[0] - x, position[1] - y, position[2] - z), self._info.workspace)
        return HandleState(place, velocity, 0.0, self._buttons, homed=self._homed, device_time=self._newest_t)

    def write_force(self, force: Vector3) -> None:
        """Render a force, N; none while the device is not calibrated.

        Raises:
            DeviceError: It is not finite (then it is zero), or the service is gone.
        """
        if not finite(force):
            self._send(ZERO3)
            raise DeviceError(f"{NAME}: the force is not a number; it is set to zero.")
        self._send(within(force, FORCE_LIMIT) if self._homed else ZERO3)

    def close(self) -> None:
        """Set the force to zero and let the service go."""
        connection, self._socket = self._socket, None
        if connection is None:
            return
        try:
            if self._speaker is not None:
                connection.send(self._speaker.force(ZERO3))
        except DeviceError:
            pass  # it is gone already
        finally:
            connection.close()

    def _rest(self) -> None:
        self._speaker: Speaker | None = None
        self._sample: messages.Sample | None = None
        self._device_id = ""
        self._centre = ZERO3
        self._newest_t = self._clock()
        self._under_way: deque[float] = deque()
        self._passed_over = 0
        self._buttons = 0
        self._homed = False
        self.refused = 0

    def _begin(self, where: tuple[str, int], device: messages.Device) -> None:
        """Take a device of the service at `where`."""
        config = device.config or messages.Config()
        self._info = _info(config.extended_device_id or device.device_id, config.type)
        self._device_id = device.device_id
        has_presets = config.preset is not None
        dialect = self._dialect or version(*where) or (Dialect.VECTOR if has_presets else Dialect.VALUES)
        self._speaker = Speaker(device.device_id, dialect)
        self._homed = device.status is None or device.status.calibrated
        self._centre = self._base_centre
        if has_presets:
            self._centre = ZERO3
            # Its answer may still be in the frame of before.
            self._passed_over = 1
            self._tell(self._speaker.centre())
        self._send(ZERO3)
        self._newest_t = self._clock()

    def _send(self, force: Vector3) -> None:
        self._opened()
        if self._speaker is not None and len(self._under_way) < MOST_UNDER_WAY:
            self._tell(self._speaker.force(force))

    def _tell(self, text: str) -> None:
        if self._opened().send(text):
            self._under_way.append(self._clock())

    def _take(self, text: str) -> None:
        """Take an answer; the newest that can be believed counts. It was measured when it was asked for."""
        asked_t = self._under_way.popleft() if self._under_way else self._newest_t
        if self._passed_over:
            self._passed_over -= 1
            return
        message = messages.decode(text)
        device = None if message is None else _of(message, self._device_id)
        sample = None if device is None or device.state is None else messages.sample(device.state)
        if message is None or device is None or sample is None:
            self.refused += 1
            return
        if device.status is not None:
            self._homed = device.status.calibrated
        self._buttons = messages.buttons(message)
        self._sample = sample
        self._newest_t = asked_t

    def _opened(self) -> WebSocket:
        if self._socket is None:
            raise DeviceError(f"{NAME}: it is not open; open it first.")
        return self._socket


def discover() -> list[Found]:
    """Return the devices that the service on this machine has."""
    try:
        _, connection, snapshot = connect(parse(""), LOOK_S)
    except DeviceError as error:
        if REMEDY in str(error):
            return [unusable("inverse3", NAME, "the package wsproto is missing", REMEDY)]
        return []
    connection.close()
    return [_found(device) for device in snapshot.inverse3]


def _found(device: messages.Device) -> Found:
    info = _info(device.device_id, (device.config or messages.Config()).type)
    return Found(
        driver="inverse3",
        uri=f"inverse3:{device.device_id}",
        name=info.name,
        serial=info.serial,
        port="Inverse Service",
        renders=info.renders,
        rate=info.rate,
    )


def _of(message: messages.Message, device_id: str) -> messages.Device | None:
    return next((device for device in message.inverse3 if device.device_id == device_id), None)


def _chosen(dialect: str) -> Dialect | None:
    if dialect == "auto":
        return None
    try:
        return Dialect(dialect)
    except ValueError:
        raise DeviceError(
            f'devices.inverse3.dialect: {dialect!r} is none; use "auto", "vector" or "values".'
        ) from None


def _vector(value: object) -> Vector3:
    parts = value if isinstance(value, (list, tuple)) else ()
    numbers = [float(part) for part in parts if isinstance(part, (int, float))]
    if len(numbers) == len(parts) == 3:
        vector = (numbers[0], numbers[1], numbers[2])
        if inside(vector, 0.5):
            return vector
    raise DeviceError(f"devices.inverse3.centre: {value!r} is no place; give three metres within ±0.5.")


def _info(serial: str, kind: str) -> DeviceInfo:
    return DeviceInfo(
        name=NAME if kind == "inverse3" else f"Haply {kind.capitalize()}",
        serial=serial,
        axes=3,
        workspace=REACH.get(kind, WORKSPACE),
        force_limit=FORCE_LIMIT,
        stiffness_limit=STIFFNESS_LIMIT,
        rate=RATE,
        renders="force",
    )
