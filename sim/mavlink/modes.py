"""PX4's modes on the wire: custom modes (px4_custom_mode.h), and MAVLink's standard modes that name them."""

from __future__ import annotations

from typing import NamedTuple

from pymavlink.dialects.v20 import common as m

from sim.autopilot.modes import Mode
from sim.mavlink.dialect import available_mode

# MAV_MODE_PROPERTY.
_ADVANCED, _NOT_SELECTABLE = 1, 2


class Named(NamedTuple):
    """What a mode is called on the wire.

    Attributes:
        main: Byte 2 of HEARTBEAT's custom_mode.
        sub: Byte 3.
        standard: MAV_STANDARD_MODE, 0 where it is none.
        properties: MAV_MODE_PROPERTY.
    """

    main: int
    sub: int
    standard: int = m.MAV_STANDARD_MODE_NON_STANDARD
    properties: int = 0

    @property
    def custom(self) -> int:
        """As it stands in HEARTBEAT."""
        return self.main << 16 | self.sub << 24


CUSTOM_MODES: dict[Mode, Named] = {
    Mode.TAKEOFF: Named(4, 2, m.MAV_STANDARD_MODE_TAKEOFF),
    Mode.HOLD: Named(4, 3),
    Mode.RETURN: Named(4, 5, m.MAV_STANDARD_MODE_SAFE_RECOVERY),
    Mode.LAND: Named(4, 6, m.MAV_STANDARD_MODE_LAND),
    Mode.OFFBOARD: Named(6, 0, properties=_ADVANCED),
    Mode.MISSION: Named(4, 4, m.MAV_STANDARD_MODE_MISSION),
    Mode.POSITION: Named(3, 0, m.MAV_STANDARD_MODE_POSITION_HOLD),
    Mode.ALTITUDE: Named(2, 0, m.MAV_STANDARD_MODE_ALTITUDE_HOLD),
    # A failsafe's; PX4 tells it as Land.
    Mode.DESCEND: Named(4, 6, properties=_NOT_SELECTABLE),
}
_SELECTABLE = {mode: named for mode, named in CUSTOM_MODES.items() if not named.properties & _NOT_SELECTABLE}
MODES = {(named.main, named.sub): mode for mode, named in _SELECTABLE.items()}
STANDARD_MODES = {named.standard: mode for mode, named in CUSTOM_MODES.items() if named.standard}

_NOT_SIMULATED = "it is not simulated"
_NAMES = {1: "Manual", 5: "Acro", 7: "Stabilized"}
_BY_STICKS = m.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED | m.MAV_MODE_FLAG_STABILIZE_ENABLED
_BY_ITSELF = m.MAV_MODE_FLAG_AUTO_ENABLED | m.MAV_MODE_FLAG_STABILIZE_ENABLED | m.MAV_MODE_FLAG_GUIDED_ENABLED
_BASE_MODES = {Mode.POSITION: _BY_STICKS | m.MAV_MODE_FLAG_GUIDED_ENABLED, Mode.ALTITUDE: _BY_STICKS}


def custom_mode(mode: Mode) -> int:
    """Return HEARTBEAT's custom_mode: main mode in byte 2, sub mode in byte 3."""
    return CUSTOM_MODES[mode].custom


def base_mode(mode: Mode) -> int:
    """Return HEARTBEAT's base_mode, but for the flag that says armed."""
    return m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | _BASE_MODES.get(mode, _BY_ITSELF)


def available_modes(index: int) -> list[m.MAVLink_message] | None:
    """Return AVAILABLE_MODES for one mode, counted from 1, or for all (0); None where there is no such one."""
    number = len(_SELECTABLE)
    told = [
        available_mode(number, place, named.standard, named.custom, named.properties, mode.value)
        for place, (mode, named) in enumerate(_SELECTABLE.items(), 1)
    ]
    if index == 0:
        return told
    return told[index - 1 : index] if 1 <= index <= number else None


def refusal(main: int, sub: int) -> tuple[str, str]:
    """Return the name of a mode this vehicle does not have, and why not."""
    return _NAMES.get(main, f"Mode {main}/{sub}"), _NOT_SIMULATED
