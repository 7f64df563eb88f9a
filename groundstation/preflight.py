"""`groundstation preflight`: the checks of Preflight (F7) without a screen, for scripts, paper and who cannot see it.

The very processes of a flight run, so that what is judged is what would fly; only that their recording goes to the
run's own folder, which goes with them.
"""

from __future__ import annotations

import argparse
import contextlib
import datetime
import sys
import time
from collections.abc import Callable, Sequence

import msgspec

from drivers.stick import StickSender
from groundstation.console import Console
from groundstation.errors import InputError
from groundstation.fly import check_simulated, plan, started
from groundstation.messages import Severity
from groundstation.run import Run
from groundstation.run_folder import run_folder
from groundstation.status_line import StatusLine
from groundstation.tui.check import Check
from groundstation.tui.checks import checks
from groundstation.tui.checks_told import LEVELS, in_words, total
from groundstation.tui.frame import Frame, Reader, Supervisor
from groundstation.tui.track import History, Track

_TURN_S = 0.05
# So long nothing may be red nor change: by then round trip and firmware have been told, too.
_STEADY_S = 3.0
_STOPPED = 130


class Looking:
    """Looks at the checks until they can be judged.

    Args:
        look: Makes the checks.
        wait_s: How long what is red may take, s.
        clock: Monotonic seconds.

    Attributes:
        found: The checks as they are now.
    """

    def __init__(self, look: Callable[[], list[Check]], wait_s: float, clock: Callable[[], float]) -> None:
        self._look, self._wait_s, self._clock = look, wait_s, clock
        self._begun = self._steady = clock()
        self._known: list[tuple[str, Severity]] = []
        self.found: list[Check] = []

    def turn(self) -> bool:
        """Look once; say whether to go on."""
        now = self._clock()
        self.found = self._look()
        known = sorted((check.name, check.severity) for check in self.found)
        if known != self._known:
            self._known, self._steady = known, now
        if _red(self.found):
            return now - self._begun < self._wait_s
        return now - self._steady < _STEADY_S and now - self._begun < self._wait_s + _STEADY_S

    @property
    def words(self) -> str:
        """How it is going, in a line."""
        red = _red(self.found)
        named = f": {', '.join(red[:4])}{' …' * (len(red) > 4)}" if red else ""
        return f"{self._clock() - self._begun:3.0f} s  {len(red)} to mend{named}"


def run(asked: argparse.Namespace) -> int:
    """Make the checks, tell them, and return the exit code.

    Raises:
        InputError: Something asked for cannot be.
    """
    if not asked.sim and not asked.connect:
        raise InputError("preflight checks a vehicle; say which, with --sim or --connect URL.")
    check_simulated(asked)
    planned = plan(asked)
    try:
        found = _checked(planned, asked)
    except KeyboardInterrupt:
        return _STOPPED
    sys.stdout.write(_as_json(found, planned) if asked.json else f"{in_words(found, _heading(planned))}\n")
    return int(bool(_red(found)))


def _checked(planned: Run, asked: argparse.Namespace) -> list[Check]:
    """Run a run's processes, and look until its checks can be judged."""
    apart = msgspec.structs.replace(planned, log=str(run_folder(planned.run_id) / "preflight"))
    stick = StickSender(str(planned.hand)) if planned.hand else None
    with (
        contextlib.closing(stick) if stick else contextlib.nullcontext(),
        started(apart, asked) as (bus, supervisor),
        StatusLine(sys.stderr) as line,
    ):
        looking = Looking(_looker(planned, Console(bus, "preflight"), supervisor), asked.wait, time.monotonic)
        line.tell(f"Checking the vehicle at {planned.url} …")
        while looking.turn():
            line.step(looking.words)
            if stick is not None:
                stick.send((0.0, 0.0, 0.0), 0.0, 0, time.monotonic())
            time.sleep(_TURN_S)
        return looking.found


def _looker(planned: Run, console: Reader, supervisor: Supervisor) -> Callable[[], list[Check]]:
    started_t = console.snapshot().t

    def look() -> list[Check]:
        supervisor.poll()
        return checks(
            Frame(
                snapshot=console.snapshot(),
                run=planned,
                started=started_t,
                states=supervisor.states(),
                stick=None,
                hindrances={},
                guarded_by="",
                notes=(),
                track=Track(),
                history=History(),
            )
        )

    return look


def _red(found: Sequence[Check]) -> list[str]:
    return [check.name for check in found if check.severity is Severity.ALARM]


def _heading(planned: Run) -> str:
    where = "simulated vehicle" if planned.simulated else f"vehicle at {planned.url}"
    return f"Preflight, {where}, {_now()}"


def _now() -> str:
    return datetime.datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")


def _as_json(found: Sequence[Check], planned: Run) -> str:
    told = {
        "at": _now(),
        "url": "" if planned.simulated else planned.url,
        "simulated": planned.simulated,
        "may_be_flown": not _red(found),
        "total": total(found),
        "checks": [
            {"name": each.name, "level": LEVELS[each.severity], "state": each.state, "remedy": each.remedy}
            for each in found
        ],
    }
    return f"{msgspec.json.format(msgspec.json.encode(told)).decode()}\n"
