"""Dialogs over the flight: they stand over the events, hide no essentials, and let urgent acts through."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from groundstation.tui.acts import ACTS, BY_NAME
from groundstation.tui.everywhere import KEYS


def _urgent() -> list[BindingType]:
    return [
        Binding(",".join(act.keys), f"urgent('{act.name}')", act.label, show=False)
        for act in ACTS
        if act.urgent
    ]


class Dialog(ModalScreen[bool]):
    """What all dialogs share: Escape leaves, an urgent act leaves and is done."""

    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "answer(False)", "Back", show=False),
        *_urgent(),
        *KEYS,
    ]

    def action_answer(self, yes: bool) -> None:
        """Leave with an answer."""
        self.dismiss(yes)

    async def action_urgent(self, name: str) -> None:
        """Leave, and do what cannot wait."""
        self.dismiss(result=False)
        await self.app.run_action(f"app.act('{name}')")


class Confirm(Dialog):
    """Asks back before an act.

    Args:
        question: What is asked.
        consequence: What happens then.
        key: The key that says yes, besides y; "" for none.
        within: It is taken back by itself after this, s; 0 for never.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("y,Y", "answer(True)", "Yes", show=False),
        Binding("n,N", "answer(False)", "No", show=False),
    ]

    def __init__(self, question: str, consequence: str, key: str = "", within: float = 0.0) -> None:
        super().__init__()
        self._question, self._consequence, self._key, self._within = question, consequence, key, within
        if key:
            self._bindings.bind(key, "answer(True)", "Yes", show=False)

    def on_mount(self) -> None:
        """Let the question run out where it does."""
        if self._within:
            self.set_timer(self._within, self._run_out)

    def _run_out(self) -> None:
        if self.is_current:
            self.app.notify(f"{self._question} Not confirmed: nothing was done.", timeout=3.0, markup=False)
            self.dismiss(result=False)

    def asks_for(self, name: str) -> bool:
        """Say whether it is this act that is asked about."""
        return self._question.startswith(BY_NAME[name].label)

    async def action_urgent(self, name: str) -> None:
        """Do another act at once; the one that is asked about waits for its answer."""
        if not self.asks_for(name):
            await super().action_urgent(name)

    def compose(self) -> ComposeResult:
        """Lay out question, consequence and keys."""
        with Vertical(id="dialog"):
            yield Static(f"▲ {self._question}", id="question", markup=False)
            yield Static(self._consequence, id="consequence", markup=False)
            yes = f"{self._key} again or y" if self._key else "y"
            limit = f"      within {self._within:.0f} s" if self._within else ""
            yield Static(f"{yes}  yes      n or Esc  no{limit}", id="answers", markup=False)


class Typed(ModalScreen[str | None]):
    """Asks for something that is typed: no key that slips does it.

    Args:
        question: What is asked.
        consequence: What happens then.
        wrong: Says of what was typed why it will not do, or "".
        value: To begin with.
    """

    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", "Back", show=False)]

    def __init__(self, question: str, consequence: str, wrong: Callable[[str], str], value: str = "") -> None:
        super().__init__()
        self._question, self._consequence, self._wrong, self._value = question, consequence, wrong, value

    def compose(self) -> ComposeResult:
        """Lay out question, consequence and the field."""
        with Vertical(id="dialog"):
            yield Static(f"▲ {self._question}", id="question", markup=False)
            yield Static(self._consequence, id="consequence", markup=False)
            yield Input(self._value, id="typed", select_on_focus=False)
            yield Static("Enter  yes      Esc  no", id="answers", markup=False)

    @on(Input.Submitted)
    def take(self, event: Input.Submitted) -> None:
        """Take what was typed, or say why not."""
        typed = event.value.strip()
        if why := self._wrong(typed):
            self.query_one("#answers", Static).update(f"▲ {why}")
        else:
            self.dismiss(typed)

    def action_leave(self) -> None:
        """Leave without."""
        self.dismiss(None)
