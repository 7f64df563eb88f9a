"""From a run whose processes run to a screen in the terminal, and back to an exit code."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable

from groundstation.bus import Bus
from groundstation.console import Console
from groundstation.messages import Severity
from groundstation.run import Run
from groundstation.training.asking import Asker
from groundstation.training.coach import LiveCoach
from groundstation.training.follower import MissionFollower
from groundstation.training.workload import Workload
from groundstation.tui.app import FlightApp
from groundstation.tui.frame import Reader, Supervisor
from groundstation.tui.hand import StickSender
from groundstation.tui.hangup import HangupWatch
from groundstation.tui.instructing import Instructing

_SWITCH_S = 0.001


def run_screen(
    run: Run,
    console: Reader,
    supervisor: Supervisor,
    stick: StickSender | None,
    *,
    follower: MissionFollower | None = None,
    coach: LiveCoach | None = None,
    instructing: Instructing | None = None,
    on_workload: Callable[[Workload], None] = lambda _: None,
) -> int:
    """Show the screen until the operator leaves; return the exit code."""
    app = FlightApp(
        run,
        console,
        supervisor,
        stick,
        follower=follower,
        coach=coach,
        instructing=instructing,
        on_workload=on_workload,
    )
    # A collection that looks through all the modules again takes 0.2 s, and a stick is stale after 0.1 s.
    gc.collect()
    gc.freeze()
    # Nor may painting keep the stick's thread waiting: it asks for its turn and gets it within a millisecond, and the
    # young objects of some thousand frames are looked through before all are.
    sys.setswitchinterval(_SWITCH_S)
    gc.set_threshold(2_000, 20, 1_000)
    watch = HangupWatch(sys.stdin.fileno())
    try:
        code = app.run()
    finally:
        watch.stop()
    return (app.return_code or 0) if code is None else code


def fly_on_screen(run: Run, bus: Bus, supervisor: Supervisor) -> int:
    """Show the screen of a run whose processes run; return the exit code."""
    from drivers.stick import StickSender as Sender

    stick = Sender(str(run.hand)) if run.hand else None
    try:
        follower = MissionFollower(run.mission, bus, run.par) if run.mission else None
        return run_screen(
            run,
            Console(bus, "screen"),
            supervisor,
            stick,
            follower=follower,
            coach=LiveCoach(run, lambda words: bus.event(Severity.INFO, words)),
            instructing=Instructing(Asker(bus, "instructor") if run.simulated else None),
            # As an event it stands in the recording.
            on_workload=lambda workload: bus.event(Severity.INFO, workload.words),
        )
    finally:
        if stick is not None:
            stick.close()
