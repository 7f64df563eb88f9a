"""A flight without a screen, by hand: a line of status a second, commands as words. For screen readers and logs.

The same acts and choices as on the screen, from the same tables, with the same refusals; what the screen asks back
about is asked back here, too.
"""

from __future__ import annotations

import queue
import sys
import threading
import time
from collections.abc import Callable
from typing import TextIO

from groundstation.bus import Bus
from groundstation.console import Console, Snapshot
from groundstation.messages import CommandKind, FlightMode, MappingMode, Preset, Severity
from groundstation.progress.keeper import Keeper
from groundstation.run import Run
from groundstation.training.coach import LiveCoach
from groundstation.training.director import Director
from groundstation.training.follower import MissionFollower
from groundstation.training.guide import guide_of
from groundstation.training.telling import Landings
from groundstation.tui.acts import ACTS, BY_NAME, Act, Ask, coupled, in_air
from groundstation.tui.checks import checks
from groundstation.tui.checks_kept import ArmedChecks
from groundstation.tui.choices import CHOICES, CHOICES_BY_NAME, Wishes
from groundstation.tui.finding import DeviceWatch
from groundstation.tui.frame import Frame, Reader, Supervisor, workspace
from groundstation.tui.guarding import GuardWatch
from groundstation.tui.hand import Hand, StickSender
from groundstation.tui.keepalive import Keepalive
from groundstation.tui.notes import Answers, merged
from groundstation.tui.plain_words import HELP, line
from groundstation.tui.rows import clock
from groundstation.tui.theme import MARKS
from groundstation.tui.track import History, Track
from groundstation.tui.ways import WORDS

_TURN_S = 0.05
_EVERY_S = 1.0
_POLL_S = 0.1
# What was asked back about and not confirmed within this was not meant; a kill is a matter of moments.
_CONFIRM_S, _KILL_S = 10.0, 3.0
_EVENTS = 50


class PlainFlight:
    """The operator's side of a flight in words: `hear` takes what was typed, `turn` tells what is new.

    Args:
        run: The run.
        console: The operator's side of the bus.
        supervisor: Says how the other processes are.
        tell: Prints a line.
        hand: The on-screen stick's deflection, or None where another device is in use.
        director: Knows how the mission is going, asked anew each time; None without one.
        coach: Tells the trainee what to do instead, if there is one.
        keep: Makes words an event, for the recording.

    Attributes:
        left: The operator wants to leave.
        snapshot: The newest of everything.
        yaw_range: Rotation of the stick that gives the full yaw rate, rad.
    """

    def __init__(
        self,
        run: Run,
        console: Reader,
        supervisor: Supervisor,
        tell: Callable[[str], None],
        hand: Hand | None,
        *,
        director: Callable[[], Director | None] = lambda: None,
        coach: LiveCoach | None = None,
        keep: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._armed_checks = ArmedChecks(keep)
        self._director, self._coach = director, coach
        self._run, self._console, self._supervisor, self._tell = run, console, supervisor, tell
        self._hand = hand
        self._answers, self._wishes = Answers(), Wishes()
        self._guard, self._device = GuardWatch(), DeviceWatch()
        self._track, self._history = Track(), History()
        self._asked: tuple[Callable[[], None], frozenset[str], float] | None = None
        self._confirmed_real = run.simulated
        self._next_line = self._next_poll = 0.0
        self._last, self._state, self._coaching = "", (), ""
        self.left = False
        self.yaw_range = run.settings.mapping.yaw_range
        self.snapshot = console.snapshot()
        self._started = self._told_t = self.snapshot.t

    def turn(self) -> None:
        """Take the newest of everything and tell what is new."""
        snapshot = self.snapshot = self._console.snapshot()
        if snapshot.t >= self._next_poll:
            self._next_poll = snapshot.t + _POLL_S
            self._supervisor.poll()
        self._answers.take(snapshot)
        if self._asked and snapshot.t > self._asked[2]:
            self._asked = None
            self._tell("Not confirmed: nothing was done.")
        self._coaching = self._coached(snapshot)
        self._tell_events(snapshot)
        self._armed_checks.look(self._frame())
        status, pilot = snapshot.status, snapshot.pilot
        state = (status and (status.mode, status.armed, status.in_air), pilot and pilot.phase)
        if snapshot.t >= self._next_line or state != self._state:
            self._state, self._next_line = state, snapshot.t + _EVERY_S
            self._tell_line()

    def hear(self, typed: str) -> None:
        """Do what was typed."""
        words = typed.split()
        if not words:
            return
        if self._asked is not None:
            self._answered(words)
        elif (act := _act(words)) is not None:
            self._ask_or_do(act)
        elif words[0].lower() in CHOICES_BY_NAME:
            self._choose(words[0].lower(), words[1:])
        else:
            self._other(words)

    def _answered(self, words: list[str]) -> None:
        """Take what follows a question: the word that was asked for, or what makes things safer, else nothing."""
        then, wanted, _ = self._asked or (lambda: None, frozenset[str](), 0.0)
        self._asked = None
        act = _act(words)
        if " ".join(words) in wanted:
            then()
        elif act is not None and act.urgent and act.ask is not Ask.ALWAYS:
            self._ask_or_do(act)
        else:
            self._tell("Not confirmed: nothing was done.")

    def _ask_or_do(self, act: Act) -> None:
        if hindrance := act.hindrance(self.snapshot):
            self._tell(f"{act.label}: {hindrance}.")
        elif act.kind is CommandKind.ENGAGE and not self._confirmed_real:
            status = self.snapshot.status
            number = str(status.system_id) if status is not None else "REAL"
            words = f"Engage the REAL vehicle? Type REAL, or its system id, {number}."
            self._ask(words, lambda: self._engage_real(act), {"REAL", number})
        elif act.ask is Ask.ALWAYS or (act.ask is Ask.REAL and not self._run.simulated):
            which = "simulated" if self._run.simulated else "REAL"
            within = _KILL_S if act.kind is CommandKind.KILL else _CONFIRM_S
            words = f"{act.label} the {which} vehicle? {act.explains} Type yes within {within:.0f} s."
            self._ask(words, lambda: self._do(act), {"yes"}, within)
        else:
            self._do(act)

    def _engage_real(self, act: Act) -> None:
        self._confirmed_real = True
        self._do(act)

    def _ask(
        self, words: str, then: Callable[[], None], wanted: set[str], within: float = _CONFIRM_S
    ) -> None:
        self._asked = then, frozenset(wanted), self.snapshot.t + within
        self._tell(words)

    def _do(self, act: Act) -> None:
        if hindrance := act.hindrance(self.snapshot):
            self._tell(f"{act.label}: {hindrance}.")
        else:
            self._send(act.kind)

    def _choose(self, name: str, wanted: list[str]) -> None:
        choice, pilot = CHOICES_BY_NAME[name], self.snapshot.pilot
        if (hindrance := choice.hindrance(self.snapshot)) or pilot is None:
            self._tell(f"{choice.label}: {hindrance}.")
            return
        value = choice.after(self._wishes.present(choice.kind, pilot))
        if wanted:
            table = {CommandKind.PRESET: Preset, CommandKind.MAPPING: MappingMode}.get(choice.kind)
            found = table.__members__.get(wanted[0].upper()) if table else None
            if found is None:
                known = ", ".join(table.__members__).lower() if table else "nothing; it goes on and off"
                self._tell(f"{name}: {wanted[0]} is not known; use {known}.")
                return
            value = int(found)
        self._wishes.sent(choice.kind, value, self.snapshot.t)
        self._send(choice.kind, value)

    def _other(self, words: list[str]) -> None:
        word, rest = words[0].lower(), words[1:]
        if word == "stick" and self._hand is not None:
            self._move(self._hand, rest)
        elif word == "centre" and self._hand is not None:
            self._hand.centre()
        elif word == "checks":
            for check in checks(self._frame()):
                remedy = f"; {check.remedy}" if check.remedy else ""
                self._tell(f"{MARKS[check.severity].strip() or 'ok'} {check.name}: {check.state}{remedy}")
        elif word == "help":
            self._tell(HELP)
        elif word == "quit":
            self._quit()
        else:
            self._tell(f"{words[0]}: is no command; 'help' lists them.")

    def _move(self, hand: Hand, rest: list[str]) -> None:
        try:
            forward, left, up, turn = (float(share) / 100.0 for share in rest)
        except ValueError:
            self._tell("stick: give four numbers, per cent: forward left up turn, as in 'stick 20 0 0 0'.")
            return
        for axis, share in enumerate((forward, left, up, turn)):
            hand.place(axis, share)

    def _quit(self) -> None:
        if in_air(self.snapshot):
            words = "The vehicle is in the air. Quit? A coupled vehicle holds. Type yes."
            self._ask(words, self.leave, {"yes"})
        else:
            self.leave()

    def leave(self) -> None:
        """Leave; a vehicle that follows the hand is left holding."""
        status = self.snapshot.status
        if coupled(self.snapshot) or (status is not None and status.mode == FlightMode.OFFBOARD):
            self._console.command(CommandKind.HOLD)
        self.left = True

    def _send(self, kind: CommandKind, value: int = 0) -> None:
        self._answers.sent(self._console.command(kind, value), kind, self.snapshot.t)

    def _frame(self) -> Frame:
        snapshot, director = self.snapshot, self._director()
        return Frame(
            snapshot=snapshot,
            run=self._run,
            started=self._started,
            states=self._supervisor.states(),
            stick=self._hand.share if self._hand is not None else None,
            hindrances={each.name: each.hindrance(snapshot) for each in (*ACTS, *CHOICES)},
            guarded_by=self._guard.look(snapshot),
            device_found=self._device.look(snapshot),
            notes=tuple(self._answers.notes),
            track=self._track,
            history=self._history,
            figures=director.figures if director is not None else None,
            guide=guide_of(director, snapshot.t) if director is not None else None,
            coaching=self._coaching,
            ways=WORDS,
        )

    def _coached(self, snapshot: Snapshot) -> str:
        director = self._director()
        if self._coach is None or director is None:
            return ""
        return self._coach.look(snapshot, guide_of(director, snapshot.t), director.clearance)

    def _tell_events(self, snapshot: Snapshot) -> None:
        for note in merged(snapshot.events, tuple(self._answers.notes), _EVENTS):
            if note.t > self._told_t:
                self._told_t = note.t
                sign = "" if note.severity is Severity.INFO else f"{note.severity.name}: "
                self._tell(f"{clock(note.t - self._started)} {sign}{note.source}: {note.text}")

    def _tell_line(self) -> None:
        words = line(self._frame())
        if words.partition(" ")[2] != self._last:
            self._last = words.partition(" ")[2]
            self._tell(words)


def _act(words: list[str]) -> Act | None:
    """Return the act that words name: as in the table, or as its label reads."""
    named = "".join(words).lower()
    return BY_NAME.get(named) or next(
        (act for act in ACTS if act.label.lower().replace(" ", "") == named), None
    )


def fly_plainly(run: Run, bus: Bus, supervisor: Supervisor) -> int:
    """Fly a run whose processes run, in words; return the exit code."""
    from drivers.stick import StickSender as Sender

    stick = Sender(str(run.hand)) if run.hand else None
    follower = MissionFollower(run.mission, bus, run.par) if run.mission else None
    keeper = Keeper(run, follower.attempts) if follower else None
    hand = Hand() if stick is not None else None

    def keep(words: str) -> None:
        bus.event(Severity.INFO, words)

    coach = LiveCoach(run, keep)
    flight = PlainFlight(
        run,
        Console(bus, "plain"),
        supervisor,
        _print,
        hand,
        director=lambda: follower.director if follower is not None else None,
        coach=coach,
        keep=keep,
    )
    keepalive = Keepalive(lambda: _send_stick(stick, hand, flight)) if stick is not None else None
    if keepalive is not None:
        keepalive.start()
    try:
        _loop(flight, follower, Landings(run.par_from), keeper, keepalive)
    except KeyboardInterrupt:
        flight.leave()
        raise
    finally:
        if keepalive is not None:
            keepalive.stop()
        if stick is not None:
            stick.close()
        for words in keeper.close() if keeper else ():
            _print(words)
    return 0


def _loop(
    flight: PlainFlight,
    follower: MissionFollower | None,
    landings: Landings,
    keeper: Keeper | None,
    keepalive: Keepalive | None,
) -> None:
    typed: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(sys.stdin, typed), name="words", daemon=True).start()
    while not flight.left:
        if keepalive is not None:
            keepalive.turned()
        flight.turn()
        if follower is not None:
            follower.look(flight.snapshot)
            for words in landings.news(follower.judgement):
                _print(words)
        for words in keeper.look() if keeper else ():
            _print(words)
        try:
            flight.hear(typed.get(timeout=_TURN_S))
        except queue.Empty:
            continue
    # What was commanded last is to leave before the processes are ended.
    time.sleep(_TURN_S)


def _read(source: TextIO, typed: queue.SimpleQueue[str]) -> None:
    """Read lines until there are no more; then the status goes on without commands."""
    for text in source:
        typed.put(text)


def _send_stick(stick: StickSender | None, hand: Hand | None, flight: PlainFlight) -> None:
    if stick is not None and hand is not None:
        position, yaw = hand.deflection(workspace(flight.snapshot), flight.yaw_range)
        stick.send(position, yaw, 0, time.monotonic())


def _print(words: str) -> None:
    print(words, flush=True)
