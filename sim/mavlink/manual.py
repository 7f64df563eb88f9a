"""Sticks from the wire: a joystick's MANUAL_CONTROL, and RC_CHANNELS_OVERRIDE in the place of a radio.

Which of the two counts is the autopilot's business (COM_RC_IN_MODE).
"""

from __future__ import annotations

from pymavlink.dialects.v20 import common as m

from sim.autopilot.autopilot import Autopilot
from sim.autopilot.sticks import Sticks

CHANNELS = 18
UNUSED = 0xFFFF
_MIDDLE_US, _HALF_US = 1500, 500
_FULL = 1000
# Of a channel after the eighth, MAVLink has another value for "give it back to the radio".
_RELEASE, _RELEASE_LATE = 0, UNUSED - 1
_FIRST_LATE = 8
# Roll, pitch, throttle, yaw; the order of PX4's documentation.
_STICKS = 4


class Manual:
    """Takes sticks for one vehicle, whatever link they come on.

    Args:
        autopilot: Flies by them.

    Attributes:
        channels: As they were overridden last, µs; `UNUSED` where they were not. Empty before the first.
    """

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self.channels: tuple[int, ...] = ()

    def joystick(self, message: m.MAVLink_manual_control_message) -> None:
        """Take a joystick's; an axis out of range is not there, and stands in the middle."""
        forward, right, clockwise = (
            value / _FULL if abs(value) <= _FULL else 0.0 for value in (message.x, message.y, message.r)
        )
        up = 2.0 * message.z / _FULL - 1.0 if 0 <= message.z <= _FULL else 0.0
        self._autopilot.sticks(Sticks(forward, -right, up, -clockwise), joystick=True)

    def override(self, message: m.MAVLink_rc_channels_override_message) -> None:
        """Take channels in the place of a radio's; one that is left out stays as it was."""
        old = self.channels or (UNUSED,) * CHANNELS
        self.channels = tuple(
            _channel(place, getattr(message, f"chan{place + 1}_raw"), old[place]) for place in range(CHANNELS)
        )
        if UNUSED not in self.channels[:_STICKS]:
            right, forward, up, clockwise = (
                max(-1.0, min(1.0, (us - _MIDDLE_US) / _HALF_US)) for us in self.channels[:_STICKS]
            )
            self._autopilot.sticks(Sticks(forward, -right, up, -clockwise), joystick=False)


def _channel(place: int, value: int, old: int) -> int:
    """Return a channel's new value: its own, the old where it is left out, none where it is given back."""
    if place < _FIRST_LATE:
        return old if value == UNUSED else (UNUSED if value == _RELEASE else value)
    return old if value in (0, UNUSED) else (UNUSED if value == _RELEASE_LATE else value)
