"""What is looked at before a flight: each check's state in words and, where it is not well, what to do."""

from __future__ import annotations

from groundstation.messages import Severity
from groundstation.tui import checks_computer as computer
from groundstation.tui import checks_here as here
from groundstation.tui import checks_vehicle as vehicle
from groundstation.tui.check import Check
from groundstation.tui.frame import Frame


def checks(frame: Frame) -> list[Check]:
    """Return all checks, the worst first, else the hand's, the vehicle's, its own failsafes."""
    found = [
        here.device(frame),
        here.handle(frame),
        here.servo(frame),
        vehicle.link(frame),
        vehicle.link_quality(frame),
        vehicle.identity(frame),
        vehicle.health(frame),
        vehicle.transmitter(frame),
        vehicle.awake(frame),
        vehicle.position(frame),
        vehicle.home(frame),
        vehicle.battery(frame),
        vehicle.fence(frame),
        vehicle.speeds(frame),
        here.mission(frame),
        here.recording(frame),
        computer.supply(frame.now),
        *vehicle.parameters(frame),
    ]
    return sorted(found, key=lambda check: -check.severity)


def red(frame: Frame) -> int:
    """Return how many checks forbid to fly."""
    return sum(check.severity is Severity.ALARM for check in checks(frame))
