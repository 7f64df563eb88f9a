"""Intervals against tables and against chance, pairs within a seed, and how it is told."""

import math
from random import Random

import pytest
from evaluation_support import result
from hypothesis import given
from hypothesis import strategies as st

from groundstation.evaluation import figure
from groundstation.evaluation.case import Outcome
from groundstation.evaluation.comparison import METRICS, average, completed, difference, discordant, subjects
from groundstation.evaluation.intervals import mean, student, wilson
from groundstation.evaluation.words import comparison

TIME = next(metric for metric in METRICS if metric.name == "time")


def outcome(time=10.0, completed=True, **figures):
    return Outcome(completed=completed, time=time, **{"rms_error": 0.1, "clearance": 1.0} | figures)


@pytest.mark.parametrize(
    ("freedom", "quantile"),
    [(1, 12.7062), (2, 4.3027), (3, 3.1824), (4, 2.7764), (5, 2.5706), (6, 2.4469), (7, 2.3646), (9, 2.2622),
     (29, 2.0452), (99, 1.9842), (999, 1.9623)],
)  # fmt: skip
def test_students_quantile_is_that_of_the_tables(freedom, quantile):
    assert student(freedom) == pytest.approx(quantile, rel=5e-4)


@pytest.mark.parametrize(
    ("successes", "count", "low", "high"),
    # Newcombe 1998, Two-sided confidence intervals for the single proportion, table I, method 3.
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilsons_interval_is_that_of_the_literature(successes, count, low, high):
    found = wilson(successes, count)
    assert (found.low, found.high) == pytest.approx((low, high), abs=5e-5)


@given(count=st.integers(1, 500), share=st.floats(0.0, 1.0))
def test_wilsons_interval_holds_the_rate_and_stays_within_0_and_1(count, share):
    found = wilson(round(share * count), count)
    assert 0.0 <= found.low <= found.value + 1e-12
    assert found.value - 1e-12 <= found.high <= 1.0
    assert found.low < found.high


def test_an_interval_of_a_mean_holds_the_truth_19_times_in_20():
    random = Random(1)
    held = 0
    for _ in range(2000):
        found = mean([random.gauss(3.0, 2.0) for _ in range(6)])
        held += found.low <= 3.0 <= found.high
    assert held / 2000 == pytest.approx(0.95, abs=0.015)


def test_too_few_to_tell_has_no_interval():
    assert mean([2.0]).value == 2.0
    assert math.isnan(mean([2.0]).low)
    assert not mean([2.0]).leaves_out_zero
    assert math.isnan(mean([]).value)
    assert math.isnan(wilson(0, 0).value)


def test_differences_are_within_a_seed_so_that_what_seeds_share_cancels():
    shared = [10.0, 20.0, 30.0, 40.0]
    results = [
        result(outcome(time + extra), controller=name, seed=seed)
        for name, extra in (("paper", 0.0), ("assisted", -1.0))
        for seed, time in enumerate(shared)
    ]
    paper, assisted = subjects(results).values()
    found = difference(assisted, paper, TIME)
    assert (found.value, found.low, found.high) == pytest.approx((-1.0, -1.0, -1.0))
    assert found.leaves_out_zero
    assert average(assisted, TIME).half > 10.0


def test_a_seeds_flights_are_averaged_first_for_only_seeds_are_independent():
    results = [
        result(outcome(10.0 + seed), controller="paper", seed=seed, delay=delay)
        for seed in range(3)
        for delay in (0.0, 0.1, 0.2, 0.3)
    ]
    (paper,) = subjects(results).values()
    assert average(paper, TIME) == mean([10.0, 11.0, 12.0])


def test_only_pairs_that_both_have_the_figure_are_compared():
    results = [
        result(outcome(10.0), controller="paper", seed=0),
        result(outcome(None, completed=False), controller="paper", seed=1),
        result(outcome(12.0), controller="assisted", seed=0),
        result(outcome(99.0), controller="assisted", seed=1),
        result(outcome(50.0), controller="assisted", seed=2),
    ]
    paper, assisted = subjects(results).values()
    found = difference(assisted, paper, TIME)
    assert (found.value, found.size) == (2.0, 1)
    assert discordant(assisted, paper) == (0, 1)
    assert (completed(paper).value, completed(assisted).value) == (0.5, 1.0)


def told():
    random = Random(2)
    return [
        result(
            outcome(
                20.0 + random.gauss(0.0, 1.0) - 5.0 * (name == "assisted"),
                completed=seed > 0 or name != "paper",
            ),
            controller=name,
            seed=seed,
            delay=delay,
        )
        for seed in range(4)
        for delay in (0.0, 0.3)
        for name in ("paper", "assisted")
    ]


def test_the_comparison_is_told_plainly():
    text = comparison(told(), 100)
    lines = text.splitlines()
    assert lines[0].startswith("16 flights, 4 seeds")
    assert any(line.split() == ["completed", "6/8", "(41–93", "%)", "8/8", "(68–100", "%)"] for line in lines)
    assert any(line.startswith("completed") and "2 won, 0 lost" in line for line in lines)
    (faster,) = [line for line in lines if line.startswith("time") and line.endswith("*")]
    assert "−" in faster
    assert any(line.startswith("0.3 s") and "3/4" in line and "4/4" in line for line in lines)
    assert not any(line.startswith("by mission") for line in lines)


def test_one_subject_alone_is_told_without_differences():
    text = comparison([each for each in told() if each.case.controller == "paper"], 100)
    assert "difference" not in text
    assert "paper" in text


@pytest.mark.parametrize("width", [40, 60, 200])
def test_tables_break_between_subjects_where_the_terminal_is_narrow(width):
    results = [
        result(outcome(), controller=name, guard=guard, seed=seed)
        for seed in range(2)
        for name in ("assisted", "transparent")
        for guard in ("barrier", "risk_field", "off")
    ]
    lines = comparison(results, width).splitlines()
    for name in ("assisted, off", "transparent, risk_field"):
        assert any(name in line for line in lines)
    tables = [line for line in lines if line.startswith(("completed", "RMS"))]
    assert all(len(line) <= max(width, 50) for line in tables)


def test_the_figure_is_drawn_along_what_was_varied(tmp_path):
    figure.draw(tmp_path / "figure.svg", told())
    text = (tmp_path / "figure.svg").read_text()
    assert all(
        words in text for words in ("round trip, s", "assisted", "input disagreement, m/s", "completed")
    )


def test_a_figure_of_one_flight_has_no_bars_and_no_warnings(tmp_path):
    figure.draw(tmp_path / "one.svg", [result(Outcome(reason="it did not take off"))])
    assert (tmp_path / "one.svg").exists()
