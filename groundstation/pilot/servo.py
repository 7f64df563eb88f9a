"""The pilot process: device ↔ Pilot.step ↔ bus, once every tick of the device's rate.

handle ──► engagement ──► Pilot.step ──► force on the hand
              ▲               └────────► setpoint, controller's state, handle on the bus
vehicle's state, commands
"""

from __future__ import annotations

import gc
import time
from math import hypot

import msgspec

from drivers.device import ZERO3, DeviceError, DeviceInfo, HandleState
from groundstation.bus import Bus
from groundstation.child import Lifeline, run_child
from groundstation.clock import Clock, Every, Pacer
from groundstation.config import differences
from groundstation.devices.keeper import ABSENT, DeviceKeeper, Keeper
from groundstation.devices.making import flight_device
from groundstation.devices.unpluggable import Unpluggable
from groundstation.messages import COMMAND, Command, CommandKind, MappingMode, Phase, Severity
from groundstation.pilot.chooser import (
    CHOOSING,
    after_settings,
    at_tick,
    beginning,
    commanded,
    enabled,
    obeyed,
    pressed,
    squeezed,
)
from groundstation.pilot.engagement import (
    Conditions,
    Ending,
    Engagement,
    advance,
    centred,
    disengage,
    engage,
)
from groundstation.pilot.guest import load_controller
from groundstation.pilot.inputs import Inputs
from groundstation.pilot.lateness import Lateness
from groundstation.pilot.limits import bounded
from groundstation.pilot.link_state import link_fault
from groundstation.pilot.outbox import MadeFrom, Outbox, Tick
from groundstation.pilot.pilot import Memory, Outputs, Pilot
from groundstation.pilot.realtime import request_realtime
from groundstation.pilot.sight import ZERO4
from groundstation.pilot.surroundings import surroundings_of
from groundstation.pilot.unplugging import Unplugging
from groundstation.pilot.vehicle_feed import VehicleFeed
from groundstation.run import Run, read_run, run_file

ROLE = "pilot"
REPORT_S = 0.5
# Waited for awake before a deadline, where real-time priority makes that worth it, s.
SPIN_S = 1e-4
AT_REST = HandleState(ZERO3, ZERO3, 0.0, 0, homed=False, device_time=0.0)

# After these the link steers by itself; after DISENGAGE the vehicle holds.
_RELEASING = frozenset(
    {
        CommandKind.DISENGAGE,
        CommandKind.HOLD,
        CommandKind.LAND,
        CommandKind.RETURN,
        CommandKind.DISARM,
        CommandKind.KILL,
    }
)


class Servo:
    """Everything between the device and the bus but the waiting: `tick` is one turn.

    Args:
        run: Settings, mission, and what is known of the vehicle.
        bus: Where records come from and go to.
        keeper: Of the haptic device.
        clock: Monotonic seconds.

    Attributes:
        rate: Ticks a second that the device is made for, Hz.
    """

    def __init__(self, run: Run, bus: Bus, keeper: Keeper, clock: Clock = time.monotonic) -> None:
        self._run = run
        self._settings = run.settings
        self._surroundings = surroundings_of(run)
        self._controller = load_controller(run.controller, run.settings)
        self._chosen = beginning(run.settings, guided=run.guidance > 0.0)
        self._bus = bus
        self._clock = clock
        self._keeper = keeper
        self._feed = VehicleFeed(bus, self._surroundings.radius)
        self._ahead = ZERO4
        self._speed_limits = self._feed.speed_limits
        self._commands = bus.subscriber(COMMAND)
        self._outbox = Outbox(bus)
        self._setpoint_due = Every(1.0 / run.settings.rates.setpoint)
        self._report_due = Every(REPORT_S)
        self._engagement = Engagement()
        self._reason = ""
        self._last_t = clock()
        self._place = ZERO3
        self._step_s = 0.0
        self._told_present, self._told_info = False, ABSENT
        self._fitted = self._taken = 0
        self._taken_t = 0.0
        self._fit(ABSENT)

    def tick(self, now: float, dt: float) -> None:
        """Run one turn.

        Args:
            now: Monotonic s.
            dt: Since the last turn by the loop's pace, s.
        """
        handle = self._keeper.read(now)
        if self._keeper.info is not self._info:
            self._fit(self._keeper.info)
        self._feed.update(now, self._ahead)
        if self._feed.speed_limits != self._speed_limits:
            self._take_speed_limits()
        hand, conditions = self._look(now, handle)
        for kind in commanded(self._chosen, hand.buttons, self._settings.buttons):
            self._outbox.command(now, kind)
        before = self._engagement.phase
        cut = self._decide(conditions) or not hand.homed
        phase = self._engagement.phase
        age = conditions.state_age
        feed = self._feed
        self._chosen = pressed(self._chosen, hand.buttons, self._settings.buttons)
        choices = at_tick(self._chosen, self._settings.buttons)
        inputs = Inputs(dt, phase, cut, hand, feed.sample, age, feed.delay, feed.loss, choices, feed.seen)
        began = self._clock()
        self._memory, outputs = self._pilot.step(self._memory, inputs)
        self._step_s = max(self._step_s, self._clock() - began)
        self._ahead = outputs.forecast.p
        if outputs.fault and phase is Phase.ENGAGED:
            self._engagement = Engagement()
            self._end(Ending(outputs.fault))
        self._keeper.write(outputs.force)
        self._publish(conditions, inputs, outputs, changed=self._engagement.phase is not before)

    def report(self, now: float, late: Lateness, missed: int, *, realtime: bool) -> None:
        """Tell twice a second which device there is, at once when it comes or goes, and how time is kept."""
        keeper = self._keeper
        due = self._report_due.due(now)
        if due or keeper.present is not self._told_present or keeper.info is not self._told_info:
            self._told_present, self._told_info = keeper.present, keeper.info
            self._outbox.device_report(now, keeper.info, present=keeper.present, homed=self._homed)
        if not due:
            return
        longest = (keeper.read_s, keeper.write_s, self._step_s)
        self._outbox.servo_report(now, self.rate, late.report(), longest, missed, realtime=realtime)
        keeper.read_s = keeper.write_s = self._step_s = 0.0
        if self._engagement.phase is Phase.DISENGAGED:
            self._outbox.setpoint(now, ZERO4, now, active=False)

    def close(self) -> None:
        """Leave no force on the hand and no setpoint for the vehicle."""
        try:
            self._keeper.close()
        finally:
            now = self._clock()
            self._outbox.setpoint(now, ZERO4, now, active=False)

    def _fit(self, info: DeviceInfo) -> None:
        """Fit the controller to a device."""
        self._info = info
        self.rate = info.rate
        self._pilot = self._made()
        self._memory = Memory()
        self._homed = False
        self._fitted += 1
        self._tell_gains()

    def _made(self) -> Pilot:
        """Return the controller for settings, device and vehicle: no faster than that allows itself."""
        self._allowed = bounded(self._settings.limits, self._speed_limits)
        settings = msgspec.structs.replace(self._settings, limits=self._allowed)
        return Pilot(settings, self._info, self._surroundings, self._controller)

    def _take_speed_limits(self) -> None:
        """Fit the controller to the speeds that the vehicle allows; a hand that is coupled is let go first."""
        self._speed_limits = self._feed.speed_limits
        now = bounded(self._settings.limits, self._speed_limits)
        if now == self._allowed:
            return
        self._engagement, ending = disengage(self._engagement, "the vehicle's speed limits have changed")
        if ending:
            self._end(ending._replace(severity=Severity.ALARM))
        self._pilot = self._made()
        words = f"{now.horizontal_speed:.3g} m/s around, {now.vertical_speed:.3g} m/s up and down"
        self._bus.event(Severity.INFO, f"Speed limits with this vehicle: {words}.")

    def _tell_gains(self) -> None:
        """Say where the device cannot render the gains that are set."""
        set_, info = self._settings.control, self._info
        for mode, used in zip(MappingMode, self._pilot.gains, strict=True):
            if (used.stiffness, used.damping) != (set_.stiffness, set_.damping):
                x, y, z = used.stiffness
                self._bus.event(
                    Severity.INFO,
                    f"In {mode.name.lower()} mode {info.name} is passive at {info.rate:.0f} Hz up to "
                    f"control.stiffness = [{x:.3g}, {y:.3g}, {z:.3g}], control.damping = {used.damping:.3g}: "
                    "these are used.",
                )

    def _look(self, now: float, handle: HandleState | None) -> tuple[HandleState, Conditions]:
        """Return the handle, at rest where there is none, and what coupling depends on."""
        feed = self._feed
        # Where nothing is known of it, it has not moved: from another place it would have worked on the force held.
        hand = handle if handle is not None else AT_REST._replace(position=self._place)
        self._place = hand.position
        self._homed = hand.homed
        east, north, up, _ = feed.sample.velocity
        conditions = Conditions(
            t=now,
            gap=now - self._last_t,
            believable=feed.believable,
            present=handle is not None,
            homed=handle is not None and handle.homed,
            centred=centred(hand, self._info, self._settings.mapping.yaw_range),
            handle_age=now - hand.device_time,
            connected=feed.connected,
            armed=feed.armed,
            in_air=feed.in_air,
            mode=feed.mode,
            streaming=feed.streaming,
            state_age=now - feed.state_t,
            state_valid=feed.valid,
            boots=feed.boots,
            link_fault=link_fault(feed.delay, feed.loss, self._settings.link),
            unsafe=feed.unsafe,
            enabled=enabled(hand.buttons, self._settings.buttons),
            squeezed=squeezed(hand.buttons, self._settings.buttons),
            speed=hypot(east, north),
            climb=abs(up),
            speed_limit=self._allowed.horizontal_speed,
            climb_limit=self._allowed.vertical_speed,
        )
        self._last_t = now
        return hand, conditions

    def _decide(self, conditions: Conditions) -> bool:
        """Follow commands and conditions; return whether the force must be gone at once."""
        for command in self._commands.drain():
            self._taken += 1
            self._taken_t = command.t
            self._obey(command, conditions)
        phase = self._engagement.phase
        self._engagement, ending = advance(self._engagement, conditions, self._settings.safety)
        if ending:
            self._end(ending)
            return ending.cut
        if self._engagement.phase is not phase:
            self._bus.event(Severity.INFO, "Engaged: the vehicle follows the hand.")
        return False

    def _obey(self, command: Command, conditions: Conditions) -> None:
        kind = CommandKind(command.kind)
        if kind is CommandKind.ENGAGE:
            self._engage(command, conditions)
        elif kind is CommandKind.SETTINGS:
            self._outbox.answer(conditions.t, command, self._take_settings())
        elif kind in CHOOSING:
            self._chosen, refusal = obeyed(self._chosen, command)
            self._outbox.answer(conditions.t, command, refusal)
        elif kind in _RELEASING:
            words = f"the operator commanded {kind.name.capitalize()}"
            self._engagement, ending = disengage(self._engagement, words)
            if ending:
                self._end(ending)
            if kind is CommandKind.DISENGAGE:
                self._outbox.answer(conditions.t, command, "")

    def _take_settings(self) -> str:
        """Take the settings that the run's file has now; return why not, or ""."""
        if self._engagement.phase is not Phase.DISENGAGED:
            return "the hand is engaged; release it first"
        before, flown_with = self._settings, (self._run, self._settings, self._surroundings)
        try:
            self._run = read_run(run_file(self._run.run_id))
            self._settings = self._run.settings
            self._surroundings = surroundings_of(self._run)
            self._fit(self._info)
        except (OSError, ValueError) as error:
            self._run, self._settings, self._surroundings = flown_with
            return f"the settings cannot be flown with: {error}"
        if words := differences(before, self._settings):
            self._bus.event(Severity.INFO, f"Settings: {words}.")
        self._chosen = after_settings(self._chosen, before, self._settings)
        return ""

    def _engage(self, command: Command, conditions: Conditions) -> None:
        before = self._engagement.phase
        self._engagement, words = engage(self._engagement, conditions, self._settings.safety)
        if words:
            self._reason = words
            refusal = f"Engage refused: {words}."
            self._bus.event(Severity.WARNING, refusal)
            self._outbox.answer(conditions.t, command, refusal)
            return
        self._reason = ""
        self._outbox.answer(conditions.t, command, "")
        if self._engagement.phase is not before:
            self._bus.event(Severity.INFO, "Engaging: waiting for the vehicle to confirm Offboard.")

    def _end(self, ending: Ending) -> None:
        self._reason = ending.words
        self._bus.event(ending.severity, f"Disengaged: {ending.words}.")

    def _publish(self, c: Conditions, inputs: Inputs, outputs: Outputs, *, changed: bool) -> None:
        """Send handle and inputs; at 50 Hz, and at once on a change, the setpoint and the controller's state."""
        hand, present, feed = inputs.hand, self._keeper.present, self._feed
        self._outbox.handle(c.t, hand, outputs.force, present=present)
        made_from = MadeFrom(
            inputs.dt, feed.newest_t, feed.status_t, feed.ranges_t, self._taken_t, self._taken, self._fitted,
            c.present, c.homed, present,
        )  # fmt: skip
        self._outbox.made_from(c.t, made_from)
        due = self._setpoint_due.due(c.t)
        if not (due or changed):
            return
        phase = self._engagement.phase
        if changed or phase is not Phase.DISENGAGED:
            active = phase is not Phase.DISENGAGED
            self._outbox.setpoint(c.t, outputs.setpoint, hand.device_time, active=active)
        tick = Tick(inputs, outputs, self._pilot.stop(outputs))
        self._outbox.pilot_state(c.t, tick, phase, self._reason, centred=c.present and c.centred)


def body(run: Run, bus: Bus, lifeline: Lifeline) -> None:
    """Run the servo until the lifeline ends.

    Raises:
        SystemExit: There is no such device; in words.
    """
    try:
        device = flight_device(run.device, run.settings)
    except DeviceError as error:
        raise SystemExit(str(error)) from error
    unpluggable = Unpluggable(device, time.monotonic)
    unplugging = Unplugging(bus, unpluggable, simulated=run.simulated)
    servo = Servo(run, bus, DeviceKeeper(unpluggable, bus.event, time.monotonic))
    words = request_realtime()
    if words:
        bus.event(Severity.INFO, words)
    # The loop makes no cycles; a collection in the middle of a tick would only be late.
    gc.freeze()
    gc.disable()
    try:
        turn(servo, unplugging, lifeline, realtime=not words)
    finally:
        servo.close()


def turn(servo: Servo, unplugging: Unplugging, lifeline: Lifeline, *, realtime: bool) -> None:
    """Keep the servo ticking at its device's rate."""
    rate = servo.rate
    pacer = Pacer(1.0 / rate, spin=SPIN_S if realtime else 0.0)
    late = Lateness(int(2 * REPORT_S * rate))
    while lifeline.holds():
        late.add(pacer.wait())
        now = time.monotonic()
        unplugging.turn(now)
        servo.tick(now, pacer.elapsed)
        servo.report(now, late, pacer.missed, realtime=realtime)
        if servo.rate != rate:
            rate = servo.rate
            pacer.restart(1.0 / rate)
            late = Lateness(int(2 * REPORT_S * rate))


if __name__ == "__main__":
    run_child(ROLE, body)
