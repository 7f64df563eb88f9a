"""What happens to a flight beside what the hand does: wind that rises, a link that gets worse, a device that is lost.

A mission's timetable and an instructor use the same words. They are for simulated vehicles only.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from sim.scenario import Air, NonNegative, Positive

Share = Annotated[float, Meta(ge=0, le=0.95)]
# A simulated blackout is no longer than this, s: the simulator's own bound.
Outage = Annotated[float, Meta(gt=0, le=60)]


class _Event(Struct, frozen=True, forbid_unknown_fields=True, tag_field="kind"):
    """When it happens: `at_s` after take-off or, with `leg`, that long after so many points have been reached."""

    at_s: NonNegative = 0.0
    leg: Annotated[int, Meta(ge=0)] = 0


class WindChange(_Event, frozen=True, tag="wind", kw_only=True):
    """From now on the wind blows so: `velocity` (where the air goes to, ENU, m/s) and `turbulence` (σ_w, m/s)."""

    velocity: Air
    turbulence: Annotated[float, Meta(ge=0, le=10)] = 0.0


class GustNow(_Event, frozen=True, tag="gust", kw_only=True):
    """One gust of 1-cosine shape: its peak `velocity` (ENU, m/s) and how long it lasts from calm to calm, s."""

    velocity: Air
    duration_s: Positive


class Delay(_Event, frozen=True, tag="delay", kw_only=True):
    """From now on the link delays: `round_trip_s`, half of it each way, and `jitter_s` up to so much more or less."""

    round_trip_s: Annotated[float, Meta(ge=0, le=2)]
    jitter_s: Annotated[float, Meta(ge=0, le=1)] = 0.0


class Loss(_Event, frozen=True, tag="loss", kw_only=True):
    """From now on the link loses this `share` of frames, each way."""

    share: Share


class LinkLoss(_Event, frozen=True, tag="link_loss", kw_only=True):
    """The link is silent, both ways, for `duration_s`."""

    duration_s: Outage


class DeviceLoss(_Event, frozen=True, tag="device_loss", kw_only=True):
    """The haptic device is gone for `duration_s`, as if unplugged."""

    duration_s: Outage


class BatteryLeft(_Event, frozen=True, tag="battery", kw_only=True):
    """The battery holds only `remaining` of its charge, 0 to 1."""

    remaining: Annotated[float, Meta(gt=0, le=1)]


class GpsLoss(_Event, frozen=True, tag="gps_loss", kw_only=True):
    """The vehicle has no GPS for `duration_s`."""

    duration_s: Outage


Event = WindChange | GustNow | Delay | Loss | LinkLoss | DeviceLoss | BatteryLeft | GpsLoss


class Timetable:
    """Which of a mission's events are due.

    Args:
        events: In any order.
    """

    def __init__(self, events: tuple[Event, ...]) -> None:
        self._waiting = list(events)
        self._reached: list[float] = []

    def due(self, elapsed: float, leg: int) -> list[Event]:
        """Return what happens now, each event once.

        Args:
            elapsed: Since take-off, s.
            leg: Points reached so far.
        """
        self._reached += [elapsed] * (leg + 1 - len(self._reached))
        happening = [event for event in self._waiting if self._is_due(event, elapsed)]
        self._waiting = [event for event in self._waiting if event not in happening]
        return happening

    def _is_due(self, event: Event, elapsed: float) -> bool:
        if not event.leg:
            return elapsed >= event.at_s
        return event.leg < len(self._reached) and elapsed >= self._reached[event.leg] + event.at_s
