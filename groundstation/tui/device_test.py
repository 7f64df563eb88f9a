"""`groundstation devices test`: the handle in its workspace, live; axes are moved to try them, forces felt."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import ClassVar

from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Footer, Static

from drivers.device import HapticDevice
from groundstation.devices.loop import DeviceLoop
from groundstation.devices.trial import Outcome, Trial
from groundstation.tui.canvas import Canvas
from groundstation.tui.rows import Row, quantity
from groundstation.tui.theme import STYLES, THEME, Tone
from groundstation.tui.widgets.stick import pads

_FRAMES_HZ = 30.0
_TONES = {Outcome.PASSED: Tone.OK, Outcome.FAILED: Tone.FAULT, Outcome.SKIPPED: Tone.MUTED}
_MARKS = {Outcome.PASSED: "✓", Outcome.FAILED: "✗", Outcome.SKIPPED: "·"}
_CAPTIONS = ("up, and turning as left and right", "forward, left and right")


class DeviceTest(App[int]):
    """Shows a device and leads through its trial; ends with 0 where nothing was wrong, else 1.

    Args:
        loop: The device, going.
        clock: Monotonic seconds.
    """

    TITLE = "device test"
    CSS = """
    Screen { background: $ink; color: $text; }
    #device { height: 2; background: $pane; }
    #workspace { height: 1fr; min-height: 6; }
    #words { height: auto; background: $pane; padding: 0 1; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("y", "answer(True)", "yes"),
        Binding("n", "answer(False)", "no"),
        Binding("s", "skip", "skip this step"),
        Binding("q", "leave", "leave"),
        Binding("ctrl+c,ctrl+q", "leave", "leave", show=False, priority=True),
    ]
    ENABLE_COMMAND_PALETTE = False

    def __init__(self, loop: DeviceLoop, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self.register_theme(THEME)
        self.theme = THEME.name
        self._device = loop
        self._clock = clock
        self._trial: Trial | None = None
        self._rate, self._ticks, self._counted_t = 0.0, 0, clock()

    def compose(self) -> ComposeResult:
        """Device, workspace, words, keys."""
        yield Static(id="device")
        yield Static(id="workspace")
        yield Static(id="words")
        yield Footer()

    def on_mount(self) -> None:
        """Start the frames."""
        self.set_interval(1.0 / _FRAMES_HZ, self.pull)

    def pull(self) -> None:
        """Look at the device and show it."""
        state, info = self._device.state, self._device.keeper.info
        if state is not None and state.homed:
            if self._trial is None:
                self._trial = Trial(info)
                self.refresh_bindings()
                self._device.push = self._trial.push
            step = self._trial.step
            self._trial.look(state)
            if self._trial.step is not step:
                self.refresh_bindings()
        self._count()
        self.query_one("#device", Static).update(_text(self._about()), layout=False)
        workspace = self.query_one("#workspace", Static)
        workspace.update(_text(self._drawn(*workspace.size)), layout=False)
        self.query_one("#words", Static).update(_text(self._words()))

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Grey what means nothing now."""
        step = self._trial.step if self._trial else None
        if action == "answer":
            return True if step is not None and step.felt else None
        if action == "skip":
            return True if step is not None else None
        return super().check_action(action, parameters)

    def action_answer(self, yes: bool) -> None:
        """Answer what is felt."""
        if self._trial:
            self._trial.answer(yes=yes)
            self.refresh_bindings()

    def action_skip(self) -> None:
        """Leave a step out."""
        if self._trial:
            self._trial.skip()
            self.refresh_bindings()

    def action_leave(self) -> None:
        """End, with what was found as exit code."""
        self.exit(0 if self._trial is not None and self._trial.passed else 1)

    def summary(self) -> list[str]:
        """Return what was found, a line a step."""
        results = self._trial.results if self._trial else []
        return [
            f"{step.name}: {outcome.value}{f' ({words})' if words else ''}"
            for step, outcome, words in results
        ]

    def _count(self) -> None:
        now = self._clock()
        if now - self._counted_t >= 1.0:
            self._rate = (self._device.ticks - self._ticks) / (now - self._counted_t)
            self._ticks, self._counted_t = self._device.ticks, now

    def _about(self) -> list[Row]:
        state, info = self._device.state, self._device.keeper.info
        if state is None:
            return [[("▲ ", Tone.WARN), (self._device.words or "Opening the device …", Tone.WARN)]]
        title: Row = [(info.name, Tone.STRONG), (f"  {info.serial}  renders {info.renders}", Tone.MUTED)]
        if not state.homed:
            return [title, [("▲ Not homed: move the handle slowly through its whole travel.", Tone.WARN)]]
        place = "  ".join(
            f"{axis} {quantity(1e3 * value, 'mm', 1, 6, sign=True)}"
            for axis, value in zip("xyz", state.position, strict=True)
        )
        force = quantity(sum(part * part for part in self._device.force) ** 0.5, "N", 1, 4)
        rate = quantity(self._rate, "Hz", 0, 4)
        row: Row = [(f"{place}  yaw {quantity(state.yaw, 'rad', 2, 5, sign=True)}", Tone.TEXT)]
        return [title, [*row, (f"  force {force}  {rate}  buttons {state.buttons:b}", Tone.TEXT)]]

    def _drawn(self, width: int, height: int) -> list[Row]:
        if width < 8 or height < 4:
            return []
        canvas = Canvas(width, height)
        state, info = self._device.state, self._device.keeper.info
        both = pads(width, height)
        for pad, caption in zip(both, _CAPTIONS, strict=True):
            pad.draw(canvas, held=False)
            text = caption[: 2 * pad.columns]
            canvas.letters(pad.column + (pad.columns - len(text)) // 2, pad.rows, text, Tone.MUTED)
        if state is not None and state.homed:
            x, y, z = (value / info.workspace for value in state.position)
            fx, fy, fz = (value / max(info.force_limit, 1e-9) for value in self._device.force)
            for pad, at, pull in zip(both, ((-state.yaw, z), (-y, x)), ((0.0, fz), (-fy, fx)), strict=True):
                pad.arrow(canvas, at, pull)
                pad.knob(canvas, at)
        return canvas.to_rows()

    def _words(self) -> list[Row]:
        if self._trial is None:
            return [[("Waiting for the device.", Tone.MUTED)]]
        done: list[Row] = [
            [(f"{_MARKS[outcome]} {step.name} ", _TONES[outcome]), (words, Tone.MUTED)]
            for step, outcome, words in self._trial.results
        ]
        return [*done, [(self._trial.instruction, Tone.STRONG)]]


def _text(rows: list[Row]) -> Text:
    text = Text(no_wrap=True)
    for number, row in enumerate(rows):
        if number:
            text.append("\n")
        for words, tone in row:
            text.append(words, STYLES[tone])
    return text


def try_out(device: HapticDevice) -> int:
    """Show a device until the person leaves; print what was found; return the exit code."""
    loop = DeviceLoop(device)
    loop.start()
    try:
        app = DeviceTest(loop)
        code = app.run()
    finally:
        loop.stop()
    print(*app.summary(), sep="\n")
    return 1 if code is None else code
