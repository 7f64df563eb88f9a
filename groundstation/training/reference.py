"""What the simulated operators reach in a mission: its par, measured and not guessed, and their way as a ghost.

Lies as JSON beside the mission file, in `reference/`, and holds for the mission whose digest it carries.
"""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path

import msgspec
from msgspec import Struct

from groundstation.training.measures import Measures, Track
from groundstation.training.mission import Mission

FOLDER = "reference"
EXPERT = "expert"


class Reference(Struct, frozen=True):
    """The reference flights of a mission.

    Attributes:
        digest: Of the mission they flew.
        flights: By operator's name, then by seed: what they reached.
        tracks: By operator's name: where seed 0 went.
    """

    digest: str
    flights: dict[str, dict[int, Measures]]
    tracks: dict[str, Track]

    def par(self, seed: int) -> Measures | None:
        """Return what the expert reached on this seed; None where it was not flown."""
        return self.flights.get(EXPERT, {}).get(seed)


def digest_of(mission: Mission) -> str:
    """Return a digest of all that makes a mission what it is; titles and texts have no part in it."""
    plain = msgspec.structs.replace(mission, title="", teaches="", watch=())
    return sha256(msgspec.json.encode(plain)).hexdigest()[:16]


def file_of(mission_path: Path) -> Path:
    """Return where the reference of a mission file lies."""
    return mission_path.parent / FOLDER / f"{mission_path.stem}.json"
