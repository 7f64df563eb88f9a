"""The checks at arming, as an event: once each time, with what is not well by name."""

from __future__ import annotations

from dataclasses import replace

from canned_flight import CannedFlight, canned_run

from groundstation.messages import Severity
from groundstation.tui.acts import ACTS
from groundstation.tui.check import Check
from groundstation.tui.checks_kept import ArmedChecks, in_a_line
from groundstation.tui.frame import Frame
from groundstation.tui.hand import CENTRED
from groundstation.tui.track import History, Track


def test_what_is_not_well_is_named_the_worst_first():
    found = [
        Check("GF_ACTION = 4", Severity.ALARM, ""),
        Check("fence", Severity.WARNING, ""),
        Check("link", Severity.INFO, ""),
    ]
    assert in_a_line(found) == (
        "Preflight on arming: ■ 1 to mend before the flight ▲ 1 to know of: GF_ACTION = 4, fence."
    )
    assert in_a_line(found[2:]) == "Preflight on arming: ✓ all is well."


def test_it_is_told_at_each_arming_and_only_then():
    run, flight, told = canned_run(), CannedFlight(canned_run()), list[str]()
    flight.advance(0.3)
    watch = ArmedChecks(told.append)

    def look(armed: int) -> None:
        shown = flight.snapshot()
        shown.status.armed = armed
        watch.look(
            Frame(
                snapshot=replace(shown),
                run=run,
                started=1000.0,
                states={},
                stick=CENTRED,
                hindrances={act.name: "" for act in ACTS},
                guarded_by="",
                notes=(),
                track=Track(),
                history=History(),
            )
        )

    for armed, times in ((0, 0), (1, 1), (1, 1), (0, 1), (1, 2)):
        look(armed)
        assert len(told) == times
    assert told[0].startswith("Preflight on arming: ")
