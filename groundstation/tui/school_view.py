"""The course with one mission chosen, and what it is about: the same before a flight and beside one."""

from __future__ import annotations

from typing import ClassVar

from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Container, Vertical, VerticalScroll
from textual.message import Message
from textual.theme import Theme
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from groundstation.progress.desk import Desk, Report
from groundstation.tui.course import columns, head, line
from groundstation.tui.screens.dialog import Typed
from groundstation.tui.theme import Tone, styles_of
from groundstation.tui.wish import Wish

_LONGEST_NAME = 40
_LEAST_WIDTH = 40


class SchoolView(Vertical):
    """Shows how a pilot stands, mission by mission.

    Args:
        desk: Knows the pilots.
        pilot: Who is shown first.

    Attributes:
        report: Who is shown.
    """

    # What stands beside what depends on the screen.
    SCOPED_CSS = False
    DEFAULT_CSS = """
    SchoolView { height: 1fr; }
    SchoolView Static { text-wrap: nowrap; text-overflow: ellipsis; }
    SchoolView #standing { height: 2; padding: 0 1; }
    SchoolView #heads { height: 1; padding: 0 2; }
    SchoolView #rooms { height: 1fr; layout: vertical; }
    SchoolView OptionList { height: 1fr; border: round $frame; background: $ink; padding: 0 1; text-wrap: nowrap;
        border-title-color: $muted; }
    SchoolView OptionList:focus { border: round $vehicle; background-tint: $ink 0%; }
    SchoolView OptionList > .option-list--option-highlighted { background: $frame; text-style: none; }
    SchoolView OptionList:focus > .option-list--option-highlighted { background: $frame; text-style: none; }
    SchoolView #about { height: 9; border: round $frame; border-title-color: $muted; background: $ink; padding: 0 1; }
    SchoolView #about:focus { border: round $vehicle; border-title-color: $text; }
    SchoolView #words { height: auto; }
    .-beside SchoolView #rooms { layout: horizontal; }
    .-beside SchoolView #course { width: 58%; height: 1fr; }
    .-beside SchoolView #about { width: 42%; height: 1fr; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("p", "next_pilot", "Next pilot", show=False),
        Binding("a", "new_pilot", "Another pilot", show=False),
    ]

    class Chosen(Message):
        """A mission shall be flown."""

        def __init__(self, wish: Wish) -> None:
            super().__init__()
            self.wish = wish

    def __init__(self, desk: Desk, pilot: str, *, id: str = "school") -> None:  # noqa: A002 - Textual's own name
        super().__init__(id=id)
        self._desk = desk
        self.report: Report = desk.report(pilot)
        self._others: list[str] = []

    def compose(self) -> ComposeResult:
        """Lay out standing, course and what the chosen mission is about."""
        yield Static(id="standing")
        yield Static(id="heads")
        with Container(id="rooms"):
            yield OptionList(id="course")
            with VerticalScroll(id="about"):
                yield Static(id="words", markup=False)

    def on_mount(self) -> None:
        """Show the pilot, with what comes next chosen."""
        self._others = [self.report.pilot] if self.report.pilot else []
        self.query_one("#course", OptionList).focus()
        if self.report.words:
            self.app.notify(self.report.words, severity="warning", timeout=8.0, markup=False)
        self.app.theme_changed_signal.subscribe(self, self._paint)
        self.call_after_refresh(self._paint)

    def on_unmount(self) -> None:
        """The application lives on, and would keep what it calls back."""
        self.app.theme_changed_signal.unsubscribe(self)

    def on_resize(self) -> None:
        """Fit the lines to the new width."""
        self._paint()

    def action_next_pilot(self) -> None:
        """Show the next of the pilots who have flown here."""
        names = sorted({*self._desk.pilots(), *self._others}, key=str.casefold)
        if names:
            at = names.index(self.report.pilot) if self.report.pilot in names else -1
            self._show(names[(at + 1) % len(names)])

    def action_new_pilot(self) -> None:
        """Have a name typed."""
        known = ", ".join(self._desk.pilots())
        words = f"Known here: {known}. Another name begins anew." if known else "Nobody has flown here yet."
        self.app.push_screen(Typed("Who flies?", words, _wrong_name, self.report.pilot), self._typed)

    @on(OptionList.OptionHighlighted, "#course")
    def tell(self) -> None:
        """Tell about the mission that is chosen."""
        name = self.chosen
        about = self.query_one("#about", VerticalScroll)
        if name:
            about.border_title = f"{name}: Enter flies it, Tab reads on"
            width = max(about.size.width - 3, _LEAST_WIDTH)
            self.query_one("#words", Static).update("\n".join(self._desk.briefing(name, width)[2:]))
            about.scroll_home(animate=False)

    @on(OptionList.OptionSelected, "#course")
    def take(self) -> None:
        """Have the chosen mission flown."""
        if self.chosen:
            self.post_message(self.Chosen(Wish(self.chosen, self.report.pilot)))

    @property
    def chosen(self) -> str:
        """Name of the mission that is chosen, or ""."""
        option = self.query_one("#course", OptionList).highlighted_option
        return str(option.id) if option is not None else ""

    def _typed(self, name: str | None) -> None:
        if name:
            known = {each.casefold(): each for each in (*self._desk.pilots(), *self._others)}
            self._others.append(known.get(name.casefold(), name))
            self._show(self._others[-1])

    def _show(self, pilot: str) -> None:
        self.report = self._desk.report(pilot)
        self.query_one("#course", OptionList).clear_options()
        self._paint()

    def _paint(self, _theme: Theme | None = None) -> None:
        """Write all anew; what was chosen stays chosen."""
        styles, course = styles_of(self.app.theme), self.query_one("#course", OptionList)
        standing = self.report.standing
        kept = self.chosen or (standing.next.mission if standing.next else "")
        width = max(course.size.width - 2, 0)
        self.query_one("#standing", Static).update(head(self.report, styles))
        self.query_one("#heads", Static).update(columns(width, styles))
        course.clear_options()
        course.add_options(
            [
                Option(line(record, self.report, width, styles), id=name)
                for name, record in standing.records.items()
            ]
        )
        names = list(standing.records)
        if names:
            course.highlighted = names.index(kept) if kept in names else 0
            self.call_after_refresh(course.scroll_to_highlight)


def keys_line(styles_name: str, keys: tuple[tuple[str, str], ...]) -> Text:
    """Return keys and what they do in a line, in the styles of a theme."""
    styles, text = styles_of(styles_name), Text()
    for key, words in keys:
        text.append(f" {key}", styles[Tone.KEY])
        text.append(f" {words} ", styles[Tone.TEXT])
    return text


def _wrong_name(name: str) -> str:
    if not name:
        return "type a name"
    return "" if len(name) <= _LONGEST_NAME else f"at most {_LONGEST_NAME} letters"
