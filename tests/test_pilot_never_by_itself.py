"""Whatever goes wrong and comes right again, in any order: the hand is coupled by an act that came after, or not."""

from __future__ import annotations

import tempfile
from pathlib import Path

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from servo_bench import DT, Bench

from groundstation.config import Buttons, Settings
from groundstation.messages import CommandKind, FlightMode, Phase, Stream

SETTINGS = Settings(buttons=Buttons(enable=6, panic=7))
HELD = 1 << 6
# What is chosen of how the hand leads, on or off, this or that: none of it is an act to engage.
CHOOSING = [CommandKind.MAPPING, CommandKind.FINE, CommandKind.CLUTCH, CommandKind.PRESET, CommandKind.CUES]
# What can be wrong, as a field of the bench or of what the vehicle tells, with its good and its bad value.
FAULTS = {
    "stick gone": ("bench", "stick", (0.0, 0.0, 0.0), None),
    "vehicle silent": ("bench", "vehicle", True, False),
    "enable let go": ("bench", "buttons", HELD, 0),
    "squeezed": ("bench", "buttons", HELD, HELD | 1 << 7),
    "not connected": ("status", "connected", 1, 0),
    "disarmed": ("status", "armed", 1, 0),
    "landed": ("status", "in_air", 1, 0),
    "lossy": ("status", "loss", 0.0, 0.9),
    "untrusted": ("state", "valid", 1, 0),
    "no number": ("state", "velocity", (0.0,) * 4, (float("nan"),) * 4),
    "too fast": ("state", "velocity", (0.0,) * 4, (9.0, 0.0, 0.0, 0.0)),
}
# What this does ends a coupling, besides a fault.
RELEASING = [CommandKind.DISENGAGE, CommandKind.HOLD, CommandKind.LAND, CommandKind.RETURN, CommandKind.KILL]


class NeverByItself(RuleBasedStateMachine):
    """A servo with a real bus, an operator who engages now and then, and a world that goes wrong.

    `asked` is whether the newest thing that matters was an act to engage, rather than a fault or a release.
    """

    @initialize()
    def begin(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.bench = Bench(Path(self.folder.name), settings=SETTINGS)
        self.bench.buttons = HELD
        self.asked = False
        self.wrong: set[str] = set()
        self.bench.run(0.5)

    def teardown(self) -> None:
        if hasattr(self, "bench"):
            self.bench.close()
            self.folder.cleanup()

    def put(self, name: str, *, wrong: bool) -> None:
        where, field, good, bad = FAULTS[name]
        world = self.bench.world
        target = {"bench": self.bench, "status": world.status, "state": world.state}[where]
        setattr(target, field, bad if wrong else good)

    @rule()
    def engage(self) -> None:
        self.bench.world.command(CommandKind.ENGAGE, self.bench.now)
        self.bench.tick()
        self.asked = self.bench.phase() is not Phase.DISENGAGED
        assert not (self.asked and self.wrong)

    @precondition(lambda self: not self.wrong)
    @rule(name=st.none() | st.sampled_from(sorted(FAULTS)))
    def couple(self, name: str | None) -> None:
        """All the way, so that there is something that can go wrong; and often it does."""
        self.bench.world.confirm(FlightMode.HOLD, Stream.IDLE)
        self.bench.run(0.1)
        self.bench.world.command(CommandKind.ENGAGE, self.bench.now)
        self.bench.run(0.1)
        self.bench.world.confirm()
        self.bench.run(0.1)
        assert self.bench.phase() is Phase.ENGAGED
        self.asked = True
        if name:
            self.go_wrong(name)

    @rule(kind=st.sampled_from(RELEASING))
    def release(self, kind: CommandKind) -> None:
        self.bench.world.command(kind, self.bench.now)
        self.bench.tick()
        self.asked = False

    @rule(
        kind=st.sampled_from([*CHOOSING, CommandKind.SETTINGS, CommandKind.PARAMETERS]),
        value=st.integers(0, 1),
    )
    def choose(self, kind: CommandKind, value: int) -> None:
        """Clutch and mode change, as often as one likes."""
        self.bench.world.command(kind, self.bench.now, value)
        self.bench.run(0.02)

    @rule(keys=st.integers(1, 5))
    def wake_to_keys_pressed_meanwhile(self, keys: int) -> None:
        """A servo that stood still finds what was pressed while nothing happened: that was not meant for now."""
        for _ in range(keys):
            self.bench.world.command(CommandKind.ENGAGE, self.bench.now)
        self.bench.now += 5.0
        self.bench.tick()
        self.asked = False

    @rule(name=st.sampled_from(sorted(FAULTS)))
    def go_wrong(self, name: str) -> None:
        _, field, _, _ = FAULTS[name]
        self.wrong = {each for each in self.wrong if FAULTS[each][1] != field} | {name}
        self.put(name, wrong=True)
        # Longer than any of them is tolerated.
        self.bench.run(0.6)
        self.asked = False

    @precondition(lambda self: self.wrong)
    @rule()
    def come_right(self) -> None:
        for name in self.wrong:
            self.put(name, wrong=False)
        self.wrong = set()
        self.bench.run(0.3)

    @rule()
    def reboot(self) -> None:
        state = self.bench.world.state
        state.boot_t = 1.0 if state.boot_t > 10.0 else 60.0
        self.bench.run(0.05)
        # Only a clock that goes back is a reboot.
        self.asked = self.asked and state.boot_t > 10.0

    @rule(mode=st.sampled_from([FlightMode.POSITION, FlightMode.RETURN, FlightMode.MANUAL]))
    def be_taken(self, mode: FlightMode) -> None:
        # Who engages while another flies in that mode has it from them; that they go on in it takes nothing.
        already = self.bench.world.status.mode == mode
        self.bench.world.confirm(mode, Stream.ENDED)
        self.bench.run(0.1)
        self.asked = self.asked and already

    @rule()
    def link_confirms(self) -> None:
        """The worst that link and vehicle can say: they fly in Offboard, asked or not."""
        self.bench.world.confirm()
        self.bench.run(0.1)

    @rule()
    def link_waits(self) -> None:
        self.bench.world.confirm(FlightMode.HOLD, Stream.IDLE)
        before = self.bench.phase()
        self.bench.run(0.1)
        # One that flew, and flies no more, has been taken; one that was waited for is still.
        self.asked = self.asked and before is Phase.ENGAGING and self.bench.phase() is Phase.ENGAGING

    @rule(ticks=st.integers(1, 400))
    def wait(self, ticks: int) -> None:
        self.bench.run(ticks * DT)

    @rule()
    def stall(self) -> None:
        self.bench.now += 0.3
        self.bench.tick()
        self.asked = False

    @invariant()
    def it_is_coupled_only_by_an_act_that_came_after_all_that_went_wrong(self) -> None:
        if not hasattr(self, "bench"):
            return
        if self.bench.phase() is not Phase.DISENGAGED:
            assert self.asked
        elif self.asked:
            # An act that came to nothing, as when nobody confirmed it: that is no act any more.
            self.asked = False
        setpoint = self.bench.world.setpoints.newest()
        if setpoint is not None and setpoint.active:
            assert self.bench.phase() is not Phase.DISENGAGED


TestNeverByItself = NeverByItself.TestCase
TestNeverByItself.settings = settings(
    max_examples=15, stateful_step_count=20, deadline=None, suppress_health_check=list(HealthCheck)
)
