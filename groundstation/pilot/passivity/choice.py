"""Which way of keeping the port's account the settings name."""

from __future__ import annotations

from typing import Literal

from drivers.device import DeviceInfo
from groundstation.pilot.passivity.gains import physical_damping
from groundstation.pilot.passivity.observer import Observer
from groundstation.pilot.passivity.off import Off
from groundstation.pilot.passivity.scheme import Passivity
from groundstation.pilot.passivity.tank import Tank
from groundstation.pilot.passivity.wave import Wave

_GUARDED = {"observer": Observer, "wave": Wave, "tank": Tank}


def passivity_named(name: Literal["observer", "wave", "tank", "off"], device: DeviceInfo) -> Passivity:
    """Return what `control.passivity` names, for a device; a force that is only drawn, or rumbled, needs none."""
    if name == "off" or device.renders != "force":
        return Off()
    return _GUARDED[name](physical_damping(device))
