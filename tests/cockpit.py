"""The screen with its doubles, for tests that fly it: keys go in, what is shown and what was commanded come out."""

from __future__ import annotations

from contextlib import asynccontextmanager

from canned_flight import (
    NOTHING,
    START,
    CannedFlight,
    CannedReader,
    CannedStick,
    CannedSupervisor,
    canned_run,
)

from groundstation.config import Settings
from groundstation.tui.app import FlightApp
from groundstation.tui.theme import Tone
from groundstation.tui.widgets.instrument import Instrument

# Moments of the canned flight, s: hovering, and led by the hand with nothing near.
AIR, ENGAGED = 4.0, 17.0


class Cockpit:
    """The app with its doubles."""

    def __init__(self, app: FlightApp, pilot, reader: CannedReader, stick: CannedStick) -> None:
        self.app, self.pilot, self.reader, self.stick = app, pilot, reader, stick

    async def press(self, *keys: str) -> None:
        await self.pilot.press(*keys)
        await self.pilot.pause()

    async def see(self) -> None:
        """Draw what is shown now, whatever rate an instrument is usually drawn at."""
        for _ in range(15):
            self.app.pull()
        await self.pilot.pause()

    def text(self, selector: str) -> str:
        """Return what an instrument shows."""
        instrument = self.app._flight.query_one(selector, Instrument)
        return "\n".join(instrument.render_line(y).text for y in range(instrument.size.height))

    def sent(self):
        """Return what the keepalive sends now."""
        self.app._send_stick()
        return self.stick.sent[-1]

    def note(self, selector: str) -> str:
        """Return what stands in an instrument's lower border."""
        return str(self.app._flight.query_one(selector, Instrument).border_subtitle)

    def tones(self, selector: str) -> dict[str, Tone]:
        """Return the runs of text that an instrument shows, with their tones."""
        rows = self.app._flight.query_one(selector, Instrument)._rows
        return {text.strip(): tone for row in rows for text, tone in row}

    def notices(self) -> list[str]:
        return [notification.message for notification in self.app._notifications]


@asynccontextmanager
async def cockpit(
    seconds: float | None = ENGAGED,
    *,
    size=(80, 24),
    simulated=True,
    stick=True,
    delay: float = 0.0123,
    settings: Settings | None = None,
    **states: str,
):
    """Run the screen at a moment of the canned flight; None: before anything came."""
    run = canned_run(simulated=simulated, settings=settings)
    flight = CannedFlight(run, delay)
    if seconds:
        flight.advance(seconds)
    reader = CannedReader(NOTHING if seconds is None else flight.snapshot())
    sender = CannedStick()
    app = FlightApp(run, reader, CannedSupervisor(**states), sender if stick else None, clock=lambda: START)
    async with app.run_test(size=size, notifications=True) as pilot:
        scene = Cockpit(app, pilot, reader, sender)
        await scene.see()
        yield scene
