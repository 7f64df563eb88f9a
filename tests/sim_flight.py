"""A simulator with the moves of a flight, in virtual time."""

import math

import pytest

from sim.autopilot.guidance import Target
from sim.autopilot.modes import Mode
from sim.scenario import Scenario, VehicleChoice
from sim.simulator import build

DT = 0.004


class Flight:
    """A simulated vehicle.

    Args:
        model: How it moves.
        airframe: What flies.
        scenario: More tables of the scenario.
    """

    def __init__(self, model="dynamic", airframe="matrice_100", **scenario):
        self.sim = build(Scenario(vehicle=VehicleChoice(airframe=airframe, model=model), **scenario))
        self.autopilot = self.sim.autopilot
        self.mailbox = self.autopilot.mailbox()
        self.texts = []

    def run(self, seconds, each=lambda: None):
        for _ in range(round(seconds / DT)):
            each()
            self.sim.step(DT)
            self.texts.extend(notice.text for notice in self.mailbox)
            self.mailbox.clear()

    def until(self, condition, at_most, each=lambda: None):
        for _ in range(round(at_most / DT)):
            if condition():
                return self
            self.run(DT, each)
        pytest.fail(f"did not happen within {at_most} s of virtual time: {self.texts}")

    def take_off(self, height=2.0):
        assert self.autopilot.arm().ok
        assert self.autopilot.take_off(height).ok
        self.until(lambda: self.autopilot.mode is Mode.HOLD, 30)
        self.run(4)
        return self

    def fly(self, velocity, seconds, yaw_rate=0.0):
        """Stream a world velocity in Offboard."""
        return self.follow(Target(velocity=velocity, yaw_rate=yaw_rate), seconds)

    def follow(self, setpoint, seconds):
        """Stream a setpoint in Offboard."""
        self.autopilot.offboard(setpoint)
        assert self.autopilot.set_mode(Mode.OFFBOARD).ok
        self.run(seconds, lambda: self.autopilot.offboard(setpoint))
        return self

    def set(self, *pairs):
        for name, value in zip(pairs[::2], pairs[1::2], strict=True):
            assert self.autopilot.parameters.set(name, value), name
        return self

    @property
    def mode(self):
        return self.autopilot.mode

    @property
    def speed(self):
        return math.hypot(*self.sim.v[:3])
