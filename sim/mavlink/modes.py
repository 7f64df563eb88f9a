"""PX4's custom modes: main and sub mode as they stand in HEARTBEAT and MAV_CMD_DO_SET_MODE (px4_custom_mode.h)."""

from __future__ import annotations

from sim.autopilot.navigator import Mode

CUSTOM_MODES: dict[Mode, tuple[int, int]] = {
    Mode.TAKEOFF: (4, 2),
    Mode.HOLD: (4, 3),
    Mode.RETURN: (4, 5),
    Mode.LAND: (4, 6),
    Mode.OFFBOARD: (6, 0),
}
MODES = {custom: mode for mode, custom in CUSTOM_MODES.items()}

_NO_STICKS = "no manual control signal"
_MANUAL = {1: "Manual", 2: "Altitude", 3: "Position", 5: "Acro", 7: "Stabilized"}


def custom_mode(mode: Mode) -> int:
    """Return HEARTBEAT's custom_mode: main mode in byte 2, sub mode in byte 3."""
    main, sub = CUSTOM_MODES[mode]
    return main << 16 | sub << 24


def refusal(main: int, sub: int) -> tuple[str, str]:
    """Return the name of a mode this vehicle does not have, and why not."""
    if main in _MANUAL:
        return _MANUAL[main], _NO_STICKS
    if (main, sub) == (4, 4):
        return "Mission", "no mission is on board"
    return f"Mode {main}/{sub}", "it is not simulated"
