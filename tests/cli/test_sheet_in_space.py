"""From a part to its sheet in one command, on supports, and the sheet of a part's second side."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pypdfium2
import pytest
from typer.testing import Result as Outcome

import workhold
from workhold import Plate, Restrictions, Workpiece
from workhold.cli.setup_sheets import write_first_sheet
from workhold.listing.identity import make_entries
from workhold.model.solid import SolidOutline
from workhold.units import MILLIMETRE

Run = Callable[..., Outcome]
CORNERS = [(0.0, 0.0), (80.0, 4.0), (76.0, 50.0), (6.0, 44.0)]
KIT = ("--toolkit", "clamp-plate-20mm")


def side(axis: str, faces: list[tuple[int, ...]], mirrored: bool) -> Workpiece:
    """A prism 20 mm high as seen from one of its sides."""
    corners = [(-x, y, 0.0) for x, y in reversed(CORNERS)] if mirrored else [(x, y, 0.0) for x, y in CORNERS]
    loop = [corners]
    solid = SolidOutline(axis, 20.0, 8.0, 0.5, 1.0, [(0.0, 8.0)] * 4, faces, loop, loop)
    return Workpiece.from_loops("prism", [corners], solid=solid)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a drawing, and with results of both sides of a solid."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plate.json").write_text(
        json.dumps({"name": "plate", "units": "mm", "loops": [[[x, y, 0] for x, y in CORNERS]]})
    )
    plate = Plate(pitch=20, peg_radius=3)
    first, second = side("z", [(1,), (2,), (3,), (4,)], False), side("-z", [(3,), (2,), (1,), (4,)], True)
    workhold.save(workhold.design(first, plate, best=8, restrictions=Restrictions(avoid=(2,))), "op10.json")
    workhold.save(workhold.design(second, plate, best=8, restrictions=Restrictions(avoid=(0,))), "op20.json")
    return tmp_path


def words_in(path: str) -> str:
    """The text of a PDF."""
    document = pypdfium2.PdfDocument(Path(path).read_bytes())
    return " ".join(" ".join(page.get_textpage().get_text_bounded() for page in document).split())


@pytest.mark.thorough
def test_from_a_part_to_its_sheet_in_one_command(run: Run, folder: Path) -> None:
    """The first choice is on paper, on its supports; the sheet names the result file by its hash."""
    words = ("design", "plate.json", *KIT, "--best", 5, "--supports", "--thickness", 14)
    shown = run(*words, "--sheet", "a.pdf", "--out", "r.json")
    assert shown.exit_code == 0, shown.stderr
    result = workhold.open("r.json")
    text = words_in("a.pdf")
    rank = int(shown.stdout.split("The setup sheet of fixture ")[1].split()[0])
    assert "was written to a.pdf." in shown.stdout and f"Fixture {rank} of {len(result)}" in text
    assert sha256(Path("r.json").read_bytes()).hexdigest()[:12] in text
    assert "Supports and the clamp on top" in text and "+14.000 top of the part" in text
    # The same sheet, but for its day, comes from the result.
    assert run("sheet", "r.json", rank, "-o", "b.pdf", "--supports", "--thickness", 14).exit_code == 0
    assert words_in("b.pdf") == text


@pytest.mark.thorough
def test_sheet_without_supports_or_result_file(run: Run, folder: Path) -> None:
    """The sheet alone; its file may be a picture, and --json says that it was written."""
    shown = run("design", "plate.json", *KIT, "--best", 2, "--sheet", "a.svg", "--json")
    assert json.loads(shown.stdout)["sheet"] == "a.svg" and Path("a.svg").read_text().count("Fixture 1 of 2")
    assert "Supports and the clamp" not in Path("a.svg").read_text()
    assert "sheet" not in json.loads(run("design", "plate.json", *KIT, "--best", 2, "--json").stdout)


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--sheet", "a.txt"), "--sheet a.txt names no setup sheet: let the name end in .pdf, .svg or .png."),
        (("--sheet", "mine.pdf"), "mine.pdf was not written by workhold: give another name, or --force"),
        (("--sheet", "none/a.pdf"), "none"),
        (
            ("--sheet", "x.pdf", "--out", "x.pdf"),
            "x.pdf is not the name of such a result file: let the name end in .json.",
        ),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_search(
    run: Run, folder: Path, searched: dict[str, Any], words: tuple[str, ...], sentence: str
) -> None:
    """Nothing is searched, and what was there stays."""
    Path("mine.pdf").write_text("my own")
    shown = run("design", "plate.json", *KIT, *words)
    assert shown.exit_code == 2 and sentence in shown.stderr
    assert searched["asked"] is None and Path("mine.pdf").read_text() == "my own"


@pytest.mark.thorough
def test_no_fixture_leaves_no_file(run: Run, folder: Path) -> None:
    """In words; a sheet of an earlier run stays as it was."""
    shown = run("design", "plate.json", *KIT, "--avoid", "0,1,2", "--sheet", "a.pdf")
    assert shown.exit_code == 0, shown.stderr
    assert "As there is no fixture, a.pdf was not written." in shown.stdout and not Path("a.pdf").exists()
    assert run("design", "plate.json", *KIT, "--avoid", "0,1,2", "--sheet", "a.pdf", "--json").exit_code == 0
    assert not Path("a.pdf").exists()


@pytest.mark.thorough
def test_sheet_of_the_second_side(run: Run, folder: Path) -> None:
    """It says how the part is turned, what the first side cuts, and which faces both touch."""
    shown = run("sheet", "op20.json", 1, "-o", "op20.pdf", "--first-setup", "op10.json", "--supports")
    assert shown.exit_code == 0, shown.stderr
    text = words_in("op20.pdf")
    for wanted in (
        "Second set-up of the same part",
        "The part is turned over about the y axis of the first drawing, by half a turn.",
        "Face 0 of this outline must not be touched: the first set-up cuts face 3 of the solid.",
        "touched in both set-ups, in the first by its best fixture.",
        "supports in",
        "pegs above the plate 18.000 mm",
    ):
        assert wanted in text
    assert "z of the file points up." in words_in_sheet(run, "op10.json")


def words_in_sheet(run: Run, result: str) -> str:
    """The words of the sheet of the first fixture."""
    assert run("sheet", result, 1, "-o", "again.pdf").exit_code == 0
    return words_in("again.pdf")


@pytest.mark.thorough
def test_sheet_of_a_set_of_supports(run: Run, folder: Path) -> None:
    """Of a file of supports, N is the set of three; loads and sizes are those of the file."""
    load = ("--load", "force=90 at=30,20 z=4..18 axial=-30..60")
    assert run("supports", "op10.json", 1, "--pad-radius", 3, *load, "--out", "s.json").exit_code == 0
    listed = json.loads(Path("s.json").read_text())["triples"]
    for number in (1, 3):
        shown = run("sheet", "s.json", number, "-o", "s.pdf")
        assert shown.exit_code == 0, shown.stderr
        text, best = words_in("s.pdf"), listed[number - 1]["best"]
        assert f"Supports {number} of {len(listed)}" in text and "round pads Ø 6 mm" in text
        assert f"X {best['at'][0]:.3f}, Y {best['at'][1]:.3f} mm".replace("-", "−") in text
        assert "load 1: 90 N at x 30.000, y 20.000 mm" in text
    for words, sentence in (
        (("s.json", len(listed) + 1), f"there is no set {len(listed) + 1} of supports"),
        (("s.json", 1, "--thickness", 12), "s.json already gives what --thickness would"),
        (("s.json", 1, "--load", "force=5 at=1,1"), "s.json has the loads"),
    ):
        shown = run("sheet", *words, "-o", "t.pdf")
        assert shown.exit_code == 2 and sentence in shown.stderr and not Path("t.pdf").exists()


@pytest.mark.thinned(6)
@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            ("r.json", "-o", "a.pdf", "--supports"),
            "the thickness of the part is not known: give --thickness.",
        ),
        (("op10.json", "-o", "a.dxf", "--supports"), "a.dxf has no supports"),
        (
            ("op10.json", "-o", "a.csv", "--first-setup", "op20.json"),
            "--first-setup belongs to a sheet on paper",
        ),
        (("op10.json", "-o", "a.pdf", "--support-height", "8"), "--support-height belongs to supports"),
        (("r.json", "-o", "a.pdf", "--first-setup", "op10.json"), "plate has no faces of a solid"),
        (("op10.json", "-o", "op20.json", "--first-setup", "op20.json"), "-o op20.json names no kind"),
        (("op10.json", "-o", "a.pdf", "--supports", "--thickness", "0"), "--thickness"),
    ],
)
def test_what_a_sheet_in_space_cannot_be(
    run: Run, folder: Path, words: tuple[str, ...], sentence: str
) -> None:
    """One sentence, exit code 2, and no file."""
    assert run("design", "plate.json", *KIT, "--best", 1, "--out", "r.json").exit_code == 0
    shown = run("sheet", words[0], 1, *words[1:])
    assert shown.exit_code == 2 and sentence in shown.stderr and shown.stderr.count("\n") == 1
    assert not list(folder.glob("a.*"))


@pytest.mark.thorough
def test_no_supports_are_said_to_be_none(run: Run, folder: Path) -> None:
    """A part too small for three pads has a sheet without them from design, and a sentence from sheet."""
    Path("small.json").write_text(
        json.dumps(
            {"name": "small", "units": "mm", "loops": [[[0, 0, 0], [90, 2, 0], [88, 11, 0], [1, 10, 0]]]}
        )
    )
    words = ("design", "small.json", *KIT, "--best", 3, "--supports", "--thickness", 9)
    shown = run(*words, "--sheet", "a.pdf", "--out", "r.json")
    assert shown.exit_code == 0, shown.stderr
    assert (
        "no three supports hold the part under any of the best, so the sheet has none: another side up"
        in shown.stderr
    )
    assert "Supports and the clamp on top" not in words_in("a.pdf")
    assert "+9.000 top of the part" in words_in("a.pdf")
    shown = run("sheet", "r.json", 1, "-o", "b.pdf", "--supports", "--thickness", 9)
    assert (
        shown.exit_code == 2
        and "under fixture 1 no three supports" in shown.stderr
        and not Path("b.pdf").exists()
    )


@pytest.mark.thorough
def test_smaller_pads_stand_where_the_usual_ones_do_not(run: Run, folder: Path) -> None:
    """The table says which sizes and why; the sheets of design and of the fixture have the same."""
    loop = [[0, 0, 0], [90, 2, 0], [88, 21, 0], [1, 20, 0]]
    Path("slim.json").write_text(json.dumps({"name": "slim", "units": "mm", "loops": [loop]}))
    words = ("design", "slim.json", *KIT, "--best", 30, "--supports", "--thickness", 9)
    shown = run(*words, "--sheet", "a.pdf", "--out", "r.json")
    assert shown.exit_code == 0, shown.stderr
    assert "Pads of radius 3.000 mm and a tip of radius 4.000 mm" in shown.stdout
    assert "Larger pads and tips hold the part under none of these" in shown.stdout
    rank = int(shown.stdout.split("The setup sheet of fixture ")[1].split()[0])
    assert f"no such supports hold up fixture 1, so the sheet shows fixture {rank}." in shown.stderr
    assert f"\n   {rank}   " in shown.stdout.split("supports   clamp at")[1]
    assert "round pads Ø 6 mm" in words_in("a.pdf") and "its round tip Ø 8 mm" in words_in("a.pdf")
    assert run("sheet", "r.json", rank, "-o", "b.pdf", "--supports", "--thickness", 9).exit_code == 0
    assert words_in("b.pdf") == words_in("a.pdf")


@pytest.mark.thorough
def test_pegs_of_a_program_are_as_high_above_the_part_as_on_its_supports(run: Run, folder: Path) -> None:
    """Heights of a query are above where the part lies; the sheet's are above the plate, 10 mm lower."""
    (folder / "high.nc").write_text("(T1 D=6)\nT1 M6\nG90 G17 G21\nG0 X20 Y20 Z5\nG1 Z-2 F100\nG1 X40\nM30\n")
    words = ("design", "plate.json", *KIT, "--best", 5, "--supports", "--thickness", 14, "--peg-height", 6)
    shown = run(*words, "--program", "high.nc", "--sheet", "a.pdf", "--out", "r.json")
    assert shown.exit_code == 0, shown.stderr
    text = words_in("a.pdf")
    assert "top of the pegs 6.000 mm" in text and "pegs above the plate 16.000 mm" in text
    # Pegs press where they reach, not over all of the part.
    assert "0.000 6.000" in text and "0.000 14.000" not in text


def test_a_fixture_like_an_earlier_one_may_be_the_first_on_supports(monkeypatch: pytest.MonkeyPatch) -> None:
    """It stands in other holes, so three supports may find room where they find none under the earlier one."""
    result = workhold.design(side("z", [(1,), (2,), (3,), (4,)], False), Plate(20, 3, columns=6, rows=5))
    firsts = set(make_entries(result).index.tolist())
    rank = next(number for number in range(1, len(result) + 1) if number - 1 not in firsts)
    asked: list[int] = []

    def found(fixtures: Any, *_: Any, **__: Any) -> Iterator[Any]:
        for fixture in fixtures:
            asked.append(fixture.listing.row + 1)
            yield SimpleNamespace(triples=["three"] if asked[-1] == rank else [], stopped=False)

    monkeypatch.setattr("workhold.supports.asking.yield_supports", found)
    monkeypatch.setattr("workhold.model.support_triples.ChosenSupports.from_supports", lambda found: found)
    monkeypatch.setattr("workhold.presenting.papers.write_paper", lambda *_: None)
    assert write_first_sheet(result, "a.pdf", "-", 20.0, MILLIMETRE, None) == rank
    assert asked == list(range(1, rank + 1))
