"""Excitation: rich, bounded, and back where it began; flown through the very processes of every flight."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation import cli
from groundstation.excite_options import AXES
from groundstation.identification.multisine import excitation
from groundstation.recording import schema
from groundstation.review.flight import Flight

peaks = st.tuples(*[st.floats(0.1, 3.0)] * 4)
chosen = st.sets(st.integers(0, 3), min_size=1).map(sorted)
lengths = st.integers(8, 40).map(float)


@settings(max_examples=30, deadline=None)
@given(peaks, lengths, chosen)
def test_it_is_bounded_and_ends_where_it_began(peaks, seconds, axes):
    signal = excitation(peaks, seconds, axes)
    t, velocities = signal.sampled()
    assert signal.seconds == pytest.approx(seconds * (len(axes) + (2 if len(axes) > 1 else 0)))
    assert (np.abs(velocities).max(axis=0) <= np.array(peaks) + 1e-9).all()
    resting = [axis for axis in range(4) if axis not in axes]
    assert not velocities[:, resting].any()
    step = t[1] - t[0]
    # Fading takes its bite out of whole periods, no more.
    assert (np.abs(velocities.sum(axis=0) * step) <= np.array(peaks) * 0.5 + 1e-6).all()
    assert (np.abs(np.cumsum(velocities, axis=0) * step).max(axis=0) <= signal.excursion() + 1e-9).all()
    assert signal.at(-1.0) == signal.at(signal.seconds) == (0.0, 0.0, 0.0, 0.0)


@settings(max_examples=20, deadline=None)
@given(lengths, chosen)
def test_axes_flown_at_once_share_no_line(seconds, axes):
    together = excitation((1.0,) * 4, seconds, axes).stretches[-1]
    lines = together.lines[together.lines > 0.0]
    assert len(set(lines.tolist())) == len(lines)
    periods = lines * (together.end - together.start)
    assert periods == pytest.approx(np.rint(periods))


def test_its_peak_is_low_for_a_sum_of_sines():
    signal = excitation((1.0,) * 4, 40.0, [0])
    _, velocities = signal.sampled()
    middle = velocities[200:-200, 0]
    assert np.abs(middle).max() / middle.std() < 2.6


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--connect", "udpin://127.0.0.1:1"], "--confirm-real"),
        (["--sim", "--confirm-real"], "leave it out"),
        (["--sim", "--axes", "sideways"], "there is no sideways"),
        (["--sim", "--axes", ""], "axis without a name"),
        (["--sim", "--share", "2"], "give 0.05 to 1"),
        (["--sim", "--seconds", "1"], "give 8 to 300"),
        (["--sim", "--room", "0"], "1 m around"),
        (["--sim", "--altitude", "1"], "2 m below"),
        (["--sim", "--config", "OFF"], "guard is off"),
        ([], "required"),
    ],
)
def test_what_is_wrong_is_one_sentence(tmp_path, capsys, arguments, words):
    off = tmp_path / "off.toml"
    off.write_text('[shield]\nguard = "off"\n')
    with pytest.raises(SystemExit) as end:
        cli.main(
            ["excite", *(str(off) if word == "OFF" else word for word in arguments), "--logs", str(tmp_path)]
        )
    assert end.value.code == 2
    err = capsys.readouterr().err
    assert words in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.flight
def test_it_is_flown_and_its_lines_are_in_the_setpoints(tmp_path):
    command = ("excite", "--sim", "--axes", "forward", "--seconds", "10", "--logs", str(tmp_path))
    done = subprocess.run(
        [sys.executable, "-m", "groundstation.cli", *command],
        capture_output=True, text=True, timeout=110, check=False, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "groundstation identify" in done.stderr
    flight = Flight(Path(done.stdout.strip()))
    t, sent = flight.series(schema.REFERENCES[AXES.index("forward")])
    sent = np.nan_to_num(sent[:, 0])
    assert np.abs(sent).max() > 0.3
    assert sent.std() > 3.0 * np.nan_to_num(flight.series(schema.REFERENCES[2]).values[:, 0]).std()
    position = flight.series(schema.POSITION).values[:, :2]
    assert np.nanmax(np.abs(position)) < 6.0
    assert t[-1] - t[0] > 10.0
