"""A replayed flight as records of the bus, for a recording or a live view."""

from __future__ import annotations

from typing import Any, cast

from drivers.device import DeviceInfo
from groundstation.bus import Bus
from groundstation.evaluation.local_site import LocalSite
from groundstation.evaluation.sample import Sample
from groundstation.frames import body_from_world
from groundstation.messages import (
    DEVICE_REPORT,
    MISSION_PROGRESS,
    VEHICLE_STATE,
    VEHICLE_STATUS,
    DeviceReport,
    FlightMode,
    MissionProgress,
    Phase,
    Record,
    Stream,
    Topic,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.outbox import Outbox, Tick
from groundstation.pilot.sight import ZERO4, VehicleSample
from groundstation.recording.batch import Batch
from groundstation.recording.session import Session
from groundstation.training.director import Director

_BATCH_S = 1.0
_STEP_S, _CUT = 0.02, False
_UNSEEN = VehicleSample(ZERO4, ZERO4)


class Collector:
    """Takes what would go onto the bus into a batch; as much of `Bus` as an outbox needs."""

    def __init__(self) -> None:
        self.batch = Batch()

    def publisher(self, topic: Topic[Any]) -> _Sender:
        """Return a sender for a topic."""
        return _Sender(self, topic)

    def taken(self) -> Batch:
        """Return what was sent since the last time."""
        batch, self.batch = self.batch, Batch()
        return batch


class _Sender:
    def __init__(self, collector: Collector, topic: Topic[Any]) -> None:
        self._collector, self._topic = collector, topic

    def send(self, record: Record) -> None:
        """Keep a copy: an outbox fills its records anew."""
        self._collector.batch.add(self._topic, [type(record).from_buffer_copy(record)])


class ReplayRecorder:
    """An observer of a virtual flight that records it.

    Args:
        session: Where it goes.
        local: The operator's side, to be asked what is chosen and where the vehicle would stop.
        director: Judges how the mission goes.
        device: The handle that is held.
    """

    def __init__(self, session: Session, local: LocalSite, director: Director, device: DeviceInfo) -> None:
        self._session, self._local = session, local
        self._director, self._device = director, device
        self._collector = Collector()
        self._outbox = Outbox(cast(Bus, self._collector))
        self._due = _BATCH_S
        self._reported = False

    def __call__(self, sample: Sample) -> None:
        """Record a sample."""
        t, outputs, phase = sample.t, sample.outputs, sample.phase
        coupled = phase is Phase.ENGAGED
        hand = sample.handle
        self._outbox.handle(t, hand, outputs.force, present=True)
        self._outbox.setpoint(t, outputs.setpoint, t, active=coupled)
        choices = self._local.operator.choices()
        inputs = Inputs(_STEP_S, phase, _CUT, hand, _UNSEEN, sample.state_age, choices=choices)
        tick = Tick(inputs, outputs, self._local.pilot.stop(outputs))
        self._outbox.pilot_state(t, tick, phase, "", centred=True)
        batch = self._collector.batch
        batch.add(VEHICLE_STATE, [_state(sample)])
        batch.add(VEHICLE_STATUS, [_status(sample, coupled=coupled)])
        batch.add(MISSION_PROGRESS, [self._progress(sample, coupled=coupled)])
        batch.add(DEVICE_REPORT, [] if self._reported else [_report(t, self._device)])
        self._reported = True
        if t >= self._due:
            self._due = t + _BATCH_S
            self.flush()

    def flush(self) -> None:
        """Hand over what has come since the last time."""
        self._session.take(self._collector.taken())

    def _progress(self, sample: Sample, *, coupled: bool) -> MissionProgress:
        self._director.vehicle(sample.t, sample.p, in_air=True, armed=True)
        if coupled:
            self._director.controller(sample.outputs.error[:3], sample.outputs.force)
        return self._director.progress(sample.t)


def _report(t: float, device: DeviceInfo) -> DeviceReport:
    return DeviceReport(
        t=t,
        name=device.name.encode(),
        renders=device.renders.encode(),
        workspace=device.workspace,
        force_limit=device.force_limit,
        present=1,
        homed=1,
    )


def _state(sample: Sample) -> VehicleState:
    (forward, left, up, yaw_rate), yaw = sample.v, sample.p[3]
    # Back into the world is on by the other angle.
    x, y, z = body_from_world((forward, left, up), -yaw)
    return VehicleState(t=sample.t, position=sample.p, velocity=(x, y, z, yaw_rate), boot_t=sample.t, valid=1)


def _status(sample: Sample, *, coupled: bool) -> VehicleStatus:
    return VehicleStatus(
        t=sample.t,
        heard_t=sample.t - sample.state_age,
        rtt=sample.round_trip,
        battery=float("nan"),
        voltage=float("nan"),
        connected=1,
        armed=1,
        in_air=1,
        mode=FlightMode.OFFBOARD if coupled else FlightMode.HOLD,
        streaming=Stream.FLYING if coupled else Stream.IDLE,
    )
