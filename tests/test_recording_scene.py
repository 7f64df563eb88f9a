"""What stands still in a recording: every obstacle with all of its parts, pads, and a ground that holds them."""

from __future__ import annotations

import numpy as np
from canned_flight import canned_run
from msgspec.structs import replace

from groundstation.recording import entities
from groundstation.recording.scene import extent, static_scene
from sim.scenario import Gate, Pad, Sphere, Wall

MISSION = replace(
    canned_run().mission,
    obstacle=(
        Sphere("red balloon", (1.0, 2.0, 3.0), 0.5),
        Wall("wall", (-9.0, 4.0), (9.0, 4.0), 2.0, 0.2),
        Gate("gate", (5.0, 0.0, 2.0), 2.0, 2.0),
    ),
    pad=(Pad("roof", (0.0, -20.0, 3.0), 1.0),),
    route=(),
    target=None,
)


def test_every_part_of_an_obstacle_has_its_place():
    paths = [still.path for still in static_scene(MISSION)]
    assert f"{entities.OBSTACLES}/red_balloon" in paths
    assert f"{entities.OBSTACLES}/wall" in paths
    assert [path for path in paths if "gate" in path] == [
        f"{entities.OBSTACLES}/gate/{part}" for part in range(4)
    ]
    assert f"{entities.PAD}/roof" in paths
    assert len(set(paths)) == len(paths)


def test_the_scene_reaches_as_far_as_what_is_in_it():
    low, high = extent(MISSION)
    assert np.allclose(low, (-9.0, -20.0, 0.0))
    assert np.allclose(high, (9.0, 4.1, 3.5))
