"""How hard was it? Six scales to be answered in a few keys, or not at all."""

from __future__ import annotations

from typing import ClassVar

import msgspec
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Static

from groundstation.training.workload import HIGHEST, SCALES, STEP, Scale, Workload, moved

_NAME = 12
_KEYS = "↑↓ scale   ←→ answer   Enter saves   Esc skips"


class WorkloadForm(ModalScreen[Workload | None]):
    """Asks for the six scales of the NASA-TLX; gives them, or None where they were skipped."""

    ALLOW_SELECT = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up,shift+tab", "choose(-1)", "Scale before", show=False),
        Binding("down,tab", "choose(1)", "Next scale", show=False),
        Binding("left", "answer(-1)", "Less", show=False),
        Binding("right", "answer(1)", "More", show=False),
        Binding("pageup", "answer(-4)", "Much less", show=False),
        Binding("pagedown", "answer(4)", "Much more", show=False),
        Binding("enter", "save", "Save", show=False),
        Binding("escape", "skip", "Skip", show=False),
    ]

    def __init__(self) -> None:
        super().__init__()
        self._workload = Workload()
        self._at = 0

    def compose(self) -> ComposeResult:
        """Lay out the question, the scales and the keys."""
        with Vertical(id="dialog"):
            yield Static("How hard was this flight? (NASA-TLX)", id="question", markup=False)
            yield Static(id="consequence", markup=False)
            for scale in SCALES:
                yield Static(id=f"scale-{scale.name}", markup=False)
            yield Static(_KEYS, id="answers", markup=False)

    def on_mount(self) -> None:
        """Show what is answered from the beginning."""
        self._show()

    def action_choose(self, by: int) -> None:
        """Go to another scale."""
        self._at = (self._at + by) % len(SCALES)
        self._show()

    def action_answer(self, steps: int) -> None:
        """Change the answer of the scale."""
        name = SCALES[self._at].name
        answer = moved(getattr(self._workload, name), steps)
        self._workload = msgspec.structs.replace(self._workload, **{name: answer})
        self._show()

    def action_save(self) -> None:
        """Leave with the answers."""
        self.dismiss(self._workload)

    def action_skip(self) -> None:
        """Leave without."""
        self.dismiss(None)

    def _show(self) -> None:
        chosen = SCALES[self._at]
        self.query_one("#consequence", Static).update(f"{chosen.asks}\n0 {chosen.low}, 100 {chosen.high}")
        for scale in SCALES:
            row = self.query_one(f"#scale-{scale.name}", Static)
            row.set_class(scale is chosen, "-here")
            row.update(_row(scale, getattr(self._workload, scale.name), here=scale is chosen))


def _row(scale: Scale, value: int, *, here: bool) -> str:
    steps, place = HIGHEST // STEP, value // STEP
    strip = "".join("●" if cell == place else "━" if cell < place else "─" for cell in range(steps + 1))
    return f"{'▸' if here else ' '} {scale.name:<{_NAME}}{strip} {value:3d}"
