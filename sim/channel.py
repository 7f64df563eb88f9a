"""The channel between the vehicle and everyone else: what one direction of it does to frames, in virtual time.

What Linux' netem does to packets (tc-netem(8)) is done here to whole MAVLink frames, so that a stream (TCP, a serial
port) stays one that can be read. No clock and no sockets: `send` at a time, ask what is `due` at another.
"""

from __future__ import annotations

import heapq
from math import inf
from random import Random
from typing import NamedTuple

# A frame that would wait longer than this for its turn on a limited rate is lost, s: the sender's buffer is full.
QUEUE_S = 1.0
# A frame out of order comes up to this much later than it would have, s.
LATER_S = 0.1
# Frames under way at once; more are lost. It bounds the memory of a long delay.
UNDER_WAY = 10_000
# Rounding of virtual time, s: what is due "now" must not wait for the next step.
_ROUNDING_S = 1e-6


class Conditions(NamedTuple):
    """What one direction does to frames. All zero: nothing.

    Attributes:
        delay: Time every frame takes, s.
        jitter: The delay varies evenly by up to so much more and less, s; the order stays.
        loss: Share of frames lost, 0 to 1.
        burst: Mean number of frames lost one after the other; 0: losses are independent.
        duplicate: Share of frames that come twice.
        reorder: Share of frames that later ones may overtake.
        rate: Bytes a second, 0 without limit.
        blackouts: (begin, end) in s since start: what is sent meanwhile is lost.
    """

    delay: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0
    burst: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0
    rate: float = 0.0
    blackouts: tuple[tuple[float, float], ...] = ()


IDEAL = Conditions()


class Channel:
    """One direction of a link.

    Losses follow the simple Gilbert model (Gilbert, "Capacity of a burst-noise channel", 1960): a state good or bad,
    everything lost in the bad one, left with probability 1/burst and entered so that the share lost is `loss`.
    Independent losses are the case in which the next state does not depend on the last.

    Args:
        conditions: To begin with.
        seed: Of all that is random here.
    """

    def __init__(self, conditions: Conditions = IDEAL, seed: int | str = 0) -> None:
        self._random = Random(seed)
        self._under_way: list[tuple[float, int, bytes]] = []
        self._count = 0
        self._newest_t = self._black_until = -inf
        self._bad = False
        self._enter = self._leave = 0.0
        self.change(conditions)
        self._bad = self._random.random() < conditions.loss

    def change(self, conditions: Conditions) -> None:
        """Go on under other conditions; what is under way arrives as it would have."""
        self.conditions = conditions
        self._sender_free_t = -inf
        loss, burst = conditions.loss, conditions.burst
        if loss <= 0.0 or loss >= 1.0:
            self._leave, self._enter = float(loss < 1.0), float(loss >= 1.0)
            return
        # At most 1 is the probability to enter; then the bursts are longer, and the share is still right.
        self._leave = min(1.0 / burst, (1.0 - loss) / loss) if burst else 1.0 - loss
        self._enter = self._leave * loss / (1.0 - loss)

    def black_out(self, until: float) -> None:
        """Lose everything that is sent before a time, s."""
        self._black_until = max(self._black_until, until)

    def idle(self, t: float) -> bool:
        """Say whether nothing is under way and nothing would happen to a frame sent now: it may go past."""
        return self.conditions == IDEAL and not self._under_way and t >= self._black_until

    def send(self, t: float, data: bytes) -> None:
        """Take a frame at time `t`, s, which never goes back."""
        if self._is_black(t):
            return
        sent = self._sent(t, len(data))
        if sent is None or self._loses():
            return
        self._carry(sent, data)
        duplicate = self.conditions.duplicate
        if duplicate and self._random.random() < duplicate and (sent := self._sent(t, len(data))) is not None:
            self._carry(sent, data)

    def due(self, t: float) -> list[bytes]:
        """Return what arrives by time `t`, s, in the order of arrival."""
        under_way = self._under_way
        arrived: list[bytes] = []
        while under_way and under_way[0][0] <= t + _ROUNDING_S:
            arrived.append(heapq.heappop(under_way)[2])
        return arrived

    def _is_black(self, t: float) -> bool:
        return t < self._black_until or any(begin <= t < end for begin, end in self.conditions.blackouts)

    def _loses(self) -> bool:
        if self._enter == 0.0:
            self._bad = False
        else:
            self._bad = (
                self._random.random() >= self._leave if self._bad else self._random.random() < self._enter
            )
        return self._bad

    def _sent(self, t: float, size: int) -> float | None:
        """Return when the last byte of a frame has left a sender of limited rate, or None when its buffer is full."""
        rate = self.conditions.rate
        if not rate:
            return t
        begin = max(t, self._sender_free_t)
        if begin - t > QUEUE_S:
            return None
        self._sender_free_t = begin + size / rate
        return self._sender_free_t

    def _carry(self, t: float, data: bytes) -> None:
        """Put a frame that has left at time `t` on its way: the delay, then its place among the others."""
        if len(self._under_way) >= UNDER_WAY:
            return
        delay, jitter, reorder = self.conditions.delay, self.conditions.jitter, self.conditions.reorder
        if jitter:
            delay = max(0.0, delay + self._random.uniform(-jitter, jitter))
        arrival = max(t + delay, self._newest_t)
        if reorder and self._random.random() < reorder:
            arrival += self._random.uniform(0.0, LATER_S)
        else:
            self._newest_t = arrival
        self._count += 1
        heapq.heappush(self._under_way, (arrival, self._count, data))
