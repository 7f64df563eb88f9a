"""A flight that never was, as a series that obeys the paper's equations exactly."""

import numpy as np

from groundstation.review.series import FlightSeries, clearances
from groundstation.training.mission import Mission, Target
from sim.scenario import Box, Cylinder, Gate, Sphere, Wall

K1, STIFFNESS = np.array((1.2, 1.2, 1.2, 1.0)), 4.0
STEP_S = 0.02
RADIUS = 0.3
TARGET = Target((4.0, 1.0, 2.0), hold_s=3.0)
OBSTACLES = (
    Box("crate", (2.0, -0.8, 1.0), (0.8, 0.6, 2.0), 30.0),
    Cylinder("mast", (1.0, 1.4, 1.5), 0.2, 3.0),
    Sphere("balloon", (3.0, 2.0, 2.0), 0.4),
    Wall("fence", (-1.0, 3.0), (5.0, 3.0), 1.5),
    Gate("arch", (3.4, 0.8, 2.0), 1.6, 1.4, 15.0),
)
MISSION = Mission(
    schema=1, name="made-up", title="Made up", route=((1.5, 0.2, 2.2),), target=TARGET, obstacle=OBSTACLES
)


def a_series(seconds=12.0, *, obstacles=OBSTACLES, lag=0.3, wind=(0.5, -0.2, 0.0)):
    """Return a flight that comes to the target ever more slowly and executes its reference `lag` s late."""
    t = np.arange(round(seconds / STEP_S)) * STEP_S
    share = 1.0 - np.exp(-0.7 * t)
    p = np.column_stack(
        (4.0 * share, np.sin(share * np.pi / 2.0), 2.0 + 0.3 * np.sin(t) * (1.0 - share), 0.1 * share)
    )
    error = np.column_stack((0.4 * np.exp(-t), 0.2 * np.exp(-t), -0.1 * np.exp(-t), 0.05 * np.exp(-t)))
    rate = np.gradient(p, STEP_S, axis=0)
    world = rate + K1 * np.tanh(error)
    c, s = np.cos(p[:, 3]), np.sin(p[:, 3])
    v_ref = np.column_stack(
        (c * world[:, 0] + s * world[:, 1], c * world[:, 1] - s * world[:, 0], world[:, 2:])
    )
    late = round(lag / STEP_S)
    executed = np.vstack((np.repeat(v_ref[:1], late, axis=0), v_ref[: len(t) - late]))
    force = -STIFFNESS * error[:, :3]
    nothing = np.zeros_like(force)
    clearance, nearest = clearances(p, obstacles, RADIUS)
    return FlightSeries(
        t=t,
        p=p,
        p_h=p + error,
        p_h_rate=rate,
        seen=p,
        error=error,
        v_ref=v_ref,
        executed=executed,
        force=force,
        cues={"position": force, "environment": nothing + np.array((0.0, 1.0, 0.0)), "guard": nothing},
        wind=np.broadcast_to(wind, force.shape),
        clearance=clearance,
        nearest=nearest,
    )
