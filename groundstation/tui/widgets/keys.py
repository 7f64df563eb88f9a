"""The footer: which keys choose and do what, with what is chosen; a click does the same as the key."""

from __future__ import annotations

from collections.abc import Iterator

from textual import events

from groundstation.messages import CommandKind, Cue, MappingMode, PilotState, Preset
from groundstation.pilot.presets import PRESETS
from groundstation.tui.acts import ACTS
from groundstation.tui.choices import CHOICES, CUES, Choice, in_effect
from groundstation.tui.cues import Part, parts
from groundstation.tui.frame import Frame
from groundstation.tui.pages import PAGES
from groundstation.tui.rows import Row, Span, width_of
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

Item = tuple[Row, str]

_OTHERS = (("?", "Help", "app.help"), ("q", "Quit", "app.quit"))
# The first are written even where there is little room.
_LOOKS = (
    ("v", "View", "screen.view"),
    ("+", "Zoom", "screen.zoom(1)"),
    ("g", "Follow", "screen.follow"),
    ("⇥", "Instrument", "screen.page(1)"),
    ("o", "Seen", "app.acknowledge"),
    ("b", "Bell", "app.mute"),
    ("^t", "Theme", "app.next_theme"),
)
# From here on words are written in full.
_FULL = 110
_SHORT = 3


class Keys(Instrument):
    """A line of choices with what is in effect, and a line of acts."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw as many keys a line as there is room for."""
        del height
        return [[span for spans, _ in line for span in spans] for line in _lines(frame, width)]

    async def on_click(self, event: events.Click) -> None:
        """Do what the key under the pointer does."""
        if self._frame is None:
            return
        start = 0
        for spans, action in _lines(self._frame, self.size.width)[event.y]:
            end = start + width_of(spans)
            if start <= event.x < end and action:
                await self.run_action(action)
                return
            start = end


def _lines(frame: Frame, width: int) -> tuple[list[Item], list[Item]]:
    return _fitting(_choices(frame, full=width >= _FULL), width), _fitting(_acts(frame), width)


def _fitting(items: Iterator[Item], width: int) -> list[Item]:
    fitting: list[Item] = []
    for item in items:
        room = width - width_of(item[0])
        if room >= 0:
            fitting.append(item)
            width = room
    return fitting


def _acts(frame: Frame) -> Iterator[Item]:
    for act in ACTS:
        # Disarm shares the place of Arm: one of the two is always impossible.
        hidden = "disarm" if frame.hindrances["disarm"] else "arm"
        if act.name == hidden:
            continue
        possible = not frame.hindrances[act.name]
        yield _act(act.key, act.label, possible=possible), f"app.act('{act.name}')"
    pages = ((page.shown, page.label, f"app.page('{page.name}')") for page in PAGES)
    for key, label, action in (*_OTHERS, *pages, *_LOOKS):
        yield _act(key, label, possible=True), action


def _act(key: str, label: str, *, possible: bool) -> Row:
    if not possible:
        return [(f" {key} {label}", Tone.FAINT)]
    return [(f" {key}", Tone.KEY), (f" {label}", Tone.TEXT)]


def _choices(frame: Frame, *, full: bool) -> Iterator[Item]:
    pilot = frame.pilot
    cues = {part.name: part for part in parts(pilot, guided=frame.guided)} if pilot else {}
    for choice in CHOICES:
        if choice is CUES[Cue.GUIDANCE] and not frame.guided:
            continue
        words = choice.name if full or choice.kind is not CommandKind.CUES else choice.name[:_SHORT]
        if pilot is None:
            row: Row = [(f" {choice.key} {words}", Tone.FAINT)]
        else:
            shown = (
                _part(cues[choice.name], words)
                if choice.name in cues
                else _in_effect(choice, pilot, full=full)
            )
            row = [(f" {choice.key}", Tone.KEY), (" ", Tone.TEXT), shown]
        yield row, f"app.choose('{choice.name}')"
    if pilot is not None and pilot.compensated:
        yield [("  compensated", Tone.OK)], ""


def _in_effect(choice: Choice, pilot: PilotState, *, full: bool) -> Span:
    """Return what is chosen in a word: what is unusual stands out."""
    value = in_effect(choice.kind, pilot)
    if choice.kind is CommandKind.MAPPING:
        return MappingMode(value).name.lower(), Tone.STRONG
    if choice.kind is CommandKind.FINE:
        return (" FINE ", Tone.CHIP_HAND) if value else ("coarse", Tone.TEXT)
    if choice.kind is CommandKind.CLUTCH:
        return (" CLUTCH ", Tone.CAUTION) if value else ("clutch", Tone.TEXT)
    name = Preset(value).name.lower()
    if PRESETS[Preset(value)].guard:
        return name, Tone.STRONG
    return f"▲{name}{', no guard' if full else ''}", Tone.WARN


def _part(part: Part, words: str) -> Span:
    """Return a cue: in capitals while it acts, with a sign where it takes no part."""
    if part.acts:
        return words.upper(), Tone.FORCE
    if part.on and part.weighted:
        return words, Tone.TEXT
    return f"{part.mark}{words}", Tone.MUTED
