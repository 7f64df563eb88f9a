"""The link process: the only one that speaks to the vehicle."""

from __future__ import annotations

import atexit
import os
import queue
import threading
import time
from pathlib import Path

import mavsdk
from mavsdk import Configuration, Mavsdk

from groundstation import heap
from groundstation.bus import Bus
from groundstation.child import Lifeline, run_child
from groundstation.clock import Every
from groundstation.errors import InputError
from groundstation.messages import Severity
from groundstation.run import Run
from groundstation.vehicle.asleep import Sleep
from groundstation.vehicle.conversation import Conversation
from groundstation.vehicle.gate import Gate
from groundstation.vehicle.open_transport import open_transport
from groundstation.vehicle.pump import Pump
from groundstation.vehicle.signed_times import TimesKeeper, read_times
from groundstation.vehicle.signing import Signing, read_key
from groundstation.vehicle.telemetry import Notes
from groundstation.vehicle.tlog import TlogWriter
from groundstation.vehicle.transport import TransportError, parse_url

ROLE = "link"
# MAV_COMP_ID_MISSIONPLANNER: the ground station's usual component, with the usual GCS system id.
_SYSTEM_ID, _COMPONENT_ID = 255, 190


def body(run: Run, bus: Bus, lifeline: Lifeline) -> None:
    """Run the link until the lifeline ends."""
    heap.arrange()
    give_back = Every(heap.GIVE_BACK_S)
    notes: Notes = queue.SimpleQueue()
    # It complains of a connection that is about to come; its lines count from when that is there. Subscribing
    # anew then would free the callback that a thread of MAVSDK's may be in.
    connected = threading.Event()
    mavsdk.log_subscribe(
        lambda level, text, _file, _line: _note_log(notes, int(level), text) if connected.is_set() else True
    )
    try:
        signing, times = _open_signing(run, notes)
        transport = open_transport(parse_url(run.url), lambda severity, words: notes.put((severity, words)))
    except (InputError, TransportError) as error:
        raise SystemExit(str(error)) from error
    sleep = Sleep()
    gate = Gate(
        run.settings.safety.setpoint_stale_s,
        sleep.clock,
        lambda words: notes.put((Severity.WARNING, words)),
    )
    tlog = _open_tlog(run, notes)
    pump = Pump(transport, gate, tlog, time.monotonic, signing)
    mav = Mavsdk(Configuration.create_manual(_SYSTEM_ID, _COMPONENT_ID, always_send_heartbeats=True))
    pump.start(mav)
    connected.set()
    vehicle = Conversation(run, bus, mav, pump, gate, notes=notes, sleep=sleep)
    try:
        while lifeline.holds():
            vehicle.turn()
            if give_back.due(time.monotonic()):
                heap.give_back()
            vehicle.wait()
        vehicle.leave()
    finally:
        free = vehicle.close()
        pump.stop()
        if free:
            mav.destroy()
            mavsdk.log_unsubscribe()
        else:
            # Its threads go on, and would call into an interpreter that is being taken down.
            atexit.register(os._exit, 0)
        if tlog:
            tlog.close()
        if times:
            times.close()


def _open_signing(run: Run, notes: Notes) -> tuple[Signing | None, TimesKeeper | None]:
    if not run.signing_key:
        return None, None
    path = Path(run.signing_key)
    before, why = read_times(path)
    if why:
        notes.put((Severity.WARNING, why))
    signing = Signing(read_key(path), time.time, before)
    return signing, TimesKeeper(path, signing, lambda words: notes.put((Severity.WARNING, words)))


def _open_tlog(run: Run, notes: Notes) -> TlogWriter | None:
    try:
        return TlogWriter(run.tlog, lambda words: notes.put((Severity.ALARM, words)))
    except OSError as error:
        notes.put((Severity.ALARM, f"No MAVLink log: {run.tlog} cannot be written ({error.strerror})."))
        return None


def _note_log(notes: Notes, level: int, text: str) -> bool:
    """Keep MAVSDK's own lines off the terminal; its warnings become events.

    Not those of the simulator's parameters: whose they are the trainee would not learn from a real vehicle.
    """
    if level >= int(mavsdk.LogLevel.WARN) and "(SIM_" not in text:
        notes.put((Severity.WARNING, f"MAVSDK: {text}"))
    return True


if __name__ == "__main__":
    run_child(ROLE, body)
