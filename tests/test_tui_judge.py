"""What is normal, what is a warning, what is an alarm, and which of them the banner says."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from canned_flight import NOTHING, CannedFlight, canned_run

from groundstation.messages import Event, Phase, ServoReport, Severity, VehicleStatus
from groundstation.tui import judge
from groundstation.tui.acts import ACTS
from groundstation.tui.alarms import Alarms
from groundstation.tui.alerts import conditions
from groundstation.tui.finding import DeviceWatch
from groundstation.tui.frame import Frame
from groundstation.tui.hand import CENTRED
from groundstation.tui.hints import distance_to_target, next_step
from groundstation.tui.track import History, Track

INFO, WARNING, ALARM = Severity.INFO, Severity.WARNING, Severity.ALARM
RUN = canned_run()


def flying(seconds: float = 12.0):
    flight = CannedFlight(RUN)
    flight.advance(seconds)
    return flight.snapshot()


def frame(snapshot=None, guarded_by: str = "", **states: str) -> Frame:
    shown = flying() if snapshot is None else snapshot
    return Frame(
        snapshot=shown, run=RUN, started=1000.0, states=states, stick=CENTRED,
        hindrances={act.name: "" for act in ACTS}, guarded_by=guarded_by, notes=(), track=Track(), history=History(),
    )  # fmt: skip


def worst(shown: Frame) -> tuple[Severity, str]:
    """Return what the banner says of a frame that is the first of all."""
    alarms = Alarms()
    alarms.look(conditions(shown), shown.now)
    first = alarms.first()
    return (first.severity, first.text) if first is not None else (INFO, next_step(shown))


@pytest.mark.parametrize(
    ("silence", "connected", "severity"),
    [(0.1, 1, INFO), (0.6, 1, WARNING), (2.1, 1, ALARM), (0.1, 0, ALARM)],
)
def test_the_link_is_judged_by_the_vehicles_silence(silence, connected, severity):
    status = VehicleStatus(t=100.0, heard_t=100.0 - silence, connected=connected)
    assert judge.link(status, 100.0, 0.5) is severity


def test_a_vehicle_never_heard_has_no_age():
    assert judge.link_age(VehicleStatus(t=100.0), 100.0) == math.inf
    assert judge.link_age(None, 100.0) == math.inf
    assert judge.link(VehicleStatus(t=100.0, connected=1), 100.0, 0.5) is ALARM
    assert judge.link(None, 100.0, 0.5) is ALARM


@pytest.mark.parametrize(
    ("share", "severity"),
    [(0.9, INFO), (0.3, WARNING), (0.151, WARNING), (0.15, ALARM), (0.0, ALARM), (math.nan, INFO)],
)
def test_the_battery(share, severity):
    assert judge.battery(share) is severity


@pytest.mark.parametrize(
    ("value", "severity"), [(0.0, INFO), (1.0, WARNING), (4.9, WARNING), (5.0, ALARM), (math.nan, WARNING)]
)
def test_a_figure_that_is_bad_when_large(value, severity):
    assert judge.above(value, 1.0, 5.0) is severity


def test_the_servo_is_judged_against_its_own_tick():
    assert judge.lateness(ServoReport(rate=1000.0, late_p99=0.0005)) is INFO
    assert judge.lateness(ServoReport(rate=1000.0, late_p99=0.0015)) is WARNING
    assert judge.lateness(ServoReport(rate=4000.0, late_p99=0.0015)) is ALARM


def test_ticks_missed_while_starting_are_no_alarm_yet():
    assert judge.missed(ServoReport(ticks=300, missed=3)) is INFO
    assert judge.missed(ServoReport(ticks=300, missed=300)) is ALARM
    assert judge.missed(ServoReport(ticks=1_000_000, missed=900)) is INFO
    assert judge.missed(ServoReport(ticks=1_000_000, missed=2_000)) is WARNING


def test_a_mode_that_is_not_known_is_another():
    assert judge.mode_word(4) == "OFFBOARD"
    assert judge.mode_word(200) == "OTHER"


def test_all_well_says_what_can_be_done():
    severity, text = worst(frame())
    assert severity is INFO
    assert text.startswith("Engaged. Target")


def test_a_dead_process_is_said_with_what_it_means():
    severity, text = worst(frame(link="running", pilot="ended"))
    assert severity is ALARM
    assert text == "pilot has ended: no force, and the vehicle is told to hold."


def test_the_worst_process_comes_first():
    assert "link" in worst(frame(recorder="ended", link="silent"))[1]


def test_a_lost_link_is_an_alarm_a_short_silence_a_warning():
    shown = flying()
    lost = worst(frame(replace(shown, t=shown.t + 3.0)))
    short = worst(frame(replace(shown, t=shown.t + 0.5, vehicle=None)))
    assert lost[0] is ALARM
    assert "Link lost" in lost[1]
    assert short[0] is WARNING
    assert "silent for 0.52 s" in short[1]


def test_an_alarm_comes_before_a_warning_whatever_is_looked_at_first():
    shown = flying()
    shown.status.heard_t -= 0.8
    shown.device.present = 0
    severity, text = worst(frame(shown))
    assert severity is ALARM
    assert "device is gone" in text


@pytest.mark.parametrize(
    ("elapsed", "severity", "words"),
    [(1.0, INFO, "Looking for the haptic device"), (12.0, ALARM, "No haptic device has been found")],
)
def test_a_device_that_was_never_there_is_looked_for_until_it_should_have_been_found(
    elapsed, severity, words
):
    shown = flying(elapsed)
    shown.device.present = 0
    told = worst(replace(frame(shown), device_found=DeviceWatch().look(shown)))
    assert told[0] is severity
    assert words in told[1]


def test_a_device_that_was_there_is_gone_at_once():
    shown, watch = flying(1.0), DeviceWatch()
    assert watch.look(shown)
    shown.device.present = 0
    assert worst(replace(frame(shown), device_found=watch.look(shown))) == (
        ALARM, "The haptic device is gone: plug it in again; the hand is uncoupled.",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda s: setattr(s.device, "homed", 0), "not homed"),
        (lambda s: setattr(s.vehicle, "valid", 0), "not valid"),
        (lambda s: setattr(s.vehicle, "t", s.t - 1.0), "Position is 1.0 s old"),
        (lambda s: setattr(s.status, "battery", 0.1), "Battery at 10 %"),
        (lambda s: setattr(s.device, "t", s.t - 9.0), "No word from the haptic device"),
        (lambda s: setattr(s.status, "t", s.t - 1.5), "No word from the link process"),
    ],
)
def test_each_thing_that_is_wrong_is_said(edit, words):
    shown = flying()
    edit(shown)
    severity, text = worst(frame(shown))
    assert severity is not INFO
    assert words in text


def test_an_alarming_event_is_said_for_a_moment():
    shown = flying(12.0)
    event = Event(t=shown.t - 1.0, severity=ALARM, source=b"pilot", text=b"Disengaged: the hand is gone.")
    assert worst(frame(replace(shown, events=(event,)))) == (ALARM, "Disengaged: the hand is gone.")
    event.t -= 10.0
    assert worst(frame(replace(shown, events=(event,))))[0] is INFO


def test_the_next_step_follows_the_flight():
    assert "Waiting for the vehicle at udpin" in next_step(frame(NOTHING))
    assert "Shift+A arms" in next_step(frame(flying(0.4)))
    assert "t takes off" in next_step(frame(flying(0.8)))
    assert "e engages" in next_step(frame(flying(3.0)))
    shown = flying(3.0)
    shown.pilot.centred = 0
    shown.pilot.reason = b"the vehicle's position is 0.8 s old"
    assert next_step(frame(shown)) == (
        "Uncoupled: the vehicle's position is 0.8 s old. Space centres, e engages."
    )
    shown.pilot.phase = Phase.ENGAGING
    assert "Engaging" in next_step(frame(shown))
    shown.pilot.phase, shown.pilot.on_leash = Phase.ENGAGED, 1
    assert "leash" in next_step(frame(shown))


def test_what_keeps_the_vehicle_from_the_hand_is_said_the_hands_own_part_first():
    shown = flying()
    shown.pilot.on_leash = 1
    assert next_step(frame(shown, "column")) == "Guard: it keeps the vehicle away from column."
    assert next_step(frame(shown, "floor")) == "Guard: it keeps the vehicle away from the ground."
    shown.pilot.waiting = 1
    assert next_step(frame(shown, "column")) == "Centre the handle to take hold."
    shown.pilot.clutched = 1
    assert next_step(frame(shown, "column")) == "Clutch: the handle moves nothing. c takes hold again."


def test_the_way_to_the_target():
    shown = flying()
    x, y, z = RUN.mission.target.position
    shown.vehicle.position[:] = (x, y, z - 1.5, 0.0)
    assert distance_to_target(frame(shown)) == pytest.approx(1.5)
    assert math.isnan(distance_to_target(frame(NOTHING)))
