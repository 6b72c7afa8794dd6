"""``--unit`` in and out, and ``workhold toolkits``."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import isclose
from pathlib import Path
from typing import Any

import pytest
import typer
from reading_helpers import new_dxf, rectangle
from svg_reading import texts

from fakes import fake_result
from workhold import save
from workhold.files.toolkit_file import list_preset_names, load_toolkit
from workhold.units import INCH

ROOT = Path(__file__).parent.parent.parent


def test_tables_in_inches_are_those_in_millimetres(
    run: Any, searched: dict[str, Any], tmp_path: Path
) -> None:
    """Every length of the two tables over 25.4, to four decimals; the other words are the same."""
    result = searched["result"] = fake_result(3)
    fixture, opening = result[0], f"{result[0].jaw_separation / 25.4:.4f}"
    vise = ("--pitch", "10mm", "--columns", "3", "--peg-radius", "3mm")
    listed = run("design", "widget", *vise, "--unit", "inch").stdout
    assert "opening in" in listed and opening in listed.split()
    save(result, tmp_path / "r.json")
    told = run("show", tmp_path / "r.json", 1, "--unit", "inch").stdout
    assert f"Opening S {opening} in" in told and " x in " in told and " y in " in told
    rows = [line.split() for line in told.splitlines()]
    for peg in fixture.pegs:
        row = next(one for one in rows if one[:1] == [str(peg.hole)])
        assert (float(row[2]), float(row[3])) == pytest.approx((peg.x / 25.4, peg.y / 25.4), abs=5e-5)


def test_show_in_inches(run: Any, tmp_path: Path) -> None:
    save(fake_result(2), tmp_path / "r.json")
    outcome = run("show", tmp_path / "r.json", 1, "--unit", "inch")
    assert f"Opening S {fake_result(2)[0].jaw_separation / 25.4:.4f} in" in outcome.stdout
    assert "mm" not in outcome.stdout
    refused = run("show", tmp_path / "r.json", 1, "--unit", "ell")
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)


@pytest.mark.parametrize("option", ["--unit", "--drawing-unit"])
def test_a_drawing_in_pixels_is_asked_for_and_told_how_many_make_an_inch(
    run: Any, tmp_path: Path, option: str
) -> None:
    """The refusal names the answers; with one of them lengths are in mm, or in the unit of the command."""
    path = tmp_path / "plate.svg"
    page = 'width="288px" height="144px" viewBox="0 0 288 144"'
    body = '<rect x="72" y="36" width="144" height="72"/>'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {page}>{body}</svg>')
    refused = run("features", path)
    assert refused.exit_code == 2
    assert "say which with --unit px72, px90 or px96" in refused.stderr
    assert "50.800 x 25.400 mm" in run("features", path, option, "px72").stdout
    assert "38.100 x 19.050 mm" in run("features", path, option, "px96").stdout
    inches = ("--unit", "inch", "--drawing-unit", "px72")
    assert "2.0000 x 1.0000 in" in run("features", path, *inches).stdout
    remarked = run("features", path, "--unit", "mm")
    assert "144.000 x 72.000 mm" in remarked.stdout
    assert "give --unit px72, px90 or px96" in remarked.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("unit", [None, "inch"])
def test_pictures_are_in_the_unit_asked(
    run: Any, searched: dict[str, Any], tmp_path: Path, unit: str | None
) -> None:
    """Of one fixture, of the faces, of the best and their thumbnails; millimetres where no unit is asked."""
    result = searched["result"] = fake_result(1)
    save(result, tmp_path / "r.json")
    asked = () if unit is None else ("--unit", unit)
    assert run("show", tmp_path / "r.json", 1, "--draw", tmp_path / "shown.svg", *asked).exit_code == 0
    assert (
        run("features", "widget", "--peg-radius", "3mm", "--draw", tmp_path / "faces.svg", *asked).exit_code
        == 0
    )
    vise = ("--pitch", "10mm", "--columns", "3", "--peg-radius", "3mm")
    assert run("design", "widget", *vise, "--draw", tmp_path, *asked).exit_code == 0
    opening = result[0].jaw_separation
    wanted, size = (
        (f"{opening:.3f} mm", "6 mm") if unit is None else (f"{opening / 25.4:.4f} in", "0.23622 in")
    )
    words = {path.stem: " ".join(texts(path.read_text())) for path in tmp_path.glob("*.svg")}
    assert [
        name for name in ("shown", "fixture-01", "thumbnails") if f"S = {wanted}" not in words[name]
    ] == []
    assert f"a peg of Ø {size} lies" in words["faces"]


@pytest.mark.thorough
def test_the_nearest_miss_is_drawn_in_the_unit_asked(run: Any, tmp_path: Path) -> None:
    vise = ("--pitch", "10mm", "--columns", "1", "--peg-radius", "3mm", "--min-gap", "300mm")
    assert run("design", "widget", *vise, "--unit", "inch", "--draw", tmp_path).exit_code == 0
    assert "Ø 0.23622 in" in texts((tmp_path / "nearest-miss.svg").read_text())


def test_a_drawing_without_a_unit_is_in_that_of_the_command(run: Any, tmp_path: Path) -> None:
    """A 60 x 40 plate: inches where nobody else says; as the file says otherwise; --drawing-unit overrides both."""
    for insunits in (0, 4):
        document, space = new_dxf(insunits)
        rectangle(space)
        document.saveas(tmp_path / f"{insunits}.dxf")
    unsaid, said = tmp_path / "0.dxf", tmp_path / "4.dxf"
    assert run("features", unsaid).exit_code == 2
    assert ": 60.0000 x 40.0000 in" in run("features", unsaid, "--unit", "inch").stdout
    assert ": 60.000 x 40.000 mm" in run("features", unsaid, "--drawing-unit", "mm").stdout
    outcome = run("features", said, "--unit", "inch")
    assert ": 2.3622 x 1.5748 in" in outcome.stdout
    assert "The file says its unit is mm; it was read so (--drawing-unit overrides it)." in outcome.stderr
    outcome = run("features", said, "--unit", "inch", "--drawing-unit", "inch")
    assert ": 60.0000 x 40.0000 in" in outcome.stdout
    assert run("features", said, "--unit", "mm").stderr == ""


def test_parts_and_vises_in_inches(run: Any) -> None:
    rows = [line.split() for line in run("toolkits", "--unit", "inch").stdout.splitlines()]
    assert rows[0][:4] == ["name", "pitch", "in", "peg"]
    assert [row[0] for row in rows[2:]] == list(list_preset_names())
    assert next(row for row in rows if row[0] == "plate-one-inch")[1:4] == ["1", "0.25", "3"]
    assert "width in" in run("parts", "--unit", "in").stdout
    assert "pitch mm" in run("toolkits").stdout


@pytest.mark.parametrize("name", list_preset_names())
def test_every_vise_is_shown_with_its_source(run: Any, name: str) -> None:
    outcome = run("toolkits", name)
    assert outcome.exit_code == 0, outcome.stderr
    assert outcome.stdout.splitlines()[-1].startswith("Source: ")


def test_the_figures_of_a_vise(run: Any, tmp_path: Path) -> None:
    """In its own unit, or in the one asked for; a user's file too; what was assumed is said to be."""
    inches = run("toolkits", "plate-one-inch").stdout
    assert re.search(r"distance between holes +1 in", inches)
    assert "0.2501 to 0.2503 in" in inches
    assert "0.00039 in (assumed: no source says)" in inches
    assert "6.353 to 6.358 mm" in run("toolkits", "plate-one-inch", "--unit", "mm").stdout
    path = tmp_path / "own.toml"
    path.write_text(
        'unit = "mm"\npitch = [20, 25]\ncolumns = 2\npeg_radius = 3\nrows = 8\nbody_radius = 5\nblocked = ["L-B"]\n'
        "row_offset = 5\nmax_opening = 90\n"
    )
    own = run("toolkits", path).stdout
    for words in (
        "20 x 25 mm",
        "rows on each jaw",
        "L-B",
        "90 mm",
        "5 mm",
        "(assumed: no pin and hole are given)",
    ):
        assert words in own
    refused = run("toolkits", "plate-one")
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
    assert "try plate-one-inch" in refused.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["hardware.md", "no-fixture.md"])
def test_the_worked_examples_of_the_manual(
    name: str, run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The commands of these pages print the lines quoted there, spaces aside."""
    page = (ROOT / "docs" / name).read_text()
    blocks = re.findall(r"```console\n(.*?)```", page, flags=re.S)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    printed: list[str] = []
    for line in "".join(blocks).splitlines():
        if line.startswith("$ workhold "):
            outcome = run(*line.split()[2:])
            assert outcome.exit_code == 0, outcome.stderr
            printed = [" ".join(words.split()) for words in outcome.stdout.splitlines()]
        else:
            assert any(words.startswith(" ".join(line.split())) for words in printed), line
    assert printed


def test_the_vise_file_of_the_manual(tmp_path: Path) -> None:
    """Every entry there is one, and its peg tolerance is the sum that the page reckons."""
    page = (ROOT / "docs" / "hardware.md").read_text()
    block = next(one for one in re.findall(r"```toml\n(.*?)```", page, flags=re.S) if "columns" in one)
    (tmp_path / "jaws.toml").write_text(block)
    loaded = load_toolkit(tmp_path / "jaws.toml")
    assert isclose(loaded.tolerance.peg, 0.044)
    assert "0.044 mm" in page


def test_the_manual_lists_every_preset() -> None:
    """The table has a row for each preset with its pitch, peg and columns."""
    page = (ROOT / "docs" / "hardware.md").read_text()
    for name in list_preset_names():
        loaded = load_toolkit(name)
        if not loaded.toolkit.plates:
            assert f"`{name}`" in page
            continue
        unit, first = loaded.unit, loaded.toolkit.plates[0]
        pitch, peg = unit.format_short_length(first.pitch[0]), unit.format_short_length(2 * first.peg_radius)
        of = unit.abbreviation
        assert f"\n| `{name}` | {pitch} {of} | {peg} {of} | {first.columns or 'any'} |" in page
    kinds = ("plate-", "table-", "gripper-", "clamp-", "fence-", "two-clamp-", "machine-vise-", "strap-")
    assert sum(page.count(f"\n| `{kind}") for kind in kinds) == sum(
        bool(load_toolkit(name).toolkit.plates) for name in list_preset_names()
    )


@pytest.mark.thorough
def test_a_toolkit_in_inches_is_shown_in_inches(
    run: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On terminal and paper, which is then Letter; not where another unit is asked for or set for good. Lengths that are
    typed are in mm all the same."""
    file, page = tmp_path / "r.json", tmp_path / "sheet.svg"

    def words_of(*further: str) -> str:
        for old in tmp_path.glob("sheet*.svg"):
            old.unlink()
        assert run("sheet", file, "1", "-o", page, "--force", *further).exit_code == 0
        return " ".join(word for one in tmp_path.glob("sheet*.svg") for word in texts(one.read_text()))

    found = run("design", "widget", "--toolkit", "clamp-plate-one-inch", "--best", "1", "--out", file)
    assert found.exit_code == 0 and "error in" in found.stdout
    assert "on Letter" in words_of() and "Lengths inch" in words_of("--thickness", "12.7")
    assert "0.5000 in" in words_of("--thickness", "12.7")
    assert "on A4" in words_of("--unit", "mm") and "on A4" in words_of("--paper", "a4")
    monkeypatch.setenv("WORKHOLD_UNIT", "mm")
    assert "on A4" in words_of()
    monkeypatch.setenv("WORKHOLD_UNIT", "inch")
    assert "on Letter" in words_of() and "12.7000 in" in words_of("--thickness", "12.7")
    metric = run("design", "widget", "--toolkit", "clamp-plate-20mm", "--best", "1")
    assert "error in" in metric.stdout
    monkeypatch.setenv("WORKHOLD_UNIT", "ell")
    assert "Unit 'ell' is not known" in run("show", file, "1").stderr


def test_inches_are_told_by_the_holes() -> None:
    """Eighths of an inch that are not whole or half millimetres."""
    for name in list_preset_names():
        assert load_toolkit(name).toolkit.is_in_inches == (load_toolkit(name).unit is INCH)


# A drawing without a unit: refused with both sizes, and on a terminal asked for.
@pytest.fixture
def drawing(tmp_path: Path) -> Path:
    """A plate of 60 by 40, nobody knows of what."""
    document, space = new_dxf(0)
    rectangle(space)
    document.saveas(tmp_path / "plate.dxf")
    return tmp_path / "plate.dxf"


def test_both_sizes_are_shown(run: Callable[..., Any], drawing: Path) -> None:
    """What it would be in mm and in inches, and the option that says which."""
    outcome = run("features", drawing)
    assert outcome.exit_code == 2 and outcome.stdout == ""
    assert (
        "it is 60 mm wide, or 60 in = 1,524 mm; say which with --unit mm (or inch, cm, m)" in outcome.stderr
    )


def test_somebody_at_a_terminal_is_asked(
    run: Callable[..., Any], drawing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The answer is the drawing's unit; one that is none is refused."""
    monkeypatch.setattr("workhold.cli.options.is_at_terminal", lambda: True)
    answers = iter(["inch", "ell"])
    monkeypatch.setattr(typer, "prompt", lambda *words, **more: next(answers))
    outcome = run("features", drawing)
    assert outcome.exit_code == 0 and "plate: 1524.000 x 1016.000 mm" in outcome.stdout
    assert "it is 60 mm wide" in outcome.stderr
    refused = run("features", drawing)
    assert "Unit 'ell' is not known" in refused.stderr and refused.exit_code == 2
