"""``workhold sheet``: every kind of file, every option, and what it refuses."""

from __future__ import annotations

import csv
import json
from datetime import date
from hashlib import sha256
from math import sqrt
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pypdfium2
import pytest
from drawing_examples import diamond
from svg_reading import by_class

import workhold
from workhold import Query, Result, __version__, save
from workhold.model.fixture_table import FixtureTable, make_unknown_quality


def diamond_result() -> Result:
    """A result of one true fixture, told twice."""
    fixture, workpiece, vise = diamond()
    null_vector = np.full((1, 4), 0.25)
    table = FixtureTable(
        arrangement=np.zeros(1, np.int8),
        column=np.array([[peg.column for peg in fixture.pegs]], np.int32),
        row=np.array([[peg.row for peg in fixture.pegs]], np.int32),
        face=np.array([[peg.face for peg in fixture.pegs]], np.int32),
        theta=np.radians([fixture.pose.theta_deg]),
        position=np.array([[fixture.pose.x, fixture.pose.y]]),
        jaw_separation=np.array([fixture.travel]),
        force=np.array([[peg.force for peg in fixture.pegs]]),
        quality=make_unknown_quality(null_vector.min(axis=1)),
    )
    counts = {"I": 2, "II": 0}
    return Result(Query(workpiece, vise), table.take(np.array([0, 0])), counts, counts)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a result file ``r.json`` and of a file of loads, from which commands are run."""
    save(diamond_result(), tmp_path / "r.json")
    loads = '[[load]]\nname = "drilling"\nforce = 80\nat = [20, 20]\n'
    (tmp_path / "loads.toml").write_text(loads)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def words_in(path: Path) -> str:
    """The text of a PDF."""
    document = pypdfium2.PdfDocument(path.read_bytes())
    return " ".join(" ".join(page.get_textpage().get_text_bounded() for page in document).split())


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "start"),
    [("a.pdf", b"%PDF-"), ("a.SVG", b"<?xml"), ("a.png", b"\x89PNG"), ("a.dxf", b"  0\nSECTION")],
)
def test_every_kind_of_file_is_written(run: Any, folder: Path, name: str, start: bytes) -> None:
    """The ending tells what it is; the same command gives the same bytes."""
    arguments = ("sheet", "r.json", 1, "-o", name, "--date", "2026-03-31")
    outcome = run(*arguments)
    assert outcome.exit_code == 0, outcome.stderr
    assert outcome.stdout == f"Written to {name}.\n"
    first = (folder / name).read_bytes()
    assert first.startswith(start)
    run(*arguments)
    assert (folder / name).read_bytes() == first


def test_sheet_tells_where_it_comes_from(run: Any, folder: Path) -> None:
    """Date, hash of the result file, version, rank; today's date when none is given."""
    run("sheet", "r.json", 2, "--out", "a.pdf")
    words = words_in(folder / "a.pdf")
    for wanted in (
        date.today().isoformat(),
        sha256((folder / "r.json").read_bytes()).hexdigest()[:12],
        f"workhold {__version__}",
        "Fixture 2 of 2",
    ):
        assert wanted in words


def test_all_figures_of_quality_are_told(run: Any, folder: Path) -> None:
    """Those that the result file lacks are computed."""
    run("sheet", "r.json", 1, "-o", "a.pdf", "--load", "force=100 at=20,20")
    words = words_in(folder / "a.pdf")
    for figure in ("closure margin", "wrench radius", "location error", "edge distance", "load reaction"):
        assert figure in words


def test_forces_loads_and_friction(run: Any, folder: Path) -> None:
    """Loads of the command line and of a file, each with a name or a number; what each peg takes at the jaw force."""
    options = ("--jaw-force", 2000, "--friction", 0.2, "--load", "force=50 at=0,0", "--loads", "loads.toml")
    outcome = run("sheet", "r.json", 1, "-o", "a.pdf", *options)
    assert outcome.exit_code == 0, outcome.stderr
    words = words_in(folder / "a.pdf")
    for wanted in ("load 1", "drilling", "at 2000 N", "1414 N", "µ 0.2"):
        assert wanted in words


def test_paper_unit_and_name(run: Any, folder: Path) -> None:
    """Letter in inches under another name; numbers of --load are inches too."""
    options = ("--paper", "LETTER", "--unit", "in", "--part-name", "Part 7", "--load", "force=50 at=1,1")
    assert run("sheet", "r.json", 1, "-o", "a.pdf", *options).exit_code == 0
    document = pypdfium2.PdfDocument((folder / "a.pdf").read_bytes())
    assert sorted(document[0].get_size()) == pytest.approx([612, 792])
    words = words_in(folder / "a.pdf")
    assert "Part 7" in words and "diamond" not in words
    assert f"{diamond()[0].jaw_separation / 25.4:.4f} in" in words


@pytest.mark.thorough
def test_lengths_of_loads_are_in_the_unit_of_the_sheet(run: Any, folder: Path) -> None:
    """A force half an inch off the corner gives the reactions of one 12.7 mm off; one 0.5 mm off gives others. In inches
    they are in pounds, rounded up."""

    def reactions(unit: str, place: str) -> list[int]:
        run("sheet", "r.json", 1, "-o", "a.pdf", "--unit", unit, "--load", f"force=5000 at={place},0")
        return [int(word) for word in words_in(folder / "a.pdf").split("load 1 ")[1].split()[:5]]

    pounds, newtons = reactions("inch", "0.5"), reactions("mm", "12.7")
    assert all(-1 / 4.4 <= lbf - n / 4.4482216 < 1 for lbf, n in zip(pounds, newtons, strict=True))
    assert newtons != reactions("mm", "0.5")


def test_what_the_program_is_not_told_is_to_be_written(run: Any, folder: Path) -> None:
    """Without thickness, length, height and dowel there are lines to write on; with them, what was given."""
    run("sheet", "r.json", 1, "-o", "a.svg", "--thickness", "11")
    empty = (folder / "a.svg").read_text()
    options = (
        "--thickness",
        "12",
        "--peg-length",
        "20",
        "--peg-height",
        "0.25in",
        "--dowel",
        "6 mm m6 in H7",
    )
    assert run("sheet", "r.json", 1, "-o", "b.svg", *options).exit_code == 0
    full = (folder / "b.svg").read_text()
    names = ("thickness", "peg length", "height above the jaws", "dowel and fit")
    for name, value in zip(names, ("12.000 mm", "20.000 mm", "6.350 mm", "6 mm m6 in H7"), strict=True):
        assert name in empty and name in full
        assert value not in empty and value in full
    # Three lines to write on are gone.
    assert lines_to_write_on(empty) - lines_to_write_on(full) == 3


def lines_to_write_on(svg: str) -> int:
    """How many level lines of the width of those to write on there are among the words."""
    groups = [group for page in [svg] for group in by_class(page, "words")]
    return sum(one.get("stroke-width") == "0.8" for group in groups for one in group)


def test_pins_are_listed(run: Any, folder: Path) -> None:
    """A row for each peg with its hole, place, diameter, length and dowel; the list may be written again."""
    options = ("--unit", "inch", "--dowel", "6 mm m6 in H7, hardened", "--peg-length", "20mm")
    assert run("sheet", "r.json", 1, "-o", "pins.csv", *options).exit_code == 0
    outcome = run("sheet", "r.json", 1, "-o", "pins.csv", *options)
    assert outcome.exit_code == 0, outcome.stderr
    with (folder / "pins.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    fixture = diamond()[0]
    assert [row["hole"] for row in rows] == [peg.hole for peg in fixture.pegs]
    assert [float(row["x"]) for row in rows] == pytest.approx(
        [peg.x / 25.4 for peg in fixture.pegs], abs=1e-4
    )
    for row in rows:
        told = {key: row[key] for key in ("diameter", "length", "unit", "dowel")}
        assert told == {
            "diameter": "0.2362",
            "length": "0.7874",
            "unit": "in",
            "dowel": "6 mm m6 in H7, hardened",
        }


@pytest.mark.thorough
def test_a_force_may_carry_its_unit(run: Any, folder: Path) -> None:
    """450 lbf are 2001.7 N, 2 kN are 2000 N."""
    for given, told in (("450lbf", "at 2002 N"), ("2kN", "at 2000 N")):
        assert run("sheet", "r.json", 1, "-o", "a.pdf", "--jaw-force", given).exit_code == 0
        assert told in words_in(folder / "a.pdf")


def test_fixtures_in_the_same_holes_are_warned_of(run: Any, folder: Path) -> None:
    """The result tells the same holes twice."""
    run("sheet", "r.json", 1, "-o", "a.pdf")
    assert "The same four holes hold this part in one other way" in words_in(folder / "a.pdf")


@pytest.mark.thorough
def test_where_the_part_ends_up_is_told_when_asked(run: Any, folder: Path) -> None:
    """How far to open, and the reading when it is right, which is what a diamond on four sides always gives."""
    run("sheet", "r.json", 1, "-o", "plain.pdf")
    assert run("sheet", "r.json", 1, "-o", "a.pdf", "--seating").exit_code == 0
    plain, asked = words_in(folder / "plain.pdf"), words_in(folder / "a.pdf")
    right = f"The right reading is S = {diamond()[0].jaw_separation:.3f} mm."
    assert "Does the part end up there?" in asked and right in asked and "What it looks like" in asked
    assert "Does the part end up there?" not in plain and right not in plain


def test_part_zero_is_where_it_was_asked_for(run: Any, folder: Path) -> None:
    """The diamond's centre is the middle of its pegs; from the machine's position over L-A1 come the control's lines."""
    options = ("--zero", "centre", "--machine-position", "-300,-200")
    outcome = run("sheet", "r.json", 1, "-o", "a.pdf", *options)
    assert outcome.exit_code == 0, outcome.stderr
    words, half = words_in(folder / "a.pdf"), diamond()[0].jaw_separation / 2
    assert "centre of the outside dimensions" in words
    assert f"{half:.3f} mm" in words
    assert f"G21 G10 L2 P1 X{half - 300:.3f} Y{10 - 200:.3f} G54 G68 X0 Y0 R45.000" in words
    assert run("sheet", "r.json", 1, "-o", "a.dxf", "--zero", "centre").exit_code == 0
    (zero,) = ezdxf.readfile(folder / "a.dxf").modelspace().query('POINT[layer=="PART_ZERO"]')
    assert (zero.dxf.location.x, zero.dxf.location.y) == pytest.approx((half, 10.0))


def test_dxf_is_the_set_up_in_mm(run: Any, folder: Path) -> None:
    """Whatever the unit of the sheet, the model is in millimetres."""
    run("sheet", "r.json", 1, "-o", "a.dxf", "--unit", "inch")
    document = ezdxf.readfile(folder / "a.dxf")
    assert document.header["$INSUNITS"] == 4
    assert {peg.dxf.radius for peg in document.modelspace().query('CIRCLE[layer=="PEGS"]')} == {3.0}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("r.json", "0", "-o", "a.pdf"), "there is no fixture 0: fixtures are counted from 1"),
        (("r.json", "3", "-o", "a.pdf"), "lists 2 fixtures: there is no fixture 3"),
        (("r.json", "1"), "Missing option '--out'"),
        (("r.json", "1", "-o", "a.doc"), "let the name end in .pdf, .svg, .png, .dxf, .step or .csv"),
        (("r.json", "1", "-o", "missing/a.pdf"), "there is no folder missing"),
        (("r.json", "1", "-o", "a.pdf", "--paper", "a3"), "--paper 'a3' is not known: give a4 or letter"),
        (("r.json", "1", "-o", "a.pdf", "--unit", "foot"), "Unit 'foot' is not known"),
        (
            ("r.json", "1", "-o", "a.pdf", "--zero", "0,1e308"),
            "part zero 1e+308 is beyond 1e+06 mm: check the number",
        ),
        (("r.json", "1", "-o", "a.dxf", "--zero", "-2e6,0"), "part zero -2e+06 is beyond 1e+06 mm"),
        (
            ("r.json", "1", "-o", "a.pdf", "--machine-position", "0,-2e6"),
            "--machine-position -2e+06 is beyond 1e+06 mm",
        ),
        (
            ("r.json", "1", "-o", "a.dxf", "--jaw", "loose"),
            "jaw 'loose' is not known: give screw, constant, or how many",
        ),
        (("r.json", "1", "-o", "a.pdf", "--date", "31.3.2026"), "give it as YYYY-MM-DD"),
        (("r.json", "1", "-o", "a.pdf", "--jaw-force", "-5"), "--jaw-force '-5' is not a force above 0"),
        (("r.json", "1", "-o", "a.pdf", "--friction", "much"), "--friction 'much' is not a positive number"),
        (("r.json", "1", "-o", "a.pdf", "--load", "force=5"), "--load"),
        (("r.json", "1", "-o", "a.pdf", "--zero", "hole 1"), "the part has no hole"),
        (("r.json", "1", "-o", "a.pdf", "--machine-position", "5"), "give it as X,Y, such as -312.5,-88"),
        (("r.json", "1", "-o", "a.pdf", "--loads", "none.toml"), "none.toml"),
        (("none.json", "1", "-o", "a.pdf"), "none.json cannot be read"),
    ],
)
def test_bad_requests_are_one_sentence(
    run: Any, folder: Path, arguments: tuple[str, ...], message: str
) -> None:
    """Exit code 2, one line on stderr, and no file."""
    outcome = run("sheet", *arguments)
    assert outcome.exit_code == 2
    assert message in outcome.stderr and outcome.stderr.count("\n") == 1
    assert not list(folder.glob("a.*"))


@pytest.mark.thorough
def test_explore_says_none_where_a_part_has_no_edge(run: Any, folder: Path) -> None:
    """Each toolkit has its own figures in its row, and the first choice those of its own."""
    loop = [(-30, -20, 0), (30, -20, 1), (30, 20, 0), (-30, 20, 1)]
    (folder / "rounded.json").write_text(json.dumps({"name": "rounded", "units": "mm", "loops": [loop]}))
    words = ("explore", "rounded.json", "--vise", "table-100mm,plate-20mm,two-clamp-plate-20mm")
    shown, told = run(*words).stdout, json.loads(run(*words, "--json").stdout)
    lengths = {}
    for one in told["toolkits"]:
        (line,) = (line for line in shown.splitlines() if line.startswith(f"{one['name']} "))
        if one["figures"]:
            lengths[one["name"]] = one["figures"]["edge_distance"]
            assert f" {one['figures']['location_error']:.4f} " in line
            assert " none " in line or f" {lengths[one['name']]:.4f} " in line
    assert len(lengths) == 2 and "none" in shown
    (choice,) = (line for line in shown.splitlines() if line.startswith("First choice"))
    assert "edge distance none" in choice and "location error 0." in choice and " mm. " in choice


def test_the_command_says_none_where_a_part_has_no_edge(run: Any, folder: Path) -> None:
    """The figure then stands for no edge: no length is printed that nobody can measure on the part."""
    turn = sqrt(2) - 1
    loop = [
        (5, 0, 0),
        (35, 0, turn),
        (40, 5, 0),
        (40, 25, turn),
        (35, 30, 0),
        (5, 30, turn),
        (0, 25, 0),
        (0, 5, turn),
    ]
    for name, corners, words in (
        ("rounded", loop, "none"),
        ("square", [(0, 0, 0), (40, 0, 0), (40, 30, 0), (0, 30, 0)], ""),
    ):
        part = workhold.Workpiece.from_loops(name, [corners])
        vise = workhold.Vise(pitch=10, columns=2, peg_radius=3)
        workhold.save(workhold.design(part, vise, best=2), folder / f"{name}.json")
        shown = run("show", f"{name}.json", 1).stdout
        (line,) = (line for line in shown.splitlines() if line.startswith("edge distance"))
        assert (line.split()[2] == "none") == (words == "none")
