"""The parameter protocol of MAVLink, bytewise."""

from __future__ import annotations

import struct
from collections import deque

from pymavlink.dialects.v20 import common as m

from sim.autopilot.parameters import NAMES, SPECS, Parameters
from sim.mavlink.wire import Outbox

_LISTED_A_STEP = 2


class ParameterService:
    """PARAM_*, bytewise: an integer's bits travel in the float's place.

    What changes is told on every link, whoever changed it.

    Args:
        parameters: The autopilot's.
        outbox: Where answers go.
    """

    def __init__(self, parameters: Parameters, outbox: Outbox) -> None:
        self._parameters = parameters
        self._outbox = outbox
        self._to_list: deque[int] = deque()
        self._changed = parameters.changed
        self._known = [parameters[name] for name in NAMES]

    def step(self) -> None:
        """Tell what has changed, and the next few of a list that was asked for."""
        if self._parameters.changed != self._changed:
            self._changed = self._parameters.changed
            for index, name in enumerate(NAMES):
                if self._parameters[name] != self._known[index]:
                    self._send(index)
        for _ in range(min(_LISTED_A_STEP, len(self._to_list))):
            self._send(self._to_list.popleft())

    def list(self, _: m.MAVLink_param_request_list_message) -> None:
        """Begin to send all, from the first."""
        self._to_list = deque(range(len(NAMES)))

    def read(self, message: m.MAVLink_param_request_read_message) -> None:
        """Answer for one, by index or name."""
        index = message.param_index
        if index == -1:
            index = _index(message.param_id)
        if 0 <= index < len(NAMES):
            self._send(index)
        else:
            self._refuse(message, index, m.MAV_PARAM_ERROR_DOES_NOT_EXIST)

    def set(self, message: m.MAVLink_param_set_message) -> None:
        """Change one, or refuse; either way the answer is the value in force."""
        index = _index(message.param_id)
        if index < 0:
            self._refuse(message, -1, m.MAV_PARAM_ERROR_DOES_NOT_EXIST)
            return
        spec = SPECS[NAMES[index]]
        kind = m.MAV_PARAM_TYPE_INT32 if spec.integer else m.MAV_PARAM_TYPE_REAL32
        value = message.param_value
        if spec.integer:
            value = float(struct.unpack("<i", struct.pack("<f", value))[0])
        if message.param_type == kind:
            self._parameters.set(NAMES[index], value)
        self._send(index)

    def _send(self, index: int) -> None:
        name = NAMES[index]
        value, kind = self._parameters[name], m.MAV_PARAM_TYPE_REAL32
        self._known[index] = value
        if SPECS[name].integer:
            value = struct.unpack("<f", struct.pack("<i", int(value)))[0]
            kind = m.MAV_PARAM_TYPE_INT32
        self._outbox.send(m.MAVLink_param_value_message(name.encode(), value, kind, len(NAMES), index))

    def _refuse(
        self,
        message: m.MAVLink_param_request_read_message | m.MAVLink_param_set_message,
        index: int,
        error: int,
    ) -> None:
        name = message.param_id.encode("ascii", errors="replace")[:16]
        system, component = message.get_srcSystem(), message.get_srcComponent()
        self._outbox.send(m.MAVLink_param_error_message(system, component, name, index, error))


def _index(name: str) -> int:
    return NAMES.index(name) if name in SPECS else -1
