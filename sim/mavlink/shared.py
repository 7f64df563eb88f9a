"""What all links of one vehicle have in common."""

from __future__ import annotations

from dataclasses import dataclass

from sim.mavlink.manual import Manual
from sim.mavlink.motion import Builder
from sim.mavlink.plan_store import PlanStore
from sim.mavlink.signing import Signing
from sim.simulator import Simulator


@dataclass
class Shared:
    """One vehicle behind all its links.

    Attributes:
        simulator: The vehicle.
        system_id: Its own.
        builders: How to build each message there is.
        signing: Its key.
        plans: On board.
        manual: Its sticks.
        reboot_asked: A ground station wants a restart, and may have it.
    """

    simulator: Simulator
    system_id: int
    builders: dict[int, Builder]
    signing: Signing
    plans: PlanStore
    manual: Manual
    reboot_asked: bool = False
