"""A ground station on the other end of the simulated vehicle's endpoint, in virtual time."""

import math
import struct

import pytest
from pymavlink.dialects.v20 import common as m

from sim.mavlink.dialect import CURRENT_MODE
from sim.mavlink.endpoint import Endpoint
from sim.mavlink.wire import Inbox
from sim.scenario import Scenario, VehicleChoice
from sim.simulator import build

DT = 0.004
US = (245, 190)
VELOCITY_YAW_RATE = 1479
POSITION_YAW = 0xFFF & ~(1 | 2 | 4 | 1024)
BODY_NED, LOCAL_NED = 8, 1
NAN = math.nan


class AllFrames:
    """Finds in datagrams what pymavlink's dialect lacks, too: whole frames, of which only id and number are read."""

    def messages(self, data, *, whole):
        assert whole
        while data:
            yield Frame(data[: 12 + data[1]])
            data = data[12 + data[1] :]


class Frame(bytes):
    """A MAVLink 2 frame."""

    def get_msgId(self):  # noqa: N802 (pymavlink's)
        return int.from_bytes(self[7:10], "little")

    def get_seq(self):
        return self[4]

    def get_type(self):
        known = m.mavlink_map.get(self.get_msgId())
        return known.msgname if known else ""

    @property
    def payload(self):
        return self[10 : 10 + self[1]]

    def __getattr__(self, name):
        decoded = m.MAVLink(None).decode(bytearray(self))
        return getattr(decoded, name)


class Wire:
    """A ground station without a clock on the other end of the endpoint."""

    def __init__(self, model="kinematic", yaw_deg=0.0, seed=0, endpoint=None, **scenario):
        vehicle = VehicleChoice(model=model, yaw_deg=yaw_deg)
        self.sim = build(Scenario(vehicle=vehicle, **scenario), seed=seed)
        self.endpoint = Endpoint(self.sim, seed=seed, unix_time=1.6e9, **(endpoint or {}))
        self.packer = m.MAVLink(None, srcSystem=US[0], srcComponent=US[1])
        self.inbox = Inbox()
        self.heard = []

    def send(self, message, link=0):
        self.endpoint.receive(message.pack(self.packer), link)

    def run(self, seconds, each=lambda: None):
        """Advance and return the messages heard meanwhile."""
        heard = []
        for _ in range(max(1, round(seconds / DT))):
            each()
            self.sim.step(DT)
            self.endpoint.step()
            for datagram in self.endpoint.outgoing():
                assert len(datagram) <= 1200
                heard += self.inbox.messages(datagram, whole=True)
        self.heard += heard
        return heard

    def ask(self, message, kind):
        """Send and return the first answer of a kind."""
        self.send(message)
        return next(answer for answer in self.run(DT) if answer.get_type() == kind)

    def command(self, command, *params, target=(1, 1)):
        params = [*params, *[NAN] * (7 - len(params))]
        ack = self.ask(m.MAVLink_command_long_message(*target, command, 0, *params), "COMMAND_ACK")
        assert (ack.command, ack.target_system, ack.target_component) == (command, *US)
        return ack.result

    def texts(self):
        """Return the texts said, chunks put together."""
        texts = []
        for message in self.heard:
            if message.get_type() == "STATUSTEXT":
                if message.chunk_seq:
                    texts[-1] += message.text
                else:
                    texts.append(message.text)
        return texts

    def newest(self, kind):
        return next(message for message in reversed(self.heard) if message.get_type() == kind)

    def heard_mode(self):
        """Ask for CURRENT_MODE, which pymavlink does not know; return the mode in force and the one asked for."""
        inbox, self.inbox = self.inbox, AllFrames()
        self.command(m.MAV_CMD_REQUEST_MESSAGE, CURRENT_MODE)
        frame = next(frame for frame in reversed(self.heard) if frame.get_msgId() == CURRENT_MODE)
        self.inbox = inbox
        return struct.unpack("<II", frame.payload.ljust(8, b"\0")[:8])

    def setpoint(self, frame, mask, xyz=(0, 0, 0), v=(0, 0, 0), yaw=0.0, yaw_rate=0.0, a=(0, 0, 0)):
        self.send(
            m.MAVLink_set_position_target_local_ned_message(0, 1, 1, frame, mask, *xyz, *v, *a, yaw, yaw_rate)
        )

    def fly(self, seconds, *setpoint, **fields):
        self.setpoint(*setpoint, **fields)
        assert self.command(m.MAV_CMD_DO_SET_MODE, 1, 6, 0) == m.MAV_RESULT_ACCEPTED
        self.run(seconds, lambda: self.setpoint(*setpoint, **fields))
        return self

    def take_off(self):
        assert self.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1, 0) == m.MAV_RESULT_ACCEPTED
        assert self.command(m.MAV_CMD_NAV_TAKEOFF) == m.MAV_RESULT_ACCEPTED
        self.run(8)
        assert self.sim.p[2] == pytest.approx(2.5, abs=0.2)
        return self
