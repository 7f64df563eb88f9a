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
from sim.scenario import error_sentence, unusable

Gain = Annotated[float, Meta(gt=0, le=1_000)]
Limit = Annotated[float, Meta(gt=0, le=1_000)]
Gains4 = tuple[Gain, Gain, Gain, Gain]
Gains3 = tuple[Gain, Gain, Gain]
Limits4 = tuple[Limit, Limit, Limit, Limit]
Limits3 = tuple[Limit, Limit, Limit]
Share = Annotated[float, Meta(ge=0, le=1)]
Button = Annotated[int, Meta(ge=-1, le=31)]

CONFIG_NAME = "groundstation.toml"


class ConfigError(InputError):
    """The settings are wrong; the message names file, key and reason."""


class Mapping(Struct, frozen=True, forbid_unknown_fields=True):
    """From the handle to ṗ_h and p_h.

    Attributes:
        mode: To begin with; *rate*: displacement gives a speed; *position*: the handle's travel, scaled, is p_h's.
        frame: Axes the handle moves along: the world's (the paper) or the vehicle's heading.
        deadband: Displacement that means nothing in rate mode, as a share of the workspace.
        expo: 0 linear, 1 cubic: finer near the centre.
        speed: ṗ_h at full displacement, m/s and rad/s; its yaw holds in position mode too.
        scale: In position mode, m of p_h a metre of the handle's travel, on each axis.
        fine: What fine leaves of `speed` and `scale`.
        yaw_range: Rotation of the handle that gives the full yaw rate, rad.
        leash: Largest distance of p_h from the last seen p, m.
        leash_yaw: Likewise in yaw, rad.
    """

    mode: Literal["rate", "position"] = "rate"
    frame: Literal["world", "heading"] = "heading"
    deadband: Annotated[float, Meta(ge=0, le=0.5)] = 0.05
    expo: Annotated[float, Meta(ge=0, le=1)] = 0.3
    speed: Limits4 = (2.0, 2.0, 1.0, 0.8)
    scale: Limits3 = (20.0, 20.0, 10.0)
    fine: Annotated[float, Meta(gt=0, le=1)] = 0.3
    yaw_range: Annotated[float, Meta(gt=0, le=3.1)] = 1.0
    leash: Limit = 1.5
    leash_yaw: Annotated[float, Meta(gt=0, le=3.1)] = 0.8


class Buttons(Struct, frozen=True, forbid_unknown_fields=True):
    """What the handle's buttons do: the number of each, from 0, or −1 for none.

    Attributes:
        clutch: While it is held the handle moves nothing: index as with a mouse.
        fine: While it is held, fine.
        mapping: Switches between rate and position.
        turn_left, turn_right: Turn at the full yaw rate while held, for a handle without rotation.
        release: Uncouples the hand: the vehicle holds.
        hold, land, return_home: Command that, as the keys do.
        enable: Enabling switch: the hand is coupled only while it is held. One with three positions is let go in its
            first, held in its middle, and let go again when it is squeezed through.
        panic: The contact of such a switch that closes when it is squeezed through: uncouples the hand.
    """

    clutch: Button = 0
    fine: Button = 1
    mapping: Button = 4
    turn_left: Button = 2
    turn_right: Button = 3
    release: Button = 5
    hold: Button = -1
    land: Button = -1
    return_home: Button = -1
    enable: Button = -1
    panic: Button = -1

    def __post_init__(self) -> None:
        for name in ("enable", "panic"):
            number = getattr(self, name)
            for other in self.__struct_fields__:
                if number >= 0 and other != name and getattr(self, other) == number:
                    raise ValueError(
                        f"{name} and {other} are both button {number}; give {name} one of its own"
                    )


class Control(Struct, frozen=True, forbid_unknown_fields=True):
    """Equations (4) and (5), and what may stand around them.

    Attributes:
        preset: Which cues, guard and compensation to begin with; see `groundstation.pilot.presets`.
        k1: Diagonal of K₁, 1/s in effect; less where the delay leaves no phase margin for it.
        phase_margin_deg: What the position loop keeps of phase at its crossover, degrees.
        stiffness: k_x, k_y, k_z: force on the hand a metre of position error, N/m.
        damping: Force against the handle's velocity, N·s/m; no more of it is used than the device renders passively.
        passivity: What keeps the hand from being given more energy than it gave: time-domain *observer*, *wave*
            variables, a two-layer energy *tank*, or *off*, only to see what happens without.
        compensation: The presets that compensate the vehicle's response may; off, none does.
        k3, k4: Diagonals of the dynamic compensation: pull of a small velocity error, 1/s, and its most, m/s².
        airframe: Preset or file whose χ is compensated on a vehicle that is not simulated; "" for none.
    """

    preset: Literal["paper", "assisted", "transparent", "training"] = "assisted"
    k1: Gains4 = (1.2, 1.2, 1.2, 1.0)
    phase_margin_deg: Annotated[float, Meta(ge=5, le=80)] = 45.0
    stiffness: Gains3 = (4.0, 4.0, 4.0)
    damping: Annotated[float, Meta(ge=0, le=50)] = 0.4
    passivity: Literal["observer", "wave", "tank", "off"] = "observer"
    compensation: bool = True
    k3: Gains4 = (2.5, 2.5, 2.5, 2.5)
    k4: Gains4 = (2.0, 2.0, 2.0, 2.0)
    airframe: str = ""


class Cues(Struct, frozen=True, forbid_unknown_fields=True):
    """Gains of the force cues beside equation (5); a preset gives each its weight.

    Attributes:
        environment: Push away from what is nearer than `reach`, N a metre nearer.
        reach: m from the hull.
        mismatch: Force a m/s between the velocity asked for and the one flown, N·s/m.
        guard: k of k (u_safe − u_cmd), N·s/m.
        part_limit: Largest norm of any one cue, N.
        guidance: Pull towards the mission's way, N a metre further from it than `tube`; see `[training]`.
        tube: So far from the way nothing pulls, m.
        guidance_limit: What guidance takes of the device's force at most, as a share.
    """

    environment: Gain = 5.0
    reach: Limit = 1.2
    mismatch: Gain = 1.0
    guard: Gain = 2.5
    part_limit: Limit = 6.0
    guidance: Gain = 6.0
    tube: Limit = 0.15
    guidance_limit: Annotated[float, Meta(gt=0, le=0.5)] = 0.3


class Shield(Struct, frozen=True, forbid_unknown_fields=True):
    """What keeps the velocity asked for out of obstacles and fence, and above the floor.

    Attributes:
        guard: A control *barrier*; a parametric *risk_field* in its place, to compare; or *off*.
        margin: Kept between hull and obstacle, m.
        braking: Share of `limits.acceleration` that it counts on for braking.
        floor: Lowest altitude of the vehicle's middle, m.
        ceiling: Highest, m; 0 for none.
        fence: Largest distance from the origin in the plane, m; 0 for none.
    """

    guard: Literal["barrier", "risk_field", "off"] = "barrier"
    margin: Annotated[float, Meta(ge=0, le=10)] = 0.25
    braking: Annotated[float, Meta(gt=0, le=1)] = 0.5
    floor: Annotated[float, Meta(ge=0, le=100)] = 0.5
    ceiling: Annotated[float, Meta(ge=0, le=1_000)] = 0.0
    fence: Annotated[float, Meta(ge=0, le=100_000)] = 0.0

    def __post_init__(self) -> None:
        if 0.0 < self.ceiling <= self.floor:
            raise ValueError(
                f"the ceiling, {self.ceiling}, is not above the floor, {self.floor}; raise one or lower the other"
            )


class Link(Struct, frozen=True, forbid_unknown_fields=True):
    """How gains and speed fall as the link worsens; between good and poor they fall evenly.

    Attributes:
        assumed_delay_s: Round trip until the first is measured.
        good_delay_s, poor_delay_s, hold_delay_s: Round trip up to which all is given, from which the least is, and
            from which the vehicle holds.
        good_loss, poor_loss, hold_loss: Likewise the share of frames lost.
        least_gain: Share of stiffness and cues that a poor link leaves.
        least_speed: Share of the speed limits that it leaves.
    """

    assumed_delay_s: Annotated[float, Meta(gt=0, le=1)] = 0.1
    good_delay_s: Annotated[float, Meta(gt=0, le=5)] = 0.2
    poor_delay_s: Annotated[float, Meta(gt=0, le=5)] = 0.8
    hold_delay_s: Annotated[float, Meta(gt=0, le=5)] = 1.2
    good_loss: Annotated[float, Meta(ge=0, lt=1)] = 0.05
    poor_loss: Annotated[float, Meta(ge=0, lt=1)] = 0.4
    hold_loss: Annotated[float, Meta(gt=0, le=1)] = 0.7
    least_gain: Annotated[float, Meta(gt=0, le=1)] = 0.4
    least_speed: Annotated[float, Meta(gt=0, le=1)] = 0.3

    def __post_init__(self) -> None:
        for name in ("delay_s", "loss"):
            good, poor, hold = (getattr(self, f"{word}_{name}") for word in ("good", "poor", "hold"))
            if not good < poor < hold:
                raise ValueError(
                    f"good_{name}, poor_{name}, hold_{name} must rise; they are {good}, {poor}, {hold}"
                )


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


class Training(Struct, frozen=True, forbid_unknown_fields=True):
    """What helps who learns.

    Attributes:
        guidance: How strongly the hand is guided to the mission's way, 0 to 1; *auto* fades as skill grows.
    """

    guidance: Literal["auto"] | Share = "auto"


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
    link_warning_s: Annotated[float, Meta(gt=0, le=5.0)] = 0.4


class Rates(Struct, frozen=True, forbid_unknown_fields=True):
    """How often, Hz."""

    setpoint: Annotated[float, Meta(ge=20, le=100)] = 50.0
    telemetry: Annotated[float, Meta(ge=10, le=250)] = 50.0
    screen: Annotated[float, Meta(ge=1, le=60)] = 30.0


class Recording(Struct, frozen=True, forbid_unknown_fields=True):
    """How much recordings may take.

    Attributes:
        part_mb: A flight that has grown so large goes on in a next file, `NAME.part-2.rrd` and so on, MB.
        folder_gb: When all flights in the log folder take more as one begins, the oldest go, GB; 0 for never.
        warn_gb: Less left on the disk is told, GB.
    """

    part_mb: Annotated[float, Meta(ge=1, le=100_000)] = 512.0
    folder_gb: Annotated[float, Meta(ge=0)] = 0.0
    warn_gb: Annotated[float, Meta(ge=0)] = 1.0


class Settings(Struct, frozen=True, forbid_unknown_fields=True):
    """All settings of the program.

    Attributes:
        devices: Settings of device drivers, a table for each by its name; the driver knows what is in it.
    """

    mapping: Mapping = Mapping()
    buttons: Buttons = Buttons()
    control: Control = Control()
    cues: Cues = Cues()
    shield: Shield = Shield()
    limits: Limits = Limits()
    link: Link = Link()
    safety: Safety = Safety()
    rates: Rates = Rates()
    recording: Recording = Recording()
    training: Training = Training()
    devices: dict[str, dict[str, Any]] = {}


def load_settings(path: Path | None) -> Settings:
    """Read the settings file, or the defaults where there is none and none was asked for.

    Args:
        path: The file asked for, or None for `groundstation.toml` here or in the user's configuration folder.

    Raises:
        ConfigError: With file, key and reason in one sentence.
    """
    file = path or usual_file()
    if file is None:
        return Settings()
    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{file}: cannot be read ({error.strerror}); check the path.") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{file}: is not UTF-8 text; settings are TOML files.") from error
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{file}: is not valid TOML: {error}.") from error
    if why := unusable(tables):
        raise ConfigError(f"{file}: {why}.")
    try:
        return msgspec.convert(tables, Settings, strict=True)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{file}: {error_sentence(error)}") from error


def differences(before: Settings, after: Settings) -> str:
    """Return in words which settings differ, with their new values; "" where none does."""
    return ", ".join(
        f"{section}.{key} = {getattr(table, key)}"
        for section in before.__struct_fields__
        if isinstance(table := getattr(after, section), Struct)
        for key in table.__struct_fields__
        if getattr(table, key) != getattr(getattr(before, section), key)
    )


def check_flown_by_rate(settings: Settings) -> None:
    """Refuse settings that no simulated hand flies by: it holds the handle where a speed is, not where a place is.

    Raises:
        ConfigError: The mapping begins in position mode.
    """
    if settings.mapping.mode != "rate":
        raise ConfigError('mapping.mode: a simulated hand flies by rate; set "rate" to let one fly.')


def usual_file() -> Path | None:
    """Return the settings file that is read where none is asked for, if there is one."""
    return next((file for file in (Path(CONFIG_NAME), user_file()) if file.is_file()), None)


def user_file() -> Path:
    """Return where the user's own settings file is, or would be."""
    import platformdirs

    return Path(platformdirs.user_config_dir("groundstation", appauthor=False)) / CONFIG_NAME
