"""A pilot's missions, hours and skills on paper, to show to somebody."""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from pathlib import Path

from groundstation import __version__
from groundstation.errors import InputError
from groundstation.progress.flown import Flown
from groundstation.progress.skills import levels_of, standing_of
from groundstation.progress.words import counted, hours
from groundstation.report import pdf
from groundstation.report.document import Finding, Report, Table, page
from groundstation.training.mission import Mission

CHECK_RIDE = "check-ride"
SUFFIXES = (".pdf", ".html", ".md")
NO_LICENCE = (
    "This sheet tells what was flown with this program, as its recordings have it. It is no licence, no rating and "
    "no proof of competence under any law: the rules for flying a real vehicle are those of where you fly."
)


def write(flights: Sequence[Flown], curriculum: Sequence[Mission], out: Path) -> None:
    """Write a pilot's certificate.

    Args:
        flights: One pilot's, oldest first, at least one.
        curriculum: In the order in which it is learned.
        out: Its ending says what is written.

    Raises:
        InputError: The file cannot be written, or its ending is another.
    """
    kind = out.suffix.lower()
    if kind not in SUFFIXES:
        raise InputError(f"{out}: a certificate is one of {', '.join(SUFFIXES)}; name such a file.")
    report = certificate_of(flights, curriculum, datetime.datetime.now().astimezone().date())
    try:
        if kind == ".pdf":
            pdf.save(report, out)
        else:
            out.write_text(page(report) if kind == ".html" else markdown(report), encoding="utf-8")
    except OSError as error:
        raise InputError(f"{out}: cannot be written ({error.strerror}); choose another --out.") from error


def certificate_of(flights: Sequence[Flown], curriculum: Sequence[Mission], today: datetime.date) -> Report:
    """Return a pilot's certificate; see `write`."""
    standing = standing_of(curriculum, flights, today)
    alone = [each for each in flights if not each.instructed]
    ride = [each for each in alone if each.mission == CHECK_RIDE and each.passed]
    findings = [
        Finding("", "missions passed", f"{standing.passed} of {len(standing.records)}"),
        Finding("", "check-ride", _best_words(ride) if ride else "not passed yet"),
        Finding("", "time in the air", hours(sum(each.duration_s for each in flights))),
        Finding(
            "", "of it with a real vehicle", hours(sum(f.duration_s for f in flights if not f.simulated))
        ),
        Finding("", "flights", f"{len(flights)}"),
        Finding("", "of them with an instructor's doing, as practice", f"{len(flights) - len(alone)}"),
        Finding("", "collisions", f"{sum(each.collisions for each in flights)}"),
    ]
    lead = [
        f"{flights[0].pilot} has flown the missions below between {flights[0].day} and {flights[-1].day}.",
        NO_LICENCE,
    ]
    facts = [("issued", f"{today}"), ("by", f"groundstation {__version__}")]
    tables = [_missions(alone, curriculum), _skills(flights, curriculum)]
    return Report(f"Flown by feel: {flights[0].pilot}", lead, findings, (), facts, tables)


def _missions(flights: Sequence[Flown], curriculum: Sequence[Mission]) -> Table:
    rows: list[tuple[str, ...]] = []
    for mission in curriculum:
        passed = [each for each in flights if each.mission == mission.name and each.passed]
        if passed:
            best = max(passed, key=lambda each: each.points or 0.0)
            touched = sum(each.collisions for each in flights if each.mission == mission.name)
            rows.append(
                (
                    mission.title,
                    f"{mission.level}",
                    f"{passed[0].day}",
                    f"{best.points or 0.0:.0f}",
                    f"{best.day}",
                    "simulated" if best.simulated else "real",
                    f"{touched}",
                )
            )
    heads = ("mission", "level", "first passed", "best of 100", "on", "vehicle", "collisions")
    words = "" if rows else "None yet."
    return Table("Missions passed", words, heads, rows)


def _skills(flights: Sequence[Flown], curriculum: Sequence[Mission]) -> Table:
    levels = levels_of({mission.name: mission for mission in curriculum}, flights)
    rows = [(skill, f"{level:.0f}") for skill, level in levels.items()]
    return Table("Skills", "How the latest flights went, of 100.", ("skill", "level"), rows)


def _best_words(ride: Sequence[Flown]) -> str:
    best = max(ride, key=lambda each: each.points or 0.0)
    return f"passed on {ride[0].day}, best {best.points or 0.0:.0f} of 100 in {counted(len(ride), 'ride')}"


def markdown(report: Report) -> str:
    """Return a report without its figures as Markdown."""
    parts = [f"# {report.title}", *report.lead]
    parts.append(_grid(("", "found"), [(finding.what, finding.found) for finding in report.findings]))
    for table in report.tables:
        parts += [f"## {table.title}", *filter(None, (table.words,))]
        parts += [_grid(table.heads, table.rows)] if table.rows else []
    parts.append(", ".join(f"{name} {value}" for name, value in report.facts))
    # Markdown passes HTML on, and a pilot's name may be any.
    return "\n\n".join(parts).replace("<", "&lt;") + "\n"


def _grid(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = [[cell.replace("|", r"\|") for cell in line] for line in (heads, *rows)]
    cells.insert(1, ["---"] * len(heads))
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)
