"""The recorder process: all that crosses the bus into a Rerun file, and to a live viewer if there is one."""

from __future__ import annotations

import datetime
import importlib
import os
import sys
import threading
import time
import traceback
from collections import deque

from groundstation import heap
from groundstation.bus import Bus
from groundstation.child import Lifeline, run_child
from groundstation.clock import Every, Pacer
from groundstation.messages import Severity
from groundstation.recording.batch import Batch, Taps
from groundstation.recording.room import make_room
from groundstation.run import Run, start_of

ROLE = "recorder"
_TURN_S = 0.05
# Rows cost per call, not per row: large batches for the file, small ones where somebody watches.
_BATCH_S = 0.75
_LIVE_BATCH_S = 0.1
# What has piled up while the process was held up goes in parts of at most so long, one a turn.
_LONGEST_S = 1.0
_NICENESS = 10
# Arrow's own allocator, and Rerun's, would keep what they have taken for themselves: 3 to 5 MB, and 3 MB.
_GIVES_BACK = {"ARROW_DEFAULT_MEMORY_POOL": "system", "MIMALLOC_PURGE_DELAY": "0"}
# It warns of every file without an index, which is how a flight is recorded: the index is made at its end.
_SAYS_LITTLE = {"RUST_LOG": "error"}


def record(run: Run, bus: Bus, lifeline: Lifeline) -> None:
    """Record until the lifeline no longer holds."""
    heap.arrange()
    for name, value in (_GIVES_BACK | _SAYS_LITTLE).items():
        os.environ.setdefault(name, value)
    taps = Taps(bus)
    # Rerun takes seconds to import on a busy machine, longer than the taps hold. The heart begins to beat after it.
    opening = threading.Thread(target=importlib.import_module, args=("groundstation.recording.session",))
    opening.start()
    while opening.is_alive():
        taps.drain()
        opening.join(_TURN_S)
    from groundstation.recording.session import Session

    heap.take_small_blocks()
    if removed := make_room(run.recording.parent, run.settings.recording.folder_gb, run.recording.stem):
        words = f"{removed[0]} to {removed[-1]}" if len(removed) > 1 else removed[0]
        bus.event(Severity.INFO, f"Removed the oldest flights, {words}: over recording.folder_gb.")
    start = start_of(run.started, datetime.datetime.now().astimezone(), time.monotonic())
    session = Session(run, start, bus.event)
    batches = Every(_LIVE_BATCH_S if run.viewer_url else _BATCH_S)
    waiting = deque[Batch]()
    pacer, give_back = Pacer(_TURN_S), Every(heap.GIVE_BACK_S)
    while lifeline.holds():
        if taps.drain():
            bus.event(Severity.WARNING, "The recorder was held up for seconds; handle samples are missing.")
        if batches.due(time.monotonic()):
            waiting.extend(taps.take().parts(_LONGEST_S))
            if give_back.due(time.monotonic()):
                heap.give_back()
        if waiting:
            session.take(waiting.popleft())
        pacer.wait()
    taps.drain()
    for batch in (*waiting, *taps.take().parts(_LONGEST_S)):
        session.take(batch)
    session.close()


def main() -> None:
    """Run the process, behind all others: no control deadline shall wait because of it."""
    os.nice(_NICENESS)
    code = 0
    try:
        run_child(ROLE, record)
    except Exception:  # noqa: BLE001 - the end of the process; the supervisor shows its last words
        traceback.print_exc()
        code = 1
    sys.stderr.flush()
    # At a normal end Rerun waits without limit for a live viewer that does not read; all is written by now.
    os._exit(code)


if __name__ == "__main__":
    main()
