"""Keys that work on every screen besides the urgent acts and the pages; help lists them too."""

from __future__ import annotations

from textual.binding import Binding

KEYS = (
    Binding("o,O", "app.acknowledge", "Alarms seen", show=False),
    Binding("b,B", "app.mute", "Bell on/off", show=False),
    Binding("ctrl+t", "app.next_theme", "Next theme", show=False, priority=True),
)
