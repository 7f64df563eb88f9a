"""How numbers and states look in plots: names and colours, logged with the data for every view."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle, islice

import rerun as rr

from groundstation.recording import lanes, palette, schema
from groundstation.recording.item import Still

_WIDTH = 1.5
_COLOURS: dict[str, tuple[palette.Colour, ...]] = {
    **{quantity.path: (palette.REFERENCE,) for quantity in schema.REFERENCES},
    **{quantity.path: (palette.EXECUTED,) for quantity in schema.EXECUTED},
    schema.STATE_AGE.path: (palette.SKY,),
    schema.ROUND_TRIP.path: (palette.ORANGE,),
    schema.HANDLE_AGE.path: (palette.GREEN,),
    schema.SILENCE.path: (palette.PURPLE,),
    schema.RECKONED.path: (palette.YELLOW,),
    schema.SHARES.path: (palette.GREEN, palette.PURPLE),
    schema.PHASE_MARGIN.path: (palette.YELLOW,),
    schema.TARGET_DISTANCE.path: (palette.GREEN,),
    schema.FORCE_SIZE.path: (palette.SKY, palette.VERMILION),
    schema.CLEARANCE.path: (palette.SKY,),
    schema.MARGIN.path: (palette.VERMILION,),
    schema.CUE_SIZES.path: (palette.ORANGE, palette.SKY, palette.GREEN, palette.VERMILION, palette.GREY),
}


def static_styles() -> Iterator[Still]:
    """Yield names and colours of every quantity's series and every lane's states."""
    for quantity in (*schema.QUANTITIES, *schema.GAUGES):
        colours = _COLOURS.get(quantity.path) or tuple(islice(cycle(palette.PARTS), len(quantity.parts)))
        names = [_series_name(quantity, place) for place in range(len(quantity.parts))]
        yield Still(
            quantity.path,
            rr.SeriesLines(colors=list(colours), names=names, widths=[_WIDTH] * len(names)),
        )
    for lane in lanes.LANES:
        words = [word for word, _ in lane.states]
        colours = [palette.TONES[tone] for _, tone in lane.states]
        yield Still(lane.path, rr.StateConfiguration(values=words, labels=words, colors=colours))


def _series_name(quantity: schema.Quantity, place: int) -> str:
    """Return a part's name, with its unit where it is not the one of the parts before it."""
    units = quantity.unit.split(", ")
    part = quantity.parts[place]
    return f"{part}, {units[1]}" if len(units) > 1 and place == len(quantity.parts) - 1 else part
