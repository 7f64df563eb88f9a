"""The pilot's part of what an instructor or a timetable does: the haptic device of a simulated flight is lost."""

from __future__ import annotations

from groundstation.bus import Bus
from groundstation.clock import Every
from groundstation.devices.unpluggable import Unpluggable
from groundstation.messages import INTERVENTION, INTERVENTION_ANSWER
from groundstation.training.answering import REAL, WELCOME_S, answer_to
from groundstation.training.events import DeviceLoss
from groundstation.training.happening import Calm, unpacked


class Unplugging:
    """Takes those that are the device's from the bus, and answers them; a real vehicle's flight is left alone.

    Args:
        bus: Where they come from.
        device: The one in hand.
        simulated: The vehicle is.
    """

    def __init__(self, bus: Bus, device: Unpluggable, *, simulated: bool) -> None:
        self._device, self._simulated = device, simulated
        self._asked = bus.subscriber(INTERVENTION)
        self._answers = bus.publisher(INTERVENTION_ANSWER)
        self._welcome = Every(WELCOME_S)

    def turn(self, now: float) -> None:
        """Do what was asked for, at `now`, monotonic s."""
        for asked in self._asked.drain():
            happening = unpacked(asked.happening)
            if isinstance(happening, Calm) and self._simulated:
                # The link answers for both.
                self._device.unplug(0.0)
            elif isinstance(happening, DeviceLoss):
                if self._simulated:
                    self._device.unplug(happening.duration_s)
                self._answers.send(answer_to(asked, "" if self._simulated else REAL, now))
        if self._welcome.due(now):
            self._answers.welcome()
