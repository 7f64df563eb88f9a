"""One whole vehicle, in virtual time: the simulator, what speaks for it, and its connections with their channels."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from sim.autopilot.parameters import NAMES
from sim.channel import Channel
from sim.conditions import BLACKOUT, IDEAL_BOTH_WAYS, BothWays, changed, publish
from sim.mavlink.endpoint import Endpoint
from sim.momentary import MOMENTARY
from sim.process.framing import Splitter
from sim.process.transport import Transport
from sim.simulator import Simulator


class Connection:
    """A transport with the channel before it, both ways. Each has a channel of its own, like a radio.

    Args:
        transport: What carries the bytes.
        both: The channel's conditions.
        seed: Of its chances.
    """

    def __init__(self, transport: Transport, both: BothWays, seed: str) -> None:
        self.transport = transport
        self.up = Channel(both.up, f"{seed} up")
        self.down = Channel(both.down, f"{seed} down")
        self._arriving = Splitter(whole=transport.whole)
        self._leaving = Splitter(whole=True)

    def receive(self, t: float) -> Iterator[bytes]:
        """Yield what reaches the vehicle at time `t`, s."""
        if self.up.idle(t):
            yield from self._arriving.flush()
            yield from self.transport.receive()
            return
        for data in self.transport.receive():
            for frame in self._arriving.split(data):
                self.up.send(t, frame)
        yield from self.up.due(t)

    def send(self, t: float, datagrams: list[bytes]) -> None:
        """Send what the vehicle says at time `t`, s, and what was under way until now."""
        if not self.down.idle(t):
            for data in datagrams:
                for frame in self._leaving.split(data):
                    self.down.send(t, frame)
            datagrams = self.down.due(t)
        for data in datagrams:
            self.transport.send(data)


class Vehicle:
    """Steps one vehicle and lets it speak; it restarts when a ground station asks for it, and its links stay.

    Args:
        make: Returns a new simulator, standing at its start.
        transports: Its links; the first is told what PX4 tells an API, the others what it tells a ground station.
        both: The channel's conditions to begin with; parameters change them in flight.
        seed: Of the noise, and of the channels' chances.
        system_id: Its MAVLink system id.
        unix_time: Wall-clock time of its start, s.
        key: To sign with, 32 bytes, or None.

    Attributes:
        t: Time since the start, s; unlike the simulator's it goes on over a restart.
        simulator: The vehicle as it is.
        system_id: As given.
    """

    def __init__(
        self,
        make: Callable[[], Simulator],
        transports: Sequence[Transport],
        *,
        both: BothWays = IDEAL_BOTH_WAYS,
        seed: int = 0,
        system_id: int = 1,
        unix_time: float = 0.0,
        key: bytes | None = None,
    ) -> None:
        self.t = 0.0
        self.simulator = make()
        self.system_id = system_id
        self._make = make
        self._both = both
        self._seed = seed
        self._unix_time = unix_time
        self._key = key
        self.connections = tuple(
            Connection(transport, both, f"{seed} {number}") for number, transport in enumerate(transports)
        )
        self._blackout_ends: float | None = None
        publish(both, self.simulator.autopilot.parameters)
        self._begin()

    def step(self, dt: float) -> None:
        """Hear, move, and speak: `dt` seconds."""
        self.t += dt
        endpoint = self._endpoint
        for number, connection in enumerate(self.connections):
            for data in connection.receive(self.t):
                endpoint.receive(data, number, whole=connection.transport.whole)
            endpoint.links[number].heard = connection.transport.heard
        self.simulator.step(dt)
        endpoint.step()
        for number, connection in enumerate(self.connections):
            connection.send(self.t, endpoint.outgoing(number))
        # Only now: who asked for a blackout or a restart has been answered.
        if self._parameters.changed != self._seen or self._blackout_ends is not None:
            self._follow_parameters()
        if endpoint.reboot_asked:
            self._restart()

    def close(self) -> None:
        """Close its links."""
        for connection in self.connections:
            connection.transport.close()

    def _begin(self) -> None:
        self._parameters = self.simulator.autopilot.parameters
        self._seen = self._parameters.changed
        self._endpoint = Endpoint(
            self.simulator,
            seed=self._seed,
            unix_time=self._unix_time + self.t,
            system_id=self.system_id,
            links=len(self.connections),
            key=self._key,
        )

    def _restart(self) -> None:
        """Begin anew at the start, with parameters and key as they are, for an autopilot stores them.

        What happens once is over with the restart.
        """
        self._key = self._endpoint.key
        kept = self._parameters
        self.simulator = self._make()
        for name in NAMES:
            if name not in MOMENTARY:
                self.simulator.autopilot.parameters.set(name, kept[name])
        self._begin()

    def _follow_parameters(self) -> None:
        """Change the channel as the parameters say."""
        asked = self._parameters[BLACKOUT]
        if self._blackout_ends is None and asked > 0.0:
            self._blackout_ends = self.t + asked
            for connection in self.connections:
                connection.up.black_out(self._blackout_ends)
                connection.down.black_out(self._blackout_ends)
        elif self._blackout_ends is not None and self.t >= self._blackout_ends:
            self._blackout_ends = None
            self._parameters.set(BLACKOUT, 0.0)
        if self._parameters.changed == self._seen:
            return
        self._seen = self._parameters.changed
        self._both = changed(self._both, self._parameters)
        for connection in self.connections:
            connection.up.change(self._both.up)
            connection.down.change(self._both.down)
