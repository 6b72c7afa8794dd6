"""Drawings that somebody made to hurt: one plain sentence, within limits, and no warning of a library."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import pytest
from attrs import evolve

from workhold import Workpiece
from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.dxf.walk import BlockNesting, DxfWalk
from workhold.files.part.load import read_workpiece
from workhold.files.part.survey import list_drawn_layers, survey_part_file
from workhold.geometry import loop as loop_module
from workhold.geometry.loop import ComparisonBudget, LoopShape, find_near_segments, make_loop_segments

PLATE = [((0, 0), (60, 0)), ((60, 0), (60, 40)), ((60, 40), (0, 35)), ((0, 35), (0, 0))]


def line(start: tuple[float, float], end: tuple[float, float], layer: str = "0") -> str:
    """The tags of a LINE."""
    places = f"10\n{start[0]!r}\n20\n{start[1]!r}\n11\n{end[0]!r}\n21\n{end[1]!r}\n"
    return f"0\nLINE\n8\n{layer}\n{places}"


def drawing(
    path: Path, entities: str | None = None, *, unit: str = "70\n4", blocks: str = "", version: str = "AC1015"
) -> Path:
    """A DXF file of some tags; of a plate where no entities are given."""
    entities = "".join(line(*ends) for ends in PLATE) if entities is None else entities
    head = f"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\n{version}\n9\n$INSUNITS\n{unit}\n0\nENDSEC\n"
    body = f"0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    path.write_text(head + body)
    return path


@pytest.mark.parametrize("unit", ["1\nx", "1\nnan", "1\n1e400", "1\n", "40\ninf"])
def test_a_unit_that_is_no_number_is_asked_for(tmp_path: Path, unit: str) -> None:
    """Old drawings give it as text; with a unit given they are read."""
    path = drawing(tmp_path / "text.dxf", unit=unit, version="AC1009")
    with pytest.raises(InputError, match="unit is not"):
        read_workpiece(path)
    assert read_workpiece(path, unit="mm").workpiece.bounds[2] == 60.0
    assert survey_part_file(path).asked == ("unit",)


@pytest.mark.parametrize("unit", ["1e400", "1x", "4,5"])
def test_a_unit_is_not_what_a_repair_makes_of_it(tmp_path: Path, unit: str) -> None:
    """The library takes the digits with which a number begins, and so inches for 1e400."""
    path = drawing(tmp_path / "damaged.dxf", unit=f"70\n{unit}")
    with pytest.raises(InputError, match=rf"unit is not one for parts \(\$INSUNITS {unit}\)"):
        read_workpiece(path)


def test_blocks_that_double_are_foreseen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousand million plates in thirty blocks are refused before they are written out."""

    def block(name: str, inner: str) -> str:
        return f"0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n{inner}0\nENDBLK\n8\n0\n"

    def insert(name: str) -> str:
        return f"0\nINSERT\n8\n0\n2\n{name}\n10\n0\n20\n0\n"

    blocks = block("B0", "".join(line(*ends) for ends in PLATE))
    blocks += "".join(block(f"B{k}", 2 * insert(f"B{k - 1}")) for k in range(1, 31))
    visited: list[str] = []
    visit = DxfWalk.visit

    def counted(self: DxfWalk, entity: Any, nest: BlockNesting) -> None:
        visited.append(entity.dxftype())
        visit(self, entity, nest)

    monkeypatch.setattr(DxfWalk, "visit", counted)
    path = drawing(tmp_path / "blocks.dxf", insert("B30"), blocks=blocks)
    with pytest.raises(InputError, match=r"more than the 100,000 entities .* written out"):
        read_workpiece(path)
    assert len(visited) < 5
    path = drawing(tmp_path / "few.dxf", insert("B0"), blocks=blocks)
    assert len(read_workpiece(path).workpiece.segments) == 4


@pytest.mark.parametrize("number", ["nan", "1e400", "1e300"])
@pytest.mark.parametrize("code", ["42", "20"])
def test_the_unit_is_asked_for_whatever_the_numbers_are(tmp_path: Path, code: str, number: str) -> None:
    """A size to help choose is said of sound ones only."""
    rows = "".join(f"10\n{x}\n20\n{y}\n42\n0\n" for x, y in ((0, 0), (60, 0), (60, 40)))
    head = "0\nLWPOLYLINE\n100\nAcDbEntity\n8\n0\n100\nAcDbPolyline\n90\n3\n70\n1\n"
    damaged = rows.replace(f"{code}\n0\n", f"{code}\n{number}\n", 1)
    path = drawing(tmp_path / "no_unit.dxf", head + damaged, unit="70\n0")
    with pytest.raises(InputError, match=r"the drawing's unit is not said: say which"):
        read_workpiece(path)
    with pytest.raises(InputError, match=r"no_unit\.dxf: "):
        read_workpiece(path, unit="mm")
    assert survey_part_file(path).asked == ("unit",)


def test_a_file_without_a_model_space_is_damaged(tmp_path: Path) -> None:
    """Its layouts name one that is not there."""
    objects = (
        "0\nSECTION\n2\nOBJECTS\n0\nDICTIONARY\n3\nACAD_LAYOUT\n350\nD\n0\nDICTIONARY\n5\nD\n3\nInfinity\n"
    )
    objects += "350\n1A\n3\nLayout1\n350\n1E\n0\nLAYOUT\n5\n1A\n100\nAcDbPlotSettings\n100\nAcDbLayout\n"
    layouts = "330\n17\n0\nLAYOUT\n5\n1E\n0\nENDSEC\n0\nEOF\n"
    path = tmp_path / "none.dxf"
    path.write_text("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n0\nENDSEC\n" + objects + layouts)
    for read in (read_workpiece, lambda file: list_drawn_layers(file, None, None)):
        with pytest.raises(InputError, match=r"none\.dxf: the DXF file is damaged"):
            read(path)
    assert survey_part_file(path).loaded is None


def test_no_warning_comes_before_the_sentence(tmp_path: Path) -> None:
    """Lengths that overflow, in inches."""
    ends = [((0.0, 0.0), (1e308, 0.0)), ((1e308, 0.0), (1e308, 1e308)), ((1e308, 1e308), (0.0, 0.0))]
    path = drawing(tmp_path / "far.dxf", "".join(line(*pair) for pair in ends), unit="70\n1")
    part = tmp_path / "far.json"
    part.write_text(json.dumps({"units": "inch", "loops": [[[0, 0, 0], [1e308, 0, 0], [0, 1e308, 0]]]}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for file in (path, part):
            with pytest.raises(InputError, match="finite number"):
                read_workpiece(file)
        assert survey_part_file(path).loaded is None


def insert(block: str, columns: int = 1, rows: int = 1, handle: str = "") -> str:
    """The tags of an INSERT."""
    named = f"5\n{handle}\n" if handle else ""
    return f"0\nINSERT\n{named}8\n0\n2\n{block}\n10\n0\n20\n0\n70\n{columns}\n71\n{rows}\n44\n1\n45\n1\n"


def block(name: str, inside: str) -> str:
    """The tags of a block."""
    return f"0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n0\n20\n0\n{inside}0\nENDBLK\n8\n0\n"


def test_arrays_of_nothing_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An array of arrays of an empty block."""
    monkeypatch.setitem(LIMITS, "dxf", evolve(LIMITS["dxf"], most_elements=1000))
    blocks = block("A", insert("B", 30, 30)) + block("B", "")
    path = drawing(tmp_path / "arrays.dxf", insert("A", 30, 30), blocks=blocks)
    with pytest.raises(InputError, match="more than the 1,000 entities"):
        list_drawn_layers(path, None, None)
    with pytest.raises(InputError, match="more than the 1,000 entities"):
        read_workpiece(path)


def test_vertices_count_each_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A polyline of a hundred corners in a block that is inserted twenty times."""
    monkeypatch.setitem(LIMITS, "dxf", evolve(LIMITS["dxf"], most_elements=1000))
    corners = "".join(f"10\n{k}\n20\n{k * k}\n" for k in range(100))
    polyline = f"0\nLWPOLYLINE\n100\nAcDbEntity\n8\n0\n100\nAcDbPolyline\n90\n100\n70\n1\n{corners}"
    path = drawing(tmp_path / "many.dxf", insert("A", 20), blocks=block("A", polyline))
    with pytest.raises(InputError, match="more than the 1,000 entities and vertices"):
        read_workpiece(path)


def test_names_of_any_length_are_shortened(tmp_path: Path) -> None:
    """Handles in labels, and kinds of entities in remarks."""
    odd = "".join(f"0\nKIND{k}{'X' * 300}\n5\n{k + 500:X}\n8\n0\n" for k in range(50))
    plate = "".join(line(*ends) for ends in PLATE)
    path = drawing(
        tmp_path / "names.dxf",
        insert("A", handle="A" * 100_000) + odd,
        blocks=block("A", plate + line((9, 9), (9, 20))),
    )
    loaded = read_workpiece(path)
    assert max(len(remark) for remark in loaded.remarks) < 2000


def comb(teeth: int) -> list[list[float]]:
    """Corners of slanted teeth side by side, whose bounding boxes overlap."""
    rows = [[0.1 * k + 50 * (k % 2), -0.1 * k + 50 * (k % 2), 0.0] for k in range(2 * teeth)]
    low = -0.2 * teeth - 60
    return [*rows, [0.2 * teeth + 60, low + 60, 0.0], [0.2 * teeth + 60, low, 0.0], [-10.0, low, 0.0]]


def test_slanted_teeth_are_compared_with_their_neighbours() -> None:
    """Not with all whose boxes overlap theirs."""
    part = Workpiece.from_loops("comb", [comb(300)])
    shape = LoopShape.from_segments(make_loop_segments(part.loops[0]))
    comparisons = ComparisonBudget("the part")
    for k in range(len(shape.segments)):
        find_near_segments(shape, k, shape, comparisons)
    assert comparisons.most - comparisons.left < 8 * len(shape.segments)


def test_what_cannot_be_told_apart_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Crescents within each other: too many pairs to compare."""
    monkeypatch.setattr(loop_module.ComparisonBudget.__init__, "__defaults__", (500,))
    rows = [[x, y, 0.3 if k % 2 else -0.3] for k, (x, y, _) in enumerate(comb(100))]
    rows[-4:] = [[*row[:2], 0.0] for row in rows[-4:]]
    with pytest.raises(InputError, match="more than 500 pairs of segments"):
        Workpiece.from_loops("comb", [rows])


def test_circles_within_circles_are_nested_by_the_one_around() -> None:
    """Each asks the one around it first, so that steps grow with the circles and not with their pairs."""
    import numpy as np

    from workhold.files.budget import UNLIMITED, Budget
    from workhold.files.outline.joining import JoinedLoop
    from workhold.files.outline.nesting import nest_loops

    loops = [JoinedLoop(np.array([[r, 0.0, 1.0], [-r, 0.0, 1.0]]), ("", "")) for r in range(1, 201)]
    budget = Budget(UNLIMITED)
    parts = nest_loops(loops, budget)
    assert len(parts) == 100 and all(len(part.loops) == 2 for part in parts)
    assert budget.steps <= 400
