"""Tells how far an evaluation is: a bar on a terminal, else a line now and then."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import Self, TextIO

_LINE_EVERY_S = 10.0


class Progress:
    """A context in which results are told as they come.

    Args:
        total: How many flights there are.
        done: How many of them were flown before.
        out: Where to; colours as NO_COLOR and the terminal have it.
        clock: Monotonic seconds.
    """

    def __init__(
        self, total: int, done: int, out: TextIO, clock: Callable[[], float] = time.monotonic
    ) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        self._total, self._done = total, done
        self._completed = self._flown = 0.0
        self._out, self._clock = out, clock
        self._began = self._told_t = clock()
        console = Console(file=out)
        self._bar = Bar(
            TextColumn("flights"),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TextColumn("{task.fields[pace]}"),
            TimeRemainingColumn(),
            console=console,
            expand=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("flights", total=total, completed=done, pace="")
        self._quiet = not console.is_terminal

    def __enter__(self) -> Self:
        """Show it."""
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take it away."""
        self._bar.stop()

    def add(self, flown: float) -> None:
        """Tell of one more flight, which took so many virtual seconds."""
        self._done += 1
        self._flown += flown
        now = self._clock()
        pace = f"{self._flown / max(now - self._began, 1e-9):.0f} × real time"
        self._bar.update(self._task, advance=1, pace=pace)
        if self._quiet and (now - self._told_t >= _LINE_EVERY_S or self._done == self._total):
            self._told_t = now
            self._out.write(f"{self._done}/{self._total} flights, {pace}\n")
            self._out.flush()
