"""The log survives what ends the program; the table has every column, Parquet and CSV alike."""

import csv

import pytest
from evaluation_support import CASE, result
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from groundstation.errors import InputError
from groundstation.evaluation.case import Case, Outcome
from groundstation.evaluation.store import CASE_COLUMNS, OUTCOME_COLUMNS, Log, write_table

LOST = Outcome(reason='"lost", after a while')


def flown(path):
    log = Log(path)
    log.close()
    return log.results


def test_what_was_added_is_there_when_the_log_is_opened_again(tmp_path):
    path = tmp_path / "log.jsonl"
    log = Log(path)
    assert log.results == {}
    for seed in range(3):
        log.add(result(seed=seed))
    # Nobody closed it: what is added is with the system already.
    assert path.read_bytes().count(b"\n") == 3
    log.close()
    assert set(flown(path).values()) == {result(seed=seed) for seed in range(3)}


@given(cut=st.integers(min_value=0, max_value=2000))
def test_a_log_cut_anywhere_gives_its_whole_lines_and_goes_on(tmp_path_factory, cut):
    path = tmp_path_factory.mktemp("cut") / "log.jsonl"
    log = Log(path)
    for seed in range(3):
        log.add(result(LOST, seed=seed))
    log.close()
    content = path.read_bytes()[:cut]
    path.write_bytes(content)
    log = Log(path)
    assert len(log.results) == content.count(b"\n")
    log.add(result(seed=7))
    log.close()
    assert len(flown(path)) == content.count(b"\n") + 1


def test_two_evaluations_do_not_write_one_log(tmp_path):
    log = Log(tmp_path / "log.jsonl")
    with pytest.raises(InputError, match="another evaluation is writing it"):
        Log(tmp_path / "log.jsonl")
    log.close()


def test_another_file_of_that_name_is_left_alone(tmp_path):
    path = tmp_path / "log.jsonl"
    path.write_text("my notes\nare precious\n")
    with pytest.raises(InputError, match="is no log of this version"):
        Log(path)
    assert path.read_text() == "my notes\nare precious\n"


def test_a_place_that_cannot_be_written_is_told(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        Log(tmp_path / "nowhere" / "log.jsonl")


def test_every_field_has_its_column():
    assert set(CASE_COLUMNS.values()) == set(Case.__struct_fields__)
    assert set(OUTCOME_COLUMNS.values()) == set(Outcome.__struct_fields__)


def test_parquet_has_types_and_leaves_empty_what_does_not_exist(tmp_path):
    write_table(tmp_path / "t.parquet", [result(), result(LOST, seed=1)])
    table = parquet.read_table(tmp_path / "t.parquet")
    assert table.column_names == [*CASE_COLUMNS, *OUTCOME_COLUMNS]
    first, second = table.to_pylist()
    assert (first["completed"], first["time_s"], first["seed"], first["mission"]) == (True, 10.0, 0, "step")
    assert second["time_s"] is second["rms_error_m"] is None
    assert str(table.schema.field("time_s").type) == "double"
    assert str(table.schema.field("seed").type) == "int64"
    assert str(table.schema.field("completed").type) == "bool"


def test_csv_says_the_same(tmp_path):
    write_table(tmp_path / "t.csv", [result(), result(LOST, seed=1)])
    with (tmp_path / "t.csv").open(newline="") as file:
        first, second = csv.DictReader(file)
    assert list(first) == [*CASE_COLUMNS, *OUTCOME_COLUMNS]
    assert (first["time_s"], first["airframe"]) == ("10.0", CASE.airframe)
    assert (second["time_s"], second["reason"]) == ("", LOST.reason)


def test_a_table_that_cannot_be_written_leaves_the_old_one(tmp_path, monkeypatch):
    path = tmp_path / "t.csv"
    write_table(path, [result()])
    old = path.read_text()
    (tmp_path / ".t.csv.part").mkdir()
    with pytest.raises(OSError, match="directory"):
        write_table(path, [result(), result(seed=1)])
    assert path.read_text() == old
