"""What moves in the scene: the vehicle and where it will be, the hand's p_h, the leash between, and the force."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
import rerun as rr

from groundstation.messages import HANDLE, PILOT_STATE, VEHICLE_STATE, Phase
from groundstation.recording import entities
from groundstation.recording.batch import Batch
from groundstation.recording.columns import Rows, rows_in, rows_of
from groundstation.recording.item import Chunk, Numbers, time_column

# States in a strip: short enough to grow smoothly, long enough to keep a long flight's trail cheap.
_STRIP = 5
_STILL_M = 0.01


class Trail:
    """A way flown as short strips, so that the viewer shows as much of it as has been flown.

    Args:
        path: Entity.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._points: list[list[float]] = []

    def lift(self) -> None:
        """End the line here; the next point starts a new one."""
        self._points.clear()

    def add(self, times: Numbers, points: Numbers) -> Iterator[Chunk]:
        """Yield the strips that a batch completes; points that hardly differ from the one before add nothing.

        Args:
            times: (n,), s on the timeline.
            points: (n, 3), world, m.
        """
        ends: list[float] = []
        strips: list[list[list[float]]] = []
        for t, point in zip(times.tolist(), points.tolist(), strict=True):
            if self._points and _near(point, self._points[-1]):
                continue
            self._points.append(point)
            if len(self._points) > _STRIP:
                ends.append(t)
                strips.append(self._points.copy())
                del self._points[:-1]
        if strips:
            lines = rr.LineStrips3D.columns(strips=np.array(strips, np.float32))
            yield Chunk(self._path, time_column(np.array(ends)), lines)


def _near(one: Sequence[float], other: Sequence[float]) -> bool:
    return all(abs(a - b) < _STILL_M for a, b in zip(one, other, strict=True))


class Motion:
    """Turns vehicle and pilot records into moving geometry.

    Args:
        start: Monotonic time that is 0 on the timeline, s.
        heading: The handle's axes turn with the vehicle (`mapping.frame`), so the force on it does too.
    """

    def __init__(self, start: float, *, heading: bool) -> None:
        self._start = start
        self._heading = heading
        self._vehicle_trail = Trail(entities.VEHICLE_TRAIL)
        self._hand_trail = Trail(entities.HAND_TRAIL)
        self._force = np.zeros((1, 3))
        self._force_t = np.zeros(1)

    def chunks(self, batch: Batch) -> Iterator[Chunk]:
        """Yield a batch's motion."""
        if states := [state for state in batch.of(VEHICLE_STATE) if state.valid]:
            yield from self._vehicle(rows_of(states))
        if batch.of(HANDLE):
            rows = rows_in(batch, HANDLE)
            self._force_t = np.concatenate((self._force_t[-1:], rows["t"]))
            self._force = np.concatenate((self._force[-1:], rows["force"]))
        if batch.of(PILOT_STATE):
            yield from self._hand(rows_in(batch, PILOT_STATE))

    def _vehicle(self, rows: Rows) -> Iterator[Chunk]:
        times, position = time_column(rows["t"], self._start), rows["position"]
        pose = rr.Transform3D.columns(
            translation=position[:, :3], quaternion=quaternions(rows["roll"], rows["pitch"], position[:, 3])
        )
        yield Chunk(entities.VEHICLE_POSE, times, pose)
        ground = position[:, :3] * (1.0, 1.0, 0.0)
        plumbs = _strips(position[:, :3], ground)
        yield Chunk(entities.PLUMB, times, rr.LineStrips3D.columns(strips=plumbs))
        yield from self._vehicle_trail.add(rows["t"] - self._start, position[:, :3])

    def _hand(self, rows: Rows) -> Iterator[Chunk]:
        """Yield what holds while engaged; in rows that are not engaged it is empty, which clears it."""
        engaged = rows["phase"] == Phase.ENGAGED
        column = time_column(rows["t"], self._start)
        lengths = engaged.astype(np.int32)
        shown = rows[engaged]
        hand, seen = shown["p_h"][:, :3], (shown["p_h"] - shown["error"])[:, :3]
        force = self._world_force(shown) * entities.ARROW_M_PER_N
        leashes = _strips(seen, hand)
        yield Chunk(entities.HAND, column, rr.Points3D.columns(positions=hand).partition(lengths))
        yield Chunk(entities.LEASH, column, rr.LineStrips3D.columns(strips=leashes).partition(lengths))
        arrows = rr.Arrows3D.columns(origins=seen, vectors=force).partition(lengths)
        yield Chunk(entities.FORCE_ARROW, column, arrows)
        predicted, stop = shown["predicted"][:, :3], shown["stop"]
        prospects = _strips(seen, predicted, stop)
        for path, points in ((entities.PREDICTED, predicted), (entities.STOP, stop)):
            yield Chunk(path, column, rr.Points3D.columns(positions=points).partition(lengths))
        yield Chunk(entities.PROSPECT, column, rr.LineStrips3D.columns(strips=prospects).partition(lengths))
        if not engaged.all():
            self._hand_trail.lift()
        if len(shown):
            yield from self._hand_trail.add(shown["t"] - self._start, hand)

    def _world_force(self, rows: Rows) -> Numbers:
        """Return the force last rendered on the hand at each row, (n, 3), world, N."""
        newest = np.searchsorted(self._force_t, rows["t"], side="right") - 1
        force = self._force[np.maximum(newest, 0)]
        turn = (rows["p_h"] - rows["error"])[:, 3] if self._heading else np.zeros(len(rows))
        cosine, sine = np.cos(turn), np.sin(turn)
        x, y = force[:, 0], force[:, 1]
        return np.column_stack((cosine * x - sine * y, sine * x + cosine * y, force[:, 2]))


def _strips(*points: Numbers) -> npt.NDArray[np.float32]:
    """Return a strip a row through points, (n, 3) each, as one (n, points, 3) array: Rerun loops over lists."""
    return np.stack(points, axis=1, dtype=np.float32)


def quaternions(roll: Numbers, pitch: Numbers, yaw: Numbers) -> npt.NDArray[np.float64]:
    """Return attitudes R = R_z(yaw) R_y(pitch) R_x(roll) as quaternions [x, y, z, w].

    Args:
        roll: (n,), about the vehicle's x (forward), rad.
        pitch: (n,), about y (left), rad.
        yaw: (n,), about z, counter-clockwise from east, rad.
    """
    (cr, sr), (cp, sp), (cy, sy) = (_halves(angle) for angle in (roll, pitch, yaw))
    return np.column_stack(
        (
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        )
    )


def _halves(angle: Numbers) -> Sequence[Numbers]:
    return np.cos(angle / 2), np.sin(angle / 2)
