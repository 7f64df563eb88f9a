"""What a vehicle's distance sensors measure, through MAVLink, UDP, MAVSDK and the bus, up to the pilot's points."""

import math
import time

import pytest

from bench.rig import Program
from groundstation.messages import OBSTACLES, RING_SECTORS
from groundstation.pilot.vehicle_feed import VehicleFeed

pytestmark = [pytest.mark.flight, pytest.mark.timeout(120)]

# Looking north-east at a wall that runs across, with a post on the left.
MISSION = """
schema = 1
name = "sensing"
title = "Something on every side"
[vehicle]
yaw_deg = 45.0
[[obstacle]]
shape = "wall"
name = "wall"
from = [6.0, 0.0]
to = [0.0, 6.0]
height = 6.0
[[obstacle]]
shape = "cylinder"
name = "post"
center = [-1.5, 1.5, 2.0]
radius = 0.3
height = 8.0
[target]
position = [0.0, 0.0, 2.0]
hold_s = 60.0
[criteria]
time_limit_s = 90.0
"""


def test_the_vehicles_sensors_reach_the_pilot(tmp_path):
    mission = tmp_path / "sensing.toml"
    mission.write_text(MISSION)
    program = Program("--sim", "--headless", "--mission", str(mission), "--logs", str(tmp_path))
    try:
        rings = program.bus.subscriber(OBSTACLES)
        feed = VehicleFeed(program.bus)
        heard = []

        def sees(view):
            feed.update(time.monotonic(), feed.sample.position)
            heard.extend(rings.drain())
            return view.status and view.status.rtt > 0.0 and len(heard) > 9 and len(feed.seen) > 1

        view = program.until(sees, 40, "the vehicle sees")
        record = heard[-1]
        x, y, z, yaw = feed.sample.position
        assert yaw == pytest.approx(math.radians(45.0), abs=0.1)
        # Wall ahead: its line is east + north = 6, less half its thickness. Post on the left.
        ahead = (6.0 - x - y) / math.sqrt(2.0)
        assert record.ring[0] == pytest.approx(ahead, abs=0.3)
        left = math.hypot(-1.5 - x, 1.5 - y) - 0.3
        assert record.ring[RING_SECTORS // 4] == pytest.approx(left, abs=0.3)
        assert record.ring[RING_SECTORS // 2] == math.inf
        assert record.below == pytest.approx(z, abs=0.3)
        assert math.isnan(record.above)
        assert record.limit == 12.0
        post, wall = feed.seen
        assert math.hypot(post[0] + 1.5, post[1] - 1.5) == pytest.approx(0.3, abs=0.2)
        assert wall[0] + wall[1] == pytest.approx(6.0, abs=0.5)
        assert 0.0 < view.status.rtt < 0.5
        assert feed.delay == pytest.approx(view.status.rtt, abs=0.5)
        assert feed.loss == 0.0
    finally:
        program.close()
