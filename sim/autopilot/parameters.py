"""The parameters the simulated vehicle honours: PX4's names, defaults and ranges, and a few of the simulator's own.

Source: PX4 v1.15 parameter reference (src/modules/{commander,navigator,mc_pos_control}/*_params.c) with the
multicopter defaults of ROMFS/px4fmu_common/init.d/rc.mc_defaults (NAV_ACC_RAD, RTL_RETURN_ALT, RTL_DESCEND_ALT).
Where PX4 allows more than is simulated, the range here is narrower.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Spec(NamedTuple):
    """What a parameter is by default and may be.

    Attributes:
        default: At start.
        lowest: Smallest value.
        highest: Largest value.
        integer: How it travels on the wire.
        among: The only values there are, where not all in the range mean something.
    """

    default: float
    lowest: float
    highest: float
    integer: bool = False
    among: tuple[int, ...] = ()

    def allows(self, value: float) -> bool:
        """Say whether the parameter may have this value."""
        if not math.isfinite(value) or not self.lowest <= value <= self.highest:
            return False
        if self.integer and value != int(value):
            return False
        return not self.among or value in self.among


def _whole(default: int, lowest: int, highest: int, *among: int) -> Spec:
    return Spec(default, lowest, highest, integer=True, among=among)


_LINK_ACTIONS = (0, 1, 2, 3, 5, 6)
_PX4: dict[str, Spec] = {
    "BAT_CRIT_THR": Spec(0.07, 0.05, 0.5),
    "BAT_EMERGEN_THR": Spec(0.05, 0.03, 0.5),
    "BAT_LOW_THR": Spec(0.15, 0.05, 0.5),
    "CBRK_FLIGHTTERM": _whole(121212, 0, 121212),
    "COM_ARM_BAT_MIN": Spec(-1.0, -1.0, 0.9),
    "COM_ARM_MIS_REQ": _whole(0, 0, 1),
    "COM_DISARM_LAND": Spec(2.0, -1.0, 60.0),
    "COM_DISARM_PRFLT": Spec(10.0, -1.0, 600.0),
    "COM_DLL_EXCEPT": _whole(0, 0, 7),
    "COM_DL_LOSS_T": _whole(10, 5, 300),
    "COM_FAIL_ACT_T": Spec(5.0, 0.0, 25.0),
    "COM_FLT_TIME_MAX": _whole(-1, -1, 86400),
    "COM_LKDOWN_TKO": Spec(3.0, -1.0, 5.0),
    "COM_LOW_BAT_ACT": _whole(0, 0, 3, 0, 2, 3),
    "COM_OBL_RC_ACT": _whole(0, 0, 7, 0, 1, 3, 4, 5, 6, 7),
    "COM_OF_LOSS_T": Spec(1.0, 0.0, 60.0),
    "COM_POSCTL_NAVL": _whole(0, 0, 1),
    "COM_RCL_EXCEPT": _whole(0, 0, 7),
    "COM_RC_IN_MODE": _whole(3, 0, 4),
    "COM_RC_LOSS_T": Spec(0.5, 0.0, 35.0),
    "COM_RC_OVERRIDE": _whole(1, 0, 3),
    "COM_RC_STICK_OV": Spec(30.0, 5.0, 80.0),
    "COM_TAKEOFF_ACT": _whole(0, 0, 1),
    "FD_FAIL_P": _whole(60, 0, 180),
    "FD_FAIL_P_TTRI": Spec(0.3, 0.02, 5.0),
    "FD_FAIL_R": _whole(60, 0, 180),
    "FD_FAIL_R_TTRI": Spec(0.3, 0.02, 5.0),
    "GF_ACTION": _whole(2, 0, 5),
    "GF_MAX_HOR_DIST": Spec(0.0, 0.0, 10000.0),
    "GF_MAX_VER_DIST": Spec(0.0, 0.0, 10000.0),
    "GF_PREDICT": _whole(0, 0, 1),
    "MC_YAWRATE_MAX": Spec(200.0, 0.0, 1800.0),
    "MC_YAW_P": Spec(2.8, 0.0, 5.0),
    "MIS_DIST_1WP": Spec(10000.0, -1.0, 100000.0),
    "MIS_TAKEOFF_ALT": Spec(2.5, 0.0, 80.0),
    "MIS_TKO_LAND_REQ": _whole(0, 0, 4),
    "MIS_YAW_ERR": Spec(12.0, 0.0, 90.0),
    "MPC_ACC_HOR": Spec(3.0, 2.0, 15.0),
    "MPC_ACC_HOR_MAX": Spec(5.0, 2.0, 15.0),
    "MPC_HOLD_DZ": Spec(0.1, 0.0, 1.0),
    "MPC_LAND_ALT1": Spec(10.0, 0.0, 122.0),
    "MPC_LAND_ALT2": Spec(5.0, 0.0, 122.0),
    "MPC_LAND_SPEED": Spec(0.7, 0.6, 3.0),
    "MPC_MAN_Y_MAX": Spec(150.0, 0.0, 400.0),
    "MPC_TKO_SPEED": Spec(1.5, 1.0, 5.0),
    "MPC_VEL_MANUAL": Spec(10.0, 3.0, 20.0),
    "MPC_XY_CRUISE": Spec(5.0, 1.0, 20.0),
    "MPC_XY_MAN_EXPO": Spec(0.6, 0.0, 1.0),
    "MPC_XY_P": Spec(0.95, 0.0, 2.0),
    "MPC_XY_VEL_I_ACC": Spec(0.4, 0.0, 60.0),
    "MPC_XY_VEL_MAX": Spec(12.0, 0.0, 20.0),
    "MPC_XY_VEL_P_ACC": Spec(1.8, 1.2, 5.0),
    "MPC_YAWRAUTO_MAX": Spec(45.0, 5.0, 360.0),
    "MPC_YAW_EXPO": Spec(0.6, 0.0, 1.0),
    "MPC_YAW_MODE": _whole(0, 0, 3),
    "MPC_Z_MAN_EXPO": Spec(0.6, 0.0, 1.0),
    "MPC_Z_P": Spec(1.0, 0.1, 1.5),
    "MPC_Z_VEL_I_ACC": Spec(2.0, 0.2, 3.0),
    "MPC_Z_VEL_MAX_DN": Spec(1.5, 0.5, 4.0),
    "MPC_Z_VEL_MAX_UP": Spec(3.0, 0.5, 8.0),
    "MPC_Z_VEL_P_ACC": Spec(4.0, 2.0, 15.0),
    "MPC_Z_V_AUTO_DN": Spec(1.5, 0.5, 4.0),
    "MPC_Z_V_AUTO_UP": Spec(3.0, 0.5, 8.0),
    "NAV_ACC_RAD": Spec(2.0, 0.05, 200.0),
    "NAV_DLL_ACT": _whole(0, 0, 6, *_LINK_ACTIONS),
    "NAV_MC_ALT_RAD": Spec(0.8, 0.05, 200.0),
    "NAV_RCL_ACT": _whole(2, 1, 6, *_LINK_ACTIONS[1:]),
    "RTL_CONE_ANG": _whole(45, 0, 90, 0, 25, 45, 65, 80, 90),
    "RTL_DESCEND_ALT": Spec(10.0, 0.0, 10000.0),
    "RTL_LAND_DELAY": Spec(0.0, -1.0, 10000.0),
    "RTL_MIN_DIST": Spec(10.0, 0.5, 10000.0),
    "RTL_RETURN_ALT": Spec(30.0, 0.0, 10000.0),
    "RTL_TYPE": _whole(0, 0, 3, 0, 1, 3),
}

# The simulator's own. The channel per direction, UP toward the vehicle: delay and jitter, s; shares of frames
# lost, doubled and reordered; bytes a second (0: no limit). A blackout of so many seconds from now, which goes back
# to 0 by itself. The wind: where the air goes to, m/s, and the strength of its turbulence, m/s. What happens once,
# by `sim.momentary`: a gust with its peak, m/s, and how long it blows, s; so many seconds without GPS; a battery that
# has only this share of its charge left.
# None may close the channel for good: a ground station must be able to take it back. Bytes a second from 1 to
# `LEAST_RATE` count as `LEAST_RATE`; whole silences are blackouts, which end.
LEAST_RATE = 1000.0
_CHANNEL = {
    "DELAY": Spec(0.0, 0.0, 10.0),
    "JITTER": Spec(0.0, 0.0, 10.0),
    "LOSS": Spec(0.0, 0.0, 0.95),
    "DUP": Spec(0.0, 0.0, 1.0),
    "REORD": Spec(0.0, 0.0, 1.0),
    "RATE": Spec(0.0, 0.0, 1e9),
}
_OWN: dict[str, Spec] = {
    **{f"SIM_{way}_{name}": spec for way in ("UP", "DN") for name, spec in _CHANNEL.items()},
    "SIM_BAT_LEFT": Spec(0.0, 0.0, 1.0),
    "SIM_GPS_LOST": Spec(0.0, 0.0, 60.0),
    "SIM_GUST_E": Spec(0.0, -40.0, 40.0),
    "SIM_GUST_N": Spec(0.0, -40.0, 40.0),
    "SIM_GUST_S": Spec(0.0, 0.0, 60.0),
    "SIM_GUST_U": Spec(0.0, -40.0, 40.0),
    "SIM_NET_BLACK": Spec(0.0, 0.0, 60.0),
    "SIM_WIND_E": Spec(0.0, -40.0, 40.0),
    "SIM_WIND_N": Spec(0.0, -40.0, 40.0),
    "SIM_WIND_U": Spec(0.0, -40.0, 40.0),
    "SIM_WIND_TURB": Spec(0.0, 0.0, 20.0),
}
SPECS: dict[str, Spec] = dict(sorted((_PX4 | _OWN).items()))
NAMES = tuple(SPECS)


class Parameters:
    """Current values by name.

    Attributes:
        changed: How often a value was set: whoever keeps what it read need only look again when this has grown.
    """

    def __init__(self) -> None:
        self._values = {name: spec.default for name, spec in SPECS.items()}
        self.changed = 0

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def set(self, name: str, value: float) -> bool:
        """Take a value; say whether it was taken: it must be finite, in range, and whole for an integer."""
        if not SPECS[name].allows(value):
            return False
        self._values[name] = value
        self.changed += 1
        return True
