"""From a run whose processes run to a screen in the terminal, and back to an exit code."""

from __future__ import annotations

import sys
from collections.abc import Callable

from groundstation.bus import Bus
from groundstation.console import Console
from groundstation.messages import Severity
from groundstation.progress.keeper import Keeper
from groundstation.run import Run
from groundstation.training.asking import Asker
from groundstation.training.coach import LiveCoach
from groundstation.training.follower import MissionFollower
from groundstation.training.workload import Workload
from groundstation.tui import memory
from groundstation.tui.app import FlightApp
from groundstation.tui.frame import Reader, Supervisor
from groundstation.tui.hand import StickSender
from groundstation.tui.hangup import watched
from groundstation.tui.instructing import Instructing
from groundstation.tui.wish import Ending


def run_screen(
    run: Run,
    console: Reader,
    supervisor: Supervisor,
    stick: StickSender | None,
    *,
    follower: MissionFollower | None = None,
    coach: LiveCoach | None = None,
    keeper: Keeper | None = None,
    on_workload: Callable[[Workload], None] = lambda _: None,
    instructing: Instructing | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> Ending:
    """Show the screen until the operator leaves; return how that was."""
    app = FlightApp(
        run,
        console,
        supervisor,
        stick,
        follower=follower,
        coach=coach,
        keeper=keeper,
        instructing=instructing,
        on_workload=on_workload,
        tell=tell,
    )
    try:
        with watched():
            code = app.run()
    finally:
        memory.leave()
    return Ending((app.return_code or 0) if code is None else code, app.wish)


def fly_on_screen(run: Run, bus: Bus, supervisor: Supervisor) -> Ending:
    """Show the screen of a run whose processes run; return how it was left."""
    from drivers.stick import StickSender as Sender

    stick = Sender(str(run.hand)) if run.hand else None
    follower = MissionFollower(run.mission, bus, run.par) if run.mission else None
    keeper = Keeper(run, follower.attempts) if follower else None

    def tell(words: str) -> None:
        bus.event(Severity.INFO, words)

    def on_workload(workload: Workload) -> None:
        # As an event it stands in the recording.
        tell(workload.words)
        if keeper:
            keeper.keep_workload(workload)

    try:
        return run_screen(
            run,
            Console(bus, "screen"),
            supervisor,
            stick,
            follower=follower,
            coach=LiveCoach(run, tell),
            keeper=keeper,
            on_workload=on_workload,
            instructing=Instructing(Asker(bus, "instructor") if run.simulated else None),
            tell=tell,
        )
    finally:
        for words in keeper.close() if keeper else ():
            sys.stderr.write(f"groundstation: {words}\n")
        if stick is not None:
            stick.close()
