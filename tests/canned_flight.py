"""A flight along the paper's mission, computed by its equations in virtual time, as records of the bus.

For tests of the screen and for its pictures: real records, no processes, the same every time.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from groundstation.config import Settings
from groundstation.console import Snapshot
from groundstation.frames import body_from_world, wrap
from groundstation.messages import (
    Autopilot,
    CommandAnswer,
    CommandKind,
    DeviceReport,
    Event,
    FlightMode,
    Handle,
    MissionProgress,
    Phase,
    PilotState,
    Preset,
    ServoReport,
    Setpoint,
    Severity,
    Stream,
    VehicleState,
    VehicleStatus,
)
from groundstation.pilot.choices import ALL_CUES
from groundstation.run import Run
from groundstation.training.attempts import Attempts
from groundstation.training.director import Director
from groundstation.training.judgement import Judgement, judgement_of
from groundstation.training.measurer import Measurer
from groundstation.training.mission import MISSIONS_FOLDER, load_mission
from groundstation.training.score import Score, score_of
from groundstation.training.sights import Sights
from sim.environment.world import World

START = 1000.0
STEP_S = 0.02
ENGAGED_S = 6.0
STIFFNESS = 4.0
GAIN = 1.2
LAG_S = 0.45
WIND = (0.25, -0.45, 0.05)
NEAR_M = 1.2
NOTHING = Snapshot(START, None, None, None, None, None, None, None, None, None, (), ())


def canned_run(*, simulated: bool = True, settings: Settings | None = None, mission: bool = True) -> Run:
    """Return a run of the paper's mission with the on-screen stick."""
    path = MISSIONS_FOLDER / "paper.toml"
    return Run(
        run_id="1-canned",
        url="udpin://127.0.0.1:14540" if simulated else "serial:///dev/ttyUSB0:57600",
        simulated=simulated,
        device="virtual:/tmp/groundstation-1-canned/hand.sock",
        mission=load_mission(path) if mission else None,
        mission_path=str(path) if mission else "",
        settings=settings or Settings(),
        log="logs/2026-11-22_10-00-00_paper",
        viewer_url="",
        started="2026-11-22T10:00:00.000+00:00",
    )


class CannedFlight:
    """The flight; `advance` goes on, `snapshot` tells where it is.

    The hand leads along the mission's route, the vehicle follows with a lag in a wind; near obstacles the guard acts.

    Args:
        run: With the mission.
        delay: Round trip, s.
    """

    def __init__(self, run: Run, delay: float = 0.0123) -> None:
        assert run.mission is not None
        assert run.mission.target is not None
        self._points = [*run.mission.route, run.mission.target.position]
        self._world = World(run.mission.obstacle)
        self._delay = delay
        self._climb_to = run.mission.takeoff_altitude_m
        self.elapsed = 0.0
        self._p = [0.0, 0.0, 0.0, 0.15]
        self._v = [0.0, 0.0, 0.0, 0.0]
        self._p_h = [0.0, 0.0, 0.0, 0.15]
        self._rate = [0.0, 0.0, 0.0, 0.0]
        self._leg = 0

    @property
    def engaged(self) -> bool:
        """The hand leads."""
        return self.elapsed >= ENGAGED_S

    def advance(self, seconds: float) -> None:
        """Go on for a while."""
        for _ in range(round(seconds / STEP_S)):
            self._tick()

    def _tick(self) -> None:
        self.elapsed += STEP_S
        goal = self._points[self._leg] if self.engaged else (0.0, 0.0, self._climb_to)
        way = [goal[i] - self._p_h[i] for i in range(3)]
        distance = math.hypot(*way)
        if self.engaged and distance < 0.3 and self._leg < len(self._points) - 1:
            self._leg += 1
        speed = min(1.0, distance) * (0.9 + 0.2 * math.sin(self.elapsed))
        pull = STEP_S / 0.6
        for i in range(3):
            wanted = speed * way[i] / max(distance, 1e-6)
            self._rate[i] += pull * (wanted - self._rate[i])
        turn = wrap(math.atan2(way[1], way[0]) - self._p_h[3]) if self.engaged and distance > 0.5 else 0.0
        self._rate[3] = max(-0.6, min(0.6, turn))
        for i in range(4):
            self._p_h[i] += STEP_S * self._rate[i]
            asked = self._rate[i] + GAIN * math.tanh(self._p_h[i] - self._p[i])
            wind = WIND[i] * (1 + math.sin(0.7 * self.elapsed + i)) if i < 3 and self.elapsed > 2.0 else 0.0
            self._v[i] += STEP_S / LAG_S * (asked + wind - self._v[i])
            self._p[i] += STEP_S * self._v[i]

    def _error(self) -> list[float]:
        return [self._p_h[i] - self._p[i] for i in range(4)]

    def snapshot(self) -> Snapshot:
        """Return all records as of now."""
        t = START + self.elapsed
        error = self._error()
        ahead, left, _ = body_from_world((self._v[0], self._v[1], self._v[2]), self._p[3])
        return Snapshot(
            t=t,
            handle=self._handle(t, error),
            setpoint=self._setpoint(t, error),
            pilot=self._pilot(t, error),
            vehicle=VehicleState(
                t=t - 0.012, position=tuple(self._p), velocity=tuple(self._v), roll=-0.1 * left, pitch=0.1 * ahead,
                boot_t=60.0 + self.elapsed, valid=1,
            ),
            ranges=None,
            status=self._status(t),
            servo=ServoReport(
                t=t - 0.3, rate=1000.0, late_p50=24e-6, late_p99=118e-6, late_max=0.41e-3,
                read=30e-6, write=22e-6, step=61e-6, ticks=int(1000 * self.elapsed), missed=3, realtime=1,
            ),
            device=DeviceReport(
                t=t - 0.3, name=b"On-screen stick", renders=b"nothing", workspace=0.1, force_limit=10.0,
                present=1, homed=1,
            ),
            progress=MissionProgress(
                t=t - 0.02, stage=b"on the way" if self.engaged else b"on the ground", leg=int(self.engaged), legs=5,
                target_distance=math.dist(self._p[:3], self._points[-1]),
                clearance=self._world.nearest((self._p[0], self._p[1], self._p[2])).distance,
            ),
            events=self._events(t),
            answers=(),
        )  # fmt: skip

    def _handle(self, t: float, error: list[float]) -> Handle:
        yaw = self._p[3]
        lead = (
            body_from_world((self._rate[0], self._rate[1], self._rate[2]), yaw)
            if self.engaged
            else (0.0,) * 3
        )
        force = body_from_world((error[0], error[1], error[2]), yaw)
        return Handle(
            t=t - 0.001,
            position=tuple(0.05 * value for value in lead),
            force=tuple(-STIFFNESS * value * self.engaged for value in force),
            yaw=self._rate[3] if self.engaged else 0.0,
            device_t=t - 0.002,
            tick=int(1000 * self.elapsed),
            homed=1,
            present=1,
        )

    def _asked(self, error: list[float]) -> tuple[float, ...]:
        world = [self._rate[i] + GAIN * math.tanh(error[i]) for i in range(4)]
        return (*body_from_world((world[0], world[1], world[2]), self._p[3]), world[3])

    def _setpoint(self, t: float, error: list[float]) -> Setpoint:
        return Setpoint(
            t=t - 0.008, velocity=self._asked(error), number=int(50 * self.elapsed), active=self.engaged
        )

    def _pilot(self, t: float, error: list[float]) -> PilotState:
        asked = self._asked(error)
        state = PilotState(
            t=t - 0.008,
            p_h=tuple(self._p_h),
            p_h_rate=tuple(self._rate),
            error=tuple(error),
            v_ref=asked,
            v_safe=asked,
            v_c=asked,
            state_age=0.012,
            phase=Phase.ENGAGED if self.engaged else Phase.DISENGAGED,
            centred=not self.engaged,
            preset=Preset.ASSISTED,
            cues=ALL_CUES,
            k1=(math.nan,) * 4,
            phase_margin=math.nan,
            delay=math.nan,
            gain_share=1.0,
            speed_share=1.0,
        )
        if self.engaged:
            self._lead(state, error)
        return state

    def _lead(self, state: PilotState, error: list[float]) -> None:
        """Fill in what there is only while the hand leads: forecast, gains, cues."""
        ahead = [self._p[i] + self._delay * self._v[i] for i in range(4)]
        state.predicted[:] = ahead
        state.predicted_velocity[:] = self._v[:3]
        brake = LAG_S + math.hypot(*self._v[:3]) / 6.0
        state.stop[:] = [ahead[i] + brake * self._v[i] for i in range(3)]
        poor = max(0.0, min(1.0, (self._delay - 0.2) / 0.6))
        state.delay, state.phase_margin = self._delay, math.radians(45.0 + 12.0 * (1.0 - poor))
        state.k1[:] = [GAIN - 0.8 * poor] * 3 + [1.0 - 0.6 * poor]
        state.gain_share, state.speed_share = 1.0 - 0.6 * poor, 1.0 - 0.7 * poor
        state.compensated = 1
        state.force[:] = [-STIFFNESS * value for value in error[:3]]
        state.damping[:] = [-0.02 * value for value in self._rate[:3]]
        near = self._world.nearest((self._p[0], self._p[1], self._p[2]))
        if near.distance < NEAR_M:
            push = NEAR_M - near.distance
            state.environment[:] = [2.0 * push * value for value in near.normal]
            state.guard[:] = [push * value for value in near.normal]
            state.guarding, state.guarded_by = 1, near.name.encode()

    def _status(self, t: float) -> VehicleStatus:
        flying = self.elapsed > 1.0
        mode = FlightMode.OFFBOARD if self.engaged else FlightMode.TAKEOFF if flying else FlightMode.READY
        return VehicleStatus(
            t=t - 0.05,
            heard_t=t - 0.018,
            loss=0.004,
            rtt=self._delay,
            battery=0.87 - 0.002 * self.elapsed,
            voltage=15.9,
            sent=int(50 * max(self.elapsed - ENGAGED_S, 0)),
            health=127,
            system_id=1,
            component=1,
            autopilot=Autopilot.PX4,
            firmware=b"1.15.4",
            speed_limits=(12.0, 3.0, 1.5),
            connected=1,
            armed=self.elapsed > 0.5,
            in_air=flying,
            mode=mode,
            streaming=Stream.FLYING if self.engaged else Stream.IDLE,
        )

    def _events(self, t: float) -> tuple[Event, ...]:
        told = (
            (0.1, Severity.INFO, b"link", "Vehicle 1 found on udpin://127.0.0.1:14540."),
            (0.5, Severity.INFO, b"link", "Arm accepted."),
            (1.0, Severity.INFO, b"link", "Takeoff accepted."),
            (5.4, Severity.WARNING, b"pilot", "Engage refused: the handle is not in its centre."),
            (6.0, Severity.INFO, b"pilot", "Engaged: the vehicle follows the hand."),
            (10.2, Severity.INFO, b"sim", "A gust begins: 2.0 m/s toward north."),
        )
        return tuple(
            Event(t=START + at, severity=severity, source=source, text=text.encode())
            for at, severity, source, text in told
            if START + at <= t
        )


class CannedFollower:
    """Follows the mission of a canned flight as `groundstation.training.follower` does, without a bus."""

    def __init__(self, run: Run) -> None:
        assert run.mission is not None
        self.attempts = Attempts(run.mission, radius=0.2)
        self.judgement: Judgement | None = None
        self._par = run.par
        self._sights = Sights()
        self._seen_t = 0.0

    @property
    def measurer(self) -> Measurer:
        """Measures the flight."""
        return self.attempts.current

    @property
    def director(self) -> Director:
        """Knows how it is going."""
        return self.attempts.current.director

    @property
    def score(self) -> Score | None:
        """Of the flight as far as it has come."""
        return score_of(self.director.mission, self.measurer.measures(), self._par)

    def look(self, view: Snapshot) -> None:
        """Take note of a snapshot."""
        state, status, pilot, handle = view.vehicle, view.status, view.pilot, view.handle
        if state is None or status is None or pilot is None or handle is None or state.t <= self._seen_t:
            return
        self._seen_t = state.t
        for sight in (*self._sights.take([state], [status], [pilot], [handle]), *self._sights.rest()):
            self.attempts.show(sight)
        if self.attempts.landed:
            self.judgement = judgement_of(self.attempts.landed[-1], self._par)


class CannedReader:
    """A console that shows what it is given and notes what it is told; commands are answered by hand."""

    def __init__(self, snapshot: Snapshot) -> None:
        self.shown = snapshot
        self.commands: list[CommandKind] = []
        self.values: list[int] = []
        self.amounts: list[tuple[str, float]] = []
        self.answers: list[CommandAnswer] = []

    def snapshot(self) -> Snapshot:
        """Return what is shown, with the answers given since."""
        answers, self.answers = tuple(self.answers), []
        return replace(self.shown, answers=answers)

    def command(self, kind: CommandKind, value: int = 0, name: str = "", amount: float = 0.0) -> int:
        """Take note of a command."""
        self.commands.append(kind)
        self.values.append(value)
        self.amounts.append((name, amount))
        return len(self.commands)


class CannedSupervisor:
    """Processes that are as they are said to be."""

    def __init__(self, **states: str) -> None:
        self.words: dict[str, str] = states or dict.fromkeys(("sim", "recorder", "link", "pilot"), "running")

    def poll(self) -> Sequence[str]:
        """Nothing is new."""
        return []

    def states(self) -> Mapping[str, str]:
        """Return the words."""
        return self.words


class CannedStick:
    """Keeps what the on-screen stick sent."""

    def __init__(self) -> None:
        self.sent: list[tuple[tuple[float, float, float], float, int, float]] = []

    def send(self, position: tuple[float, float, float], yaw: float, buttons: int, t: float) -> bool:
        """Keep a sample."""
        self.sent.append((position, yaw, buttons, t))
        return True
