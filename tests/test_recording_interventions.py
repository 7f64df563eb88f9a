"""What was let happen, in the recording: a lane of what is in force, words for people, and what was asked for."""

from recording_support import a_status, rows

from groundstation.messages import (
    INTERVENTION,
    INTERVENTION_ANSWER,
    VEHICLE_STATUS,
    Intervention,
    InterventionAnswer,
)
from groundstation.recording import entities, lanes
from groundstation.recording.batch import Batch
from groundstation.recording.interventions import Interventions
from groundstation.training.events import DeviceLoss, LinkLoss, WindChange
from groundstation.training.happening import Calm, packed
from groundstation.training.in_force import STATES

START = 50.0
WIND = WindChange(velocity=(3.0, 0.0, 0.0))


def answer(t, happening, *, number=7, ok=1, source=b"instructor", text=b""):
    return InterventionAnswer(
        t=START + t, number=number, ok=ok, source=source, happening=packed(happening), text=text
    )


def batch(answers=(), asked=(), status=()):
    made = Batch()
    made.add(INTERVENTION_ANSWER, answers)
    made.add(INTERVENTION, asked)
    made.add(VEHICLE_STATUS, [a_status(START + t) for t in status])
    return made


def test_a_flight_that_is_left_alone_has_nothing_of_it():
    assert not list(Interventions(START).chunks(batch(status=range(10))))


def test_the_lane_shows_the_gravest_and_when_it_ends_by_itself():
    told = Interventions(START)
    first = rows(
        told.chunks(batch([answer(2.0, LinkLoss(duration_s=3.0)), answer(1.0, WIND)], status=(0.5, 1.5, 4.9)))
    )
    assert first[lanes.INTERVENTION.path] == [(1.0, "wind"), (2.0, "link lost")]
    then = rows(told.chunks(batch(status=(5.1, 5.2))))
    assert then[lanes.INTERVENTION.path] == [(5.1, "wind")]
    last = rows(told.chunks(batch([answer(6.0, Calm())], status=(6.1,))))
    assert last[lanes.INTERVENTION.path] == [(6.0, "nothing")]


def test_words_are_by_whom_and_a_refusal_says_why():
    refused = answer(2.0, DeviceLoss(duration_s=5.0), ok=0, source=b"mission", text=b"the vehicle is real")
    found = rows(Interventions(START).chunks(batch([answer(1.0, WIND), refused])))
    assert found["/events/instructor"] == [(1.0, "Wind 3.0 m/s from the west.")]
    assert found["/events/mission"] == [(2.0, "Haptic device lost for 5 s refused: the vehicle is real.")]
    assert found[lanes.INTERVENTION.path] == [(1.0, "wind")], "what was refused is not in force"


def test_what_was_asked_for_is_there_as_it_crossed_the_bus():
    asked = Intervention(t=START + 1.0, number=7, source=b"instructor", happening=packed(WIND))
    chunks = list(Interventions(START).chunks(batch([answer(1.5, WIND)], [asked])))
    lines = [line for chunk in chunks for line in rows([chunk]).get(entities.INTERVENTIONS, ())]
    data = packed(WIND).decode()
    assert sorted(lines) == [(1.0, f"asked 7 instructor {data}"), (1.5, f"done 7 instructor {data}")]


def test_the_lane_knows_every_state():
    assert {word for word, _ in lanes.INTERVENTION.states} == {"nothing", *STATES.values()}
