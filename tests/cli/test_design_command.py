"""``workhold design``: what it asks the search, what it writes and says, and what it refuses."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

import workhold
from fakes import fake_proof, fake_result
from workhold.cli import design_command
from workhold.errors import InputError
from workhold.search import estimate

# How an earlier output of the same name begins.
OURS = '{"format": "workhold-result/1"}'
VISE = ("--pitch", "10,12.7", "--columns", "3", "--peg-radius", "3")


def test_the_search_is_asked_what_the_user_asked(run: Any, searched: dict[str, Any]) -> None:
    outcome = run(
        *(
            "design",
            "widget",
            *VISE,
            "--rows",
            9,
            "--min-gap",
            2.5,
            "--max-opening",
            80,
            "--row-offset",
            -1.5,
        ),
        *("--contact-margin", 0.5, "--type", "ii", "--best", 4, "--threads", 2),
    )
    assert outcome.exit_code == 0, outcome.stderr
    asked = searched["asked"]
    vise = asked.toolkit
    assert (vise.pitch, vise.columns, vise.rows, vise.peg_radius) == ((10, 12.7), 3, 9, 3)
    assert (vise.min_gap, vise.max_opening, vise.row_offset) == (2.5, 80, -1.5)
    assert (asked.types, asked.contact_margin, asked.best) == (("II",), 0.5, 4)
    assert asked.workpiece.name == "widget"
    assert searched["options"]["threads"] == 2
    assert not searched["options"]["cancel"].is_set()


def test_what_is_not_said_has_the_defaults_of_the_model(run: Any, searched: dict[str, Any]) -> None:
    assert run("design", "widget", "--pitch", 10, "--columns", 1, "--peg-radius", 0).exit_code == 0
    asked = searched["asked"]
    vise = asked.toolkit
    assert (vise.pitch, vise.rows, vise.min_gap, vise.max_opening, vise.row_offset) == (
        (10, 10),
        None,
        10,
        None,
        0,
    )
    assert (asked.types, asked.contact_margin, asked.best) == (("I", "II"), 0, None)


def test_result_and_table(run: Any, searched: dict[str, Any], tmp_path: Path) -> None:
    outcome = run("design", "widget", *VISE, "--out", tmp_path / "r.json")
    assert outcome.exit_code == 0
    result = searched["result"]
    assert len(workhold.open(tmp_path / "r.json")) == 7
    lines = outcome.stdout.splitlines()
    assert lines[0].split()[:2] == ["rank", "like"]
    shown = next(k for k, line in enumerate(lines) if "fixtures:" in line)
    ranks = [int(line.split()[0]) for line in lines[2:shown]]
    assert ranks[0] == 1 and ranks == sorted(ranks) and len(ranks) <= 5
    assert result[0].pegs[0].hole in lines[2]
    assert lines[shown].startswith(
        f"7 fixtures: {result.counts['I']} of type I, {result.counts['II']} of type II; "
        f"{sum(result.distinct.values())} distinct under the part's symmetry; "
    )
    assert lines[-1] == f"Written to {tmp_path / 'r.json'}."
    assert outcome.stderr == ""


def test_best_says_how_many_there_are_and_how_many_are_kept(
    run: Any, searched: dict[str, Any], tmp_path: Path
) -> None:
    outcome = run("design", "widget", *VISE, "--out", tmp_path / "r.json", "--best", 2, "--list", 0)
    assert "7 fixtures" in outcome.stdout
    assert "the best 2 are kept" in outcome.stdout
    assert "rank" not in outcome.stdout
    data = json.loads((tmp_path / "r.json").read_text())
    assert len(data["fixtures"]) == 2
    assert sum(data["found"].values()) == 7


def test_no_fixture_is_an_answer(
    run: Any, searched: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(design_command, "explain_none", lambda *_: None)
    searched["result"] = fake_result(0)
    outcome = run("design", "widget", *VISE, "--out", tmp_path / "r.json")
    assert outcome.exit_code == 0
    assert "No fixture exists for plate in this vise" in outcome.stdout
    assert json.loads((tmp_path / "r.json").read_text())["counts"] == {"I": 0, "II": 0}


@pytest.mark.parametrize(("name", "more"), [("r.csv", ()), ("r.txt", ("--format", "CSV"))])
def test_csv_by_name_or_by_request(
    run: Any, searched: dict[str, Any], tmp_path: Path, name: str, more: tuple[str, ...]
) -> None:
    assert run("design", "widget", *VISE, "--out", tmp_path / name, *more).exit_code == 0
    with (tmp_path / name).open(newline="") as stream:
        assert len(list(csv.DictReader(stream))) == 7


def test_standard_output_carries_the_file_and_nothing_else(run: Any, searched: dict[str, Any]) -> None:
    outcome = run("design", "widget", *VISE, "--out", "-")
    assert len(json.loads(outcome.stdout)["fixtures"]) == 7
    assert "7 fixtures" in outcome.stderr


def test_notes_and_remarks_go_to_stderr(run: Any, searched: dict[str, Any]) -> None:
    searched["result"] = fake_result(3, notes=("Two things could not be decided.",))
    outcome = run("design", "widget", *VISE)
    assert "Two things could not be decided." in outcome.stderr
    assert "decided" not in outcome.stdout


def told(outcome: Any) -> list[str]:
    """The lines behind the counts."""
    lines = outcome.stdout.splitlines()
    return lines[next(k for k, line in enumerate(lines) if " distinct under " in line) + 1 :]


def test_the_account_of_the_search_is_one_line(run: Any, searched: dict[str, Any], tmp_path: Path) -> None:
    searched["result"] = fake_result(7, proof=fake_proof(0))
    outcome = run("design", "widget", *VISE, "--out", tmp_path / "r.json")
    assert told(outcome) == [
        "Proven: 82,764 candidates, 1,324 verified, 32 decided by interval arithmetic, none undecided.",
        f"Written to {tmp_path / 'r.json'}.",
    ]
    assert outcome.stderr == ""
    # Where standard output carries the file, the line goes with the other words.
    outcome = run("design", "widget", *VISE, "--out", "-")
    assert json.loads(outcome.stdout)["proof"]["candidates"] == 82_764
    assert "\nProven: 82,764 candidates" in outcome.stderr


def test_the_algebra_goes_through_no_cells(run: Any, searched: dict[str, Any]) -> None:
    """Its candidates come from polynomials, and each is proven by itself."""
    searched["result"] = fake_result(7, proof=fake_proof(0, cells=0, discarded_by_bound=0, verified=1))
    assert told(run("design", "widget", *VISE)) == [
        "Proven one by one: 1 candidate of the polynomials, 1 verified, 32 decided by interval arithmetic, none undecided."
    ]


@pytest.mark.parametrize(
    ("count", "rest"), [(1, None), (3, None), (4, "The other one is"), (9, "The other 6 are")]
)
def test_what_is_undecided_is_said_plainly(
    run: Any, searched: dict[str, Any], tmp_path: Path, count: int, rest: str | None
) -> None:
    """The first few with their reasons, and where to find the others."""
    searched["result"] = fake_result(7, proof=fake_proof(count))
    lines = told(run("design", "widget", *VISE, "--out", tmp_path / "r.json"))
    total = f"{82_764 + count:,} candidates, 1,324 verified, 32 decided by interval arithmetic, {count} undecided:"
    assert lines[0] == f"Not proven throughout: {total}"
    named = [
        f"  Type {'I' * (k % 2 + 1)} on faces 0, 1, 2, 4 at {7.25 * k:.6f} degrees: reason {k}."
        for k in range(3)
    ]
    assert lines[1 : 1 + min(count, 3)] == named[:count]
    if rest:
        assert lines[4] == f'  {rest} under "proof" in {tmp_path / "r.json"}.'
    assert lines[-1] == f"Written to {tmp_path / 'r.json'}."
    if rest:
        lines = told(run("design", "widget", *VISE, "--out", tmp_path / "r.csv"))
        assert lines[4] == f'  {rest} under "proof" in a JSON file written with --out.'


def test_an_interrupted_search_is_proven_so_far(run: Any, searched: dict[str, Any]) -> None:
    searched["result"] = fake_result(3, complete=False, proof=fake_proof(0))
    assert told(run("design", "widget", *VISE))[0].startswith("Proven so far: 82,764 candidates")


def test_an_incomplete_result_is_written_and_marked(
    run: Any, searched: dict[str, Any], tmp_path: Path
) -> None:
    searched["result"] = fake_result(3, complete=False)
    outcome = run("design", "widget", *VISE, "--out", tmp_path / "r.json", "--draw", tmp_path / "d")
    assert outcome.exit_code == 130
    assert json.loads((tmp_path / "r.json").read_text())["complete"] is False
    assert "interrupted: these are only some of the fixtures" in outcome.stderr
    assert not (tmp_path / "d").exists()


@pytest.mark.thorough
def test_the_best_twelve_are_drawn(run: Any, searched: dict[str, Any], tmp_path: Path) -> None:
    folder = tmp_path / "new" / "d"
    searched["result"] = fake_result(60)
    outcome = run("design", "widget", *VISE, "--draw", folder)
    assert outcome.exit_code == 0, outcome.stderr
    assert f"Drawn: 26 pictures in {folder}." in outcome.stdout
    names = ["thumbnails", *(f"fixture-{rank:02d}" for rank in range(1, 13))]
    assert sorted(p.name for p in folder.iterdir()) == sorted(
        f"{n}{e}" for n in names for e in (".svg", ".png")
    )
    assert (folder / "fixture-12.svg").read_text().lstrip().startswith("<")
    assert (folder / "thumbnails.png").read_bytes().startswith(b"\x89PNG")


def test_pictures_of_an_earlier_design_do_not_linger(
    run: Any, searched: dict[str, Any], tmp_path: Path
) -> None:
    (tmp_path / "fixture-09.png").write_bytes(b"tEXtSoftware\0workhold")
    (tmp_path / "fixture-99.png").write_text("not ours")
    (tmp_path / "notes.txt").write_text("not ours")
    searched["result"] = fake_result(1)
    run("design", "widget", *VISE, "--draw", tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "fixture-01.png",
        "fixture-01.svg",
        "fixture-99.png",
        "notes.txt",
        "thumbnails.png",
        "thumbnails.svg",
    ]


BAD = [
    (("--pitch", "-5"), "pitch -5.0 is not a positive length"),
    (("--pitch", "0"), "pitch 0.0 is not a positive length"),
    (("--pitch", "nan"), "--pitch 'nan' is not a distance"),
    (("--pitch", "abc"), "--pitch 'abc' is not a distance"),
    (("--pitch", ""), "--pitch '' is not a distance"),
    (("--pitch", "10,"), "--pitch '10,' is not a distance"),
    (("--pitch", "10,20,30"), "--pitch '10,20,30' has 3 numbers"),
    (("--pitch", "1e400"), "--pitch '1e400' is not a distance"),
    (("--pitch", "4"), "pegs of radius 3 overlap in neighbouring holes 4 apart"),
    (("--columns", "0"), "columns 0 is not a positive whole number"),
    (("--columns", "-2"), "columns -2 is not a positive whole number"),
    (("--columns", "1.5"), "--columns '1.5' is not a whole number"),
    (("--columns", "many"), "--columns 'many' is not a whole number"),
    (("--rows", "0"), "rows 0 is not a positive whole number"),
    (("--peg-radius", "-1"), "peg radius -1.0 is not a length"),
    (("--peg-radius", "inf"), "--peg-radius 'inf' is not a length"),
    (("--peg-radius", "3ell"), "--peg-radius '3ell' is not a length: give a plain number in mm"),
    (("--min-gap", "-1"), "min gap -1.0 is not a length"),
    (("--max-opening", "0"), "max opening 0.0 is not a positive length"),
    (("--max-opening", "5"), "max opening 5 is below the min gap 10"),
    (("--row-offset", "x"), "--row-offset 'x' is not a length"),
    (("--contact-margin", "-1"), "--contact-margin -1 is negative"),
    (("--contact-margin", "nan"), "--contact-margin 'nan' is not a length"),
    (("--best", "0"), "--best 0 is not a positive whole number"),
    (("--threads", "0"), "--threads 0 is not a positive whole number"),
    (("--type", "III"), "--type 'III' is not known: give I, II or both"),
    (("--format", "xml"), "--format 'xml' is not known: give json, csv or npz"),
    (("--part", "0"), "There is no part 0"),
    (("--join-tolerance", "wide"), "--join-tolerance 'wide' is not a length"),
    (("--unit", "furlong"), "'furlong'"),
    (("--colums", "3"), "No such option: --colums"),
    (("second.dxf",), "unexpected extra argument"),
    (("--out", "missing/r.json"), "there is no folder missing: create it first"),
    (("--out", "."), "is a folder: name a file in it"),
    (("--draw", "old.json"), "is a file"),
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("arguments", "message"), BAD)
def test_bad_requests_are_refused_before_the_search(
    run: Any,
    searched: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[str, ...],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("old.json").write_text(OURS)
    outcome = run("design", "widget", *VISE, "--out", "old.json", *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr
    assert outcome.stderr.startswith("workhold: error: ")
    assert outcome.stderr.count("\n") == 1
    assert outcome.stdout == ""
    assert searched["asked"] is None
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("old.json", OURS)]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("content", [None, b"", b"\x00\xff" * 300, b"0\nSECTION\n", b'{"name": "x"}'])
@pytest.mark.parametrize("name", ["part.dxf", "part.svg", "part.json", "part"])
def test_unreadable_parts_are_refused(
    run: Any, searched: dict[str, Any], tmp_path: Path, name: str, content: bytes | None
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    outcome = run("design", tmp_path / name, *VISE)
    assert outcome.exit_code == 2
    assert outcome.stderr.count("\n") == 1
    assert searched["asked"] is None


def test_missing_options_are_named(run: Any) -> None:
    outcome = run("design", "widget", "--columns", "1")
    assert outcome.exit_code == 2
    assert "the vise's distance between holes is not given: add --pitch" in outcome.stderr


def test_a_refusal_of_the_search_leaves_the_earlier_output(
    run: Any, searched: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    def answer(*_: object, **__: object) -> None:
        raise InputError("the peg fits nowhere.")

    monkeypatch.setattr(sys.modules["workhold.search.design"], "answer", answer)
    (tmp_path / "r.json").write_text(OURS)
    outcome = run("design", "widget", *VISE, "--out", tmp_path / "r.json")
    assert (outcome.exit_code, outcome.stderr) == (2, "workhold: error: the peg fits nowhere.\n")
    assert (tmp_path / "r.json").read_text() == OURS


@pytest.mark.thorough
def test_both_engines_write_the_same_counts(run: Any, tmp_path: Path) -> None:
    """``--engine algebra`` searches by the paper's polynomials and lists the same fixtures, the first with seating."""
    counts, seatings = [], []
    for engine in ("curves", "algebra"):
        out = tmp_path / f"{engine}.json"
        arguments = ["design", "oblongPart", "--pitch", "12", "--columns", "1", "--peg-radius", "3"]
        done = run(*arguments, "--engine", engine, "--seating", "2", "--out", str(out))
        assert done.exit_code == 0, done.stderr
        written = json.loads(out.read_text())
        counts.append(written["counts"])
        seatings.append([len(one["seating"]["seats"]) for one in written["fixtures"] if "seating" in one])
        assert written["seating"] == 2 and run("verify", str(out), "--complete").exit_code == 0
        head = "Proven: " if engine == "curves" else "Proven one by one: "
        assert [line for line in told(done) if line.startswith(head) and line.endswith(", none undecided.")]
    assert counts[0] == counts[1]
    assert seatings[0] == seatings[1] and len(seatings[0]) == 2
    assert run(*arguments, "--engine", "luck").exit_code == 2


@pytest.mark.parametrize(
    ("arguments", "best", "told"),
    [
        (
            ("--out", "r.json"),
            1000,
            "there are about 250,000 fixtures, 240 MB in r.json. Listed are the best 1,000; --all lists all.",
        ),
        ((), 1000, "there are about 250,000 fixtures, 240 MB. Listed are the best 1,000; --all lists all."),
        (("--out", "r.json", "--all"), None, "there are about 250,000 fixtures, 240 MB in r.json."),
        (
            ("--all",),
            None,
            "workhold: error: --all of about 250,000 fixtures takes 240 MB: write them to a file",
        ),
        (("--out", "r.json", "--best", "4"), 4, ""),
        (("--best", "4", "--all"), None, "--all and --best are opposites"),
    ],
)
def test_of_very_many_fixtures_the_best_are_listed(
    run: Any,
    searched: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    arguments: tuple[str, ...],
    best: int | None,
    told: str,
) -> None:
    """How many there are, and how large a file of all would be, is said before; two hundred thousand are not many."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked: 249_600)
    outcome = run("design", "widget", *VISE, *arguments)
    assert told in outcome.stderr and bool(told) == (
        "about" in outcome.stderr or "opposites" in outcome.stderr
    )
    assert outcome.exit_code == (2 if "error" in outcome.stderr else 0)
    if outcome.exit_code == 0:
        assert searched["asked"].best == best
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked: 200_000)
    if best != 4 and "--best" not in arguments:
        outcome = run("design", "widget", *VISE, *arguments, "--force")
        assert outcome.exit_code == 0 and "about" not in outcome.stderr and searched["asked"].best is None


def test_a_file_that_is_too_large_as_text_is_refused_beforehand(
    run: Any, searched: dict[str, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The remedy works: columns carry them."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked: 4_000_000)
    outcome = run("design", "widget", *VISE, "--out", "r.json", "--all")
    assert outcome.exit_code == 2 and "3,840 MB in r.json" in outcome.stderr and "900 MB" in outcome.stderr
    assert searched["asked"] is None and not Path("r.json").exists()
    asked = []
    monkeypatch.setattr(
        design_command, "search_and_stream", lambda query, *_, **__: asked.append(query) or searched["result"]
    )
    assert run("design", "widget", *VISE, "--out", "r.npz", "--all").exit_code == 0
    assert [query.best for query in asked] == [None]


def test_json_says_how_many_there_are_about(
    run: Any, searched: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """For programs that cannot read remarks."""
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked: 249_600)
    assert json.loads(run("design", "widget", *VISE, "--json").stdout)["estimated"] == 249_600
