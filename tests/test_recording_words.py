"""States are logged when they change, events and commands when they happen; and the schema is documented."""

from __future__ import annotations

from pathlib import Path

import pytest
from recording_support import a_pilot_state, a_run, a_status, batch_of, rows

from groundstation.messages import (
    COMMAND,
    COMMAND_ANSWER,
    DEVICE_REPORT,
    EVENT,
    MISSION_PROGRESS,
    PILOT_STATE,
    VEHICLE_STATUS,
    Command,
    CommandAnswer,
    CommandKind,
    DeviceReport,
    Event,
    FlightMode,
    MappingMode,
    MissionProgress,
    Phase,
    Preset,
    Severity,
    Stream,
)
from groundstation.recording import entities, lanes, palette, schema
from groundstation.recording.batch import Batch
from groundstation.recording.changes import Changes
from groundstation.recording.item import Chunk, Still
from groundstation.recording.session import Translator
from groundstation.recording.style import static_styles
from groundstation.training.director import Stage

START = 50.0
DOCS = Path(__file__).resolve().parents[1] / "docs"


def test_a_state_is_logged_when_it_changes_and_not_again_in_the_next_batch():
    changes = Changes(START)
    modes = (FlightMode.HOLD, FlightMode.HOLD, FlightMode.OFFBOARD)
    statuses = [a_status(START + i, mode=mode) for i, mode in enumerate(modes)]
    first = rows(changes.chunks(batch_of(VEHICLE_STATUS, *statuses)))
    assert first[lanes.MODE.path] == [(0.0, "hold"), (2.0, "offboard")]
    assert first[lanes.VEHICLE.path] == [(0.0, "in air")]
    again = rows(
        changes.chunks(batch_of(VEHICLE_STATUS, a_status(START + 3), a_status(START + 4, connected=False)))
    )
    assert again == {lanes.VEHICLE.path: [(4.0, "no link")]}


def test_the_leash_shows_in_the_phase_only_while_engaged():
    states = [
        a_pilot_state(START, phase=Phase.DISENGAGED, on_leash=True),
        a_pilot_state(START + 1, on_leash=False),
        a_pilot_state(START + 2, on_leash=True),
    ]
    found = rows(Changes(START).chunks(batch_of(PILOT_STATE, *states)))
    assert [word for _, word in found[lanes.PHASE.path]] == ["disengaged", "engaged", "on leash"]


@pytest.mark.parametrize(
    ("present", "homed", "word"), [(0, 1, "absent"), (1, 0, "not homed"), (1, 1, "ready")]
)
def test_the_device_is_absent_or_not_homed_or_ready(present, homed, word):
    report = DeviceReport(t=START, present=present, homed=homed)
    found = rows(Changes(START).chunks(batch_of(DEVICE_REPORT, report)))
    assert found == {lanes.DEVICE_STATE.path: [(0.0, word)]}


def test_a_reason_is_logged_once_and_its_end_is_not():
    said = [a_pilot_state(START + i) for i in range(4)]
    for state, reason in zip(said, (b"no device", b"no device", b"", b"link lost"), strict=True):
        state.reason = reason
    found = rows(Changes(START).chunks(batch_of(PILOT_STATE, *said)))
    assert found[entities.REASON] == [(0.0, "no device"), (3.0, "link lost")]


def test_what_the_guard_keeps_away_from_is_logged_when_it_begins_and_not_when_it_ends():
    said = [a_pilot_state(START + i, guarding=bool(name)) for i, name in enumerate(NAMES)]
    for state, name in zip(said, NAMES, strict=True):
        state.guarded_by = name
    found = rows(Changes(START).chunks(batch_of(PILOT_STATE, *said)))
    assert found[entities.GUARDED] == [
        (1.0, "keeps away from crate"),
        (3.0, "keeps away from floor"),
        (5.0, "keeps away from floor"),
    ]
    assert found[lanes.GUARD.path] == [
        (0.0, "lets pass"),
        (1.0, "guards"),
        (4.0, "lets pass"),
        (5.0, "guards"),
    ]


NAMES = (b"", b"crate", b"crate", b"floor", b"", b"floor")


@pytest.mark.parametrize(
    ("mapping", "flags", "word"),
    [
        (MappingMode.RATE, {}, "rate"),
        (MappingMode.RATE, {"fine": 1}, "rate, fine"),
        (MappingMode.POSITION, {}, "position"),
        (MappingMode.POSITION, {"fine": 1}, "position, fine"),
        (MappingMode.POSITION, {"clutched": 1, "waiting": 1}, "clutched"),
        (MappingMode.RATE, {"waiting": 1, "fine": 1}, "waiting for the centre"),
    ],
)
def test_how_the_handle_moves_p_h_is_one_word_of_its_lane(mapping, flags, word):
    state = a_pilot_state(START)
    state.mapping = mapping
    for name, value in flags.items():
        setattr(state, name, value)
    found = rows(Changes(START).chunks(batch_of(PILOT_STATE, state)))
    assert found[lanes.MAPPING.path] == [(0.0, word)]
    assert word in {known for known, _ in lanes.MAPPING.states}


def test_preset_and_compensation_are_lanes():
    states = [a_pilot_state(START), a_pilot_state(START + 1)]
    states[1].preset, states[1].compensated = Preset.TRAINING, 1
    found = rows(Changes(START).chunks(batch_of(PILOT_STATE, *states)))
    assert found[lanes.PRESET.path] == [(0.0, "assisted"), (1.0, "training")]
    assert found[lanes.COMPENSATION.path] == [(0.0, "off"), (1.0, "on")]


def test_a_number_that_means_nothing_does_not_end_the_recording():
    found = rows(Changes(START).chunks(batch_of(VEHICLE_STATUS, a_status(START, mode=250))))
    assert found[lanes.MODE.path] == [(0.0, "250")]


def test_events_are_filed_by_source_with_their_level():
    events = [
        Event(t=START + 1, severity=Severity.ALARM, source=b"link", text=b"Vehicle lost."),
        Event(t=START + 2, severity=Severity.INFO, source=b"pilot", text="Höhe \xff".encode("latin-1")),
    ]
    chunks = list(Changes(START).texts(batch_of(EVENT, *events)))
    assert rows(chunks) == {"/events/link": [(1.0, "Vehicle lost.")], "/events/pilot": [(2.0, "H�he �")]}
    levels = [column.as_arrow_array().to_pylist() for column in chunks[0].columns]
    assert [["ERROR"]] in levels


def test_commands_and_answers_read_as_sentences_in_one_place_in_their_order():
    batch = Batch()
    batch.add(COMMAND, [Command(t=START + 1, number=1, kind=CommandKind.ENGAGE, source=b"screen")])
    batch.add(
        COMMAND_ANSWER, [CommandAnswer(t=START + 2, number=1, kind=CommandKind.ENGAGE, ok=0, text=b"no link")]
    )
    batch.add(COMMAND_ANSWER, [CommandAnswer(t=START + 1.5, number=1, kind=CommandKind.ARM, ok=1)])
    assert rows(Changes(START).texts(batch)) == {
        entities.COMMANDS: [
            (1.0, "Engage asked for (screen)"),
            (1.5, "Arm done"),
            (2.0, "Engage refused: no link"),
        ]
    }


def test_every_state_a_lane_can_take_has_its_colour():
    words = {lane.path: {word for word, _ in lane.states} for lane in lanes.LANES}
    assert words[lanes.MODE.path] == {mode.name.lower() for mode in FlightMode}
    assert words[lanes.STREAM.path] == {state.name.lower() for state in Stream}
    assert words[lanes.PHASE.path] == {phase.name.lower() for phase in Phase} | {"on leash"}
    assert words[lanes.STAGE.path] == {stage.value for stage in Stage}
    assert words[lanes.PRESET.path] == {preset.name.lower() for preset in Preset}
    modes = {mode.name.lower() for mode in MappingMode}
    assert modes | {f"{mode}, fine" for mode in modes} < words[lanes.MAPPING.path]
    assert set(palette.TONES) == set(lanes.Tone)


def test_every_quantity_has_names_and_colours_for_all_its_series():
    styled = {still.path: still.content for still in static_styles()}
    for quantity in schema.QUANTITIES:
        assert len(styled[quantity.path].colors.as_arrow_array()) == len(quantity.parts), quantity.path
        assert len(styled[quantity.path].names.as_arrow_array()) == len(quantity.parts), quantity.path


def test_no_entity_has_two_meanings():
    paths = [item.path for item in (*schema.QUANTITIES, *lanes.LANES)]
    assert len(paths) == len(set(paths))


def test_the_logs_page_shows_the_schema_as_it_is():
    assert schema.tables() in (DOCS / "logs.md").read_text(encoding="utf-8")


def test_the_device_is_described_once_it_reports_and_again_when_it_is_another(tmp_path):
    translator = Translator(a_run(tmp_path / "flight"), START)

    def told(name: bytes, present: int = 1) -> list[str]:
        report = DeviceReport(t=START, name=name, serial=b"7", present=present, workspace=0.04, force_limit=8)
        return [i.path for i in translator.items(batch_of(DEVICE_REPORT, report)) if isinstance(i, Still)]

    page = ["/__properties/device", entities.ABOUT]
    assert told(b"Falcon", present=0) == []
    assert told(b"Falcon") == page
    assert told(b"Falcon") == []
    assert told(b"Inverse3") == page


def test_the_stage_is_logged_in_the_directors_words(tmp_path):
    progress = MissionProgress(t=START, stage=Stage.HOLDING.value.encode())
    items = Translator(a_run(tmp_path / "flight"), START).items(batch_of(MISSION_PROGRESS, progress))
    chunks = [item for item in items if isinstance(item, Chunk) and item.path == lanes.STAGE.path]
    assert rows(chunks) == {lanes.STAGE.path: [(0.0, "holding at the target")]}
