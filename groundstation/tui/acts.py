"""What the operator can ask for: one table for keys, footer, palette, dialogs and help.

What can be chosen besides, how the handle leads and what it feels, is in `groundstation.tui.choices`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from groundstation.console import Snapshot
from groundstation.messages import CommandKind, Phase

# The controller speaks at 50 Hz.
PILOT_STALE_S = 0.5


class Ask(Enum):
    """When an act is asked back before it is done."""

    NEVER = "never"
    REAL = "where the vehicle is real"
    ALWAYS = "always"


@dataclass(frozen=True, slots=True)
class Act:
    """One act of the operator.

    Attributes:
        kind: The command it sends.
        key: The key that does it.
        label: As shown beside the key.
        explains: One sentence for help and palette.
        hindrance: Says from a snapshot why it cannot be done now, or "" where it can. The pilot and the link
            decide; this only keeps what is plainly impossible from looking possible.
        ask: When to ask back.
        everywhere: The key that does it on every screen, over dialogs and while text is typed; "" for none.
    """

    kind: CommandKind
    key: str
    label: str
    explains: str
    hindrance: Callable[[Snapshot], str]
    ask: Ask = Ask.NEVER
    everywhere: str = ""

    @property
    def name(self) -> str:
        """The act's name in actions and tests."""
        return self.kind.name.lower()

    @property
    def urgent(self) -> bool:
        """It makes things safer, and so is a key away everywhere."""
        return bool(self.everywhere)

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that do it."""
        return with_shift(self.key)


def with_shift(key: str) -> tuple[str, ...]:
    """Return a key without shift and with it, unless it is one that takes shift or knows none."""
    return (key,) if key == key.upper() else (key, key.upper())


def in_air(snapshot: Snapshot) -> bool:
    """Say whether the vehicle was last known to fly."""
    return snapshot.status is not None and bool(snapshot.status.in_air)


def armed(snapshot: Snapshot) -> bool:
    """Say whether the vehicle was last known to be armed."""
    return snapshot.status is not None and bool(snapshot.status.armed)


def coupled(snapshot: Snapshot) -> bool:
    """Say whether the hand was last known to be coupled to the vehicle, or about to be."""
    return snapshot.pilot is not None and snapshot.pilot.phase != Phase.DISENGAGED


def pilot_silent(snapshot: Snapshot) -> str:
    """Say that nobody is there to obey what is the pilot's business, or ""."""
    pilot = snapshot.pilot
    silent = pilot is None or snapshot.t - pilot.t > PILOT_STALE_S
    return "the pilot process does not answer" if silent else ""


def _connected(snapshot: Snapshot) -> bool:
    return snapshot.status is not None and bool(snapshot.status.connected)


def _cannot_arm(snapshot: Snapshot) -> str:
    if not _connected(snapshot):
        return "no vehicle is connected"
    return "it is armed already" if armed(snapshot) else ""


def _cannot_disarm(snapshot: Snapshot) -> str:
    if not armed(snapshot):
        return "it is not armed"
    return "it is in the air; land first" if in_air(snapshot) else ""


def _cannot_take_off(snapshot: Snapshot) -> str:
    if not _connected(snapshot):
        return "no vehicle is connected"
    if in_air(snapshot):
        return "it is in the air already"
    return "" if armed(snapshot) else "arm it first"


def _cannot_engage(snapshot: Snapshot) -> str:
    if silent := pilot_silent(snapshot):
        return silent
    if coupled(snapshot):
        return "the hand is engaged already"
    if not in_air(snapshot):
        return "take off first"
    device = snapshot.device
    if device is None or not device.present:
        return "there is no haptic device"
    return "" if device.homed else "the haptic device is not homed"


def _cannot_disengage(snapshot: Snapshot) -> str:
    return "" if coupled(snapshot) else "the hand is not engaged"


def _not_in_air(snapshot: Snapshot) -> str:
    return "" if in_air(snapshot) else "it is not in the air"


def _cannot_kill(snapshot: Snapshot) -> str:
    return "" if armed(snapshot) or in_air(snapshot) else "its motors are off"


_K = CommandKind
ACTS = (
    Act(_K.ARM, "A", "Arm", "Start the motors.", _cannot_arm, Ask.REAL),
    Act(_K.DISARM, "D", "Disarm", "Stop the motors on the ground.", _cannot_disarm),
    Act(_K.TAKEOFF, "t", "Take off", "Climb to the mission's altitude, hold.", _cannot_take_off, Ask.REAL),
    Act(_K.ENGAGE, "e", "Engage", "Couple hand and vehicle; centre the handle first.", _cannot_engage),
    Act(_K.DISENGAGE, "x", "Release", "Uncouple the hand; it holds.", _cannot_disengage, everywhere="f5"),
    Act(_K.HOLD, "h", "Hold", "Stop and stay there.", _not_in_air, everywhere="f2"),
    Act(_K.RETURN, "r", "Return", "Fly back to where it was armed.", _not_in_air, everywhere="f4"),
    Act(_K.LAND, "l", "Land", "Land where it is.", _not_in_air, everywhere="f3"),
    Act(_K.KILL, "k", "Kill", "Stop the motors at once: it falls.", _cannot_kill, Ask.ALWAYS, "f6"),
)
BY_NAME = {act.name: act for act in ACTS}
# In the order of their keys.
URGENT = tuple(sorted((act for act in ACTS if act.urgent), key=lambda act: act.everywhere))
