"""What the screen knows of learning: how the mission goes, what a coach says, who flew what, and what comes next.

The part of the application between commanding (`groundstation.tui.commanding`) and showing (`groundstation.tui.app`).
"""

from __future__ import annotations

from collections.abc import Callable

from groundstation.console import Snapshot
from groundstation.progress.desk import Desk
from groundstation.progress.keeper import Keeper
from groundstation.progress.skills import Advice
from groundstation.run import Run
from groundstation.training.coach import LiveCoach
from groundstation.training.director import Director, Stage
from groundstation.training.follower import MissionFollower
from groundstation.training.guide import Guide, guide_of
from groundstation.training.score import Score
from groundstation.training.workload import Workload
from groundstation.tui.acts import armed, coupled, in_air
from groundstation.tui.commanding import Commanding
from groundstation.tui.frame import Reader
from groundstation.tui.wish import Wish


class Schooling(Commanding):
    """An application in which a mission is followed, judged, kept, and led on from.

    Args:
        run: The run.
        console: The operator's side of the bus.
        follower: Follows the mission, if there is one.
        coach: Tells the trainee what to do instead, if there is one.
        desk: Knows the pilots and the course; the one of the run's folder where none is given.
        keeper: Keeps the flights that land, if they are anybody's.
        on_workload: Keeps what was answered after a flight.

    Attributes:
        desk: As given.
        best: The pilot's best score of this mission, or None.
        advice: What comes next for the pilot, once a flight has landed.
        wish: What shall be flown after this run, or None.
    """

    def __init__(
        self,
        run: Run,
        console: Reader,
        *,
        follower: MissionFollower | None,
        coach: LiveCoach | None,
        desk: Desk | None,
        keeper: Keeper | None,
        on_workload: Callable[[Workload], None],
    ) -> None:
        super().__init__(run, console)
        self._follower, self._coach, self._keeper = follower, coach, keeper
        self.desk = desk or Desk(run.recording.parent)
        self.best = self.desk.best(run.pilot, run.mission, run.par) if run.mission else None
        self._on_workload = on_workload
        self.advice: Advice | None = None
        self.wish: Wish | None = None

    @property
    def pilot(self) -> str:
        """Who flies."""
        return self._flight_run.pilot

    @property
    def director(self) -> Director | None:
        """Knows how the mission is going, if there is one."""
        return self._follower.director if self._follower is not None else None

    @property
    def score(self) -> Score | None:
        """What the flight under way is worth so far."""
        return self._follower.score if self._follower is not None else None

    def follow(self, snapshot: Snapshot) -> None:
        """Take note of what is new for the mission, and keep what has landed."""
        if self._follower is None:
            return
        self._follower.look(snapshot)
        self._keep()

    def guided(self, snapshot: Snapshot, *, quiet: bool) -> tuple[Guide | None, str]:
        """Return where the mission leads and what the coach says; nothing new where `quiet`."""
        director = self.director
        if director is None:
            return None, ""
        guide = guide_of(director, snapshot.t)
        if self._coach is None:
            return guide, ""
        return guide, self._coach.look(snapshot, guide, director.clearance, quiet=quiet)

    def action_next(self) -> None:
        """Fly what the school recommends."""
        if self.advice is None:
            self.action_page("school")
        else:
            self.fly_next(Wish(self.advice.mission, self.pilot))

    def fly_next(self, wish: Wish) -> None:
        """Leave this run and have the next one begin with what is wished: on the ground, and simulated only."""
        mission, director = self._flight_run.mission, self.director
        if not self._flight_run.simulated:
            words = "A real vehicle is flown as it was connected: leave with q, and choose the mission then."
            self.notify(words, severity="warning", timeout=6.0)
        elif armed(self._snapshot) or in_air(self._snapshot) or coupled(self._snapshot):
            self.notify("Land and disarm first.", severity="warning", timeout=4.0)
        elif mission and director and director.stage is Stage.WAITING and wish == (mission.name, self.pilot):
            # It is this one that waits to be flown.
            self.action_fly()
        else:
            self.wish = wish
            self.leave()

    def take_workload(self, workload: Workload | None) -> None:
        """Keep how hard it was, unless that was not said."""
        if workload is not None:
            self._on_workload(workload)
            self.notify(f"Kept: workload {workload.raw:.0f} of 100.", timeout=3.0)

    def action_page(self, name: str) -> None:
        """Show a page over the flight."""
        raise NotImplementedError

    def action_fly(self) -> None:
        """Go back to the flight."""
        raise NotImplementedError

    def leave(self) -> None:
        """End the screen; a vehicle that follows the hand is left holding."""
        raise NotImplementedError

    def _keep(self) -> None:
        """Have what has landed kept; once it is, look what comes next."""
        if self._keeper is None:
            return
        for words in self._keeper.look():
            self.notify(words, severity="warning", timeout=10.0, markup=False)
        if self._keeper.fresh():
            self.advice = self.desk.report(self.pilot).standing.next
