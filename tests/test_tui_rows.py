"""Numbers with units, rows and bars."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.tui.rows import bar, clock, fit, gauge, quantity, shortened, span_of_time, spread, width_of
from groundstation.tui.theme import Tone

anything = st.floats(allow_nan=True, allow_infinity=True)


@pytest.mark.parametrize(
    ("value", "decimals", "width", "sign", "text"),
    [
        (1.234, 2, 0, False, "1.23 m"),
        (1.234, 2, 6, True, " +1.23 m"),
        (-1.234, 1, 0, False, "−1.2 m"),
        (-0.001, 2, 0, False, "0.00 m"),
        (-0.001, 2, 0, True, "+0.00 m"),
        (12345.678, 2, 6, False, " 12346 m"),
        (None, 2, 3, False, "  – m"),
        (math.nan, 2, 3, False, "  – m"),
        (-math.inf, 2, 0, True, "– m"),
    ],
)
def test_a_quantity_has_its_unit(value, decimals, width, sign, text):
    assert quantity(value, "m", decimals, width, sign=sign) == text


@given(value=anything, decimals=st.integers(0, 4), sign=st.booleans())
def test_a_quantity_never_fails_and_ends_with_its_unit(value, decimals, sign):
    assert quantity(value, "m/s", decimals, 8, sign=sign).endswith(" m/s")


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0213, "0.02 s"),
        (3.44, "3.4 s"),
        (42.2, "42 s"),
        (185.0, "3 min"),
        (-1.0, "0.00 s"),
        (math.inf, "– s"),
    ],
)
def test_a_time_is_said_the_way_one_says_it(seconds, text):
    assert span_of_time(seconds) == text


def test_the_clock_never_runs_before_the_start():
    assert [clock(t) for t in (-3.0, 0.0, 61.9, 3600.0)] == ["00:00", "00:00", "01:01", "60:00"]


@given(st.lists(st.text(min_size=0, max_size=9)), st.integers(0, 40))
def test_a_fitted_row_has_the_width_asked_for(texts, width):
    assert width_of(fit([(text, Tone.TEXT) for text in texts], width)) == width


def test_where_there_is_no_room_the_right_part_is_cut_and_the_left_stays():
    row = spread([("left part", Tone.TEXT)], [("right part", Tone.TEXT)], 14)
    assert "".join(text for text, _ in row) == "left part righ"


def drawn(value: float | None, mark: float | None = None) -> str:
    return "".join(text for text, _ in bar(value, 10.0, 11, Tone.FORCE, mark))


def test_a_bar_grows_from_the_middle_to_its_side():
    assert drawn(0.0) == "─────┼─────"
    assert drawn(5.0) == "─────┼██▌──"
    assert drawn(-5.0) == "──▐██┼─────"
    assert drawn(10.0) == "─────┼█████"
    assert drawn(-1e9) == "█████┼─────"


def test_what_is_not_known_is_an_empty_track():
    assert drawn(None) == drawn(math.nan) == drawn(math.inf) == drawn(0.0)


def test_a_mark_shows_a_second_value():
    assert drawn(0.0, mark=4.0) == "─────┼─┃───"
    assert drawn(0.0, mark=-99.0) == "┃────┼─────"


def test_at_the_limit_a_bar_warns():
    assert Tone.WARN in {tone for _, tone in bar(10.0, 10.0, 11, Tone.FORCE)}
    assert Tone.WARN not in {tone for _, tone in bar(9.9, 10.0, 11, Tone.FORCE)}


@given(value=anything, limit=anything, width=st.integers(1, 60), mark=anything)
def test_a_bar_always_has_its_width(value, limit, width, mark):
    assert width_of(bar(value, limit, width, Tone.FORCE, mark)) == 2 * ((width - 1) // 2) + 1


def test_a_gauge_grows_from_the_left_and_warns_at_its_limit():
    assert "".join(text for text, _ in gauge(2.5, 10.0, 10, Tone.FORCE)) == "██▌───────"
    assert {tone for text, tone in gauge(11.0, 10.0, 10, Tone.FORCE) if text} == {Tone.WARN}
    for nothing in (None, math.nan, 0.0, -3.0):
        assert "".join(text for text, _ in gauge(nothing, 10.0, 10, Tone.FORCE)) == "──────────"


@given(value=anything, limit=anything, width=st.integers(0, 60))
def test_a_gauge_always_has_its_width(value, limit, width):
    assert width_of(gauge(value, limit, width, Tone.FORCE)) == width


@given(st.text("ab 那", max_size=30), st.integers(-2, 40))
def test_what_is_shortened_fits_and_says_so(words, width):
    found = shortened(words, width)
    assert len(found) <= max(width, 0) or found == words == ""
    assert found == words or found.endswith("…") or width <= 0


def test_only_whole_words_are_left():
    title = "A yard with a few things to fly around"
    assert shortened(title, 37) == "A yard with a few things to fly …"
    assert shortened(title, 38) == title
    assert shortened("around", 4) == "aro…"
