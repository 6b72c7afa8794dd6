"""The path of a program on the plan and the sheet: where the pose puts it, cut at the drawing, its nearest move marked."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from datetime import date
from itertools import pairwise
from math import hypot
from pathlib import Path

import numpy as np
import pytest

from workhold import Fence, Plate, Program, Query, Result, Vise, answer, load
from workhold.drawing import draw_fixture, draw_setup_sheet
from workhold.drawing.path_drawn import PagePaths, PlannedPath, make_planned_path
from workhold.drawing.pdf import convert_svg_to_pdf
from workhold.drawing.scene import Box, View
from workhold.fixels.toolkit import Toolkit
from workhold.model.moves import Moves
from workhold.statics.program_clearance import find_nearest_passing

EXAMPLES = Path(__file__).parent.parent.parent / "examples"
VISE = Vise(pitch=20, columns=2, peg_radius=4)
TOOLKITS: dict[str, Toolkit] = {
    "vise": VISE,
    "plate": Plate(pitch=20, peg_radius=4, columns=8, rows=6, travel=(10, 40), directions=["-x"]),
    "fence": Fence(pitch=20, peg_radius=4, wall_offset=8, columns=8, rows=6),
}


def result_in(toolkit: Toolkit) -> Result:
    """The bracket with its program."""
    part = load(EXAMPLES / "bracket.dxf")
    program = Program.read(EXAMPLES / "bracket.nc", EXAMPLES / "tools.toml", thickness=12)
    return answer(Query(part, toolkit, program=program, peg_height=6, best=3))


@pytest.fixture(scope="module", params=list(TOOLKITS))
def result(request: pytest.FixtureRequest) -> Result:
    """The bracket in each kind."""
    return result_in(TOOLKITS[request.param])


def by_class(svg: str, name: str) -> list[ET.Element]:
    """The elements of a class."""
    return [one for one in ET.fromstring(svg).iter() if one.get("class") == name]


def map_of(svg: str) -> tuple[float, float, float]:
    """Scale, left and top of the map from the vise frame to the page, as the group of paths carries it."""
    (group,) = by_class(svg, "paths")
    numbers = re.findall(r"-?[\d.]+(?:e-?\d+)?", group.attrib["data-model-to-page"])
    return float(numbers[0]), float(numbers[4]), float(numbers[5])


def ends_of(d: str) -> np.ndarray:
    """The points of path data at which its moves, lines and arcs end."""
    return np.array([[float(x), float(y)] for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)(?=[MLA]|$)", d)])


@pytest.mark.thorough
def test_path_lies_where_the_pose_puts_the_part(result: Result) -> None:
    """The slot's ends on the page, taken back by the pose, are those that the program names."""
    path = make_planned_path(result, 0)
    assert path is not None
    svg = draw_fixture(result[0], result.workpiece, result.toolkit, path=path)
    scale, left, top = map_of(svg)
    points = np.concatenate([ends_of(one.attrib["d"]) for one in by_class(svg, "cut-2")])
    x, y = result[0].pose.inverse.apply((points[:, 0] - left) / scale, (top - points[:, 1]) / scale)
    for corner in ((60.0, 18.0), (24.0, 20.0), (60.0, 20.0), (24.0, 18.0)):
        assert np.hypot(x - corner[0], y - corner[1]).min() < 0.01
    assert np.hypot(x - 102, y - 18).max() > 60


@pytest.mark.thorough
def test_nearest_move_is_marked_at_its_distance(result: Result) -> None:
    """The marked place is off what it passes by the clearance, the tool's radius and the peg's."""
    path, near = make_planned_path(result, 0), find_nearest_passing(result, 0)
    assert path is not None and near is not None
    svg = draw_fixture(result[0], result.workpiece, result.toolkit, path=path)
    (mark,) = by_class(svg, "nearest-place")
    scale, left, top = map_of(svg)
    x, y = (float(mark.attrib["cx"]) - left) / scale, (top - float(mark.attrib["cy"])) / scale
    peg = result[0].pegs[near.contact]
    if peg not in result[0].placed:
        assert y - near.radius == pytest.approx(near.distance, abs=0.01)
    elif near.element.startswith(("peg", "locator")):
        off = hypot(x - peg.x, y - peg.y) - near.radius - 4.0
        assert off == pytest.approx(near.distance, abs=0.01)
    words = [one.text for one in ET.fromstring(svg).iter() if one.tag.endswith("text")]
    assert f"line {near.line}, T{near.tool}: {near.distance:.3f} mm" in words


@pytest.mark.thorough
def test_sheet_names_the_program_with_its_tools_and_zero(result: Result) -> None:
    """The sheet's part zero is the program's, and every tool stands on it with its lines."""
    pages = draw_setup_sheet(result, 1)
    words = [one.text for page in pages for one in ET.fromstring(page).iter() if one.tag.endswith("text")]
    for said in ("bracket.nc", "T1", "13 to 30", "37 to 41", "49 to 70", "origin of the drawing"):
        assert said in words
    assert by_class(pages[0], "rapid") and by_class(pages[0], "cut-1") and by_class(pages[0], "nearest")
    assert convert_svg_to_pdf(pages, date(2026, 3, 1)).startswith(b"%PDF")
    assert not any("this sheet's" in (word or "") for word in words)
    other = draw_setup_sheet(result, 1, zero="centre")
    words = [one.text for page in other for one in ET.fromstring(page).iter() if one.tag.endswith("text")]
    assert any("X0 Y0 is at x 0.000, y" in (word or "") for word in words)


def moves(*rows: tuple[tuple[float, float], tuple[float, float], float]) -> Moves:
    """Cutting moves at height 0 from starts, ends and bulges."""
    return Moves.from_rows(
        [(1, 1, True, (*one, 0.0), (*other, 0.0), bulge, 0.0, 0.0) for one, other, bulge in rows]
    )


def test_paths_end_at_the_box() -> None:
    """Straight moves are cut at the box, arcs beyond it left out, and what is outside is not drawn."""
    given = moves(
        ((-20, 5), (20, 5), 0.0),
        ((20, 5), (30, 5), 0.0),
        ((5, 5), (5, 9), 1.0),
        ((1, 5), (1, 9), -1.0),
        ((5, -3), (5, 15), 0.0),
    )
    paths = PagePaths.from_moves(given, View(1.0, 0.0, 10.0), box=Box(0, 0, 10, 10))
    assert paths.shown.tolist() == [True, False, True, False, True]
    assert paths.start[0].tolist() == [0, 5] and paths.end[0].tolist() == [10, 5]
    assert paths.start[4].tolist() == [5, 10] and paths.end[4].tolist() == [5, 0]
    assert paths.make_path_data(np.arange(5)) == "M0 5L10 5M5 5A2 2 0 0 0 7 3A2 2 0 0 0 5 1M5 10L5 0"


def test_short_moves_are_drawn_together_and_keep_their_end() -> None:
    """A run of moves of a hundredth of a unit becomes a few lines that end where it ends."""
    xs = np.linspace(0, 1.203, 121)
    given = moves(*(((a, 0.0), (b, 0.0), 0.0) for a, b in pairwise(xs.tolist())))
    d = PagePaths.from_moves(given, View(1.0, 0.0, 0.0)).make_path_data(np.arange(120))
    assert d.count("L") == 4 and d.endswith("L1.203 0") and d.count("M") == 1
    apart = moves(((0, 0), (0.1, 0), 0.0), ((5, 0), (5.1, 0), 0.0), ((5.1, 0), (5.3, 0.2), 0.4))
    assert (
        PagePaths.from_moves(apart, View(1.0, 0.0, 0.0))
        .make_path_data(np.arange(3))
        .startswith("M0 0L0.1 0M5 0L5.1 0A")
    )


def test_plan_grows_for_what_is_cut_beside_the_part_but_not_for_a_far_journey(result: Result) -> None:
    """The extent holds the border's path; a cut a metre away does not shrink the plan."""
    path = make_planned_path(result, 0)
    assert path is not None
    extent = Box(0, 0, 130, 130)
    assert path.enlarge_extent(extent).width > 130 or path.enlarge_extent(extent).height > 130
    far = moves(((0, 0), (1000, 0), 0.0))
    from attrs import evolve

    off = evolve(path.program, moves=evolve(far, tool=[2]))
    assert PlannedPath(off, path.fixture, None).enlarge_extent(extent) == extent
