"""The parameters the simulated vehicle honours: PX4's names and defaults (its parameter reference), with ranges."""

from __future__ import annotations

import math
from typing import NamedTuple


class Spec(NamedTuple):
    """What a parameter is by default and may be. `integer` is how it travels on the wire."""

    default: float
    lowest: float
    highest: float
    integer: bool = False


# Two defaults are not PX4's. COM_OBL_RC_ACT: 5 (hold) for 0 (position), which needs sticks that are not there.
# COM_RC_IN_MODE: 4 (no sticks), for the same reason; it and COM_RC_OVERRIDE are there to be read.
SPECS: dict[str, Spec] = {
    "BAT_CRIT_THR": Spec(0.07, 0.05, 0.5),
    "BAT_LOW_THR": Spec(0.15, 0.05, 0.5),
    "COM_DISARM_LAND": Spec(2.0, 0.1, 60.0),
    "COM_DISARM_PRFLT": Spec(10.0, 1.0, 600.0),
    "COM_DL_LOSS_T": Spec(10.0, 5.0, 300.0, integer=True),
    "COM_LOW_BAT_ACT": Spec(0, 0, 3, integer=True),
    "COM_OBL_RC_ACT": Spec(5, 3, 7, integer=True),
    "COM_OF_LOSS_T": Spec(1.0, 0.1, 60.0),
    "COM_RC_IN_MODE": Spec(4, 4, 4, integer=True),
    "COM_RC_OVERRIDE": Spec(1, 1, 1, integer=True),
    "MC_YAW_P": Spec(2.8, 0.1, 5.0),
    "MIS_TAKEOFF_ALT": Spec(2.5, 0.5, 80.0),
    "MPC_ACC_HOR": Spec(3.0, 2.0, 15.0),
    "MPC_ACC_HOR_MAX": Spec(5.0, 2.0, 15.0),
    "MPC_LAND_SPEED": Spec(0.7, 0.6, 3.0),
    "MPC_TKO_SPEED": Spec(1.5, 1.0, 5.0),
    "MPC_XY_CRUISE": Spec(5.0, 1.0, 20.0),
    "MPC_XY_P": Spec(0.95, 0.1, 2.0),
    "MPC_XY_VEL_I_ACC": Spec(0.4, 0.0, 10.0),
    "MPC_XY_VEL_MAX": Spec(12.0, 0.1, 20.0),
    "MPC_XY_VEL_P_ACC": Spec(1.8, 1.2, 5.0),
    "MPC_YAWRAUTO_MAX": Spec(60.0, 5.0, 360.0),
    "MPC_Z_P": Spec(1.0, 0.1, 1.5),
    "MPC_Z_VEL_I_ACC": Spec(2.0, 0.2, 3.0),
    "MPC_Z_VEL_MAX_DN": Spec(1.5, 0.5, 4.0),
    "MPC_Z_VEL_MAX_UP": Spec(3.0, 0.5, 8.0),
    "MPC_Z_VEL_P_ACC": Spec(4.0, 2.0, 15.0),
    "NAV_DLL_ACT": Spec(0, 0, 3, integer=True),
    "RTL_RETURN_ALT": Spec(30.0, 0.0, 150.0),
}
NAMES = tuple(SPECS)


class Parameters:
    """Current values by name."""

    def __init__(self) -> None:
        self._values = {name: spec.default for name, spec in SPECS.items()}

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def set(self, name: str, value: float) -> bool:
        """Take a value; say whether it was taken: it must be finite, in range, and whole for an integer."""
        spec = SPECS[name]
        if not math.isfinite(value) or not spec.lowest <= value <= spec.highest:
            return False
        if spec.integer and value != int(value):
            return False
        self._values[name] = value
        return True
