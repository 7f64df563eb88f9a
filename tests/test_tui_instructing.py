"""What an instructor's keys let happen: the strengths, the palette of a class of one, the instructor's screen."""

import itertools

import pytest
from recording_support import a_run
from test_instruct_command import a_flight

from groundstation.bus import Bus
from groundstation.instruct.screen import InstructorApp
from groundstation.instruct.seat import seat
from groundstation.messages import INTERVENTION, CommandKind
from groundstation.run import write_run
from groundstation.run_folder import Stay, sweep
from groundstation.training.answering import REAL
from groundstation.training.asking import Asker
from groundstation.training.events import BatteryLeft, GustNow, LinkLoss, WindChange
from groundstation.training.happening import Calm, packed, unpacked, words
from groundstation.training.strengths import OFFERS, STRENGTHS
from groundstation.tui.instructing import Instructing


@pytest.mark.parametrize("strength", range(len(STRENGTHS)))
def test_every_offer_can_happen_in_every_strength(strength):
    for offer, toward in itertools.product(OFFERS, (0.0, 1.0, 4.0)):
        happening = offer.at(strength, toward)
        assert unpacked(packed(happening)) == happening
        assert words(happening)


def test_no_key_has_two_meanings():
    keys = [offer.key for offer in OFFERS]
    assert len(set(keys)) == len(keys)
    assert not set(keys) & {"1", "2", "3", "c", "o", "h", "L", "s", "v", "q"}


def test_the_palette_lets_happen_and_tells_only_refusals(tmp_path):
    run = a_run(tmp_path / "flight")
    write_run(run)
    stay, bus, link = Stay(run.run_id), Bus(run.run_id, "screen"), Bus(run.run_id, "link")
    try:
        asked = link.subscriber(INTERVENTION)
        instructing = Instructing(Asker(bus, "instructor"))
        commands = {command.title: command for command in instructing.commands()}
        assert commands["Instructor: gust"].help == "Gust 7.0 m/s from the west, 4 s long."
        commands["Instructor: gust"].callback()
        commands["Instructor: take all back"].callback()
        assert [unpacked(each.happening) for each in asked.drain()] == [
            GustNow(velocity=(7.0, 0.0, 0.0), duration_s=4.0),
            Calm(),
        ]
        assert instructing.refusals() == []
        assert not list(Instructing(None).commands()), "a real vehicle is left alone"
    finally:
        bus.close()
        link.close()
        stay.end()
        sweep(run.run_id)


async def test_keys_of_the_instructors_screen(tmp_path):
    with a_flight(tmp_path) as (run, heard), seat(run) as taken:
        app = InstructorApp(taken)
        async with app.run_test(size=(120, 40)) as pilot:
            await pilot.press("3", "o", "o", "w", "1", "k", "b", "h", "s", *"go on", "enter")
            for _ in range(100):
                await pilot.pause(0.02)
                if any("Done: battery" in note.text for note in app._notes) and len(heard) >= 6:
                    break
            app.pull()
            told = [note.text for note in app._notes]
        wanted = [unpacked(each.happening) for each in heard if hasattr(each, "happening")]
        assert wanted == [
            WindChange(velocity=(0.0, -8.0, 0.0)), LinkLoss(duration_s=2.0), BatteryLeft(remaining=0.14)
        ]  # fmt: skip
        assert [each.kind for each in heard if hasattr(each, "amount")] == [CommandKind.HOLD]
        assert b"go on" in [each.text for each in heard if hasattr(each, "severity")]
        assert told[0] == "Asked for: wind 8.0 m/s from the north."
        assert "Done: battery down to 14 %." in told
        assert "battery down to 14 %" in taken.in_force.told(taken.look().t)


async def test_the_screen_says_what_is_refused_and_ends_with_the_flight(tmp_path):
    with a_flight(tmp_path, REAL) as (run, _), seat(run) as taken:
        app = InstructorApp(taken)
        async with app.run_test(size=(80, 24)) as pilot:
            await pilot.press("g")
            for _ in range(100):
                await pilot.pause(0.02)
                if any("Refused" in note.text for note in app._notes):
                    break
            assert f"Refused: gust 7.0 m/s from the west, 4 s long: {REAL}." in [n.text for n in app._notes]
            sweep(run.run_id)
            await pilot.pause(0.2)
        assert app.ended
        assert app.return_code == 0
