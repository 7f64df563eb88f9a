"""The line of words: what is wrong, or what to do next."""

from __future__ import annotations

from groundstation.messages import Severity
from groundstation.tui.alerts import worst
from groundstation.tui.frame import Frame
from groundstation.tui.rows import Row, fit
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

_LOOKS = {
    Severity.INFO: (" › ", Tone.NOTE),
    Severity.WARNING: (" ▲ CAUTION  ", Tone.CAUTION),
    Severity.ALARM: (" ■ ALARM  ", Tone.ALARM),
}


class Banner(Instrument):
    """One line over the whole width."""

    EVERY = 3

    def draw(self, frame: Frame, width: int, height: int) -> list[Row]:
        """Draw the worst alert, or the next step."""
        del height
        severity, text = worst(frame)
        mark, tone = _LOOKS[severity]
        return [fit([(mark, tone), (text, tone), (" " * width, tone)], width)]
