"""Reports: one page that needs nothing else, a PDF, and the numbers they stand for."""

import re
from html.parser import HTMLParser

import numpy as np
import pytest
from msgspec.structs import replace
from series_support import MISSION, RADIUS, TARGET, a_series

from groundstation import cli
from groundstation.errors import InputError
from groundstation.report import paper, pdf
from groundstation.report.document import Finding, Plate, Report, page
from groundstation.report.paper_findings import deviation, following, settled_at, strongest_near
from groundstation.report.paper_flights import Flights, Flown
from groundstation.report.paper_report import report_on
from groundstation.training.mission import Mission, Target
from sim.scenario import Box

VOID = {"meta", "path", "use", "rect"}
SHORT = Mission(
    schema=1,
    name="short",
    title="A short way past a post",
    target=Target((0.9, 0.0, 2.0), radius=0.4, hold_s=0.2),
    obstacle=(Box("post", (0.5, 1.0, 1.5), (0.3, 0.3, 3.0)),),
)


class Page(HTMLParser):
    """Checks that elements are closed in their order, and gathers them with their attributes."""

    def __init__(self, text):
        super().__init__()
        self.elements = []
        self._open = []
        self.feed(text)
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self._open.pop() == tag

    def named(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]


def line(figure):
    figure.subplots().plot([0.0, 1.0], [1.0, 0.0])


def a_report(*findings):
    plates = (Plate("Figure 1", 'It falls & "fast"', "From <one> to none.", 2.0, line),)
    return Report("A report", ("What it is.",), findings, plates, (("Seed", "3"),))


def test_a_page_has_everything_inside_and_escapes_what_is_said():
    text = page(a_report(Finding("Fig. 1", "fall", "1 m", "≤ 2 m", holds=True)))
    parsed = Page(text)
    assert [svg["aria-label"] for svg in parsed.named("svg")] == ['Figure 1: It falls & "fast"']
    assert "From &lt;one&gt; to none." in text
    for tag in ("script", "img", "link", "iframe", "object"):
        assert not parsed.named(tag)
    for _, attributes in parsed.elements:
        assert "src" not in attributes
        assert all(attributes.get(name, "#").startswith("#") for name in ("href", "xlink:href"))
    assert not re.search(r"url\((?!#)", text)
    assert "@import" not in text


def test_a_report_holds_unless_a_finding_fails():
    holds, open_one = Finding("", "a", "1", "1", holds=True), Finding("", "b", "2")
    fails = Finding("", "c", "3", "1", holds=False)
    assert a_report(holds, open_one).holds
    assert not a_report(holds, open_one, fails).holds
    assert '<tr class="fails">' in page(a_report(fails))


def test_the_same_report_is_the_same_page():
    assert page(a_report()) == page(a_report())


def test_a_pdf_has_a_page_of_words_and_the_figures(tmp_path):
    file = tmp_path / "report.pdf"
    pdf.save(a_report(Finding("Fig. 1", "fall", "1 m")), file)
    written = file.read_bytes()
    assert written.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", written)) == 2


def test_the_equations_are_checked_to_rounding_and_a_deviation_is_found():
    series = a_series()
    assert deviation(series) < 1e-12
    bent = series.v_ref.copy()
    bent[100, 1] += 1e-3
    assert deviation(series._replace(v_ref=bent)) == pytest.approx(1e-3)
    pull = series.cues["position"].copy()
    pull[5, 2] -= 2e-3
    assert deviation(series._replace(cues={"position": pull})) == pytest.approx(2e-3)


def test_the_lag_of_the_vehicle_is_found_and_taken_out():
    found = following(a_series(lag=0.3))
    assert found.lag == pytest.approx(0.3)
    assert found.rest == pytest.approx(0.0, abs=1e-12)
    assert found.difference > 0.01


def test_settled_is_when_the_bound_is_left_for_the_last_time():
    t, distance = np.arange(6.0), np.array([9.0, 0.04, 0.06, 0.05, 0.01, 0.02])
    assert settled_at(t, distance, 0.05) == 3.0
    assert settled_at(t, distance, 0.015) is None
    assert settled_at(t, distance, 10.0) == 0.0


def test_the_strongest_force_is_looked_for_only_near_obstacles():
    series = a_series()
    far = np.flatnonzero(series.clearance > 1.0)
    force = np.full((len(series.t), 3), 0.0)
    force[far[0]] = (100.0, 0.0, 0.0)
    closest = int(series.clearance.argmin())
    force[closest] = (0.0, 3.0, 4.0)
    assert strongest_near(series._replace(cues={"position": force})) == (5.0, series.nearest[closest])


def test_an_obstacle_that_comes_near_only_at_the_end_counts_too():
    series = a_series()
    clearance = np.full(len(series.t), 2.0)
    clearance[-1] = 0.5
    push = strongest_near(series._replace(clearance=clearance))
    assert push == (pytest.approx(np.linalg.norm(series.cues["position"][-1])), series.nearest[-1])


def flown(series, *, held=True, collisions=0):
    return Flown(series, replace(MISSION, target=TARGET), RADIUS, collisions, held)


def test_every_bar_that_is_not_met_fails_by_name():
    calm = a_series(seconds=12.0)
    good = report_on(Flights(flown(calm), flown(calm), flown(calm)), 0)
    assert good.holds
    short = a_series(seconds=4.0)
    bad = report_on(Flights(flown(short, held=False), flown(short, collisions=1), flown(short)), 0)
    failed = {(finding.where, finding.what) for finding in bad.findings if finding.holds is False}
    assert failed == {
        ("Fig. 9", "target reached and held"),
        ("Fig. 10", "collisions"),
        ("Fig. 12", "final distance to the target, without wind"),
        ("Fig. 12", "the same over the last 3 s, RMS"),
    }


def test_titles_say_what_was_seen():
    calm = a_series(seconds=12.0)
    plates = report_on(Flights(flown(calm), flown(calm), flown(calm)), 0).plates
    settled = settled_at(calm.t, np.linalg.norm(np.array(TARGET.position) - calm.p[:, :3], axis=1), 0.05)
    titles = {plate.name: plate.title for plate in plates}
    assert f"from {settled:.1f} s on" in titles["Figure 12"]
    short = a_series(seconds=4.0)
    titles = {
        plate.name: plate.title for plate in report_on(Flights(*[flown(short, held=False)] * 3), 0).plates
    }
    assert "does not hold" in titles["Figure 9"]
    assert "do not stay" in titles["Figure 12"]


def test_the_paper_is_flown_and_reported_from_end_to_end(tmp_path, capsys):
    out = tmp_path / "short.html"
    code = paper.report(out, 3, pdf=False, mission=SHORT)
    said = capsys.readouterr()
    rows = said.out.splitlines()
    assert rows[-1] == str(out)
    assert code == int(any(row.endswith("FAILS") for row in rows))
    assert any("target reached and held" in row and row.endswith("holds") for row in rows)
    equations = next(row for row in rows if row.startswith("Eq. 4, 5"))
    assert equations.endswith("holds")
    assert said.err.splitlines() == [
        "flying without wind",
        "flying in wind",
        "flying in wind, assisted",
        "drawing",
    ]
    text = out.read_text(encoding="utf-8")
    assert len(Page(text).named("svg")) == 6
    assert len(text) < 2_000_000


@pytest.mark.parametrize("where", ["nowhere/paper.html", "", "paper.pdf"])
def test_a_page_that_cannot_be_written_is_told_before_anything_is_flown(tmp_path, where, capsys):
    with pytest.raises(InputError, match=re.escape(str(tmp_path / where))):
        paper.report(tmp_path / where, 0, pdf=True)
    assert capsys.readouterr().err == ""


def test_a_pdf_that_cannot_be_written_is_told_too(tmp_path):
    (tmp_path / "paper.pdf").mkdir()
    with pytest.raises(InputError, match=r"paper\.pdf: cannot be written"):
        paper.report(tmp_path / "paper.html", 0, pdf=True)


def test_the_command_tells_an_unwritable_path_and_ends_with_2(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(["report", "--paper", "--out", str(tmp_path / "nowhere" / "paper.html")])
    assert ended.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1
