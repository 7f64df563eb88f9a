"""The vehicle's end of its MAVLink connections, in virtual time: bytes in, datagrams out, no socket and no clock."""

from __future__ import annotations

from sim.mavlink.link import Link
from sim.mavlink.manual import Manual
from sim.mavlink.motion import Motion
from sim.mavlink.plan_store import PlanStore
from sim.mavlink.sensing import Sensing
from sim.mavlink.shared import Shared
from sim.mavlink.signing import Signing
from sim.mavlink.status import Status
from sim.mavlink.streams import GROUND_STATION_RATES, ONBOARD_RATES
from sim.mavlink.targets import Targets
from sim.sensors import Sensors
from sim.simulator import Simulator


class Endpoint:
    """Speaks for a simulator as PX4 would.

    Every link has its own sequence numbers, streams and intervals; parameters, plans and the vehicle are shared. An
    answer goes to the link that asked, texts and changed parameters go to all. The first link is told what PX4 tells
    on its port for an API, the others what it tells a ground station.

    Args:
        simulator: The vehicle.
        seed: Of its sensors' noise.
        unix_time: Wall-clock time of the simulator's zero, s.
        system_id: Its MAVLink system id.
        links: How many connections it has.
        key: 32 bytes to sign with and to expect signatures of; without, nothing is signed and all are heard.

    Attributes:
        links: The connections; `heard` of one says whether somebody listens there.

    Raises:
        ValueError: The key has another length.
    """

    def __init__(
        self,
        simulator: Simulator,
        *,
        seed: int = 0,
        unix_time: float = 0.0,
        system_id: int = 1,
        links: int = 1,
        key: bytes | None = None,
    ) -> None:
        manual, plans = Manual(simulator.autopilot), PlanStore(simulator.autopilot)
        sources = (
            Motion(simulator),
            Sensing(simulator, Sensors(seed)),
            Targets(simulator, plans),
            Status(simulator, manual, system_id, unix_time),
        )
        self._shared = Shared(
            simulator=simulator,
            system_id=system_id,
            builders={id_: build for source in sources for id_, build in source.builders.items()},
            signing=Signing(lambda: unix_time + simulator.t, key),
            plans=plans,
            manual=manual,
        )
        rates = (ONBOARD_RATES, *[GROUND_STATION_RATES] * (links - 1))
        self.links = tuple(Link(self._shared, number, rates[number]) for number in range(links))

    @property
    def reboot_asked(self) -> bool:
        """A ground station asked for a restart and may have it: whoever runs the vehicle makes a new one."""
        return self._shared.reboot_asked

    @property
    def key(self) -> bytes | None:
        """The signing key as it is now: a ground station may have set one."""
        return self._shared.signing.key

    def receive(self, data: bytes, link: int = 0, *, whole: bool = True) -> None:
        """Take bytes from ground stations, garbage included.

        Args:
            data: Bytes as they came.
            link: Where they came.
            whole: They are a datagram; otherwise a frame may go on in the next ones.
        """
        self.links[link].receive(data, whole=whole)

    def step(self) -> None:
        """Queue what is due after the simulator's step: telemetry, notices, the rest of a list."""
        for link in self.links:
            link.step()

    def outgoing(self, link: int = 0) -> list[bytes]:
        """Return the datagrams to send on a link, and forget them."""
        return self.links[link].outgoing()
