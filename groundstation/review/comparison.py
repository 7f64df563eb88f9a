"""Two flights in one view: a recording of both, on one timeline that begins when the hand was coupled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from groundstation.errors import InputError
from groundstation.recording import palette
from groundstation.recording.item import Chunk, Item, Still, send, time_column
from groundstation.recording.program import optimise
from groundstation.recording.scene import static_scene
from groundstation.recording.schema import APPLICATION, TIMELINE
from groundstation.review.flight import Flight
from groundstation.review.outcome import outcome_of
from groundstation.review.recorded_series import recorded_series
from groundstation.review.series import FlightSeries, Numbers, lengths

_NAMES = ("A", "B")
_COLOURS = (palette.ORANGE, palette.BLUE)
# Where a vehicle's letter stands, m.
_ABOVE = np.array([0.0, 0.0, 0.35])
_CURVES = (
    ("error", "p̃: how far the drone is from the hand, m"),
    ("force", "Force on the hand, N"),
    ("clearance", "Clearance, m"),
    ("target", "To the target, m"),
    ("speed", "Speed, m/s"),
    ("asked", "Speed asked for, m/s"),
)


def write_comparison(paths: Sequence[Path], out: Path) -> None:
    """Write a recording of two flights.

    Args:
        paths: Of the flights.
        out: The recording; it is replaced.

    Raises:
        InputError: A flight cannot be read, or its hand was never coupled, or there is no room to write.
    """
    flights = [Flight(path) for path in paths]
    stream = rr.RecordingStream(APPLICATION, recording_id=f"{paths[0].stem} {paths[1].stem}")
    try:
        stream.save(out, default_blueprint=_blueprint())
    except RuntimeError as error:
        raise InputError(
            f"{out}: cannot be written ({error}); free the disk, or choose another --out."
        ) from error
    for still in static_scene(flights[0].mission):
        # Of the scene only what stands still is of use; what moves is drawn for each flight.
        if "/vehicle" not in still.path:
            send(stream, [still])
    for name, colour, flight in zip(_NAMES, _COLOURS, flights, strict=True):
        series = recorded_series(flight)
        if series is None:
            raise InputError(f"{flight.path}: the hand was never coupled, so there is nothing to compare.")
        send(stream, _items(name, colour, flight, series))
    send(stream, [Still("/about", rr.TextDocument(_page(flights), media_type=rr.MediaType.MARKDOWN))])
    stream.flush(timeout_sec=10.0)
    stream.disconnect()
    optimise(out)


def _items(name: str, colour: palette.Colour, flight: Flight, series: FlightSeries) -> Iterator[Item]:
    """Yield one flight: its way, the vehicle on it, and its curves."""
    times = time_column(series.t)
    places = series.p[:, :3]
    yield Still(f"/world/{name}/way", rr.LineStrips3D([places], colors=[colour], radii=[-1.0]))
    yield Still(f"/world/{name}/vehicle", rr.Points3D.from_fields(colors=[colour], radii=[0.18]))
    yield Still(f"/world/{name}/name", rr.Points3D.from_fields(colors=[colour], radii=[0.01], labels=[name]))
    yield Chunk(f"/world/{name}/vehicle", times, rr.Points3D.columns(positions=places))
    yield Chunk(f"/world/{name}/name", times, rr.Points3D.columns(positions=places + _ABOVE))
    for (curve, _), values in zip(_CURVES, _curves(flight, series), strict=True):
        path = f"/{curve}/{name}"
        yield Still(
            path, rr.SeriesLines(names=[f"{name}: {flight.path.stem}"], colors=[colour], widths=[2.0])
        )
        yield Chunk(path, times, rr.Scalars.columns(scalars=values))


def _curves(flight: Flight, series: FlightSeries) -> Sequence[Numbers]:
    nowhere = np.full(len(series.t), np.nan)
    mission = flight.mission
    to_target = nowhere
    if mission and mission.target:
        to_target = lengths(np.array(mission.target.position) - series.p[:, :3])
    clearance = np.where(np.isfinite(series.clearance), series.clearance, np.nan)
    return (
        lengths(series.error),
        lengths(series.force),
        clearance,
        to_target,
        lengths(series.executed),
        lengths(series.v_ref),
    )


def _blueprint() -> rrb.Blueprint:
    axis = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    plots = [
        rrb.TimeSeriesView(
            contents=[f"/{curve}/**"],
            name=title,
            axis_x=axis,
            plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop, visible=curve == _CURVES[0][0]),
        )
        for curve, title in _CURVES
    ]
    scene = rrb.Spatial3DView(
        origin="/world", name="Both ways", line_grid=rrb.LineGrid3D(spacing=1.0, color=(60, 64, 72))
    )
    left = rrb.Vertical(scene, rrb.TextDocumentView(origin="/about", name="Both flights"), row_shares=[3, 2])
    return rrb.Blueprint(
        rrb.Horizontal(left, rrb.Grid(*plots, grid_columns=2), column_shares=[5, 6]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE),
    )


def _page(flights: Sequence[Flight]) -> str:
    """Return a table with both flights' figures."""
    outcomes = [outcome_of(flight) for flight in flights]
    facts = [flight.properties() for flight in flights]
    rows: list[tuple[str, ...]] = [
        ("flight", *(flight.path.stem for flight in flights)),
        ("pilot", *(str(fact.get("pilot", "")) or "–" for fact in facts)),
        ("mission", *(str(fact.get("mission", "")) or "–" for fact in facts)),
        ("result", *(outcome.result for outcome in outcomes)),
        ("score", *(f"{outcome.score.points:.0f}" if outcome.score else "–" for outcome in outcomes)),
    ]
    for name, title in (
        ("duration", "take-off to landing, s"),
        ("path", "way, m"),
        ("final_error", "to the target, m"),
        ("least_clearance", "least clearance, m"),
        ("max_force", "largest force, N"),
        ("rms_error", "p̃ RMS, m"),
        ("collisions", "collisions"),
    ):
        values = [getattr(outcome.figures, name) if outcome.figures else np.nan for outcome in outcomes]
        rows.append((title, *(f"{value:.3g}" if np.isfinite(value) else "–" for value in values)))
    lines = ["| | A (orange) | B (blue) |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows)]
    if facts[0].get("mission") != facts[1].get("mission"):
        lines.append("\nThe missions differ; the obstacles shown are A's.")
    return "\n".join(lines)
