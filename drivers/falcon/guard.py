"""What of the Falcon's replies can be believed.

A reply holds no checksum. Bytes lost or doubled nearly always break its frame, but a byte doubled and another lost
in the same 16 leave a frame that looks right: of a line that spoils 1 % of its bytes, one reply in 600 is wrong so,
one in 5000 in its buttons or homing. So an event needs three replies that agree, and a position must be one that
the hand can have reached as it was moving.
"""

from __future__ import annotations

from typing import NamedTuple

from drivers.falcon.packet import ALL_LEGS, Counts, Reply

AGREEING = 3
FASTEST = 80_000.0
"""Counts a second: a grip at 2 m/s where it turns the legs fastest, 25 rad/m."""

HARDEST = 2_000_000.0
"""Counts a second squared: likewise at 50 m/s², harder than a hand pulls. Hitting a stop is harder still."""

ROUNDING = 2.0


class _Seen(NamedTuple):
    """A leg's or all legs' counts at t, s, and counts a second since `before`, s earlier."""

    t: float
    counts: Counts
    rates: tuple[float, float, float] = (0.0, 0.0, 0.0)
    before: float = 0.0


class Guard:
    """Believes replies, or not.

    Attributes:
        homed: All legs are.
        buttons: The grip's, one bit each.
        refused: Positions not believed.
    """

    def __init__(self) -> None:
        self.homed = False
        self.buttons = 0
        self.refused = 0
        self._flags = self._new_flags = (0, 0)
        self._agreed = 0
        self._trusted: _Seen | None = None
        self._doubted: _Seen | None = None

    def take(self, t: float, reply: Reply) -> bool:
        """Take note of a reply to a request made at `t`, s; say whether its encoders can be believed.

        A place that the hand cannot have come to is believed where the next reply is near it.
        """
        self._confirm((reply.buttons, reply.legs))
        here = _Seen(t, reply.encoders)
        if self._trusted is not None and _expected(self._trusted, here):
            self._trusted, self._doubted = _onward(self._trusted, here), None
            return True
        if self._doubted is not None and _near(self._doubted, here):
            self._trusted, self._doubted = _onward(self._doubted, here), None
            return True
        self._doubted = here
        self.refused += 1
        return False

    def _confirm(self, flags: tuple[int, int]) -> None:
        if flags == self._flags:
            self._agreed = 0
            return
        self._agreed = self._agreed + 1 if self._agreed and flags == self._new_flags else 1
        self._new_flags = flags
        if self._agreed == AGREEING:
            self._flags, self._agreed = flags, 0
            self.buttons, self.homed = flags[0], flags[1] == ALL_LEGS


def _expected(seen: _Seen, here: _Seen) -> bool:
    """Say whether a hand that went on as it was moving, faster or slower, can be here."""
    elapsed = here.t - seen.t
    most = ROUNDING + HARDEST * elapsed * (elapsed + seen.before)
    if seen.before:
        most += ROUNDING * elapsed / seen.before
    (a, b, c), (d, e, f), (u, v, w) = seen.counts, here.counts, seen.rates
    return (
        abs(d - a - u * elapsed) <= most
        and abs(e - b - v * elapsed) <= most
        and abs(f - c - w * elapsed) <= most
    )


def _near(seen: _Seen, here: _Seen) -> bool:
    """Say whether any hand can have come here."""
    most = ROUNDING + FASTEST * (here.t - seen.t)
    (a, b, c), (d, e, f) = seen.counts, here.counts
    return abs(d - a) <= most and abs(e - b) <= most and abs(f - c) <= most


def _onward(seen: _Seen, here: _Seen) -> _Seen:
    elapsed = here.t - seen.t
    if elapsed <= 0.0:
        return here._replace(rates=seen.rates, before=seen.before)
    (a, b, c), (d, e, f) = seen.counts, here.counts
    return here._replace(rates=((d - a) / elapsed, (e - b) / elapsed, (f - c) / elapsed), before=elapsed)
