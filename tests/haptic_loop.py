"""A hand, the servo's maths and a vehicle far away, in virtual time: what delays and losses do to the haptic port."""

from __future__ import annotations

from math import exp, sin, tau
from random import Random
from typing import Literal, NamedTuple

from drivers.arm import Arm, ArmState, stop
from drivers.device import DeviceInfo, HandleState
from groundstation.config import Control, Settings
from groundstation.messages import Phase
from groundstation.pilot.controller import world_rates
from groundstation.pilot.pilot import Inputs, Memory, Pilot
from groundstation.pilot.sight import VehicleSample

DT = 0.001
DEVICE = DeviceInfo("test", "", 4, 0.1, 10.0, 1000.0, 1000.0, "force")
# A light handle in a loose grip: what little resists a force that should not be there.
LOOSE = Arm(mass=0.2, stiffness=20.0)
TELEMETRY_TICKS = 20
Mode = Literal["observer", "wave", "tank", "off"]
LAG_S = 0.4


class Link(NamedTuple):
    """What lies between servo and vehicle, each way: mean delay, s; jitter and loss, shares; a blackout, s."""

    delay: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0
    blackout: tuple[float, float] = (0.0, 0.0)


class Way:
    """One direction of a link: what is sent comes later, or never; what comes out of order is passed over."""

    def __init__(self, link: Link, random: Random) -> None:
        self._link, self._random = link, random
        self._under_way: list[tuple[float, float, object]] = []
        self._newest_t = 0.0
        self.came_t = 0.0

    def send(self, t: float, value: object) -> None:
        begin, end = self._link.blackout
        if begin <= t < end or self._random.random() < self._link.loss:
            return
        spread = self._link.jitter * (2.0 * self._random.random() - 1.0)
        self._under_way.append((t + self._link.delay * (1.0 + spread), t, value))

    def receive(self, t: float) -> object | None:
        """Return the newest of what has come, if it is newer than all before."""
        come = [item for item in self._under_way if item[0] <= t]
        if not come:
            return None
        self._under_way = [item for item in self._under_way if item[0] > t]
        _, sent_t, value = max(come, key=lambda item: item[1])
        if sent_t < self._newest_t:
            return None
        self._newest_t, self.came_t = sent_t, t
        return value


class HapticRun(NamedTuple):
    """What a run did to the hand.

    Attributes:
        least_energy: That the hand's account at the port ever held, J; negative: the hand was given some.
        felt_moving: Share of equation (5)'s force that was felt while the hand swept, Σ f·f₅ / Σ f₅·f₅.
        felt_resting: Likewise while it rested.
    """

    least_energy: float
    felt_moving: float
    felt_resting: float


def haptic_run(
    link: Link, *, passivity: Mode, seconds: float = 20.0, seed: int = 0, arm: Arm = LOOSE
) -> HapticRun:
    """Let a hand sweep for a while and then rest, with a vehicle that is blown about; count every tick's f·Δx."""
    random = Random(seed)
    control = Control(preset="paper", stiffness=(8.0, 8.0, 8.0), passivity=passivity)
    pilot = Pilot(Settings(control=control), DEVICE)
    memory, state = Memory(), ArmState()
    up, down = Way(link, random), Way(link, random)
    p, v, setpoint, sample = (0.0,) * 4, (0.0,) * 4, (0.0,) * 4, VehicleSample()
    phases = [random.uniform(0.0, tau) for _ in range(3)]
    energy = least = 0.0
    felt, wanted = [0.0, 0.0], [1e-12, 1e-12]
    for tick in range(round(seconds / DT)):
        t = tick * DT
        handle = HandleState(state.position, state.velocity, 0.0, 0, homed=True, device_time=t)
        inputs = Inputs(DT, Phase.ENGAGED, False, handle, sample, t - down.came_t, delay=2.0 * link.delay)
        memory, out = pilot.step(memory, inputs)
        if tick % TELEMETRY_TICKS == 0:
            up.send(t, out.setpoint)
            down.send(t, VehicleSample(p, world_rates(v, p[3])))
        setpoint = up.receive(t) or setpoint
        sample = down.receive(t) or sample
        share = 1.0 - exp(-DT / LAG_S)
        v = tuple(a + share * (b - a) for a, b in zip(v, setpoint, strict=True))
        gust = [0.5 * sin(0.9 * t + phase) for phase in phases]
        p = (p[0] + (v[0] + gust[0]) * DT, p[1] + (v[1] + gust[1]) * DT, p[2] + (v[2] + gust[2]) * DT, 0.0)
        resting = t >= 0.6 * seconds
        reach = 0.0 if resting else 0.06
        intention = tuple(reach * sin(1.7 * t + phase) for phase in phases)
        moved = stop(arm.step(state, DT, intention, 0.0, out.force), DEVICE.workspace)
        energy -= sum(f * (b - a) for f, a, b in zip(out.force, state.position, moved.position, strict=True))
        least = min(least, energy)
        felt[resting] += sum(f * g for f, g in zip(out.force, out.position_force, strict=True))
        wanted[resting] += sum(g * g for g in out.position_force)
        state = moved
    return HapticRun(least, felt[0] / wanted[0], felt[1] / wanted[1])


def least_energy(
    link: Link, *, passivity: Mode, seconds: float = 20.0, seed: int = 0, arm: Arm = LOOSE
) -> float:
    """Return the least energy, J, that the hand's account at the port ever held in a run."""
    return haptic_run(link, passivity=passivity, seconds=seconds, seed=seed, arm=arm).least_energy
