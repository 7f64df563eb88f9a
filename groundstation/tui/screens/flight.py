"""The flight screen: essentials always, more instruments where the terminal is larger."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

from textual import events
from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.screen import Screen
from textual.widget import Widget

from groundstation.tui.acts import ACTS
from groundstation.tui.choices import CHOICES
from groundstation.tui.frame import Frame
from groundstation.tui.hand import Hand
from groundstation.tui.widgets.altitude import Altitude
from groundstation.tui.widgets.attitude import Attitude
from groundstation.tui.widgets.banner import Banner
from groundstation.tui.widgets.composed import Across, Composed, Down
from groundstation.tui.widgets.curves import Curves
from groundstation.tui.widgets.force import Force
from groundstation.tui.widgets.happenings import Happenings
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.widgets.keys import Keys
from groundstation.tui.widgets.mission import Mission
from groundstation.tui.widgets.numbers import FlightLine, Numbers
from groundstation.tui.widgets.overview import Overview
from groundstation.tui.widgets.pages import ALL, NAMES, Pages
from groundstation.tui.widgets.status import StatusBar
from groundstation.tui.widgets.stick import FORWARD, LEFT, UP, YAW, Stick
from groundstation.tui.widgets.system import System
from groundstation.tui.widgets.tracking import Tracking
from groundstation.tui.widgets.velocity import Velocity

# Key, axis, direction, and what it moves; steps stay until they are taken back or the stick is centred.
STEPS: tuple[tuple[str, int, int, str], ...] = (
    ("up", FORWARD, 1, "forward"),
    ("down", FORWARD, -1, "back"),
    ("left", LEFT, 1, "left"),
    ("right", LEFT, -1, "right"),
    ("w", UP, 1, "up"),
    ("s", UP, -1, "down"),
    ("a", YAW, 1, "turn left"),
    ("d", YAW, -1, "turn right"),
)


# One instrument at a time, in this order.
_PAGES = (
    "map",
    "mission",
    "attitude",
    "numbers",
    "stick",
    "force",
    "tracking",
    "velocity",
    "curves",
    "system",
    "events",
)


def _bindings() -> list[BindingType]:
    acts = [Binding(",".join(act.keys), f"app.act('{act.name}')", act.label, show=False) for act in ACTS]
    choices = [
        Binding(",".join(choice.keys), f"app.choose('{choice.name}')", choice.label, show=False)
        for choice in CHOICES
    ]
    steps = [
        Binding(key, f"step({axis}, {direction})", f"Stick {words}", show=False)
        for key, axis, direction, words in STEPS
    ]
    return [
        *acts,
        *choices,
        *steps,
        Binding("space,0", "centre", "Stick to the centre", show=False),
        Binding("tab", "page(1)", "Next instrument", show=False, priority=True),
        Binding("shift+tab", "page(-1)", "Instrument before", show=False, priority=True),
        Binding("v,V", "view", "Next view", show=False),
        Binding("g,G", "follow", "Follow, or whole mission", show=False),
        Binding("plus,equals_sign", "zoom(1)", "Zoom in", show=False),
        Binding("minus,underscore", "zoom(-1)", "Zoom out", show=False),
        Binding("question_mark,f1", "app.help", "Help", show=False),
        Binding("q,Q", "app.quit", "Quit", show=False),
    ]


class FlightScreen(Screen[None], Composed):  # pyright: ignore[reportIncompatibleMethodOverride] - Textual's
    """The instruments, laid out once and then only painted.

    Args:
        hand: The on-screen stick's deflection, or None where another device is in use.
    """

    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = _bindings()
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-normal"), (170, "-wide")]  # noqa: RUF012 - Textual's
    VERTICAL_BREAKPOINTS = [(0, "-short"), (36, "-tall"), (52, "-high")]  # noqa: RUF012 - Textual's

    def __init__(self, hand: Hand | None) -> None:
        super().__init__()
        self._hand = hand
        self._stick = Stick(hand, id="stick")
        self._map = Overview(id="map")
        self._pages = Pages(self.show_page, id="pages")
        self._instruments: list[Instrument] = []
        self._shown: list[Instrument] = []
        self._latest: Frame | None = None

    def compose(self) -> ComposeResult:
        """Lay out the instruments."""
        yield StatusBar(id="status")
        yield FlightLine(id="line")
        yield Banner(id="banner")
        yield self._pages
        with Across(id="body"):
            with Down(id="where"):
                with Across(id="place"):
                    yield self._map
                    yield Altitude(id="altitude")
                with Across(id="below"):
                    yield Attitude(id="attitude")
                    yield Happenings(id="events")
            with Down(id="hand"):
                yield Numbers(id="numbers")
                yield self._stick
                yield Force(id="force")
                yield Tracking(id="tracking")
                yield Velocity(id="velocity")
                yield System(id="system")
            with Down(id="story"):
                yield Mission(id="mission")
                yield Curves(id="curves")
        yield Keys(id="keys")

    def on_mount(self) -> None:
        """Remember the instruments, and show the one that was asked for before they were there."""
        self._instruments = list(self.query(Instrument))
        self._make_room(self._pages.page)

    def show(self, frame: Frame) -> None:
        """Hand a frame to the instruments that are to be seen."""
        self._latest = frame
        self._shown = self._shown or [instrument for instrument in self._instruments if _seen(instrument)]
        for instrument in self._shown:
            instrument.show(frame)

    def action_step(self, axis: int, direction: int) -> None:
        """Move the on-screen stick by a step."""
        if self._hand is not None:
            self._hand.step(axis, direction)

    def action_centre(self) -> None:
        """Put the on-screen stick into its centre."""
        self._stick.centre()

    def action_page(self, steps: int) -> None:
        """Give the body to the next instrument, or to all of them."""
        self.show_page(self._pages.after(steps))

    def show_page(self, name: str) -> None:
        """Give the body to one instrument, or to all that there is room for."""
        self._pages.page = name
        # On a slow machine keys come before the instruments do.
        if self._instruments:
            self._make_room(name)

    def _make_room(self, name: str) -> None:
        self.set_class(name != ALL, "-solo")
        for widget in self.query("#body *"):
            widget.remove_class("-here")
        if name != ALL:
            for widget in self.query_one(f"#{name}").ancestors_with_self:
                widget.set_class(isinstance(widget, Widget) and widget is not self, "-here")
        # The map's altitude stays beside it.
        self.query_one("#altitude").set_class(name == "map", "-here")
        self.call_after_refresh(self._look_again)

    def on_resize(self) -> None:
        """The terminal has another size."""
        self.call_after_refresh(self._look_again)

    def _look_again(self) -> None:
        """Find out anew which instruments have a place on the screen."""
        self._shown = []
        if self._latest is not None:
            self.show(self._latest)

    def commands(self) -> Iterator[SystemCommand]:
        """List what this screen can do, for the palette."""
        yield SystemCommand("Next view of the map (v)", "Above, side, chase, first person.", self.action_view)
        yield SystemCommand("Follow or whole (g)", "The map follows the vehicle.", self.action_follow)
        yield SystemCommand("Zoom in (+)", "Nearer.", lambda: self.action_zoom(1))
        yield SystemCommand("Zoom out (-)", "Further away.", lambda: self.action_zoom(-1))
        for name in NAMES:
            title = f"Show {name} (tab)"
            words = (
                "As many instruments as there is room for." if name == ALL else "With all the room there is."
            )
            yield SystemCommand(title, words, lambda name=name: self.show_page(name))

    def action_view(self) -> None:
        """See the flight from the next place."""
        self._map.next_sight()

    def action_follow(self) -> None:
        """Follow the vehicle with the map, or show the whole mission."""
        self._map.follow_or_whole()

    def action_zoom(self, steps: int) -> None:
        """Go nearer, or further away."""
        self._map.zoom(steps)

    def let_go(self) -> None:
        """Let go of the on-screen stick, so that it moves the vehicle no more."""
        self._stick.let_go()

    def on_screen_suspend(self) -> None:
        """A dialog comes up: no hand moves the vehicle meanwhile."""
        self.let_go()

    def on_key(self, event: events.Key) -> None:
        """Say why a key does nothing now."""
        reason = reason_for(event.key, self._latest.hindrances if self._latest else {})
        if reason:
            self.notify(reason, timeout=3.0)
            event.stop()


def _seen(instrument: Instrument) -> bool:
    """Say whether an instrument has a place on the screen now."""
    return all(widget.display for widget in instrument.ancestors_with_self if isinstance(widget, Widget))


def reason_for(key: str, hindrances: Mapping[str, str]) -> str:
    """Return why what a key asks for is not possible, or "" where it asks for nothing."""
    for asked in (*ACTS, *CHOICES):
        if key in asked.keys:
            hindrance = hindrances.get(asked.name, "")
            return f"{asked.label}: {hindrance}." if hindrance else ""
    return ""
