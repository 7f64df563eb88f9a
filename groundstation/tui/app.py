"""The Textual application: a timer pulls the newest of everything and paints, a thread keeps the stick alive.

Nothing here flies: it shows what is on the bus and sends the operator's commands. The stick's deflection goes
out at a steady rate while the screen turns; a screen that hangs is a stick gone silent, which uncouples the hand.
"""

from __future__ import annotations

import asyncio
import datetime
import importlib
import signal
import time
from collections.abc import Callable, Iterable
from typing import ClassVar, cast

from textual.app import SystemCommand
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.screen import ModalScreen, Screen

from groundstation.console import Snapshot
from groundstation.messages import CommandKind, FlightMode, Severity
from groundstation.progress.desk import Desk
from groundstation.progress.keeper import Keeper
from groundstation.run import Run, start_of
from groundstation.training.coach import LiveCoach
from groundstation.training.follower import MissionFollower
from groundstation.training.workload import Workload
from groundstation.tui import memory
from groundstation.tui.acts import ACTS, URGENT, Act, coupled, in_air
from groundstation.tui.alarms import Alarms
from groundstation.tui.alerts import conditions
from groundstation.tui.checks import red
from groundstation.tui.checks_kept import ArmedChecks
from groundstation.tui.choices import CHOICES, PRESETS_EXPLAINED, Choice
from groundstation.tui.everywhere import KEYS
from groundstation.tui.finding import DeviceWatch
from groundstation.tui.frame import Frame, Reader, Supervisor, workspace
from groundstation.tui.guarding import GuardWatch
from groundstation.tui.hand import Hand, StickSender
from groundstation.tui.instructing import Instructing
from groundstation.tui.keepalive import Keepalive
from groundstation.tui.milestones import Milestones
from groundstation.tui.pace import PaintPace
from groundstation.tui.pages import PAGES, PAGES_BY_NAME
from groundstation.tui.releases import PREFIX, driver_for
from groundstation.tui.schooling import Schooling
from groundstation.tui.screens.dialog import Confirm
from groundstation.tui.screens.flight import STEPS, FlightScreen
from groundstation.tui.screens.help import Help
from groundstation.tui.screens.page import Page
from groundstation.tui.theme import THEME, THEMES, next_theme
from groundstation.tui.track import History, Track
from groundstation.tui.viewer import Viewer
from groundstation.tui.widgets.stick import YAW, stays

_ALARMS_S = 0.1
_LOOK_S = 0.5


def _everywhere() -> list[BindingType]:
    """Bind what works on every screen: urgent acts also over dialogs and text fields, pages over the latter."""
    urgent = [
        Binding(act.everywhere, f"urgent('{act.name}')", act.label, show=False, priority=True)
        for act in URGENT
    ]
    pages = [Binding(page.key, f"page('{page.name}')", page.label, show=False) for page in PAGES]
    # A key of the stick that is let go moves nothing any more, whatever stands over the flight by then.
    releases = [
        Binding(f"{PREFIX}{key}", f"release({axis})", "Let go", show=False, priority=True)
        for key, axis, _, _ in STEPS
    ]
    return [
        *urgent,
        *pages,
        *releases,
        *KEYS,
        Binding("f1", "help", "Help", show=False),
        Binding("ctrl+c,ctrl+q", "quit", "Quit", show=False, priority=True),
    ]


class FlightApp(Schooling):
    """The screen of a run.

    Args:
        run: The run.
        console: The operator's side of the bus.
        supervisor: Says how the other processes are.
        stick: Takes the on-screen stick's deflection, or None where another device is in use.
        follower: Follows the mission, if there is one.
        coach: Tells the trainee what to do instead, if there is one.
        desk: Knows the pilots and the course; the one of the run's folder where none is given.
        keeper: Keeps the flights that land, if they are anybody's.
        instructing: Lets wind and failures happen for a class of one.
        on_workload: Keeps what was answered after a flight.
        tell: Makes words an event, for the recording.
        clock: Monotonic seconds, the bus's clock.
    """

    TITLE = "groundstation"
    CSS_PATH = "app.tcss"
    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = _everywhere()

    def __init__(
        self,
        run: Run,
        console: Reader,
        supervisor: Supervisor,
        stick: StickSender | None,
        *,
        follower: MissionFollower | None = None,
        coach: LiveCoach | None = None,
        desk: Desk | None = None,
        keeper: Keeper | None = None,
        instructing: Instructing | None = None,
        on_workload: Callable[[Workload], None] = lambda _: None,
        tell: Callable[[str], None] = lambda _: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(
            run,
            console,
            follower=follower,
            coach=coach,
            desk=desk,
            keeper=keeper,
            on_workload=on_workload,
        )
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = THEME.name
        self.hand = Hand()
        self._supervisor, self._stick, self._clock = supervisor, stick, clock
        self._guard, self._device = GuardWatch(), DeviceWatch()
        self._track, self._history = Track(), History()
        self._alarms, self._pace = Alarms(), PaintPace(run.settings.rates.screen)
        self._started = self._snapshot.t
        self._start = start_of(run.started, datetime.datetime.now().astimezone(), clock())
        self._next_alarms = self._next_look = 0.0
        self._keepalive = Keepalive(self._send_stick, clock)
        self._instructing = instructing or Instructing(None)
        self._flight = FlightScreen(self.hand if stick is not None else None)
        self._milestones, self._viewer = Milestones(), Viewer()
        self._armed_checks = ArmedChecks(tell)
        self._latest: Frame | None = None

    def get_driver_class(self) -> type[Driver]:
        """Return Textual's driver, or one that hears keys let go."""
        return driver_for(super().get_driver_class())

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
        self.set_interval(memory.TIDY_S, memory.tidy)
        if self._stick is not None:
            self._keepalive.start()

    def on_ready(self) -> None:
        """The flight is shown; a test that shows many screens keeps none of them."""
        if not self.is_headless:
            memory.settle()

    def pull(self) -> None:
        """Take the newest of everything and show it."""
        self._keepalive.turned()
        snapshot = self._snapshot = self._reader.snapshot()
        self.follow(snapshot)
        # A process that has died uncouples: it is asked each time, for it costs next to nothing.
        self._supervisor.poll()
        for note in self._answers.take(snapshot):
            severity = "error" if note.severity is Severity.ALARM else "warning"
            self.notify(note.text, severity=severity, timeout=6.0, markup=False)
        for refusal in self._instructing.refusals():
            self.notify(refusal, severity="warning", timeout=6.0, markup=False)
        stale_s = self._flight_run.settings.safety.state_stale_s
        if snapshot.vehicle is not None and snapshot.vehicle.valid:
            east, north, up, _ = snapshot.vehicle.position
            self._track.add(east, north, up, snapshot.vehicle.t)
        self._history.add(snapshot, stale_s)
        frame = self._frame(snapshot)
        if snapshot.t >= self._next_alarms:
            self._next_alarms = snapshot.t + _ALARMS_S
            self._alarms.look(conditions(frame), snapshot.t)
            if self._alarms.ring(snapshot.t):
                self.bell()
        self._latest = frame
        if self._pace.due(self._clock()):
            # What stands below a page is not seen, what stands below a dialog is.
            (self._page or self._flight).show(frame)
        if snapshot.t >= self._next_look:
            self._next_look = snapshot.t + _LOOK_S
            self._look_around(frame)

    def _look_around(self, frame: Frame) -> None:
        """Show the page that is due, but never in place of what the operator looks at."""
        self._armed_checks.look(frame)
        if failure := self._viewer.failure():
            self.notify(f"The viewer: {failure}", severity="warning", timeout=8.0, markup=False)
        if self.screen is self._flight and (due := self._milestones.page(frame.snapshot, red(frame))):
            self.action_page(due)

    @property
    def _page(self) -> Page | None:
        """The page that stands over the flight, if one does."""
        return next((screen for screen in self.screen_stack if isinstance(screen, Page)), None)

    def _frame(self, snapshot: Snapshot) -> Frame:
        director = self.director
        guide, coaching = self.guided(snapshot, quiet=self._alarms.first() is not None)
        return Frame(
            snapshot=snapshot,
            run=self._flight_run,
            started=self._started,
            states=self._supervisor.states(),
            stick=self.hand.share if self._stick is not None else None,
            hindrances={each.name: each.hindrance(snapshot) for each in (*ACTS, *CHOICES)},
            guarded_by=self._guard.look(snapshot),
            device_found=self._device.look(snapshot),
            notes=tuple(self._answers.notes),
            track=self._track,
            history=self._history,
            figures=director.figures if director is not None else None,
            score=self.score,
            judgement=self._follower.judgement if self._follower is not None else None,
            guide=guide,
            coaching=coaching,
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

    def action_release(self, axis: int) -> None:
        """A key of the stick was let go: its axis is centred, or in position mode left where it is."""
        if axis == YAW or self._latest is None or not stays(self._latest):
            self.hand.place(axis, 0.0)

    def action_page(self, name: str) -> None:
        """Show a page, or go back to the flight where it is shown already."""
        shown = self._page
        self.action_fly()
        if shown is None or name != shown.NAME:
            module, _, screen = PAGES_BY_NAME[name].screen.partition(":")
            found = getattr(importlib.import_module(f"groundstation.tui.screens.{module}"), screen)
            page = cast("type[Page]", found)()
            self.push_screen(page)

    def action_fly(self) -> None:
        """Go back to the flight."""
        if self.screen is self._flight:
            return
        while self.screen is not self._flight:
            self.pop_screen()

    def review_at(self, t: float) -> None:
        """Open the recording in the viewer at a moment, s on the clock of the flight."""
        self.action_review(max(t - self._start, 0.0))

    def action_review(self, at: float | None = None) -> None:
        """Open the recording in the viewer, at a time of the recording, s, or at its beginning."""
        if coupled(self._snapshot) or in_air(self._snapshot):
            self.notify("Land first: the viewer takes its time of this machine.", severity="warning")
            return
        self._viewer.open(self._flight_run.recording, at)
        self.notify("The viewer is starting.", timeout=3.0)

    def _end(self, code: int) -> None:
        """Leave at once with an exit code; the pilot lets go when it is ended."""
        self.hand.centre()
        self.exit(code)

    def action_next_theme(self) -> None:
        """Change to the next theme: dark, light, high contrast."""
        self.theme = next_theme(self.theme)

    def action_acknowledge(self) -> None:
        """Take all alarms as seen."""
        if not self._alarms.acknowledge():
            self.notify("Nothing new is wrong.", timeout=2.0)

    def action_mute(self) -> None:
        """Silence the bell, or let it ring again."""
        self._alarms.muted = not self._alarms.muted
        self.notify(f"Bell {'off' if self._alarms.muted else 'on'}.", timeout=2.0)

    def action_help(self) -> None:
        """Show the keys."""
        if not isinstance(self.screen, ModalScreen):
            self.push_screen(Help(self.settings.buttons))

    async def action_quit(self) -> None:
        """Leave; in the air, ask first."""
        if isinstance(self.screen, Confirm):
            return
        if in_air(self._snapshot):
            text = "The hand is uncoupled. A coupled vehicle holds; one that lands or returns goes on."
            self.ask("The vehicle is in the air. Quit?", text, self.leave, key="q")
        else:
            self.leave()

    def leave(self) -> None:
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
        for page in PAGES:
            yield SystemCommand(
                f"{page.label} ({page.shown})",
                page.explains,
                lambda name=page.name: self.action_page(name),
            )
        yield SystemCommand("Back to the flight (Esc)", "From any other screen.", self.action_fly)
        yield SystemCommand("Open the recording in the viewer", "After landing.", self.action_review)
        yield SystemCommand("Centre the stick (space)", "All axes at once.", self._flight.action_centre)
        yield SystemCommand("Alarms seen (o)", "Acknowledge all alarms.", self.action_acknowledge)
        yield SystemCommand("Bell on/off (b)", "The bell rings for alarms.", self.action_mute)
        yield SystemCommand("Next theme (ctrl+t)", "Dark, light, high contrast.", self.action_next_theme)
        yield from self._flight.commands()
        yield from self._instructing.commands()
        yield SystemCommand("Help (?)", "All keys.", self.action_help)
        yield SystemCommand("Quit (q)", "Asks first while the vehicle is in the air.", self.action_quit)

    def _listed(self, asked: Act | Choice, then: Callable[[], None]) -> SystemCommand:
        hindrance = asked.hindrance(self._snapshot)
        words = f"Not now: {hindrance}." if hindrance else asked.explains
        return SystemCommand(f"{asked.label} ({asked.key})", words, then)
