"""The flight screen: essentials always, more instruments where the terminal is larger."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from textual import events
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.dom import DOMNode
from textual.screen import Screen

from groundstation.tui.acts import ACTS
from groundstation.tui.choices import CHOICES
from groundstation.tui.frame import Frame
from groundstation.tui.hand import Hand
from groundstation.tui.widgets.altitude import Altitude
from groundstation.tui.widgets.attitude import Attitude
from groundstation.tui.widgets.banner import Banner
from groundstation.tui.widgets.curves import Curves
from groundstation.tui.widgets.force import Force
from groundstation.tui.widgets.happenings import Happenings
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.widgets.keys import Keys
from groundstation.tui.widgets.mission import Mission
from groundstation.tui.widgets.numbers import FlightLine, Numbers
from groundstation.tui.widgets.overview import Overview
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
        Binding("v,V", "view", "Next view", show=False),
        Binding("g,G", "follow", "Follow, or whole mission", show=False),
        Binding("plus,equals_sign", "zoom(1)", "Zoom in", show=False),
        Binding("minus,underscore", "zoom(-1)", "Zoom out", show=False),
        Binding("tab", "page(1)", "One instrument, or all", show=False),
        Binding("shift+tab", "page(-1)", "The page before", show=False),
        Binding("enter", "app.acknowledge", "Seen", show=False),
        Binding("u,U", "app.mute", "Bell off or on", show=False),
        Binding("z,Z", "app.theme_next", "Next theme", show=False),
        Binding("question_mark,f1", "app.help", "Help", show=False),
        Binding("q,Q", "app.quit", "Quit", show=False),
    ]


class FlightScreen(Screen[None]):
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
        self._instruments: list[Instrument] = []
        self._latest: Frame | None = None
        self._page = ""

    def compose(self) -> ComposeResult:
        """Lay out the instruments."""
        yield StatusBar(id="status")
        yield FlightLine(id="line")
        yield Banner(id="banner")
        with Horizontal(id="body"):
            with Vertical(id="where"):
                with Horizontal(id="place"):
                    yield self._map
                    yield Altitude(id="altitude")
                with Horizontal(id="below"):
                    yield Attitude(id="attitude")
                    with Vertical(id="course"):
                        yield Mission(id="mission")
                        yield Happenings(id="events")
            with Vertical(id="hand"):
                yield Numbers(id="numbers")
                yield self._stick
                yield Force(id="force")
                yield Tracking(id="tracking")
                yield Velocity(id="velocity")
                yield System(id="system")
            yield Curves(id="curves")
        yield Keys(id="keys")

    def on_mount(self) -> None:
        """Remember the instruments."""
        self._instruments = list(self.query(Instrument))

    def show(self, frame: Frame) -> None:
        """Hand a frame to the instruments that are to be seen."""
        self._latest = frame
        for instrument in self._instruments:
            if instrument.display:
                instrument.show(frame)

    def action_step(self, axis: int, direction: int) -> None:
        """Move the on-screen stick by a step."""
        if self._hand is not None:
            self._hand.step(axis, direction)

    def action_centre(self) -> None:
        """Put the on-screen stick into its centre."""
        self._stick.centre()

    def action_page(self, steps: int = 1) -> None:
        """Show one instrument over the whole body, the next one, or all again."""
        pages = ["", *(name for name in _PAGES if self.query(f"#{name}"))]
        self._page = pages[(pages.index(self._page) + steps) % len(pages)]
        body = self.query_one("#body")
        chosen = set(self.query_one(f"#{self._page}").ancestors_with_self) if self._page else set[DOMNode]()
        body.set_class(bool(self._page), "-alone")
        for part in body.query("*"):
            part.set_class(part in chosen, "-chosen")

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


def reason_for(key: str, hindrances: Mapping[str, str]) -> str:
    """Return why what a key asks for is not possible, or "" where it asks for nothing."""
    for asked in (*ACTS, *CHOICES):
        if key in asked.keys:
            hindrance = hindrances.get(asked.name, "")
            return f"{asked.label}: {hindrance}." if hindrance else ""
    return ""
