"""Keys let go, where the terminal reports it: the Kitty protocol's event types, which Textual does not ask for.

A release comes as a key event of its own, named `release_` and the key, so that it can be bound like any other. A
terminal that reports none sends none: there a step stays until it is taken back. Source: the protocol's description,
sw.kovidgoyal.net/kitty/keyboard-protocol, "Progressive enhancement" and "Event types".
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from textual import events
from textual._xterm_parser import XTermParser
from textual.driver import Driver
from textual.drivers import linux_driver
from textual.drivers.linux_driver import KITTY_REPORT_EVENT_TYPES, LinuxDriver

PREFIX = "release_"
_TYPED = re.compile(r"(\x1b\[[\d:]*;\d*):([123])((?:;[\d:]*)?[u~A-S])")
_ASKED = re.compile(r"\x1b\[>(\d+)u")
_RELEASE = "3"


class ReleaseParser(XTermParser):
    """Reads key events with their type: releases get a name of their own, repeats are presses."""

    def _sequence_to_key_events(self, sequence: str, alt: bool = False) -> Iterable[events.Key]:
        typed = _TYPED.fullmatch(sequence)
        if typed is None:
            yield from super()._sequence_to_key_events(sequence, alt)
            return
        for key in super()._sequence_to_key_events(typed[1] + typed[3], alt):
            if typed[2] == _RELEASE:
                # Shift may have been let go first: it is the key that counts.
                yield events.Key(PREFIX + key.key.rpartition("+")[2], None)
            else:
                yield key


class ReleaseDriver(LinuxDriver):
    """Asks the terminal for releases, too, and goes on in good order after SIGSTOP."""

    def _sigcont_application(self, *_: object) -> None:
        """Take the terminal anew.

        After SIGSTOP, of which no word comes, it was never given up. To take it a second time would leave two threads
        that read its keys, and at the end a terminal as the program had it and not the shell.
        """
        if self._must_signal_resume:
            super()._sigcont_application()
        elif self._auto_restart:
            # Not in the signal's handler: it may have come in the midst of writing.
            self._loop.call_soon_threadsafe(self._take_anew)

    def _take_anew(self) -> None:
        self.suspend_application_mode()
        self.resume_application_mode()
        self._app.refresh()

    def write(self, data: str) -> None:
        """Write to the terminal; where Textual asks for its keyboard protocol, ask for event types as well."""
        super().write(_ASKED.sub(_with_event_types, data) if data.startswith("\x1b[>") else data)

    def run_input_thread(self) -> None:
        """Read keys by the parser above: the driver makes its own out of its module."""
        linux_driver.XTermParser = ReleaseParser  # pyright: ignore[reportPrivateImportUsage]
        super().run_input_thread()


def _with_event_types(asked: re.Match[str]) -> str:
    return f"\x1b[>{int(asked[1]) | KITTY_REPORT_EVENT_TYPES}u"


def driver_for(usual: type[Driver]) -> type[Driver]:
    """Return the driver to use in place of Textual's: only a terminal on Linux has another."""
    return ReleaseDriver if usual is LinuxDriver else usual
