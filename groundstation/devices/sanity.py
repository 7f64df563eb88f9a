"""What no handle can say: a driver that says it is not believed, whatever the reason: noise, units, a defect."""

from __future__ import annotations

from math import isfinite, pi

from drivers.device import DeviceInfo, HandleState

# A workspace is a sphere that fits in; corners reach further. Three times as far is another unit.
_REACH = 3.0
# No hand is faster, m/s (a pitched ball leaves it at 45), nor turned further, rad.
_FASTEST = 50.0
_TURN = 2.0 * pi
_BUTTONS = 1 << 32
# A sample cannot be of the future; clocks of one machine agree within this, s.
_AHEAD_S = 0.01


def impossible(state: HandleState, info: DeviceInfo, now: float) -> str:
    """Return what is wrong with a handle's state, or "".

    Args:
        state: As the driver says it.
        info: Of the device.
        now: Monotonic s.
    """
    try:
        x, y, z = state.position
        u, v, w = state.velocity
        far, fast = x * x + y * y + z * z, u * u + v * v + w * w
        reach = _REACH * info.workspace
        if not far <= reach * reach:
            return _words("position", state.position, "m")
        if not fast <= _FASTEST * _FASTEST:
            return _words("velocity", state.velocity, "m/s")
        if not abs(state.yaw) <= _TURN:
            return _words("yaw", state.yaw, "rad")
        if not 0 <= state.buttons < _BUTTONS:
            return _words("buttons", state.buttons, "")
        if not (isfinite(state.device_time) and state.device_time <= now + _AHEAD_S):
            return _words("time", state.device_time, "s")
    except (TypeError, ValueError, OverflowError):
        return "its state is not made of numbers"
    return ""


def unusable(info: DeviceInfo) -> str:
    """Return what is wrong with what a device says of itself, or ""."""
    limits = (
        ("workspace", info.workspace, 1e-4, 10.0),
        ("force limit", info.force_limit, 0.0, 1e3),
        ("stiffness limit", info.stiffness_limit, 0.0, 1e6),
        ("rate", info.rate, 1.0, 1e4),
    )
    for name, value, low, high in limits:
        if not low <= value <= high:
            return f"its {name} of {value} is not possible"
    return ""


def _words(name: str, value: object, unit: str) -> str:
    return f"its {name} {value} {unit}".rstrip() + " is not possible"
