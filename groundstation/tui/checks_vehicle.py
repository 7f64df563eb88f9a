"""The vehicle's side of the checks before a flight: who it is, how it is, what it does by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator

from groundstation.messages import Health, Severity
from groundstation.pilot.limits import bounded
from groundstation.tui import judge
from groundstation.tui.check import Check
from groundstation.tui.frame import Frame
from groundstation.tui.notes import words
from groundstation.tui.rows import quantity, span_of_time
from groundstation.vehicle.failsafes import verdict
from groundstation.vehicle.profiles import LEFT_BY_LANDING, outdated, profile_of

_OK, _CAUTION, _DANGER = Severity.INFO, Severity.WARNING, Severity.ALARM
# The vehicle's own words are given as a reason for so long, s: PX4 tells why it cannot be armed once, on asking.
_WORDS_S = 60.0
_SAYS = b"Vehicle: "
# An estimator needs about so long after it is switched on, s.
_SETTLED_S = 10.0
_CALIBRATED = {
    Health.GYRO: "gyroscopes",
    Health.ACCELEROMETER: "accelerometers",
    Health.MAGNETOMETER: "compass",
}


def link(frame: Frame) -> Check:
    """Return whether the vehicle is heard."""
    status = frame.snapshot.status
    severity = judge.link(status, frame.now, frame.run.settings.safety.link_warning_s)
    if status is None or not status.connected:
        return Check("link", _DANGER, f"no vehicle at {frame.run.url}", "switch it on, check the address")
    state = f"vehicle heard {span_of_time(judge.link_age(status, frame.now))} ago"
    return Check("link", severity, state, "check radio and antennas" if severity else "")


def link_quality(frame: Frame) -> Check:
    """Return how long the way there and back takes, and how much is lost on it."""
    status = frame.snapshot.status
    rtt, loss = (status.rtt, status.loss) if status is not None else (math.nan, math.nan)
    if not math.isfinite(rtt):
        return Check(
            "round trip, loss", _CAUTION, "not measured yet", "wait; the vehicle must answer TIMESYNC"
        )
    severity = max(
        judge.above(rtt, judge.RTT_WARNING_S, judge.RTT_ALARM_S),
        judge.above(loss, judge.LOSS_WARNING, judge.LOSS_ALARM),
    )
    state = f"{quantity(1000 * rtt, 'ms', 0)}, {quantity(100 * loss, '%', 1)} of frames lost"
    return Check("round trip, loss", severity, state, "check radio and antennas" if severity else "")


def identity(frame: Frame) -> Check:
    """Return who the vehicle is and what firmware it runs."""
    status = frame.snapshot.status
    if status is None or not status.connected:
        return Check("vehicle", _CAUTION, "not known", "see the link")
    profile, version = profile_of(status.autopilot), words(status.firmware)
    component = f", component {status.component}" if status.component else ""
    who = f"system {status.system_id}{component}"
    if profile is None:
        return Check("vehicle", _DANGER, f"{who}, unknown autopilot", "fly PX4 or ArduPilot")
    state = f"{who}, {profile.name} {version or 'of unknown version'}"
    if not profile.tested:
        remedy = "never flown with this program: props off first"
        return Check("vehicle", _CAUTION, f"{state}, untested", remedy)
    if not version:
        return Check("vehicle", _CAUTION, state, "wait until it tells its firmware")
    if outdated(profile, version):
        since = ".".join(map(str, profile.since))
        return Check("vehicle", _CAUTION, f"{state}, older than {since}", "update its firmware")
    return Check("vehicle", _OK, state)


def health(frame: Frame) -> Check:
    """Return what the vehicle says of its sensors, and whether it can be armed."""
    status = frame.snapshot.status
    if status is None or not status.connected:
        return Check("health", _CAUTION, "not known", "see the link")
    known = Health(status.health)
    if not known & ~Health.TRANSMITTER:
        return Check("health", _DANGER, "not told yet", "wait for the vehicle's telemetry")
    missing = [name for flag, name in _CALIBRATED.items() if flag not in known]
    if missing:
        return Check("health", _DANGER, f"not calibrated: {', '.join(missing)}", "calibrate the vehicle")
    if Health.ARMABLE not in known and not status.armed:
        if status.mode in LEFT_BY_LANDING:
            return Check(
                "health",
                _CAUTION,
                f"cannot be armed in {judge.mode_word(status.mode)}",
                "arm: it goes to Hold first",
            )
        why = _last_words(frame)
        remedy = "mend what it says" if why else "wait; on arming it tells why, see the log (F12)"
        return Check("health", _CAUTION, ": ".join(filter(None, ("cannot be armed yet", why))), remedy)
    return Check("health", _OK, "sensors calibrated, can be armed" if not status.armed else "armed")


def transmitter(frame: Frame) -> Check:
    """Return whether somebody can take over by hand."""
    status = frame.snapshot.status
    if status is None or not status.connected:
        return Check("transmitter", _CAUTION, "not known", "see the link")
    if Health.TRANSMITTER in Health(status.health):
        return Check("transmitter", _OK, "heard by the vehicle")
    if frame.run.simulated:
        return Check("transmitter", _OK, "none, and none is needed")
    return Check("transmitter", _CAUTION, "not heard: nobody can take over by hand", "switch it on")


def awake(frame: Frame) -> Check:
    """Return how long ago the vehicle was started."""
    vehicle = frame.snapshot.vehicle
    if vehicle is None:
        return Check("since boot", _CAUTION, "not told yet", "wait for the vehicle's telemetry")
    if vehicle.boot_t < _SETTLED_S:
        return Check(
            "since boot", _CAUTION, span_of_time(vehicle.boot_t), "give its estimator time to settle"
        )
    return Check("since boot", _OK, span_of_time(vehicle.boot_t))


def position(frame: Frame) -> Check:
    """Return whether the vehicle knows where it is."""
    vehicle = frame.snapshot.vehicle
    age = frame.age(vehicle)
    if vehicle is None or age > frame.run.settings.safety.state_stale_s:
        state = f"{span_of_time(age)} old" if math.isfinite(age) else "not told yet"
        return Check("position", _DANGER, state, "wait for the estimator, or check the link")
    if not vehicle.valid or Health.LOCAL_POSITION not in _health(frame):
        return Check("position", _DANGER, "the vehicle does not trust it", "wait for GPS or optical flow")
    if Health.GLOBAL_POSITION not in _health(frame):
        return Check(
            "position", _CAUTION, "local only, without GPS", "Return and the vehicle's own fence need GPS"
        )
    return Check("position", _OK, f"local and global trusted, {span_of_time(age)} old")


def home(frame: Frame) -> Check:
    """Return whether the vehicle has where to return to."""
    if Health.HOME in _health(frame):
        return Check("home", _OK, "set")
    return Check("home", _CAUTION, "not set: Return has nowhere to go", "wait for GPS, or arm to set it")


def battery(frame: Frame) -> Check:
    """Return how full the battery is."""
    status = frame.snapshot.status
    share = status.battery if status is not None else math.nan
    if not math.isfinite(share):
        return Check("battery", _CAUTION, "the vehicle does not say", "look at the battery yourself")
    assert status is not None
    severity = judge.battery(share)
    state = quantity(100 * share, "%", 0)
    if math.isfinite(status.voltage):
        state += f", {quantity(status.voltage, 'V', 1)}"
    return Check("battery", severity, state, "charge or change it" if severity else "")


def fence(frame: Frame) -> Check:
    """Return where the guard keeps the vehicle in."""
    mission, shield = frame.run.mission, frame.run.settings.shield
    fence = mission.fence if mission is not None else None
    radius, ceiling = (fence.radius, fence.ceiling) if fence else (shield.fence, shield.ceiling)
    if shield.guard == "off":
        return Check("fence", _CAUTION, "the guard is off in the settings", "shield.guard in Settings (F10)")
    if not radius and not ceiling:
        severity = _OK if frame.run.simulated else _CAUTION
        return Check("fence", severity, "none set", "" if frame.run.simulated else "set shield.fence (F10)")
    bounds = [f"{quantity(radius, 'm', 0)} around"] if radius else []
    bounds += [f"up to {quantity(ceiling, 'm', 0)}"] if ceiling else []
    return Check("fence", _OK, ", ".join(bounds))


def speeds(frame: Frame) -> Check:
    """Return how fast the vehicle is flown: never faster than it allows itself."""
    status, limits = frame.snapshot.status, frame.run.settings.limits
    told = tuple(status.speed_limits) if status is not None else (math.nan,) * 3
    profile = profile_of(status.autopilot) if status is not None else None
    if profile is None or not all(limit > 0.0 for limit in told):
        read = profile is not None and all(name in frame.snapshot.parameters for name in profile.speeds)
        state = "one of the vehicle's own is 0" if read else "the vehicle's own are not read"
        remedy = "see its parameters below" if read else "wait; F9 reads its parameters"
        return Check("speed limits", _DANGER, state, remedy)
    used = bounded(limits, (told[0], told[1], told[2]))
    state = (
        f"{used.horizontal_speed:.3g} m/s around, {used.vertical_speed:.3g} up, down; "
        f"its own {told[0]:.3g}, {told[1]:.3g}, {told[2]:.3g}"
    )
    if used != limits:
        return Check("speed limits", _CAUTION, state, "[limits] allows more: the vehicle's are kept")
    return Check("speed limits", _OK, state)


def parameters(frame: Frame) -> Iterator[Check]:
    """Yield how each parameter is set that decides what the vehicle does by itself."""
    status = frame.snapshot.status
    profile = profile_of(status.autopilot) if status is not None else None
    values = {name: parameter.value for name, parameter in frame.snapshot.parameters.items()}
    if profile is None:
        yield Check("parameters", _DANGER, "not known: no known autopilot is heard", "wait for the vehicle")
        return
    for each in profile.judged:
        judged = verdict(each, values)
        known = f" = {values[each.name]:g}" if each.name in values else ""
        yield Check(f"{each.name}{known}", judged.severity, judged.means, judged.remedy)


def _last_words(frame: Frame) -> str:
    """Return what the vehicle last complained of, if that is not long ago, or ""."""
    return next(
        (
            words(event.text.removeprefix(_SAYS))
            for event in reversed(frame.snapshot.events)
            if event.text.startswith(_SAYS) and event.severity and frame.now - event.t < _WORDS_S
        ),
        "",
    )


def _health(frame: Frame) -> Health:
    status = frame.snapshot.status
    return Health(status.health) if status is not None else Health(0)
