"""Reference generation: from the handle to p_h and ṗ_h of equation (4), by rate or by position, without a jump.

Rate: how far the handle is out of its centre says how fast p_h moves. Position: p_h moves as the handle does, scaled;
what counts is how far it has moved since the last tick, so that the clutch, a switch of the mapping, of fine or of
the frame, or the leash, changes p_h by nothing. ṗ_h of rate mode is itself kept within the limit of acceleration: p_h
moves as a drone can.
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import NamedTuple

from msgspec import structs

from drivers.device import ZERO3, HandleState, Vector3
from groundstation import config
from groundstation.frames import Vector4
from groundstation.messages import MappingMode
from groundstation.pilot.choices import Choices
from groundstation.pilot.controller import world_rates
from groundstation.pilot.mapping import RateMapping, advance, leashed
from groundstation.pilot.sight import ZERO4

# A handle without a deadband is in its centre within this share of the workspace.
_LEAST_CENTRE = 0.02


class Reference(NamedTuple):
    """What one tick leaves to the next.

    Attributes:
        p_h: Where the hand wants the drone, world, m and rad.
        rate: ṗ_h, world, m/s and rad/s.
        on_leash: p_h wanted to go further from the vehicle than it may.
        by_rate: The part of ṗ_h by rate, world, m/s and rad/s.
        handle: Where the handle was, m.
        mapping: As it was.
        waiting: The handle moves nothing until it has been in its centre.
    """

    p_h: Vector4 = ZERO4
    rate: Vector4 = ZERO4
    on_leash: bool = False
    by_rate: Vector4 = ZERO4
    handle: Vector3 = ZERO3
    mapping: MappingMode = MappingMode.RATE
    waiting: bool = False


class ReferenceGenerator:
    """Moves p_h as the hand asks for.

    Args:
        mapping: Modes, frame, speeds, scale, leash.
        limits: Of the motion of p_h by rate.
        workspace: Radius in which the handle moves, m.

    Attributes:
        by_rate: The mapping of rate mode.
    """

    def __init__(self, mapping: config.Mapping, limits: config.Limits, workspace: float) -> None:
        self.by_rate = RateMapping(bounded(mapping, limits), workspace)
        self._settings = mapping
        self._acceleration, self._yaw_acceleration = limits.acceleration, limits.yaw_acceleration
        self._centre = max(mapping.deadband, _LEAST_CENTRE) * workspace

    def begun(self, p: Vector4, hand: HandleState, choices: Choices) -> Reference:
        """Return the reference of a hand that is not coupled: p_h stays with the vehicle at p."""
        return Reference(p_h=p, handle=hand.position, mapping=choices.mapping)

    def step(
        self, before: Reference, hand: HandleState, choices: Choices, p: Vector4, *, dt: float, share: float
    ) -> Reference:
        """Move p_h on for a tick.

        Args:
            before: Of the tick before.
            hand: The handle.
            choices: Mapping, fine, clutch, turning by buttons.
            p: Where the vehicle is seen, world, m and rad.
            dt: s.
            share: Of the speeds that may be used, 0 to 1.
        """
        by_rate = choices.mapping is MappingMode.RATE
        waiting = by_rate and self._waits(before, hand, choices)
        asked = self._asked(hand, choices, p[3], share, still=waiting or not by_rate)
        begin = before.by_rate
        if before.on_leash and _gives_way(asked, before.p_h, p):
            # The leash has stopped p_h, so there is no motion to brake: giving way counts at once.
            begin = (0.0, 0.0, 0.0, begin[3])
        moved = rate = towards(begin, asked, self._acceleration * dt, self._yaw_acceleration * dt)
        wished = advance(before.p_h, rate, dt)
        if not by_rate and not choices.clutched:
            step, speed = self._moved(before, hand, choices, p[3])
            wished, rate = added(wished, step), added(rate, speed)
        p_h, on_leash = leashed(wished, p, self._settings.leash, self._settings.leash_yaw)
        return Reference(p_h, rate, on_leash, moved, hand.position, choices.mapping, waiting)

    def _waits(self, before: Reference, hand: HandleState, choices: Choices) -> bool:
        """Say whether rate mode has yet to be taken hold of, in the centre."""
        if choices.clutched or before.mapping is MappingMode.POSITION:
            return True
        return before.waiting and hypot(*hand.position) > self._centre

    def _asked(
        self, hand: HandleState, choices: Choices, yaw: float, share: float, *, still: bool
    ) -> Vector4:
        """Return ṗ_h as rate mode asks for it; only the yaw's part where the handle's place means nothing."""
        x, y, z, turn = self.by_rate.rate(ZERO3 if still else hand.position, hand.yaw, yaw)
        if choices.turn:
            turn = choices.turn * self._settings.speed[3]
        if choices.clutched:
            turn = 0.0
        if choices.fine:
            share *= self._settings.fine
        return x * share, y * share, z * share, turn * share

    def _moved(
        self, before: Reference, hand: HandleState, choices: Choices, yaw: float
    ) -> tuple[Vector4, Vector4]:
        """Return how far the handle has moved since the last tick, and how fast it moves, both scaled, world."""
        (x, y, z), (a, b, c), (u, v, w) = hand.position, before.handle, hand.velocity
        factor = self._settings.fine if choices.fine else 1.0
        i, j, k = self._settings.scale
        i, j, k = i * factor, j * factor, k * factor
        turn = self.by_rate.turn(yaw)
        step = world_rates(((x - a) * i, (y - b) * j, (z - c) * k, 0.0), turn)
        return step, world_rates((u * i, v * j, w * k, 0.0), turn)


def bounded(mapping: config.Mapping, limits: config.Limits) -> config.Mapping:
    """Return a mapping whose speeds are within those that setpoints keep to, so that p_h runs away from no drone."""
    x, y, z, yaw = mapping.speed
    level, up, turn = limits.horizontal_speed, limits.vertical_speed, limits.yaw_rate
    return structs.replace(mapping, speed=(min(x, level), min(y, level), min(z, up), min(yaw, turn)))


def towards(rate: Vector4, asked: Vector4, step: float, yaw_step: float) -> Vector4:
    """Move a velocity towards another by at most `step` in the plane and upward, and `yaw_step`, m/s and rad/s."""
    x, y, z, turn = rate
    east, north = asked[0] - x, asked[1] - y
    plane = sqrt(east * east + north * north)
    share = step / plane if plane > step else 1.0
    up, around = asked[2] - z, asked[3] - turn
    return (
        x + share * east,
        y + share * north,
        z + max(-step, min(step, up)),
        turn + max(-yaw_step, min(yaw_step, around)),
    )


def _gives_way(asked: Vector4, p_h: Vector4, p: Vector4) -> bool:
    """Say whether a velocity of p_h leads no further from p."""
    return sum(rate * (wanted - place) for rate, wanted, place in zip(asked[:3], p_h, p, strict=False)) <= 0.0


def added(a: Vector4, b: Vector4) -> Vector4:
    """Return the sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]
