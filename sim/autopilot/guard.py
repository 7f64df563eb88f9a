"""What becomes of failing conditions over time: delay, takeover, clearing; see `sim.autopilot.failsafe`."""

from __future__ import annotations

from typing import NamedTuple

from sim.autopilot.failsafe import Act, Row, Situation, Takeover, mode_of, mode_row, possible, rows
from sim.autopilot.modes import Mode
from sim.autopilot.parameters import Parameters

_NO_DELAY_S = 0.1


class Decision(NamedTuple):
    """What the failsafes make of a situation.

    Attributes:
        act: To be done now.
        mode: To be flown in, unless `act` stops the motors.
        cause: Why, or "".
        then: What follows the delay in Hold that has begun, or NONE.
        wanted: The mode the operator wants; the sticks change it where they take over.
        news: The operator should hear of it.
    """

    act: Act
    mode: Mode
    cause: str = ""
    then: Act = Act.NONE
    wanted: Mode = Mode.HOLD
    news: bool = False


class Guard:
    """Keeps the failsafes of one vehicle.

    Args:
        parameters: What governs them.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self._active: dict[str, Row] = {}
        self._failing: set[str] = set()
        self._delay = 0.0
        self._act = Act.NONE
        self._taken_over = False

    @property
    def act(self) -> Act:
        """What is being done."""
        return self._act

    def reset(self) -> None:
        """Forget everything: armed or disarmed."""
        self._active.clear()
        self._failing.clear()
        self._delay = 0.0
        self._act = Act.NONE
        self._taken_over = False

    def update(
        self, situation: Situation, dt: float, *, switched: bool = False, sticks_moved: bool = False
    ) -> Decision:
        """Judge a situation.

        Args:
            situation: As it is.
            dt: Time since the last call, s.
            switched: The operator has just asked for a mode.
            sticks_moved: The operator has moved the sticks, and COM_RC_OVERRIDE heeds that.
        """
        found = rows(situation, self._parameters)
        if not found and not self._active:
            self._act, self._taken_over, self._delay = Act.NONE, False, 0.0
            return Decision(Act.NONE, situation.mode, wanted=situation.mode)
        if switched or self._taken_over:
            self._forget_settled()
        self._delay = max(0.0, self._delay - dt)
        warned = self._take_in(found)
        if self._act > Act.HOLD or self._taken_over or Mode.HOLD not in situation.flyable:
            self._delay = 0.0
        decision = self._select(situation, switched, sticks_moved)
        news = decision.act > self._act or (warned and decision.act is not Act.NONE)
        self._act = decision.act
        return decision._replace(news=news)

    def _forget_settled(self) -> None:
        for cause in [cause for cause in self._active if cause not in self._failing]:
            del self._active[cause]

    def _take_in(self, found: list[Row]) -> bool:
        """Take in the rows that fail now; say whether a new one only warns."""
        warned = False
        now = {row.cause for row in found}
        for cause in [cause for cause, row in self._active.items() if cause not in now and not row.stays]:
            del self._active[cause]
        for row in found:
            if (known := self._active.get(row.cause)) is not None:
                self._active[row.cause] = known._replace(act=row.act)
            else:
                self._active[row.cause] = self._begun(row)
                warned |= row.act is Act.WARN
        self._failing = now
        return warned

    def _begun(self, row: Row) -> Row:
        """Return a new row with its way of takeover settled; begin the delay where it has one."""
        if row.act >= Act.HOLD:
            self._taken_over = False
        if row.takeover is not Takeover.DELAYED:
            return row
        delay = self._parameters["COM_FAIL_ACT_T"]
        if delay <= _NO_DELAY_S:
            return row._replace(takeover=Takeover.BY_MODE)
        if row.act is not Act.WARN and self._delay == 0.0:
            self._delay = delay
        return row._replace(takeover=Takeover.ALWAYS)

    def _select(self, situation: Situation, switched: bool, sticks_moved: bool) -> Decision:
        worst = max(self._active.values(), key=lambda row: row.act, default=None)
        if worst is None or worst.act is Act.NONE:
            self._taken_over = False
            return Decision(Act.NONE, situation.mode, wanted=situation.mode)
        act, then, wanted = worst.act, Act.NONE, situation.mode
        takeover = max(row.takeover for row in self._active.values())
        if self._holds_first(act, takeover):
            act, then, takeover = Act.HOLD, act, Takeover.BY_MODE
        want = (switched and self._act is act) or self._taken_over
        allowed = (want or sticks_moved) if takeover is Takeover.ALWAYS else want
        self._taken_over = Act.HOLD <= act <= Act.DESCEND and takeover <= Takeover.BY_MODE and allowed
        if self._taken_over:
            if not want:
                wanted = Mode.POSITION
            fallback = mode_row(situation._replace(mode=wanted), self._parameters)
            act, then = max(Act.WARN, fallback.act if fallback else Act.WARN), Act.NONE
        act = possible(act, situation.flyable)
        if wanted is Mode.LAND and Act.RETURN in (act, then) and Mode.LAND in situation.flyable:
            act, then = Act.WARN, Act.NONE
        cause = f"{worst.cause}, {worst.detail}" if worst.detail else worst.cause
        return Decision(act, mode_of(act, wanted), cause, then, wanted)

    def _holds_first(self, act: Act, takeover: Takeover) -> bool:
        """Say whether the action waits while the vehicle holds, for the operator to notice."""
        if act <= Act.WARN or act >= Act.DISARM:
            return False
        return self._delay > 0.0 and not self._taken_over and takeover <= Takeover.BY_MODE
