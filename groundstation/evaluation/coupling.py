"""Couples the hand to the vehicle, by the servo's own rules, and couples it again when it was lost."""

from __future__ import annotations

import math

from drivers.device import DeviceInfo, HandleState
from groundstation.config import Settings
from groundstation.evaluation.channel_ends import GroundEnd, Request
from groundstation.messages import FlightMode, Phase, Stream
from groundstation.pilot.engagement import (
    Conditions,
    Engagement,
    advance,
    believable,
    centred,
    disengage,
    engage,
)
from groundstation.pilot.link_state import link_fault

# A request without effect is made again, as MAVSDK does; a person couples again no sooner than this, s.
_ASK_AGAIN_S = 0.5
_COUPLE_AGAIN_S = 1.0


class Coupling:
    """What operator, servo and link do to couple and to let go; looked at with every setpoint.

    Args:
        settings: Staleness, and when a handle is centred.
        device: The handle.
        end: The ground's end of the link.
        hesitates: How long the operator waits where the coupling could be had again after it was lost, s.

    Attributes:
        phase: How far the hand is coupled.
        present: The handle is there.
        losses: How often it was uncoupled against the operator's will.
        reason: Why last, in words.
    """

    def __init__(
        self, settings: Settings, device: DeviceInfo, end: GroundEnd, hesitates: float = 0.0
    ) -> None:
        self._settings, self._device, self._end = settings, device, end
        self._hesitates = hesitates
        self._engagement = Engagement()
        self._next_request = -math.inf
        self._next_engage = -math.inf
        self._landing = False
        self.phase = Phase.DISENGAGED
        self.present = True
        self.losses = 0
        self.reason = ""

    def land(self) -> None:
        """Let go and land: the operator's last act."""
        self._landing = True
        self._engagement = Engagement()
        self.phase = Phase.DISENGAGED
        self._next_request = -math.inf

    def update(self, t: float, handle: HandleState, fault: str, *, wanted: bool = True) -> None:
        """Go on.

        Args:
            t: Now, s.
            handle: As it is now.
            fault: Why the pilot could not fly the last tick, or "".
            wanted: The operator wants to be coupled; what he ends himself is no loss.
        """
        conditions, safety = self._conditions(t, handle), self._settings.safety
        self._engagement, ending = advance(self._engagement, conditions, safety)
        if fault and ending is None:
            self._engagement, ending = disengage(self._engagement, fault)
        if not wanted:
            self._engagement = Engagement()
        elif ending is not None:
            self.losses += 1
            self.reason = ending.words
            self._next_engage = t + _COUPLE_AGAIN_S
            self._next_request = -math.inf
        elif not self._landing and t >= self._next_engage:
            self._engagement, refused = engage(self._engagement, conditions, safety)
            if refused and self.losses:
                self._next_engage = t + self._hesitates
        self.phase = self._engagement.phase
        request = self._request()
        if request is not None and t >= self._next_request:
            self._next_request = t + _ASK_AGAIN_S
            self._end.request(t, request)

    def _request(self) -> Request | None:
        """Return what the vehicle is to be asked for now, or None where it already does it."""
        report = self._end.report
        offboard = report is not None and report.offboard
        if self._landing:
            return Request.LAND if report is None or report.armed else None
        if self.phase is Phase.DISENGAGED:
            return Request.HOLD if offboard else None
        return None if offboard else Request.OFFBOARD

    def _conditions(self, t: float, handle: HandleState) -> Conditions:
        end, report = self._end, self._end.report
        offboard = report is not None and report.offboard
        streaming = Stream.IDLE
        if self.phase is not Phase.DISENGAGED:
            streaming = Stream.FLYING if offboard else Stream.STARTING
        return Conditions(
            t=t,
            gap=0.0,
            believable=report is None or believable((*report.sample.position, *report.sample.velocity)),
            present=self.present,
            homed=True,
            centred=centred(handle, self._device, self._settings.mapping.yaw_range),
            handle_age=0.0,
            connected=report is not None,
            armed=report is not None and report.armed,
            in_air=report is not None and report.armed,
            mode=FlightMode.OFFBOARD if offboard else FlightMode.HOLD,
            streaming=streaming,
            state_age=t - end.heard_t,
            state_valid=report is None or report.trusted,
            boots=0,
            link_fault=link_fault(end.round_trip, end.loss, self._settings.link),
        )
