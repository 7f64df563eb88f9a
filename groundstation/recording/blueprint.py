"""The layout in which a recording opens: scene and events on the left, plots on the right, states below."""

from __future__ import annotations

from collections.abc import Iterable

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.api import VisualizerLike
from rerun.blueprint.encodings import TextLogColumn
from rerun.encodings import EntityPathLike

from groundstation.recording import entities, lanes, palette, schema
from groundstation.recording.scene import extent
from groundstation.training.mission import Mission

_WHOLE_WAY = rrb.VisibleTimeRanges(
    timeline=schema.TIMELINE,
    start=rrb.TimeRangeBoundary.infinite(),
    end=rrb.TimeRangeBoundary.cursor_relative(),
)
Overrides = dict[EntityPathLike, VisualizerLike | Iterable[VisualizerLike]]
_TRAILS: Overrides = {
    entities.VEHICLE_TRAIL: _WHOLE_WAY,
    entities.HAND_TRAIL: _WHOLE_WAY,
    entities.INCIDENTS: _WHOLE_WAY,
    entities.LOSSES: _WHOLE_WAY,
}
_AXIS = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
# Rerun shows them by their paths' alphabet.
_HAPPENED = (
    lanes.ALERT, lanes.GUARD, lanes.INTERVENTION, lanes.MODE, lanes.PHASE, lanes.POINTS, lanes.STAGE, lanes.VEHICLE,
)  # fmt: skip
# The velocities share their colours: one legend is enough.
_FIRST = "Forward velocity"
# From above: what is shown around a mission, m, and how wide and deep an eye sees, m a metre of its height.
_AROUND_M = 4.0
_SEEN_WIDE, _SEEN_DEEP = 1.5, 0.9
_BACKGROUND: palette.Colour = (20, 23, 28)
_GRID = (120, 128, 140, 90)


def blueprint(mission: Mission | None) -> rrb.Blueprint:
    """Return the layout.

    Args:
        mission: What the camera must have in view; None for free flight.
    """
    left = rrb.Vertical(
        rrb.Tabs(_scene(mission), _chase(), _above(mission), active_tab=0),
        rrb.Tabs(
            _events(), rrb.TextDocumentView(origin=entities.ABOUT, name="About this flight"), active_tab=0
        ),
        row_shares=[5, 2],
    )
    right = rrb.Tabs(_flight(), _velocity(), _hand(), _feel(), _machinery(), active_tab=0)
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(left, right, column_shares=[5, 6]),
            _states("What happened", *_HAPPENED),
            row_shares=[20, 10],
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=schema.TIMELINE),
    )


def _scene(mission: Mission | None) -> rrb.Spatial3DView:
    low, high = extent(mission)
    middle = (low + high) / 2
    size = max(float((high - low)[:2].max()), 6.0)
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(middle[0] - 0.3 * size, middle[1] - 0.75 * size, middle[2] + 0.4 * size),
        look_target=tuple(middle),
        eye_up=(0, 0, 1),
    )
    return _space(f"Scene (force: {entities.ARROW_M_PER_N} m/N)", eye)


def _above(mission: Mission | None) -> rrb.Spatial3DView:
    low, high = extent(mission)
    middle = (low + high) / 2
    wide, deep = (high - low)[:2] + _AROUND_M
    height = max(wide / _SEEN_WIDE, deep / _SEEN_DEEP)
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(middle[0], middle[1], middle[2] + height),
        look_target=tuple(middle),
        eye_up=(0, 1, 0),
    )
    return _space("From above", eye)


def _chase() -> rrb.Spatial3DView:
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(-6.0, -2.5, 3.2),
        look_target=(0, 0, 0),
        eye_up=(0, 0, 1),
        tracking_entity=entities.CHASED,
    )
    return _space("Chase", eye)


def _space(name: str, eye: rrb.EyeControls3D) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin=entities.WORLD,
        name=name,
        overrides=_TRAILS,
        background=rrb.Background(color=_BACKGROUND),
        line_grid=rrb.LineGrid3D(spacing=1.0, color=_GRID),
        eye_controls=eye,
    )


def _events() -> rrb.TextLogView:
    columns = [
        TextLogColumn("loglevel"),
        TextLogColumn("body"),
    ]
    return rrb.TextLogView(
        origin=entities.EVENTS, name="Events", columns=rrb.TextLogColumns(text_log_columns=columns)
    )


def _states(name: str, *shown: lanes.Lane) -> rrb.StateTimelineView:
    return rrb.StateTimelineView(contents=[lane.path for lane in shown], name=name, time_view=_AXIS)


def _plot(
    name: str, *paths: str, legend: bool = True, overrides: Overrides | None = None
) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        contents=list(paths),
        name=name,
        axis_x=_AXIS,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop, visible=legend),
        overrides=overrides,
    )


def _flight() -> rrb.Grid:
    delay = (schema.STATE_AGE, schema.ROUND_TRIP, schema.HANDLE_AGE)
    return rrb.Grid(
        _plot("Position error p̃, m (yaw, rad: purple)", schema.ERROR.path, legend=False),
        _plot("To the target, m", schema.TARGET_DISTANCE.path, legend=False),
        _plot("Force on the hand, N", schema.HANDLE_FORCE.path),
        _plot("How hard, and the limit, N", schema.FORCE_SIZE.path),
        *_velocities()[:2],
        _plot("Delay, s", *(quantity.path for quantity in delay)),
        _plot("Clearance, and the margin, m", schema.CLEARANCE.path, schema.MARGIN.path),
        grid_columns=2,
        name="Flight",
    )


def _velocities() -> list[rrb.TimeSeriesView]:
    return [
        _plot(f"{title}, {reference.unit}", reference.path, executed.path, legend=title == _FIRST)
        for title, reference, executed in zip(
            (_FIRST, "Left velocity", "Up velocity", "Yaw rate"),
            schema.REFERENCES,
            schema.EXECUTED,
            strict=True,
        )
    ]


def _velocity() -> rrb.Grid:
    return rrb.Grid(
        *_velocities(),
        _guarded("Forward: asked (orange), guarded (red), flown", 0),
        _guarded("Left: asked (orange), guarded (red), flown", 1),
        grid_columns=2,
        name="Velocity",
    )


def _hand() -> rrb.Grid:
    return rrb.Grid(
        _plot("Handle's position, m", schema.HANDLE_POSITION.path),
        _plot("Handle's velocity, m/s", schema.HANDLE_VELOCITY.path),
        _plot("Force on the hand, N", schema.HANDLE_FORCE.path),
        _plot("Force cue of equation (5), N", schema.FORCE_CUE.path),
        _plot("p_h: where the hand wants it, m", schema.P_H.path),
        _plot("Drone's position, m", schema.POSITION.path),
        grid_columns=2,
        name="Hand",
    )


def _feel() -> rrb.Vertical:
    plots = rrb.Grid(
        _plot("Force by cue, N", schema.CUE_SIZES.path),
        _plot("Guidance to the mission's way, N", schema.GUIDANCE_CUE.path),
        _plot("Energy of the hand's port, J", schema.HANDLE_ENERGY.path),
        _plot("K₁ in effect, 1/s, and phase margin, rad", schema.K1.path, schema.PHASE_MARGIN.path),
        _plot("Round trip, s, and what it leaves, share", schema.RECKONED.path, schema.SHARES.path),
        grid_columns=2,
    )
    states = _states("Compensation, handle, preset", lanes.COMPENSATION, lanes.MAPPING, lanes.PRESET)
    return rrb.Vertical(plots, states, row_shares=[5, 2], name="Feel")


def _guarded(name: str, axis: int) -> rrb.TimeSeriesView:
    """Show one axis of v_ref and v_safe, which is the guard's doing, and what the vehicle makes of it."""
    visible = [place == axis for place in range(len(schema.V_REF.parts))]
    overrides: Overrides = {
        quantity.path: rr.SeriesLines(
            names=list(quantity.parts), colors=[colour] * len(visible), visible_series=visible
        )
        for quantity, colour in ((schema.V_REF, palette.REFERENCE), (schema.V_SAFE, palette.VERMILION))
    }
    paths = (schema.V_REF.path, schema.V_SAFE.path, schema.EXECUTED[axis].path)
    # What is hidden would stand in the legend all the same.
    return _plot(name, *paths, legend=False, overrides=overrides)


def _machinery() -> rrb.Vertical:
    plots = rrb.Grid(
        _plot("Servo's lateness, s", schema.SERVO_LATE.path),
        _plot("Servo's longest parts of a tick, s", schema.SERVO_TIME.path),
        _plot("Frames lost, share, and silence, s", schema.LOSS.path, schema.SILENCE.path),
        _plot("Setpoint frames at the gate", schema.GATE.path),
        _plot("Seen by the vehicle's sensors, m", schema.RANGES.path),
        _plot("Push the model does not know, m/s²", schema.PUSH.path),
        _plot("Battery, share", schema.BATTERY.path),
        _plot("Time between heartbeats, s", f"{schema.PROCESSES}/**"),
        grid_columns=2,
    )
    states = _states("Device, setpoint stream", lanes.DEVICE_STATE, lanes.STREAM)
    return rrb.Vertical(plots, states, row_shares=[5, 2], name="Machinery")
