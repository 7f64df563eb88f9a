"""What the simulated operators reach in a mission: its par, measured and not guessed, and their way as a ghost.

Lies as JSON beside the mission file, in `reference/`, and holds for the mission whose digest it carries.
"""

from __future__ import annotations

import math
from hashlib import sha256
from pathlib import Path

import msgspec
from msgspec import Struct

from groundstation.training.measures import Measures, Track
from groundstation.training.mission import Mission

FOLDER = "reference"
EXPERT = "expert"
# Kept of a measure: less than a tenth of a millimetre, or of a millisecond, is noise.
_DECIMALS = 4


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
    """Return a digest of all that a flight depends on: neither texts nor the place in the school are part of it."""
    plain = msgspec.structs.replace(
        mission,
        name="-",
        title="",
        teaches="",
        watch=(),
        skills=(),
        level=1,
        needs=(),
        route=tuple(msgspec.structs.replace(point, say="") for point in mission.waypoints),
        criteria=msgspec.structs.replace(mission.criteria, min_points=0.0),
    )
    return sha256(msgspec.json.encode(plain)).hexdigest()[:16]


def file_of(mission_path: Path) -> Path:
    """Return where the reference of a mission file lies."""
    return mission_path.parent / FOLDER / f"{mission_path.stem}.json"


def load_reference(mission: Mission, mission_path: Path) -> Reference | None:
    """Return the reference of a mission as read from its file; None where there is none that holds for it."""
    found = _read(file_of(mission_path))
    return found if isinstance(found, Reference) and found.digest == digest_of(mission) else None


def reference_fault(mission: Mission, mission_path: Path) -> str:
    """Return in one sentence why a mission has no reference that holds for it, or ""."""
    path = file_of(mission_path)
    found = _read(path)
    mend = f"measure it with `groundstation missions measure {mission_path}`"
    if isinstance(found, Reference):
        same = found.digest == digest_of(mission)
        return "" if same else f"{path}: was flown in another form of this mission; {mend}."
    return f"{path}: {found}; {mend}."


def save_reference(reference: Reference, mission_path: Path) -> Path:
    """Write the reference of a mission, in full or not at all; return its file.

    Raises:
        OSError: It cannot be written.
    """
    path = file_of(mission_path)
    path.parent.mkdir(exist_ok=True)
    draft = path.with_name(f".{path.name}.part")
    draft.write_bytes(_encoded(reference))
    draft.replace(path)
    return path


def _read(path: Path) -> Reference | str:
    """Return what a file holds, or in words why it is no reference."""
    try:
        return msgspec.json.decode(path.read_bytes(), type=Reference)
    except FileNotFoundError:
        return "there is no par yet"
    except OSError as error:
        return f"cannot be read ({error.strerror})"
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        return f"is no reference ({error})"


def _encoded(reference: Reference) -> bytes:
    """Return JSON with rounded numbers; what is not known is left out, as JSON has no NaN."""
    flights = {
        name: {seed: _rounded(measures) for seed, measures in flown.items()}
        for name, flown in reference.flights.items()
    }
    return (
        msgspec.json.encode({"digest": reference.digest, "flights": flights, "tracks": reference.tracks})
        + b"\n"
    )


def _rounded(measures: Measures) -> dict[str, float]:
    known = {name: value for name, value in msgspec.structs.asdict(measures).items() if not math.isnan(value)}
    return {name: round(value, _DECIMALS) for name, value in known.items()}
