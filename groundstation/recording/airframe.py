"""A quadrotor to look at, as a mesh: body, arms, rotors, skids; the front is marked by nose and front rotors.

It is 0.65 m from rotor to rotor across, whatever vehicle flies: it shows pose, not type. Vehicle axes, m.
"""

from __future__ import annotations

import math

import numpy as np
import rerun as rr

from groundstation.recording.item import Numbers
from groundstation.recording.palette import ORANGE, Colour

_ARM_M = 0.325
_ROTOR_M = 0.16
_DIAGONALS = tuple(math.radians(angle) for angle in (45, 135, 225, 315))
_BODY: Colour = (238, 238, 242)
_DARK: Colour = (70, 74, 84)
_REAR: Colour = (150, 156, 170)
_SIDES = 24


def quadrotor() -> rr.Mesh3D:
    """Return the mesh, flat shaded: every triangle has its own corners and one normal."""
    parts: list[tuple[Numbers, Colour]] = [
        (_box((0.0, 0.0, 0.0), (0.24, 0.15, 0.07)), _BODY),
        (_box((0.15, 0.0, -0.005), (0.08, 0.11, 0.05), taper=0.35), ORANGE),
        (_box((-0.02, 0.0, 0.05), (0.13, 0.09, 0.04), taper=0.7), _DARK),
        (_box((0.0, 0.11, -0.12), (0.24, 0.018, 0.018)), _DARK),
        (_box((0.0, -0.11, -0.12), (0.24, 0.018, 0.018)), _DARK),
        (_box((0.0, 0.09, -0.075), (0.02, 0.018, 0.09)), _DARK),
        (_box((0.0, -0.09, -0.075), (0.02, 0.018, 0.09)), _DARK),
    ]
    for angle in _DIAGONALS:
        x, y = _ARM_M * math.cos(angle), _ARM_M * math.sin(angle)
        parts.append((_box((x / 2, y / 2, 0.01), (_ARM_M, 0.03, 0.022), yaw=angle), _DARK))
        parts.append((_prism((x, y, 0.03), 0.026, 0.05), _DARK))
        parts.append((_prism((x, y, 0.06), _ROTOR_M, 0.006), ORANGE if x > 0 else _REAR))
    triangles = np.concatenate([shape for shape, _ in parts])
    colours = np.concatenate([np.tile(colour, (3 * len(shape), 1)) for shape, colour in parts])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return rr.Mesh3D(
        vertex_positions=triangles.reshape(-1, 3),
        vertex_normals=np.repeat(normals, 3, axis=0),
        vertex_colors=colours.astype(np.uint8),
    )


def _box(
    centre: tuple[float, float, float],
    size: tuple[float, float, float],
    *,
    yaw: float = 0.0,
    taper: float = 1.0,
) -> Numbers:
    """Return a box's triangles, (12, 3, 3); `taper` makes its front face smaller."""
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    corners[4:, 1:] *= taper
    corners *= size
    cosine, sine = math.cos(yaw), math.sin(yaw)
    corners[:, :2] = corners[:, :2] @ np.array(((cosine, sine), (-sine, cosine)))
    corners += centre
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return np.array(
        [[corners[a], corners[b], corners[c]] for f in faces for a, b, c in (f[:3], (f[0], *f[2:]))]
    )


def _prism(centre: tuple[float, float, float], radius: float, height: float) -> Numbers:
    """Return an upright round's triangles, (4 sides, 3, 3)."""
    angles = np.linspace(0.0, math.tau, _SIDES, endpoint=False)
    ring = np.column_stack((radius * np.cos(angles), radius * np.sin(angles), np.zeros(_SIDES)))
    middle_high = np.array((0.0, 0.0, height / 2))
    middle_low = -middle_high
    low, high = ring + middle_low, ring + middle_high
    triangles: list[tuple[Numbers, Numbers, Numbers]] = []
    for i in range(_SIDES):
        j = (i + 1) % _SIDES
        triangles += [
            (low[i], low[j], high[j]),
            (low[i], high[j], high[i]),
            (middle_high, high[i], high[j]),
            (middle_low, low[j], low[i]),
        ]
    return np.array(triangles) + centre
