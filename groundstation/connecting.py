"""`groundstation` without a vehicle: what is there is offered, and what is chosen is flown."""

from __future__ import annotations

import argparse
import contextlib
import datetime
from collections.abc import Sequence
from pathlib import Path

from drivers.discovery import Found, discover_all
from groundstation.config import load_settings
from groundstation.connections import Connection, recent, remember
from groundstation.login import login_name
from groundstation.progress.desk import Desk
from groundstation.progress.words import NEXT
from groundstation.training.curriculum import lessons
from groundstation.vehicle.finding import Place, listen, serial_places


def connect(asked: argparse.Namespace) -> bool:
    """Let the operator choose vehicle, device and mission, into what was asked for; say whether to fly.

    Raises:
        InputError: The settings are wrong.
    """
    from groundstation.tui.connect import Connect, Offers
    from groundstation.tui.hangup import watched

    settings = load_settings(asked.config)

    def devices() -> Sequence[Found]:
        return discover_all(settings.devices)

    offers = Offers(_places, devices, _missions(asked), recent(asked.logs), settings.buttons)
    with watched():
        chosen = Connect(offers, device=asked.device or "", mission=asked.mission or "").run()
    if chosen is None:
        return False
    asked.sim, asked.connect = not chosen.connect, chosen.connect or None
    asked.device, asked.mission = chosen.device or None, chosen.mission or None
    return True


def note(asked: argparse.Namespace) -> None:
    """Remember a real vehicle's connection; a folder that cannot be written has been told of before."""
    if asked.connect:
        day = f"{datetime.datetime.now().astimezone():%Y-%m-%d}"
        kept = Connection(asked.connect, asked.device or "", str(asked.mission or ""), day)
        with contextlib.suppress(OSError):
            remember(Path(asked.logs), kept)


def _places() -> Sequence[Place]:
    return [*listen(), *serial_places()]


def _missions(asked: argparse.Namespace) -> list[tuple[str, str]]:
    """Return the missions in the order in which they are learned, but first what comes next for the pilot."""
    pilot = asked.pilot if asked.pilot is not None else login_name()
    advice = Desk(asked.logs).report(pilot).standing.next
    following = advice.mission if advice else ""
    found = [(path.stem, mission.title, mission.name == following) for path, mission in lessons()]
    found.sort(key=lambda each: not each[2])
    return [(name, f"{title}  {NEXT} next for you" if first else title) for name, title, first in found]
