"""What the sections of the report compute, against what is known; and the document, which has no number without a key."""

from __future__ import annotations

import json
from math import pi, tan
from pathlib import Path
from typing import Any

import pytest

import workhold
from paper import benchmark_set, scale
from paper.catalogue_runs import killed_and_resumed, make_records, run_batch, write_parts
from paper.document import Figures, Heading, Line, Paragraph, Table
from paper.elimination import CASES, factors, random_system
from paper.growth import area, power_law
from paper.html_page import html_page
from paper.table_two import PRINTED, case_of
from paper.witnesses import BAR, sliding_fixture
from workhold.algebra.resultants import PAPER_DEGREES, TRUE_DEGREES


@pytest.mark.parametrize("case", CASES, ids=str)
@pytest.mark.parametrize("seed", [1, 2])
def test_one_factor_holds_the_poses(case: tuple[int, int], seed: int) -> None:
    """The paper's equations, eliminated exactly, have one factor with poses, of the degree of the algebra's resultant."""
    told = factors(random_system(case, seed))
    holding = [one for one in told["factors"] if one["holds_poses"]]
    assert [(one["degree"], one["power"]) for one in holding] == [(TRUE_DEGREES[case], 1)]
    assert told["degree"] == sum(one["degree"] * one["power"] for one in told["factors"])


def test_the_degrees_are_those_printed() -> None:
    """Each row of Table 2 stands for a case of the algebra, with the degree that is printed for it; no case is left out."""
    found = {case_of(kind, left, right): degree for kind, _, left, _, right, degree in PRINTED}
    assert found == PAPER_DEGREES and len(PRINTED) == 14
    assert all(row[1] + row[2] == (2 if row[0] == "I" else 3) for row in PRINTED)


def test_four_contacts_slide_apart_without_clamping() -> None:
    """At every separation all four touch and the forces balance, without any against the jaw; the search lists none."""
    for separation in (15, 22, 38):
        told = sliding_fixture(separation)
        assert told["largest_misfit"] == told["jaw_force"] == told["moment"] == 0.0
        assert min(told["forces"]) > 0.0 and sum(told["forces"]) == pytest.approx(1.0)
    part = workhold.Workpiece.from_loops("bar", [BAR])
    result = workhold.design(part, workhold.Vise(pitch=10, columns=2, peg_radius=3))
    upright = {7, 5}, {4, 2}
    found = [
        f
        for f in result
        if f.type == "I" and ({p.face for p in f.pegs[:2]}, {p.face for p in f.pegs[2:]}) == upright
    ]
    assert [f for f in found if abs(f.pose.theta_deg) < 1e-6] == []


def test_area_of_lines_and_arcs() -> None:
    """A circle of two bulges and one of four, and a square with a round hole."""
    circle = [[5, 0, 1], [-5, 0, 1]]
    quarter = tan(pi / 8)
    four = [[5, 0, quarter], [0, 5, quarter], [-5, 0, quarter], [0, -5, quarter]]
    assert area(workhold.Workpiece.from_loops("disc", [four])) == pytest.approx(25 * pi)
    square = [[-10, -10, 0], [10, -10, 0], [10, 10, 0], [-10, 10, 0]]
    assert area(workhold.Workpiece.from_loops("disc", [circle])) == pytest.approx(25 * pi)
    assert area(workhold.Workpiece.from_loops("plate", [square, circle])) == pytest.approx(400 - 25 * pi)


def test_a_power_law_is_found_with_its_spread() -> None:
    """Exact points give the exponent without a spread; points off by a factor up and down give that factor."""
    xs = [1.0, 2.0, 4.0, 8.0]
    exact = power_law(xs, [3.0 * x**2.5 for x in xs])
    assert exact["exponent"] == pytest.approx(2.5) and exact["factor"] == pytest.approx(3.0)
    assert exact["spread"] == pytest.approx(1.0) and exact["error"] == pytest.approx(0.0, abs=1e-9)
    many = [float(k) for k in range(1, 401)]
    off = power_law(many, [x * (1.5 if k % 2 else 1 / 1.5) for k, x in enumerate(many)])
    assert off["spread"] == pytest.approx(1.5, rel=0.01) and abs(off["exponent"] - 1.0) < 3 * off["error"]


@pytest.mark.parametrize("words", ["12 mm", "Type 2", ("see ", "Table 3")])
def test_a_number_without_a_key_is_refused(words: str | tuple[str, ...]) -> None:
    """In a sentence, a caption and a cell."""
    with pytest.raises(ValueError, match="without a key"):
        Paragraph(words)
    with pytest.raises(ValueError, match="without a key"):
        Table("Table 1", words, ("a",), ())
    with pytest.raises(ValueError, match="without a key"):
        Table("Table 1", "what", ("a",), ((words,),))


def test_numbers_are_printed_in_their_units() -> None:
    """Counts have thousands apart, shares a sign, small numbers the digits that count, and what is missing a dash."""
    figures = Figures("some", {"a": 12345, "b": 0.0123456, "c": -2.5, "d": 1e-6, "e": None})
    texts = [getattr(one, "text", one) for one in (
        figures.count("a"), figures.significant("b", 3), figures.significant("b", 2, 1e-3), figures.percent(
            "b", 1),
        figures.fixed("c", 1), figures.power("d"), figures.count("e"), figures.count("nowhere/0/x"),
    )]  # fmt: skip
    assert texts == ["12,345", "0.0123", "12", "1.2 %", "−2.5", "1e−6", "–", "–"]


def test_words_are_escaped() -> None:
    """A name with signs of HTML stands as it is."""
    assert "a &lt;b&gt; &amp; c" in html_page("t", [Heading("a <b> & c"), Paragraph("a <b> & c")])


def test_what_breaks_first_is_reckoned_from_what_a_search_takes() -> None:
    """The bound over what a search takes, over the searches of a part; what takes nothing never breaks."""
    each = {"memory": 0.0, "record": 1e4, "known": 1e-3}
    told = {one["name"]: one["parts"] for one in scale.breaking({"each": each, "queue": {"dask": 4e-3}}, 2)}
    assert told["the start of a run that goes on"] == pytest.approx(scale.START / 1e-3 / 2)
    assert told["records on one disk"] == pytest.approx(5e7) and "memory of who asks" not in told


@pytest.mark.prove
def test_a_killed_run_goes_on_to_the_same_records(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Two workers are killed, then the run; what the same command leaves has the bytes of one worker's."""
    folder = tmp_path_factory.mktemp("batch")
    parts = write_parts(folder / "parts", 24)
    run_batch(parts, folder / "one", 1)
    records = make_records(folder / "one")
    told = killed_and_resumed(parts, folder / "killed", len(records))
    assert told["workers_killed"] == 2 and 0 < told["records_when_killed"] < len(records)
    assert make_records(folder / "killed") == records


def test_the_shares_of_the_benchmark_set_are_read_where_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of the step of 1 mm, of each kind and of every set once; without the file there is no section."""
    monkeypatch.setattr(benchmark_set, "FILE", tmp_path / "grid-share.json")
    nothing: dict[str, Any] = {}
    assert list(benchmark_set.measure(nothing, True)) and nothing == {}
    assert benchmark_set.render(Figures("benchmark-set", nothing)) == []
    sets = [
        {
            "set": name,
            "kind": "vise",
            "fixtures": 10 * k,
            "fixed": [0.5, 0.1 * k, 0.9],
            "half": [1.0, 0.8, 0.7],
        }
        for k, name in enumerate("abc", 1)
    ]
    kinds = {"vise": {"fixed": [0.5, 0.2, 0.9], "half": [1.0, 0.8, 0.7]}}
    told = {"command": "python some.py", "steps": [2.0, 1.0, 0.5], "touch": 0.1, "kinds": kinds, "sets": sets}
    benchmark_set.FILE.write_text(json.dumps(told))
    data: dict[str, Any] = {}
    assert list(benchmark_set.measure(data, True))
    *_, kinds_table, sets_table = benchmark_set.render(Figures("benchmark-set", data))
    assert isinstance(kinds_table, Table) and isinstance(sets_table, Table)
    assert [words(cell) for cell in kinds_table.rows[0]] == ["vise", "3", "60", "20.0 %", "80.0 %"]
    cells = [[words(cell) for cell in row] for row in sets_table.rows]
    assert cells == [
        ["a", "10", "10.0 %", "80.0 %", "c", "30", "30.0 %", "80.0 %"],
        ["b", "20", "20.0 %", "80.0 %", "", "", "", ""],
    ]


def words(line: Line) -> str:
    """A line as it is read."""
    return "".join(one if isinstance(one, str) else one.text for one in line)
