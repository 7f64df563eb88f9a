"""The bounds of a sampled spring: what stiffness and damping a device renders passively.

A spring of stiffness K with a damper B, sampled every T, is passive on a device of physical damping b only while
b > K T/2 + |B| (Colgate and Schenkel 1997, Passivity of a class of sampled-data systems).
"""

from __future__ import annotations

from typing import NamedTuple

from drivers.device import DeviceInfo, Vector3
from groundstation.config import Settings
from groundstation.messages import MappingMode


class Gains(NamedTuple):
    """Gains a device renders passively.

    Attributes:
        stiffness: Of equation (5), N a metre of position error.
        damping: N·s/m.
        share: Of the stiffness as set, and so of every cue that grows with a place, 0 to 1.
    """

    stiffness: Vector3
    damping: float
    share: float


def passive_gains(settings: Settings, device: DeviceInfo, mode: MappingMode) -> Gains:
    """Return the gains as set, or less where the device does not render so much passively at its rate.

    In rate mode a displacement Δx of the handle moves p_h by Δx · speed/workspace · T within a tick: a spring of
    k · speed/workspace · T at the handle. In position mode it moves p_h by scale · Δx: a spring of k · scale, and the
    environment's push is another. The spring has precedence over the damper. A force that is only drawn, or rumbled,
    needs no bound.
    """
    control, mapping = settings.control, settings.mapping
    if device.renders != "force":
        return Gains(control.stiffness, control.damping, 1.0)
    if mode is MappingMode.POSITION:
        springs = [k + settings.cues.environment for k in control.stiffness]
        factors = list(mapping.scale)
    else:
        springs = list(control.stiffness)
        factors = [speed / (device.workspace * device.rate) for speed in mapping.speed[:3]]
    felt = max(k * factor for k, factor in zip(springs, factors, strict=True))
    share = min(1.0, largest_stiffness(device, device.rate, 0.0) / felt)
    x, y, z = control.stiffness
    damping = min(control.damping, largest_damping(device, device.rate, share * felt))
    return Gains((share * x, share * y, share * z), damping, share)


def physical_damping(device: DeviceInfo) -> float:
    """Return b, N·s/m, for which the device's stiffness limit holds at its rate: b = K T/2."""
    return 0.5 * device.stiffness_limit / device.rate


def largest_stiffness(device: DeviceInfo, rate: float, damping: float) -> float:
    """Return the largest K, N/m, that is passive at a servo rate, Hz, beside a damper `damping`, N·s/m; 0 if none."""
    return max(0.0, 2.0 * rate * (physical_damping(device) - abs(damping)))


def largest_damping(device: DeviceInfo, rate: float, stiffness: float) -> float:
    """Return the largest |B|, N·s/m, that is passive at a servo rate, Hz, beside a spring, N/m; 0 if none."""
    return max(0.0, physical_damping(device) - 0.5 * stiffness / rate)
