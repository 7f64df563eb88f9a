"""The Textual application: a timer pulls the newest of everything and paints, a thread keeps the stick alive.

Nothing here flies: it shows what is on the bus and sends the operator's commands. The stick's deflection goes
out at a steady rate while the screen turns; a screen that hangs is a stick gone silent, which uncouples the hand.
"""

from __future__ import annotations

import asyncio
import gc
import signal
import sys
import time
from collections.abc import Callable, Iterable
from typing import ClassVar

from textual.app import App, SystemCommand
from textual.binding import Binding, BindingType
from textual.screen import Screen

from groundstation.bus import Bus
from groundstation.console import Console, Snapshot
from groundstation.messages import CommandKind, FlightMode, Preset, Severity
from groundstation.run import Run
from groundstation.training.follower import MissionFollower
from groundstation.tui.acts import ACTS, BY_NAME, Act, Ask, coupled, in_air
from groundstation.tui.alarms import Alarms
from groundstation.tui.alerts import conditions
from groundstation.tui.choices import CHOICES, CHOICES_BY_NAME, PRESETS_EXPLAINED, Choice, Wishes
from groundstation.tui.frame import Frame, Reader, Supervisor, workspace
from groundstation.tui.guarding import GuardWatch
from groundstation.tui.hand import Hand, StickSender
from groundstation.tui.hangup import HangupWatch
from groundstation.tui.keepalive import Keepalive
from groundstation.tui.notes import Answers
from groundstation.tui.pace import PaintPace
from groundstation.tui.screens.dialog import Confirm, Help
from groundstation.tui.screens.flight import FlightScreen
from groundstation.tui.theme import THEME, THEMES, next_theme
from groundstation.tui.track import History, Track

_POLL_S = 0.1
_SWITCH_S = 0.001


class FlightApp(App[int]):
    """The screen of a run.

    Args:
        run: The run.
        console: The operator's side of the bus.
        supervisor: Says how the other processes are.
        stick: Takes the on-screen stick's deflection, or None where another device is in use.
        follower: Follows the mission, if there is one.
        clock: Monotonic seconds, the bus's clock.
    """

    TITLE = "groundstation"
    CSS_PATH = "app.tcss"
    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c,ctrl+q", "quit", "Quit", show=False, priority=True),
        Binding("ctrl+t", "next_theme", "Next theme", show=False, priority=True),
        Binding("o,O", "acknowledge", "Alarms seen", show=False),
        Binding("b,B", "mute", "Bell on/off", show=False),
    ]

    def __init__(
        self,
        run: Run,
        console: Reader,
        supervisor: Supervisor,
        stick: StickSender | None,
        *,
        follower: MissionFollower | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__()
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = THEME.name
        self.hand = Hand()
        self._flight_run, self._reader, self._supervisor = run, console, supervisor
        self._stick, self._clock = stick, clock
        self._answers = Answers()
        self._wishes, self._guard = Wishes(), GuardWatch()
        self._track, self._history = Track(), History()
        self._alarms, self._pace = Alarms(), PaintPace(run.settings.rates.screen)
        self._snapshot = console.snapshot()
        self._started = self._snapshot.t
        self._next_poll = 0.0
        self._keepalive = Keepalive(self._send_stick, clock)
        self._follower = follower
        self._flight = FlightScreen(self.hand if stick is not None else None)

    def get_default_screen(self) -> Screen[None]:
        """The flight screen is what everything else stands over."""
        return self._flight

    def on_mount(self) -> None:
        """Start the two timers."""
        self.set_class(not self._flight_run.simulated, "-real")
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGHUP):
            # Ended from outside, or the terminal has gone: out by the same door, terminal restored.
            loop.add_signal_handler(number, self._end, 128 + number)
        self.set_interval(1.0 / self._flight_run.settings.rates.screen, self.pull)
        if self._stick is not None:
            self._keepalive.start()

    def pull(self) -> None:
        """Take the newest of everything and show it."""
        self._keepalive.turned()
        snapshot = self._snapshot = self._reader.snapshot()
        if self._follower is not None:
            self._follower.look(snapshot)
        polled = snapshot.t >= self._next_poll
        if polled:
            self._next_poll = snapshot.t + _POLL_S
            self._supervisor.poll()
        for note in self._answers.take(snapshot):
            severity = "error" if note.severity is Severity.ALARM else "warning"
            self.notify(note.text, severity=severity, timeout=6.0, markup=False)
        stale_s = self._flight_run.settings.safety.state_stale_s
        if snapshot.vehicle is not None and snapshot.vehicle.valid:
            east, north, up, _ = snapshot.vehicle.position
            self._track.add(east, north, up, snapshot.vehicle.t)
        self._history.add(snapshot, stale_s)
        frame = self._frame(snapshot)
        if polled:
            self._alarms.look(conditions(frame), snapshot.t)
            if self._alarms.ring(snapshot.t):
                self.bell()
        if self._pace.due(self._clock()):
            self._flight.show(frame)

    def _frame(self, snapshot: Snapshot) -> Frame:
        return Frame(
            snapshot=snapshot,
            run=self._flight_run,
            started=self._started,
            states=self._supervisor.states(),
            stick=self.hand.share if self._stick is not None else None,
            hindrances={each.name: each.hindrance(snapshot) for each in (*ACTS, *CHOICES)},
            guarded_by=self._guard.look(snapshot),
            notes=tuple(self._answers.notes),
            track=self._track,
            history=self._history,
            figures=self._follower.director.figures if self._follower is not None else None,
            alarms=self._alarms,
            paint_hz=self._pace.rate,
        )

    def _send_stick(self) -> None:
        if self._stick is not None:
            yaw_range = self._flight_run.settings.mapping.yaw_range
            position, yaw = self.hand.deflection(workspace(self._snapshot), yaw_range)
            self._stick.send(position, yaw, 0, self._clock())

    def on_unmount(self) -> None:
        """The stick ends with the screen."""
        self._keepalive.stop()

    def on_app_blur(self) -> None:
        """The operator looks elsewhere: let go of the stick."""
        self._flight.let_go()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Grey what cannot be done now."""
        table = {"act": BY_NAME, "choose": CHOICES_BY_NAME}.get(action)
        if table is not None and parameters:
            asked = table.get(str(parameters[0]))
            return True if asked is None or not asked.hindrance(self._snapshot) else None
        return super().check_action(action, parameters)

    def action_act(self, name: str) -> None:
        """Do one of the operator's acts, asking back where that is due."""
        act = BY_NAME[name]
        if act.ask is Ask.NEVER or (act.ask is Ask.REAL and self._flight_run.simulated):
            self._command(act)
        elif not self._hindered(act):
            which = "the simulated" if self._flight_run.simulated else "the REAL"
            self._ask(f"{act.label} {which} vehicle?", act.explains, act.key, lambda: self._command(act))

    def action_choose(self, name: str) -> None:
        """Make one of the operator's choices: go on from what is in effect."""
        choice, pilot = CHOICES_BY_NAME[name], self._snapshot.pilot
        if not self._hindered(choice) and pilot is not None:
            self._send(choice.kind, choice.after(self._wishes.present(choice.kind, pilot)))

    def _choose_preset(self, preset: Preset) -> None:
        if not self._hindered(CHOICES_BY_NAME["preset"]):
            self._send(CommandKind.PRESET, preset)

    def _hindered(self, asked: Act | Choice) -> bool:
        """Say why an act or a choice is not possible, if so."""
        hindrance = asked.hindrance(self._snapshot)
        if hindrance:
            self.notify(f"{asked.label}: {hindrance}.", timeout=3.0, markup=False)
        return bool(hindrance)

    def _command(self, act: Act) -> None:
        """Send a command, unless it has become impossible while it was asked about."""
        if not self._hindered(act):
            self._send(act.kind)

    def _send(self, kind: CommandKind, value: int = 0) -> None:
        """Send a command and watch for its answer."""
        now = self._snapshot.t
        self._wishes.sent(kind, value, now)
        self._answers.sent(self._reader.command(kind, value), kind, now)

    def _ask(self, question: str, consequence: str, key: str, then: Callable[[], None]) -> None:
        def answered(yes: bool | None) -> None:
            if yes:
                then()

        self.push_screen(Confirm(question, consequence, key), answered)

    def _end(self, code: int) -> None:
        """Leave at once with an exit code; the pilot lets go when it is ended."""
        self.hand.centre()
        self.exit(code)

    def action_next_theme(self) -> None:
        """Change to the next theme: dark, light, high contrast."""
        self.theme = next_theme(self.theme)

    def action_acknowledge(self) -> None:
        """Take all alarms as seen."""
        self._alarms.acknowledge()

    def action_mute(self) -> None:
        """Silence the bell, or let it ring again."""
        self._alarms.muted = not self._alarms.muted

    def action_help(self) -> None:
        """Show the keys."""
        self.push_screen(Help())

    async def action_quit(self) -> None:
        """Leave; in the air, ask first."""
        if isinstance(self.screen, Confirm):
            return
        if in_air(self._snapshot):
            text = "The hand is uncoupled. A coupled vehicle holds; one that lands or returns goes on."
            self._ask("The vehicle is in the air. Quit?", text, "q", self._leave)
        else:
            self._leave()

    def _leave(self) -> None:
        """End the screen; a vehicle that follows the hand is left holding."""
        self.hand.centre()
        status = self._snapshot.status
        offboard = status is not None and status.mode == FlightMode.OFFBOARD
        if coupled(self._snapshot) or offboard:
            self._reader.command(CommandKind.HOLD)
        self.exit(0)

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """List all acts and choices by name; those that are not possible now say why."""
        del screen
        for act in ACTS:
            yield self._listed(act, lambda name=act.name: self.action_act(name))
        for choice in CHOICES:
            yield self._listed(choice, lambda name=choice.name: self.action_choose(name))
        for preset, words in PRESETS_EXPLAINED.items():
            title = f"Preset: {preset.name.lower()}"
            yield SystemCommand(title, words, lambda preset=preset: self._choose_preset(preset))
        yield SystemCommand("Centre the stick (space)", "All axes at once.", self._flight.action_centre)
        yield SystemCommand("Alarms seen (o)", "Acknowledge all alarms.", self.action_acknowledge)
        yield SystemCommand("Bell on/off (b)", "The bell rings for alarms.", self.action_mute)
        yield SystemCommand("Next theme (ctrl+t)", "Dark, light, high contrast.", self.action_next_theme)
        yield from self._flight.commands()
        yield SystemCommand("Help (?)", "All keys.", self.action_help)
        yield SystemCommand("Quit (q)", "Asks first while the vehicle is in the air.", self.action_quit)

    def _listed(self, asked: Act | Choice, then: Callable[[], None]) -> SystemCommand:
        hindrance = asked.hindrance(self._snapshot)
        words = f"Not now: {hindrance}." if hindrance else asked.explains
        return SystemCommand(f"{asked.label} ({asked.key})", words, then)


def run_screen(
    run: Run,
    console: Reader,
    supervisor: Supervisor,
    stick: StickSender | None,
    follower: MissionFollower | None = None,
) -> int:
    """Show the screen until the operator leaves; return the exit code."""
    app = FlightApp(run, console, supervisor, stick, follower=follower)
    # A collection that looks through all the modules again takes 0.2 s, and a stick is stale after 0.1 s.
    gc.collect()
    gc.freeze()
    # Nor may painting keep the stick's thread waiting: it asks for its turn and gets it within a millisecond, and the
    # young objects of some thousand frames are looked through before all are.
    sys.setswitchinterval(_SWITCH_S)
    gc.set_threshold(2_000, 20, 1_000)
    watch = HangupWatch(sys.stdin.fileno())
    try:
        code = app.run()
    finally:
        watch.stop()
    return (app.return_code or 0) if code is None else code


def fly_on_screen(run: Run, bus: Bus, supervisor: Supervisor) -> int:
    """Show the screen of a run whose processes run; return the exit code."""
    from drivers.stick import StickSender as Sender

    stick = Sender(str(run.hand)) if run.hand else None
    try:
        follower = MissionFollower(run.mission, bus) if run.mission else None
        return run_screen(run, Console(bus, "screen"), supervisor, stick, follower)
    finally:
        if stick is not None:
            stick.close()
