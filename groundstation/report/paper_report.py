"""The paper's figures 9 to 13 with their words, as a report on two flights."""

from __future__ import annotations

from functools import partial
from math import hypot

import numpy as np

from groundstation import __version__
from groundstation.report.document import Plate, Report
from groundstation.report.figures import cues, errors, force, motion, plane, velocities
from groundstation.report.paper_findings import (
    FINAL_M,
    findings,
    following,
    settled_at,
    strongest_near,
    to_target,
)
from groundstation.report.paper_flights import PAPER, Flights, Flown
from groundstation.training.mission import Mission
from sim.scenario import Wind

_TITLE = "The paper's figures 9 to 13, flown anew"
_SOURCE = (
    "R. Cumbicos, J. S. Ortiz: Bilateral Tele-Operation of an Unmanned Aerial Vehicle: Teaching and Learning "
    "Priority (Universidad de las Fuerzas Armadas ESPE), sections 5 and 6"
)
_LEAD = (
    "A simulated operator flies a simulated drone of a Phantom's size past obstacles to a target, with the paper's "
    "controller and nothing else: equation (4) makes the velocity reference, equation (5) the force on the hand. "
    "Pilot, arm and vehicle are those of every flight of this program; only the clock is virtual.",
    "Figures 9 and 12 are of a flight without wind, as the paper's test in a virtual environment. Figures 10, 11 "
    "and 13 are of one in wind with a rigid body for a vehicle, in place of the paper's test with a real drone.",
)


def report_on(flights: Flights, seed: int) -> Report:
    """Return the report on flights that were flown with a seed."""
    calm, windy, assisted = flights
    plates = (
        _motion("Figure 9", calm, "Without wind"),
        _motion("Figure 10", windy, _conditions(windy.mission.wind)),
        _force(windy),
        _cues(assisted),
        _errors(calm),
        _velocities(windy),
    )
    return Report(_TITLE, _LEAD, findings(flights), plates, _facts(calm.mission, windy.mission, seed))


def _motion(name: str, flown: Flown, conditions: str) -> Plate:
    series = flown.series
    closest = int(np.argmin(series.clearance))
    end = f"stops {to_target(flown)[-1]:.2f} m from the target" if flown.held else "does not hold the target"
    return Plate(
        name,
        f"{conditions} the drone goes round the obstacles and {end}",
        "In perspective with the way's shadow on the ground (lines every 2 m; dashed where an obstacle hides the "
        f"way), from the side and from above. The hull comes no nearer than {series.clearance[closest]:.2f} m to an "
        f"obstacle, the {series.nearest[closest]}. Circles are the hull every {plane.HULL_EVERY_S:g} s: where they "
        "crowd, the drone is slow.",
        motion.HEIGHT,
        partial(motion.draw, series=series, mission=flown.mission, radius=flown.radius),
    )


def _force(flown: Flown) -> Plate:
    push = strongest_near(flown.series)
    title = "The force on the hand; no obstacle was near"
    if push.name:
        title = f"The force on the hand reaches {push.force:.1f} N beside the {push.name}"
    return Plate(
        "Figure 11",
        title,
        "Strong lines: equation (5), f = −K p̃; thin lines: what the hand felt, after the passivity controller, "
        "which takes force away from a hand that gives in to it. Shaded: an obstacle is nearer than "
        f"{force.NEAR_M:g} m to the hull. Equation (5) knows no obstacles: what the hand feels beside them is the "
        "drone that follows a turn late, and the wind.",
        force.HEIGHT,
        partial(force.draw, series=flown.series),
    )


def _cues(flown: Flown) -> Plate:
    push = strongest_near(flown.series, "environment")
    title = "With what this program adds, obstacles push the hand away; none was near"
    if push.name:
        title = f"With what this program adds, the {push.name} itself pushes the hand, with up to {push.force:.1f} N"
    return Plate(
        "Beyond figure 11",
        title,
        "The same flight with the preset assisted: position is equation (5), environment the force of obstacles, "
        "guard that of the shield where it changes what the hand asks for. Cues that nobody could feel are left out.",
        cues.HEIGHT,
        partial(cues.draw, series=flown.series),
    )


def _errors(flown: Flown) -> Plate:
    assert flown.mission.target is not None
    settled = settled_at(flown.series.t, to_target(flown), FINAL_M)
    title = f"The errors do not stay within {FINAL_M:g} m of the target"
    if settled is not None:
        title = f"The errors converge: within {FINAL_M:g} m of the target from {settled:.1f} s on"
    return Plate(
        "Figure 12",
        title,
        f"Without wind. Shaded: the operator holds the target, {flown.mission.target.hold_s:g} s. What is left of "
        "the distance is the operator's own: a hand trembles and corrects what it sees. The controller's error p̃ "
        "is large while the drone flies, for it follows the hand late, and goes down as the hand comes to rest.",
        errors.HEIGHT,
        partial(errors.draw, series=flown.series, target=flown.mission.target, bar=FINAL_M),
    )


def _velocities(flown: Flown) -> Plate:
    found = following(flown.series)
    return Plate(
        "Figure 13",
        f"The drone executes the reference {found.lag:.2f} s late; wind and response leave {found.rest:.2f} m/s",
        "Reference: v_ref of equation (4), on the drone's own axes, as the velocity executed. The lag is the drone's "
        "response; what the title says is left once it is taken out is the root mean square in the plane. Below, "
        "the wind.",
        velocities.HEIGHT,
        partial(velocities.draw, series=flown.series),
    )


def _conditions(wind: Wind) -> str:
    gusts = f" and a gust of {max(hypot(*gust.velocity) for gust in wind.gust):.1f} m/s" if wind.gust else ""
    return f"In {hypot(*wind.mean):.1f} m/s of wind{gusts}"


def _facts(calm: Mission, windy: Mission, seed: int) -> tuple[tuple[str, str], ...]:
    control = PAPER.control
    return (
        ("Source of the theory", _SOURCE),
        ("Program", f"groundstation {__version__}, preset {control.preset}, seed {seed}"),
        ("Mission", f"{windy.name}: {windy.title}"),
        ("Vehicle without wind", _vehicle(calm)),
        ("Vehicle in wind", _vehicle(windy)),
        ("K₁", f"{', '.join(f'{gain:g}' for gain in control.k1)} 1/s (x, y, z, yaw)"),
        ("K of equation (5)", f"{', '.join(f'{gain:g}' for gain in control.stiffness)} N/m (x, y, z)"),
        ("Servo", "1 kHz in virtual time; setpoints and telemetry at 50 Hz; no delay but theirs"),
    )


def _vehicle(mission: Mission) -> str:
    vehicle = mission.vehicle
    return f"{vehicle.airframe}, model {vehicle.model}, estimate {mission.estimate.quality}"
