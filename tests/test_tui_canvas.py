"""Drawing with braille."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from groundstation.tui.canvas import Canvas
from groundstation.tui.rows import width_of
from groundstation.tui.theme import Tone

anywhere = st.floats(allow_nan=True, allow_infinity=True)


def texts(canvas: Canvas) -> list[str]:
    return ["".join(text for text, _ in row) for row in canvas.to_rows()]


def test_each_dot_is_the_bit_unicode_says():
    seen = ""
    for row in range(4):
        for column in range(2):
            canvas = Canvas(1, 1)
            canvas.plot([column], [row], Tone.TEXT)
            seen += texts(canvas)[0]
    assert seen == "⠁⠈⠂⠐⠄⠠⡀⢀"


def test_dots_of_a_cell_add_up_and_empty_cells_are_spaces():
    canvas = Canvas(3, 1)
    canvas.plot([2, 3], [0, 3], Tone.TEXT)
    assert texts(canvas) == [" ⢁ "]
    canvas.plot([2, 2, 2, 2, 3, 3, 3, 3], [0, 1, 2, 3, 0, 1, 2, 3], Tone.TEXT)
    assert texts(canvas) == [" ⣿ "]


def test_a_line_has_no_gaps():
    canvas = Canvas(10, 1)
    canvas.line([0, 19], [1, 1], Tone.TEXT)
    assert texts(canvas) == ["⠒" * 10]


def test_a_gap_makes_a_line_dotted():
    canvas = Canvas(10, 1)
    canvas.line([0, 19], [0, 0], Tone.TEXT, gap=2)
    assert texts(canvas) == ["⠁" * 10]


def test_letters_stand_over_dots_keep_their_tone_and_are_cut_at_the_edges():
    canvas = Canvas(4, 2)
    canvas.letters(2, 0, "abc", Tone.MUTED)
    canvas.letters(-1, 1, "xyz", Tone.MUTED)
    canvas.letters(0, 5, "nowhere", Tone.MUTED)
    canvas.line([0, 7], [0, 0], Tone.VEHICLE)
    assert canvas.to_rows()[0] == [("⠉⠉", Tone.VEHICLE), ("ab", Tone.MUTED)]
    assert texts(canvas)[1] == "yz  "


def test_a_copy_is_drawn_on_alone():
    canvas = Canvas(2, 1)
    twin = canvas.copy()
    twin.plot([0], [0], Tone.TEXT)
    twin.letters(1, 0, "x", Tone.TEXT)
    assert texts(canvas) == ["  "]
    assert texts(twin) == ["⠁x"]


@given(st.lists(st.tuples(anywhere, anywhere), min_size=1, max_size=8), st.integers(1, 9), st.integers(1, 5))
def test_whatever_is_drawn_the_rows_keep_their_size(points, columns, rows):
    canvas = Canvas(columns, rows)
    x, y = [point[0] for point in points], [point[1] for point in points]
    canvas.plot(x, y, Tone.TEXT)
    canvas.line(x, y, Tone.TEXT)
    drawn = canvas.to_rows()
    assert [width_of(row) for row in drawn] == [columns] * rows


def test_what_is_not_finite_is_left_out():
    canvas = Canvas(2, 1)
    canvas.plot([math.nan, math.inf, 0.0], [0.0, 0.0, -math.inf], Tone.TEXT)
    canvas.line([0.0, math.nan], [0.0, 3.0], Tone.TEXT)
    assert texts(canvas) == ["  "]


def test_a_line_from_far_away_still_crosses_the_picture():
    canvas = Canvas(5, 2)
    canvas.line(np.array([-1e4, 1e4]), np.array([4.0, 4.0]), Tone.TEXT)
    assert texts(canvas)[1].strip()
