"""The loops over lanes in memory that `sim.many.fast` compiles; Python runs them too, slowly.

A batch lies in blocks of `LANES` vehicles, row after row, with strides that the compiler knows: so it steps several
vehicles with one instruction. A rigid body's steering and its motion are loops of their own, shorter and so faster
than one of both.

`single` and `light_blocks` serve every law whose functions are bound to `flown`, `fallen`, `take`, `put` and
`constants_of`; here those of the kinematic one are.
"""

from __future__ import annotations

import numpy as np

from sim.kinematics import Vector3, Vector4
from sim.many.lanes import DynamicConstants, KinematicConstants, Light, Rigid, RigidConstants
from sim.many.lanes import kinematic_fallen as fallen
from sim.many.lanes import kinematic_flown as flown
from sim.many.rows import Array, Orders
from sim.models.rigid.control import control
from sim.models.rigid.dynamics import State, advance

LANES = 64


def three(a: Array, i: int, by: int) -> Vector3:
    """Return a[i], a[i + by], a[i + 2 by]."""
    return a[i], a[i + by], a[i + 2 * by]


def four(a: Array, i: int, by: int) -> Vector4:
    """Return four numbers likewise."""
    return a[i], a[i + by], a[i + 2 * by], a[i + 3 * by]


def eight(a: Array, i: int, by: int) -> Light:
    """Return eight."""
    return four(a, i, by) + four(a, i + 4 * by, by)


def seventeen(a: Array, i: int, by: int) -> State:
    """Return seventeen."""
    return (*eight(a, i, by), *eight(a, i + 8 * by, by), a[i + 16 * by])


def put_four(a: Array, i: int, by: int, numbers: Vector4) -> None:
    """Write a[i], a[i + by], a[i + 2 by], a[i + 3 by]."""
    a[i], a[i + by], a[i + 2 * by], a[i + 3 * by] = numbers


def put_eight(a: Array, i: int, by: int, numbers: Light) -> None:
    """Write eight numbers likewise."""
    put_four(a, i, by, numbers[:4])
    put_four(a, i + 4 * by, by, numbers[4:])


def twenty(a: Array, i: int, by: int) -> Rigid:
    """Return twenty."""
    return eight(a, i, by) + eight(a, i + 8 * by, by) + four(a, i + 16 * by, by)


def put_twenty(a: Array, i: int, by: int, numbers: Rigid) -> None:
    """Write twenty."""
    put_eight(a, i, by, numbers[:8])
    put_eight(a, i + 8 * by, by, numbers[8:16])
    put_four(a, i + 16 * by, by, numbers[16:])


def kinematic_constants(a: Array, i: int) -> KinematicConstants:
    """Return the constants that begin at a[i]."""
    return (*four(a, i, 1), a[i + 4])


def dynamic_constants(a: Array, i: int) -> DynamicConstants:
    """Return the constants that begin at a[i]."""
    return eight(a, i, 1) + four(a, i + 8, 1) + three(a, i + 12, 1)


def rigid_constants(a: Array, i: int) -> RigidConstants:
    """Return the constants that begin at a[i]."""
    return (
        eight(a, i, 1)
        + eight(a, i + 8, 1)
        + eight(a, i + 16, 1)
        + eight(a, i + 24, 1)
        + three(a, i + 32, 1)
        + three(a, i + 35, 1)
    )


take, put, constants_of = eight, put_eight, kinematic_constants


def single(data: Array, width: int, steps: int) -> None:
    """Step one vehicle: its lane, `width` numbers, reference, wind, whether it flies, and constants, in a row."""
    lane = take(data, 0, 1)
    v_ref, wind, constants = four(data, width, 1), three(data, width + 4, 1), constants_of(data, width + 8)
    if data[width + 7] > 0.0:
        for _ in range(steps):
            lane = flown(lane, v_ref, wind, constants)
    else:
        for _ in range(steps):
            lane = fallen(lane, v_ref, wind, constants)
    put(data, 0, 1, lane)


def light_blocks(state: Array, orders: Orders, numbers: Array, steps: int) -> None:
    """Step blocks of a model whose time goes into sines, which are not computed several at once."""
    constants = constants_of(numbers, 0)
    for block in range(state.shape[0]):
        lanes = state[block].reshape(state.shape[1] * LANES)
        wanted, air = orders.v_ref[block].reshape(4 * LANES), orders.wind[block].reshape(3 * LANES)
        for i in range(LANES):
            lane, v_ref, wind = take(lanes, i, LANES), four(wanted, i, LANES), three(air, i, LANES)
            flying = orders.flying[block, i]
            for _ in range(steps):
                lane = flown(lane, v_ref, wind, constants) if flying else fallen(lane, v_ref, wind, constants)
            put(lanes, i, LANES, lane)


def rigid_blocks(state: Array, orders: Orders, numbers: Array, steps: int) -> None:
    """Step blocks of rigid bodies."""
    constants = rigid_constants(numbers, 0)
    commands = np.empty(4 * LANES)
    for block in range(state.shape[0]):
        lanes, v_ref = state[block].reshape(20 * LANES), orders.v_ref[block].reshape(4 * LANES)
        wind, flying = orders.wind[block].reshape(3 * LANES), orders.flying[block]
        for _ in range(steps):
            steer(lanes, v_ref, flying, commands, constants)
            move(lanes, commands, wind, constants)


def steer(lanes: Array, v_ref: Array, flying: Array, commands: Array, constants: RigidConstants) -> None:
    """Find a block's commands, and its integrals one step later; all 0 where the motors are stopped."""
    for i in range(LANES):
        command, integral = control(
            seventeen(lanes, i, LANES),
            three(lanes, 17 * LANES + i, LANES),
            four(v_ref, i, LANES),
            constants[:20],
        )
        on = flying[i]
        lanes[17 * LANES + i] = integral[0] if on else 0.0
        lanes[18 * LANES + i] = integral[1] if on else 0.0
        lanes[19 * LANES + i] = integral[2] if on else 0.0
        commands[i] = command[0] if on else 0.0
        commands[LANES + i] = command[1] if on else 0.0
        commands[2 * LANES + i] = command[2] if on else 0.0
        commands[3 * LANES + i] = command[3] if on else 0.0


def move(lanes: Array, commands: Array, wind: Array, constants: RigidConstants) -> None:
    """Move a block by one step."""
    for i in range(LANES):
        state = advance(
            seventeen(lanes, i, LANES),
            four(commands, i, LANES),
            three(wind, i, LANES),
            constants[20:29],
            constants[29:],
        )
        put_eight(lanes, i, LANES, state[:8])
        put_eight(lanes, 8 * LANES + i, LANES, state[8:16])
        lanes[16 * LANES + i] = state[16]
