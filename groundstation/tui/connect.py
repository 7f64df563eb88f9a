"""Connect: which vehicle, simulated or real, which haptic device, which mission. Then the flight starts.

What is looked for is looked for in a thread of its own; nothing is spoken to, let alone flown, before Enter.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from typing import ClassVar, NamedTuple

from rich.text import Text
from textual import on, work
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from drivers.discovery import Found
from groundstation.config import Buttons
from groundstation.connections import Connection
from groundstation.errors import InputError
from groundstation.tui.buttons import button_map
from groundstation.tui.screens.dialog import Typed
from groundstation.tui.theme import STYLES, THEME, Tone
from groundstation.vehicle.finding import Place
from groundstation.vehicle.transport import parse_url

_SIM, _OTHER = "sim", "other"
_EVERY_S = 3.0
_LISTS = ("vehicle", "device", "mission")


class Chosen(NamedTuple):
    """What was chosen, as for the command line; `connect` "" is the simulated vehicle."""

    connect: str
    device: str
    mission: str

    def command(self) -> str:
        """Write the command that does the same."""
        words = ["groundstation", *(("--connect", self.connect) if self.connect else ("--sim",))]
        words += ["--device", self.device] if self.device else []
        words += ["--mission", self.mission] if self.mission else []
        return shlex.join(words)


class Offers(NamedTuple):
    """What can be chosen from.

    Attributes:
        places: Looks for vehicles; takes a second or two.
        devices: Looks for haptic devices; takes up to a second.
        missions: Name and title of each.
        recent: The last connections, newest first.
        buttons: What the device's buttons do.
    """

    places: Callable[[], Sequence[Place]]
    devices: Callable[[], Sequence[Found]]
    missions: Sequence[tuple[str, str]]
    recent: Sequence[Connection]
    buttons: Buttons


class Connect(App[Chosen]):
    """Ends with what was chosen, or with None.

    Args:
        offers: What can be chosen from.
        device, mission: Chosen to begin with, as for the command line.
    """

    TITLE = "groundstation"
    ENABLE_COMMAND_PALETTE = False
    CSS = """
    Screen { background: $ink; color: $text; }
    #title, #command, #keys { height: 1; background: $pane; padding: 0 1; }
    #buttons { height: 1; padding: 0 1; color: $muted; }
    #lists { height: 1fr; }
    OptionList { border: round $frame; border-title-color: $muted; background: $ink; height: 1fr; padding: 0 1; }
    OptionList:focus { border: round $vehicle; border-title-color: $text; background-tint: $ink 0%; }
    OptionList > .option-list--option-highlighted { background: $frame; color: $text; text-style: none; }
    #vehicle { height: 1fr; }
    .-wide #vehicle { width: 56%; height: 100%; }
    #rest { height: 1.3fr; layout: vertical; }
    .-wide #rest { width: 44%; height: 100%; }
    .-narrow #lists { layout: vertical; }
    Typed { background: transparent; align: left bottom; }
    #dialog { width: 64; height: auto; margin: 0 0 1 0; padding: 0 1; background: $pane; border: heavy $warn; }
    #question { color: $warn; text-style: bold; }
    #answers { color: $muted; }
    #typed { height: 3; border: round $vehicle; background: $ink; }
    """
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (110, "-wide")]  # noqa: RUF012 - Textual's
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", "Next list", show=False),
        Binding("o", "other", "Another address", show=False),
        Binding("u", "look", "Look again", show=False),
        Binding("q,escape", "leave", "Leave", show=False),
        Binding("ctrl+c,ctrl+q", "leave", "Leave", show=False, priority=True),
    ]

    def __init__(self, offers: Offers, *, device: str = "", mission: str = "") -> None:
        super().__init__()
        self.register_theme(THEME)
        self.theme = THEME.name
        self._offers, self._device, self._mission = offers, device, mission
        self._other = ""
        self._places: Sequence[Place] = ()

    def compose(self) -> ComposeResult:
        """Lay out the three lists, and what the choice amounts to."""
        yield Static(Text("groundstation   what shall be flown?", STYLES[Tone.STRONG]), id="title")
        with Horizontal(id="lists"):
            yield OptionList(id="vehicle")
            with Vertical(id="rest"):
                yield OptionList(id="device")
                yield OptionList(id="mission")
        yield Static(id="buttons", markup=False)
        yield Static(id="command", markup=False)
        yield Static(_keys(), id="keys")

    def on_mount(self) -> None:
        """Offer what is known at once, and begin to look for the rest."""
        for name, title in zip(_LISTS, ("vehicle", "haptic device", "mission"), strict=True):
            self.query_one(f"#{name}", OptionList).border_title = title
        missions = [
            _option("", "none: free flight"),
            *(_mission(*each) for each in self._offers.missions),
        ]
        self._fill("mission", missions, self._mission)
        self._show_places(())
        self._show_devices(())
        words = ", ".join(
            f"{number} {each.partition(',')[0]}" for number, each in button_map(self._offers.buttons)
        )
        self.query_one("#buttons", Static).update(f"buttons of the device: {words}")
        self.query_one("#vehicle", OptionList).focus()
        self.action_look()
        self.set_interval(_EVERY_S, self._listen)

    def action_look(self) -> None:
        """Look for vehicles and devices."""
        self._listen()
        self._look_for_devices()

    @work(thread=True, exclusive=True, group="places")
    def _listen(self) -> None:
        self.call_from_thread(self._show_places, self._offers.places())

    @work(thread=True, exclusive=True, group="devices")
    def _look_for_devices(self) -> None:
        self.call_from_thread(self._show_devices, self._offers.devices())

    def _show_places(self, places: Sequence[Place]) -> None:
        self._places = places
        options = [_option(_SIM, "simulated vehicle", "○ SIM ", Tone.SIMULATED)]
        options += [_place(place) for place in places]
        known = {place.url for place in places}
        options += [
            _option(each.url, f"last flown {each.day}", "■ REAL", Tone.REAL, each.url)
            for each in self._offers.recent
            if each.url not in known
        ]
        if self._other:
            options.append(_option(self._other, "as typed", "■ REAL", Tone.REAL, self._other))
        options.append(_option(_OTHER, "another address …  (o)", "■ REAL", Tone.REAL))
        self._fill("vehicle", options, self._other)

    def _show_devices(self, devices: Sequence[Found]) -> None:
        options = [_option("", "On-screen stick: mouse and keys, renders nothing")]
        options += [_device(device) for device in devices]
        if self._device and all(option.id != self._device for option in options):
            options.append(_option(self._device, f"{self._device}  as asked for"))
        self._fill("device", options, self._device)

    def _fill(self, name: str, options: list[Option], wanted: str) -> None:
        """Show a list's options; what was chosen stays chosen."""
        shown = self.query_one(f"#{name}", OptionList)
        kept = self._chosen(name) if shown.option_count else wanted
        shown.clear_options()
        shown.add_options(options)
        ids = [_id(option) for option in options]
        shown.highlighted = ids.index(kept) if kept in ids else 0
        # Before it is laid out there is nowhere to scroll to.
        self.call_after_refresh(shown.scroll_to_highlight)
        self._tell()

    def _chosen(self, name: str) -> str:
        option = self.query_one(f"#{name}", OptionList).highlighted_option
        return _id(option) if option is not None else ""

    @on(OptionList.OptionHighlighted)
    def _tell(self) -> None:
        real = self._chosen("vehicle") not in (_SIM, "")
        text = Text(" ■ REAL " if real else " ○ SIM ", STYLES[Tone.REAL if real else Tone.SIMULATED])
        text.append(f"  {self.choice().command()}", STYLES[Tone.TEXT])
        self.query_one("#command", Static).update(text)

    def choice(self) -> Chosen:
        """Return what is chosen now."""
        vehicle = self._chosen("vehicle")
        connect = "" if vehicle == _SIM else "…" if vehicle == _OTHER else vehicle
        return Chosen(connect, self._chosen("device"), self._chosen("mission"))

    @on(OptionList.OptionSelected)
    def take(self) -> None:
        """Start; first ask for the address where it is another one."""
        if self._chosen("vehicle") == _OTHER:
            self.action_other()
        else:
            self.exit(self.choice())

    def action_other(self) -> None:
        """Ask for an address."""
        words = "udpin://HOST:PORT, udpout://HOST:PORT, tcpout://HOST:PORT or serial:///dev/PORT:BAUD"
        self.push_screen(
            Typed("Where is the vehicle?", words, _wrong_url, "udpin://0.0.0.0:14540"), self._typed
        )

    def _typed(self, url: str | None) -> None:
        if url is not None:
            self._other = url
            self.query_one("#vehicle", OptionList).clear_options()
            self._show_places(self._places)

    def action_leave(self) -> None:
        """Start nothing."""
        self.exit(None)


def _wrong_url(text: str) -> str:
    try:
        parse_url(text)
    except InputError as error:
        return str(error)
    return ""


def _id(option: Option) -> str:
    # An option's id is not to be empty: what stands for nothing asked for is "-".
    return "" if option.id in (None, "-") else str(option.id)


def _option(name: str, words: str, chip: str = "", tone: Tone = Tone.TEXT, strong: str = "") -> Option:
    text = Text(no_wrap=True, overflow="ellipsis")
    if chip:
        text.append(f" {chip} ", STYLES[tone])
        text.append(" ")
    if strong:
        text.append(f"{strong}  ", STYLES[Tone.STRONG])
    text.append(words, STYLES[Tone.MUTED if strong else Tone.TEXT])
    return Option(text, id=name or "-")


def _place(place: Place) -> Option:
    option = _option(place.url, place.words, "■ REAL", Tone.REAL, place.url)
    if place.heard:
        option.prompt.append("  ✓", STYLES[Tone.OK])  # pyright: ignore[reportAttributeAccessIssue] - it is a Text
    return option


def _device(device: Found) -> Option:
    where = f" at {device.port}" if device.port else ""
    if not device.usable:
        text = Text(f"▲ {device.name}{where}: {device.why}; {device.remedy}", STYLES[Tone.MUTED])
        return Option(text, id=f"no {device.uri}", disabled=True)
    renders = "no force" if device.renders == "nothing" else device.renders
    return _option(device.uri, f"{device.name}{where}: {renders}, {device.rate:.0f} Hz")


def _mission(name: str, title: str) -> Option:
    return _option(name, title, strong=name)


def _keys() -> Text:
    text = Text()
    for key, words in (
        ("↑↓", "choose"), ("Tab", "next list"), ("Enter", "start"), ("o", "another address"),
        ("u", "look again"), ("q", "leave"),
    ):  # fmt: skip
        text.append(f" {key}", STYLES[Tone.KEY])
        text.append(f" {words} ", STYLES[Tone.TEXT])
    return text
