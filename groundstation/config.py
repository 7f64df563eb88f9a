"""Settings: `groundstation.toml` and flags become one typed object; a key that is not known is an error.

Numbers are SI. Fields of four are `[x, y, z, yaw]` or `[forward, left, up, yaw_rate]`.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Struct

from groundstation.errors import InputError
from sim.scenario import error_sentence, not_finite

Gain = Annotated[float, Meta(gt=0, le=1_000)]
Limit = Annotated[float, Meta(gt=0, le=1_000)]
Gains4 = tuple[Gain, Gain, Gain, Gain]
Gains3 = tuple[Gain, Gain, Gain]
Limits4 = tuple[Limit, Limit, Limit, Limit]

CONFIG_NAME = "groundstation.toml"


class ConfigError(InputError):
    """The settings are wrong; the message names file, key and reason."""


class Mapping(Struct, frozen=True, forbid_unknown_fields=True):
    """From the handle to ṗ_h: rate control.

    Attributes:
        frame: Axes the handle moves along: the world's (the paper) or the vehicle's heading.
        deadband: Displacement that means nothing, as a share of the workspace.
        expo: 0 linear, 1 cubic: finer near the centre.
        speed: ṗ_h at full displacement, m/s and rad/s.
        yaw_range: Rotation of the handle that gives the full yaw rate, rad.
        leash: Largest distance of p_h from the last seen p, m.
        leash_yaw: Likewise in yaw, rad.
    """

    frame: Literal["world", "heading"] = "heading"
    deadband: Annotated[float, Meta(ge=0, le=0.5)] = 0.05
    expo: Annotated[float, Meta(ge=0, le=1)] = 0.3
    speed: Limits4 = (2.0, 2.0, 1.0, 0.8)
    yaw_range: Annotated[float, Meta(gt=0, le=3.1)] = 1.0
    leash: Limit = 1.5
    leash_yaw: Annotated[float, Meta(gt=0, le=3.1)] = 0.8


class Control(Struct, frozen=True, forbid_unknown_fields=True):
    """Equations (4) and (5).

    Attributes:
        k1: Diagonal of K₁, 1/s in effect.
        stiffness: k_x, k_y, k_z: force on the hand a metre of position error, N/m.
        damping: Force against the handle's velocity, N·s/m; no more of it is used than the device renders passively.
        passivity: Keep the hand from being given more energy than it gave; off only to see what happens without.
    """

    k1: Gains4 = (1.2, 1.2, 1.2, 1.0)
    stiffness: Gains3 = (4.0, 4.0, 4.0)
    damping: Annotated[float, Meta(ge=0, le=50)] = 0.4
    passivity: bool = True


class Limits(Struct, frozen=True, forbid_unknown_fields=True):
    """What no setpoint and no force exceeds. By norm in the horizontal plane, else by axis.

    Attributes:
        horizontal_speed, vertical_speed: m/s.
        yaw_rate: rad/s.
        acceleration: m/s²; likewise `yaw_acceleration`, rad/s².
        jerk: m/s³; likewise `yaw_jerk`, rad/s³.
        force_slew: How fast the force on the hand changes, N/s.
        force_ramp_s: How long the force takes to come in after engaging, s.
    """

    horizontal_speed: Limit = 3.0
    vertical_speed: Limit = 1.5
    yaw_rate: Limit = 1.0
    acceleration: Limit = 3.0
    jerk: Limit = 20.0
    yaw_acceleration: Limit = 3.0
    yaw_jerk: Limit = 20.0
    force_slew: Limit = 200.0
    force_ramp_s: Limit = 0.1


class Safety(Struct, frozen=True, forbid_unknown_fields=True):
    """When to stop trusting.

    Attributes:
        state_stale_s: Age of the vehicle's state from which the hand is uncoupled.
        force_stale_s: Age of the vehicle's state from which the force ramps to zero.
        handle_stale_s: Age of the handle from which it is not flown.
        setpoint_stale_s: Age of a setpoint from which the gate keeps it back; never above 0.15.
        link_warning_s: Silence of the vehicle that is shown as a warning.
    """

    state_stale_s: Annotated[float, Meta(gt=0, le=1.0)] = 0.5
    force_stale_s: Annotated[float, Meta(gt=0, le=0.5)] = 0.1
    handle_stale_s: Annotated[float, Meta(gt=0, le=0.15)] = 0.1
    setpoint_stale_s: Annotated[float, Meta(gt=0, le=0.15)] = 0.15
    link_warning_s: Annotated[float, Meta(gt=0, le=5.0)] = 0.5


class Rates(Struct, frozen=True, forbid_unknown_fields=True):
    """How often, Hz."""

    setpoint: Annotated[float, Meta(ge=20, le=100)] = 50.0
    telemetry: Annotated[float, Meta(ge=10, le=250)] = 50.0
    screen: Annotated[float, Meta(ge=1, le=60)] = 30.0


class Settings(Struct, frozen=True, forbid_unknown_fields=True):
    """All settings of the program.

    Attributes:
        devices: Settings of device drivers, a table for each by its name; the driver knows what is in it.
    """

    mapping: Mapping = Mapping()
    control: Control = Control()
    limits: Limits = Limits()
    safety: Safety = Safety()
    rates: Rates = Rates()
    devices: dict[str, dict[str, Any]] = {}


def load_settings(path: Path | None) -> Settings:
    """Read the settings file, or the defaults where there is none and none was asked for.

    Args:
        path: The file asked for, or None for `groundstation.toml` here or in the user's configuration folder.

    Raises:
        ConfigError: With file, key and reason in one sentence.
    """
    file = path or _usual_file()
    if file is None:
        return Settings()
    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{file}: cannot be read ({error.strerror}); check the path.") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        raise ConfigError(f"{file}: is not valid TOML: {error}.") from error
    if where := not_finite(tables):
        raise ConfigError(f"{file}: {where}: is not a finite number; give a plain number.")
    try:
        return msgspec.convert(tables, Settings, strict=True)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{file}: {error_sentence(error)}") from error


def _usual_file() -> Path | None:
    import platformdirs

    here = Path(CONFIG_NAME)
    user = Path(platformdirs.user_config_dir("groundstation", appauthor=False)) / CONFIG_NAME
    return next((file for file in (here, user) if file.is_file()), None)
