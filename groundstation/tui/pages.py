"""The screens beside the flight: one table for keys, palette, footer and help."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PageEntry:
    """A screen beside the flight.

    Attributes:
        name: In actions and tests.
        key: The key that opens it, and closes it again; it works while text is typed, too.
        label: Its title.
        explains: One sentence for help and palette.
        screen: Where its class is, as `module:Class` under `groundstation.tui.screens`.
    """

    name: str
    key: str
    label: str
    explains: str
    screen: str

    @property
    def shown(self) -> str:
        """The key as footer, palette and help write it."""
        return self.key.replace("ctrl+", "^").upper()


PAGES = (
    PageEntry(
        "preflight", "f7", "Preflight", "Every check before flying, and what to do.", "preflight:Preflight"
    ),
    PageEntry("debrief", "f8", "Debrief", "What the flight came to; open its recording.", "debrief:Debrief"),
    PageEntry(
        "parameters", "f9", "Parameters", "The vehicle's own: look, search, set.", "parameters:ParametersPage"
    ),
    PageEntry("settings", "f10", "Settings", "Of this program: look, change, save.", "settings:SettingsPage"),
    # No function key is left: F11 is what most terminals fill the whole screen with.
    PageEntry("school", "ctrl+n", "School", "How you come along; fly another mission.", "school:SchoolPage"),
    PageEntry("log", "f12", "Log", "All events, filtered.", "log:Log"),
)
PAGES_BY_NAME = {page.name: page for page in PAGES}
