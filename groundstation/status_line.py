"""How long work is going: on a terminal one line that changes, else a line for what is begun."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self, TextIO

from groundstation.terminal import can_redraw

_CLEAR = "\r\x1b[K"
# More often nobody reads it, s.
_EVERY_S = 0.2


class StatusLine:
    """A line that tells how it is going; at the end of a `with` block it is gone.

    Args:
        out: Where to.
        clock: Monotonic seconds.

    Attributes:
        live: It is a terminal on which a line can change.
    """

    def __init__(self, out: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._out, self._clock = out, clock
        self.live = out.isatty() and can_redraw(os.environ)
        self._next = -float("inf")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def tell(self, words: str) -> None:
        """Tell what is begun."""
        self._write(f"{_CLEAR}{words}" if self.live else f"{words}\n")

    def step(self, words: str) -> None:
        """Tell how far it is: on a terminal only, and not too often."""
        if self.live and (now := self._clock()) >= self._next:
            self._next = now + _EVERY_S
            self._write(f"{_CLEAR}{words}")

    def note(self, words: str) -> None:
        """Say something that stays."""
        self._write(f"{_CLEAR}{words}\n" if self.live else f"{words}\n")

    def close(self) -> None:
        """End the changing line."""
        if self.live:
            self._write(_CLEAR)

    def _write(self, text: str) -> None:
        self._out.write(text)
        self._out.flush()
