"""The instructor's screen: the trainee's flight as it is flown, and a key for all that can be let happen."""

from __future__ import annotations

import datetime
import math
import time
from collections import deque
from collections.abc import Iterable
from typing import ClassVar

from textual.app import App, ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.screen import Screen
from textual.widgets import Input, Static

from groundstation.instruct.flights import title
from groundstation.instruct.panel import Choice, Map, Offers, Trainee
from groundstation.instruct.seat import Seat
from groundstation.messages import CommandKind, InterventionAnswer, Severity
from groundstation.run import start_of
from groundstation.training.happening import Calm, unpacked, words
from groundstation.training.strengths import OFFERS, STRENGTHS
from groundstation.tui.frame import Frame
from groundstation.tui.notes import Note
from groundstation.tui.theme import THEME, THEMES, next_theme
from groundstation.tui.track import History, Track
from groundstation.tui.widgets.happenings import Happenings
from groundstation.tui.widgets.instrument import Instrument

_HZ = 15.0
_NOTES = 50
_NARROW = 100
_KEYS = "h hold · L land · s say · v view · ctrl+t theme · q leave"
_OURS = "instructor"


def show(seat: Seat) -> int:
    """Show it until the instructor leaves or the flight ends; return the exit code."""
    app = InstructorApp(seat)
    code = app.run()
    if app.ended:
        print("The flight has ended.")
    return code or 0


class InstructorApp(App[int]):
    """What an instructor sees, and the keys.

    Args:
        seat: A place in the flight.

    Attributes:
        ended: The flight has.
    """

    TITLE = "groundstation instruct"
    ALLOW_SELECT = False
    # Letters are keys until something is to be said.
    AUTO_FOCUS = None
    CSS = """
    Screen { background: $ink; color: $text; }
    #head, #foot { height: 1; background: $pane; padding: 0 1; color: $muted; }
    #map { width: 1fr; }
    #side { width: 52; }
    #trainee { height: 15; }
    #offers { height: 12; }
    #events { height: 1fr; }
    Instrument { border: round $frame; border-title-color: $muted; border-subtitle-color: $muted; background: $ink; }
    Instrument.-stale { border: round $faint; border-subtitle-color: $warn; }
    #say { display: none; border: none; height: 1; padding: 0 1; background: $pane; }
    .-narrow #map { display: none; }
    .-narrow #side { width: 1fr; }
    .-narrow #trainee, .-narrow #offers { height: 8; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        *[Binding(offer.key, f"let('{offer.key}')", offer.name, show=False) for offer in OFFERS],
        *[Binding(str(n + 1), f"strength({n})", name, show=False) for n, name in enumerate(STRENGTHS)],
        Binding("c", "calm", "Take all back", show=False),
        Binding("o", "turn", "Wind from", show=False),
        Binding("h", "command('HOLD')", "Hold", show=False),
        Binding("L", "command('LAND')", "Land", show=False),
        Binding("s", "say", "Say", show=False),
        Binding("v", "view", "View", show=False),
        Binding("escape", "quiet", "Back", show=False),
        Binding("ctrl+t", "next_theme", "Next theme", show=False),
        Binding("q,ctrl+c,ctrl+q", "quit", "Leave", show=False),
    ]

    def __init__(self, seat: Seat) -> None:
        super().__init__()
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = THEME.name
        self.ended = False
        self._seat, self._choice = seat, Choice()
        self._track, self._history = Track(), History()
        self._notes: deque[Note] = deque(maxlen=_NOTES)
        self._commands: dict[int, CommandKind] = {}
        # As on the trainee's own screen.
        self._started = start_of(seat.run.started, datetime.datetime.now().astimezone(), time.monotonic())

    def compose(self) -> ComposeResult:
        """Yield the flight on the left, trainee, keys and events on the right."""
        yield Static(f"Instructor · {title(self._seat.run)}", id="head", markup=False)
        with Horizontal():
            yield Map(id="map")
            with Vertical(id="side"):
                yield Trainee(self._seat.in_force.told, id="trainee")
                yield Offers(self._choice, real=not self._seat.run.simulated, id="offers")
                yield Happenings(id="events")
        yield Input(placeholder="what the trainee shall read; Enter sends it, Esc does not", id="say")
        yield Static(_KEYS, id="foot", markup=False)

    def on_mount(self) -> None:
        """Begin to look."""
        self.set_interval(1.0 / _HZ, self.pull)

    def on_resize(self) -> None:
        """Leave the map out where there is no room for it."""
        self.set_class(self.size.width < _NARROW, "-narrow")

    def pull(self) -> None:
        """Take the newest of everything and show it."""
        if not self._seat.there:
            self.ended = True
            self.exit(0)
            return
        view = self._seat.look()
        for answer in self._seat.answers():
            self._note(*_told(answer))
        for answer in view.answers:
            if (kind := self._commands.pop(answer.number, None)) is not None and not answer.ok:
                self._note(Severity.WARNING, answer.text.decode(errors="replace") or f"{kind.name} refused.")
        if view.vehicle is not None and view.vehicle.valid:
            east, north, up, _ = view.vehicle.position
            self._track.add(east, north, up, view.vehicle.t)
        self._history.add(view, self._seat.run.settings.safety.state_stale_s)
        frame = Frame(
            view,
            self._seat.run,
            self._started,
            {},
            None,
            {},
            "",
            tuple(self._notes),
            self._track,
            self._history,
        )
        for instrument in self.query(Instrument):
            instrument.show(frame)

    def action_let(self, key: str) -> None:
        """Let something happen in the strength chosen."""
        offer = next(offer for offer in OFFERS if offer.key == key)
        happening = offer.at(self._choice.strength, self._choice.toward)
        self._note(Severity.INFO, f"Asked for: {words(happening)}.")
        self._seat.ask(happening)

    def action_calm(self) -> None:
        """Take all back."""
        self._note(Severity.INFO, "Asked for: all taken back.")
        self._seat.ask(Calm())

    def action_strength(self, index: int) -> None:
        """Choose how strong."""
        self._choice.strength = index

    def action_turn(self) -> None:
        """Let wind come from the next point of the compass, clockwise."""
        self._choice.toward = (self._choice.toward - math.tau / 8) % math.tau

    def action_command(self, name: str) -> None:
        """Have the vehicle hold or land."""
        kind = CommandKind[name]
        self._commands[self._seat.command(kind)] = kind

    def action_say(self) -> None:
        """Let words be typed."""
        self.query_one("#say").display = True
        self.query_one("#say", Input).focus()

    def action_quiet(self) -> None:
        """Say nothing after all."""
        field = self.query_one("#say", Input)
        field.value = ""
        field.display = False
        self.set_focus(None)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Tell the trainee."""
        if text := event.value.strip():
            self._seat.say(text)
        self.action_quiet()

    def action_view(self) -> None:
        """See the flight from elsewhere."""
        self.query_one(Map).next_sight()

    def action_next_theme(self) -> None:
        """Change to the next theme."""
        self.theme = next_theme(self.theme)

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """List what the keys do by name."""
        del screen
        for offer in OFFERS:
            yield SystemCommand(
                f"{offer.name} ({offer.key})",
                "In the strength chosen.",
                lambda key=offer.key: self.action_let(key),
            )
        yield SystemCommand(
            "Take all back (c)", "Wind and link as before, device and GPS there.", self.action_calm
        )
        yield SystemCommand("Leave (q)", "The flight goes on.", self.exit)

    def _note(self, severity: Severity, text: str) -> None:
        self._notes.append(Note(time.monotonic(), severity, _OURS, text))


def _told(answer: InterventionAnswer) -> tuple[Severity, str]:
    """Return in words what became of something, and how much that matters."""
    happening = unpacked(answer.happening)
    told = words(happening) if happening is not None else "that"
    if answer.ok:
        return Severity.INFO, f"Done: {told}."
    return Severity.WARNING, f"Refused: {told}: {answer.text.decode(errors='replace')}."
