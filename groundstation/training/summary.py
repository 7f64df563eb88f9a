"""What a headless flight tells: progress on the way, the summary at the end."""

from __future__ import annotations

import json
import math
import sys
import time
from typing import TextIO

import msgspec

from groundstation.console import Snapshot
from groundstation.messages import Event, ServoReport, Severity
from groundstation.run import Run
from groundstation.status_line import StatusLine
from groundstation.training.director import Director
from groundstation.training.judgement import Judgement, judgement_of
from groundstation.training.measurer import Measurer
from groundstation.training.score import Score
from groundstation.training.story import Moment
from groundstation.training.telling import NAME, told


class Narrator:
    """Tells the progress: on a terminal one line that changes, else a line whenever the stage does.

    Args:
        out: Where to.
    """

    def __init__(self, out: TextIO) -> None:
        self._line = StatusLine(out)
        self._last = ""
        self._told_t = time.monotonic()

    def tell(self, step: str, figures: str, view: Snapshot) -> None:
        """Tell what is new: the step, how it is going, and events."""
        for event in view.events:
            if event.t > self._told_t:
                self._told_t = event.t
                if event.severity != Severity.INFO:
                    self._line.note(_words(event))
        if not self._line.live and step != self._last:
            self._line.tell(step)
        self._line.step(f"{step}: {figures}")
        self._last = step

    def close(self) -> None:
        """End the changing line."""
        self._line.close()


def summary(
    run: Run, measurer: Measurer, judgement: Judgement, servo: ServoReport | None, failure: str
) -> dict[str, object]:
    """Return a flight's summary as it is printed with `--json`. Numbers that do not exist are null."""
    director, figures = measurer.director, measurer.director.figures
    report = servo or ServoReport(run_p50=math.nan, run_p99=math.nan, rate=math.nan)
    missing = [failure] if failure else list(judgement.shortcomings)
    return {
        "completed": not missing,
        "mission": director.mission.name,
        "simulated": run.simulated,
        "collisions": figures.collisions,
        "duration_s": _rounded(figures.duration, 2),
        "path_m": _rounded(figures.path, 3),
        "rms_error_m": _rounded(figures.rms_error, 4),
        "final_error_m": _rounded(figures.final_error, 4),
        "max_force_n": _rounded(figures.max_force, 3),
        "score": _score(judgement.score, run.par_from),
        "measures": msgspec.to_builtins(judgement.measures),
        "story": [_moment(moment, judgement.took_off_t) for moment in judgement.story],
        "servo": {
            "rate_hz": _rounded(report.rate, 1),
            "ticks": int(report.ticks),
            "missed": int(report.missed),
            "late_p50_us": _rounded(report.run_p50 * 1e6, 1),
            "late_p99_us": _rounded(report.run_p99 * 1e6, 1),
        },
        "logs": {"rrd": _existing(run, "rrd"), "tlog": _existing(run, "tlog")},
        "shortcomings": missing,
    }


def summarise(run: Run, measurer: Measurer, servo: ServoReport | None, failure: str, *, as_json: bool) -> int:
    """Print the summary and return the exit code: 0 when the mission's criteria hold, else 1."""
    judgement = judgement_of(measurer, run.par)
    figures = summary(run, measurer, judgement, servo, failure)
    if as_json:
        print(json.dumps(figures))
    else:
        print(_table(figures))
        print("\n".join(told(judgement, run.par_from)))
    sys.stdout.flush()
    return 0 if figures["completed"] else 1


def _score(score: Score | None, par_from: str) -> dict[str, object] | None:
    if score is None:
        return None
    parts = [
        {
            "name": part.name,
            "points": part.points,
            "weight": part.weight,
            "value": _known(part.value),
            "par": _known(part.par),
            "unit": part.unit,
            "formula": part.formula,
        }
        for part in score.parts
    ]
    return {"points": score.points, "par_from": par_from, "parts": parts}


def _moment(moment: Moment, took_off_t: float) -> dict[str, object]:
    return {
        "part": moment.part,
        "since_takeoff_s": _rounded(moment.t - took_off_t, 2),
        "lost": moment.lost,
        "words": moment.words,
        "position_m": list(moment.place),
    }


def _table(figures: dict[str, object]) -> str:
    servo, logs, missing = figures["servo"], figures["logs"], figures["shortcomings"]
    assert isinstance(servo, dict)
    assert isinstance(logs, dict)
    assert isinstance(missing, list)
    verdict = "completed" if figures["completed"] else "NOT completed: " + "; ".join(map(str, missing))
    total = servo["ticks"] + servo["missed"]
    share = 100.0 * servo["ticks"] / total if total else math.nan
    rows = (
        ("mission", f"{figures['mission']}: {verdict}"),
        ("time", f"{figures['duration_s']} s"),
        ("path", f"{figures['path_m']} m"),
        (
            "position error",
            f"{_metres(figures['rms_error_m'])} RMS, {_metres(figures['final_error_m'])} at the target",
        ),
        ("largest force", f"{figures['max_force_n']} N"),
        ("collisions", f"{figures['collisions']}"),
        (
            "servo",
            f"{share:.2f} % of ticks at {servo['rate_hz']} Hz, late {servo['late_p50_us']} µs p50, "
            f"{servo['late_p99_us']} µs p99",
        ),
        ("recording", logs["rrd"] or "none"),
        ("MAVLink log", logs["tlog"] or "none"),
    )
    return "\n".join(f"{name:<{NAME}} {value}" for name, value in rows)


def _metres(length: object) -> str:
    return "–" if length is None else f"{length} m"


def figures_of(director: Director, view: Snapshot) -> str:
    """Return how a mission is going, for people."""
    parts = [director.stage.value]
    if director.legs:
        parts.append(f"point {min(director.leg + 1, director.legs)}/{director.legs}")
    distance = director.target_distance()
    if not math.isnan(distance):
        parts.append(f"{distance:.1f} m to the target")
    if view.pilot:
        parts.append(f"force {math.hypot(*view.pilot.force):.1f} N")
    return ", ".join(parts)


def _words(event: Event) -> str:
    sign = "!!" if event.severity == Severity.ALARM else "!"
    return f"{sign} {event.source.decode()}: {event.text.decode(errors='replace')}"


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _rounded(value: float, digits: int) -> float | None:
    return round(value, digits) if math.isfinite(value) else None


def _existing(run: Run, suffix: str) -> str | None:
    path = run.recording if suffix == "rrd" else run.tlog
    return str(path) if path.exists() else None
