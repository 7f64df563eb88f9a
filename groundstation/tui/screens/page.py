"""What all screens beside the flight share: status above, urgent keys below, what is going on in between."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, cast

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Input

from groundstation.tui.acts import URGENT
from groundstation.tui.frame import Frame
from groundstation.tui.lines import Lines
from groundstation.tui.widgets.banner import Banner
from groundstation.tui.widgets.instrument import Instrument
from groundstation.tui.widgets.page_keys import PageKeys
from groundstation.tui.widgets.status import StatusBar

if TYPE_CHECKING:
    from groundstation.tui.app import FlightApp

_MOVES = (
    ("up", -1),
    ("down", 1),
    ("pageup", -10),
    ("pagedown", 10),
    ("home", -1_000_000),
    ("end", 1_000_000),
)


def _bindings() -> list[BindingType]:
    acts = [
        Binding(key, f"letter('{key}', '{act.name}')", act.label, show=False)
        for act in URGENT
        for key in act.keys
    ]
    moves = [Binding(key, f"move({by})", "Move", show=False) for key, by in _MOVES]
    return [
        *acts,
        *moves,
        Binding("escape", "back", "Back to the flight", show=False),
        Binding("question_mark", "app.help", "Help", show=False),
        Binding("q,Q", "app.quit", "Quit", show=False),
    ]


class Page(Screen[None]):
    """A screen beside the flight: subclass it and yield its parts from `parts`.

    Attributes:
        NAME: As in `groundstation.tui.pages`.
        OWN_KEYS: Its own keys and what they do, for its footer.
    """

    NAME: ClassVar[str] = ""
    OWN_KEYS: ClassVar[tuple[tuple[str, str, str], ...]] = ()
    ALLOW_SELECT = False
    # A text field takes keys only once it is asked for.
    AUTO_FOCUS = ""
    BINDINGS: ClassVar[list[BindingType]] = _bindings()

    def __init__(self) -> None:
        super().__init__()
        self._instruments: list[Instrument] = []
        self.lines: Lines | None = None
        # The field that words are typed into, from the key that opens it until it is left.
        self._typing: Input | None = None

    @property
    def flight(self) -> FlightApp:
        """The application, which knows of the flight."""
        return cast("FlightApp", self.app)

    def parts(self) -> Iterator[Widget]:
        """Yield what the page consists of."""
        raise NotImplementedError

    def compose(self) -> ComposeResult:
        """Lay out status, the page's parts, and its keys."""
        yield StatusBar(id="status")
        yield Banner(id="banner")
        with Vertical(id="page"):
            yield from self.parts()
        yield PageKeys(self.NAME, self.OWN_KEYS, id="keys")

    def on_mount(self) -> None:
        """Remember what is to be painted."""
        self._instruments = list(self.query(Instrument))
        lists = [each for each in self._instruments if isinstance(each, Lines)]
        # Of several the keys move the one in which a line is chosen.
        self.lines = next((each for each in lists if each.chooses), lists[0] if lists else None)

    def show(self, frame: Frame) -> None:
        """Hand a frame to the page's parts."""
        for instrument in self._instruments:
            if instrument.display:
                instrument.show(frame)

    def action_move(self, by: int) -> None:
        """Move through the list, if there is one."""
        if self.lines is not None:
            self.lines.move(by)

    def type_into(self, field: Input) -> None:
        """Let words be typed into a field."""
        field.display = True
        self._typing = field
        self.set_focus(field)

    def type_no_more(self) -> None:
        """Leave the field; it stays in sight while there is something in it."""
        if self._typing is not None:
            self._typing.display = bool(self._typing.value)
        self._typing = None
        self.set_focus(None)

    def action_letter(self, key: str, name: str) -> None:
        """Do an urgent act; a letter that was typed before its field had the focus belongs to the field."""
        if self._typing is not None:
            self._typing.insert_text_at_cursor(key)
        else:
            self.flight.action_act(name)

    def action_back(self) -> None:
        """Go back to the flight."""
        self.flight.action_fly()
