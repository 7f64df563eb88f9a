"""Who goes with a pilot on a mission: the ghost of an earlier flight, and guidance that fades as skill grows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from groundstation.errors import InputError
from groundstation.progress.flown import Flown
from groundstation.progress.opening import store_in
from groundstation.progress.skills import levels_of
from groundstation.progress.store import Store
from groundstation.training.measures import Track
from groundstation.training.mission import Mission
from groundstation.training.reference import EXPERT, digest_of, load_reference

Ghost = Literal["best", "reference", "off", ""]
# Who has this level in what a mission is mainly for is guided no more.
SKILLED = 80.0


def ghost_of(asked: Ghost, mission: Mission, path: Path, best: Track | None) -> Track | None:
    """Return the ghost to be followed.

    Args:
        asked: Whose; "" for the pilot's best flight, or the reference's where there is none yet.
        mission: What is flown.
        path: Its file: the reference lies beside it.
        best: The pilot's best flight.
    """
    if asked == "off":
        return None
    if asked == "best" or (not asked and best is not None):
        return best
    reference = load_reference(mission, path)
    return reference.tracks.get(EXPERT) if reference is not None else None


def skill_of(mission: Mission, flights: Sequence[Flown], curriculum: Sequence[Mission]) -> float:
    """Return what a pilot can of what a mission is mainly for, 0 to 1; of all they trained where it is for nothing.

    Args:
        mission: What is flown; the first of its skills counts.
        flights: The pilot's, oldest first.
        curriculum: All missions.
    """
    levels = levels_of({each.name: each for each in (*curriculum, mission)}, flights)
    if mission.skills:
        return levels.get(mission.skills[0], 0.0) / 100.0
    return sum(levels.values()) / len(levels) / 100.0 if levels else 0.0


def guidance_of(mission: Mission, flights: Sequence[Flown], curriculum: Sequence[Mission]) -> float:
    """Return how strong guidance is, 0 to 1: whole at first, none from `SKILLED` on; it falls with the level between.

    What is trained with help must be flown without it, or the help is what is learnt (the guidance hypothesis;
    Marchal-Crespo and Reinkensmeyer 2009, Review of control strategies for robotic movement training).

    Args:
        mission: What is flown; the first of its skills counts.
        flights: The pilot's, oldest first.
        curriculum: All missions.
    """
    if not mission.judged or not mission.skills:
        return 0.0
    level = 100.0 * skill_of(mission, flights, curriculum)
    return min(max(1.0 - level / SKILLED, 0.0), 1.0)


def flown_by(
    pilot: str, mission: Mission, logs: Path, tell: Callable[[str], None]
) -> tuple[list[Flown], Track | None]:
    """Return what a pilot has flown, oldest first, and the way of the best flight of a mission as it is now.

    Args:
        pilot: Who; "" for nobody.
        mission: What will be flown.
        logs: The folder of the store.
        tell: Told what is wrong with the store: that is no reason not to fly.
    """
    file = store_in(logs)
    if not pilot or not file.exists():
        return [], None
    try:
        with Store(file) as store:
            if store.words:
                tell(store.words)
            best = store.best(pilot, mission.name, digest_of(mission))
            return store.flights(pilot), store.track(best.number) if best is not None else None
    except InputError as error:
        tell(str(error))
        return [], None
