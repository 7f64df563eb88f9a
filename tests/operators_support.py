"""A short mission with a stay, a heading, an obstacle and a pad, for the tests of the simulated operators."""

import msgspec

from groundstation.operators.exercise import Exercise, fly
from groundstation.training.mission import Criteria, Landing, Mission, Waypoint
from sim.scenario import Cylinder, Pad

HOP = Mission(
    schema=1,
    name="hop",
    title="Aside, turned, and down on the pad",
    takeoff_altitude_m=1.2,
    route=(Waypoint((1.5, 0.0, 1.5)), Waypoint((2.0, 1.5, 1.5), radius=0.4, hold_s=1.0, yaw_deg=60.0)),
    landing=Landing("pad"),
    pad=(Pad("pad", (3.0, 1.5, 0.0), 0.5),),
    obstacle=(Cylinder("mast", (0.5, 2.5, 1.5), 0.2, 3.0),),
    criteria=Criteria(time_limit_s=60.0),
)
HOP_TOML = """\
schema = 1
name = "hop"
title = "A hop"
takeoff_altitude_m = 1.2
target = { position = [1.5, 0.0, 1.2], radius = 0.4, hold_s = 1.0 }
criteria = { time_limit_s = 30.0, final_error_m = 0.4 }
"""


def hop(**fields):
    return msgspec.structs.replace(HOP, **fields)


def flown(mission=HOP, operator="expert", seed=0, **fields):
    return fly(Exercise(mission, operator, seed, **fields))
