"""What happened when: the states of the flight as bars, warnings, alarms and the operator's acts as marks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from groundstation.recording.lanes import Lane, Tone
from groundstation.report.figures import style
from groundstation.review.flight import Line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import FigureBase

HEIGHT = 3.4
_COLOURS: dict[Tone, style.Colour] = {
    Tone.IDLE: (0.90, 0.90, 0.91),
    Tone.WORKING: (0.76, 0.86, 0.93),
    Tone.GOOD: (0.75, 0.89, 0.82),
    Tone.WARNING: (0.97, 0.86, 0.68),
    Tone.FAULT: (0.93, 0.72, 0.63),
}
# A word needs some room, as a share of the whole time.
_ROOM = 0.011
Changes = Sequence[tuple[float, str]]


def draw(on: FigureBase, states: Sequence[tuple[Lane, Changes]], events: Sequence[Line], end: float) -> None:
    """Draw lanes of states above the events.

    Args:
        on: Where, empty.
        states: Lanes with their changes: when, s, and to what.
        events: All of them.
        end: Of the flight, s.
    """
    axes = on.subplots()
    names = [lane.path.rpartition("/")[2] for lane, _ in states]
    for row, (lane, changes) in enumerate(states):
        _lane(axes, row, lane, changes, end)
    rows = len(states)
    for place, (name, marker, colour, chosen) in enumerate(
        (
            ("acts", "|", style.TEXT, [event for event in events if event.source == "commands"]),
            ("warnings", "^", style.HAND, [event for event in events if event.level == "WARN"]),
            ("alarms", "X", style.BAR, [event for event in events if event.level == "ERROR"]),
        )
    ):
        names.append(name)
        times = [event.t for event in chosen]
        axes.plot(times, [rows + place] * len(times), marker, color=colour, markersize=6, linestyle="none")
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(0.0, max(end, 1.0))
    axes.set_xlabel("time since the start, s")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)


def _lane(axes: Axes, row: int, lane: Lane, changes: Changes, end: float) -> None:
    tones = dict(lane.states)
    ends = [t for t, _ in changes[1:]] + [end]
    for (start, word), stop in zip(changes, ends, strict=True):
        colour = _COLOURS[tones.get(word, Tone.IDLE)]
        axes.barh(
            row, stop - start, left=start, height=0.78, color=colour, edgecolor="white", linewidth=style.HAIR
        )
        if stop - start > _ROOM * len(word) * end:
            axes.text(start + 0.003 * end, row, word, va="center", fontsize=style.SMALL, clip_on=True)
