"""A plate of which no number of columns or rows is given lies under the whole part; one that has an end ends there."""

from __future__ import annotations

from io import StringIO

import ezdxf
import pytest
from attrs import evolve
from held_any_way import HELD, PITCH, Held
from svg_reading import NAMESPACE, by_class, to_model

from workhold import Pose
from workhold.drawing import draw_fixture
from workhold.files.dxf.writer import make_setup_dxf
from workhold.model.shown import ShownSetUp, find_shown

KINDS = (
    "vise, I",
    "opening vise, II",
    "plate, bolted, clamp -x",
    "two on a plate, line, clamp2 -x -y",
    "fence, bolted, edge +y",
)
EACH = pytest.mark.parametrize(
    "held", [held for held in HELD if held.made in KINDS], ids=lambda held: held.made
)
# Far to the left of all pegs and below them; a fence lets nothing lie below it.
FAR = Pose(200.0, -70.0, -60.0)


def far_out(held: Held, **limits: int) -> tuple[Held, ShownSetUp]:
    """A part that reaches far beyond column A and row 1, and what shows."""
    fixture = evolve(held.fixture, pose=evolve(FAR, y=90.0) if held.made.startswith("fence") else FAR)
    held = evolve(held, fixture=fixture, toolkit=evolve(held.toolkit, **limits))  # type: ignore[misc]
    return held, find_shown(held.fixture, held.toolkit, held.workpiece)


@EACH
def test_a_plate_without_limits_lies_under_the_whole_part(held: Held) -> None:
    """Beyond column A and row 1 as well, each hole in its place on the lattice; only a fence is where the rows begin."""
    held, seen = far_out(held)
    fence = held.made.startswith("fence")
    for each in seen.carriers:
        assert (
            each.plate.y0 <= max(seen.part.y0, 0.0 if fence else seen.part.y0)
            and each.plate.y1 >= seen.part.y1
        )
        assert (each.rows[0] < 0) != fence
        assert {"bottom", "top"} - each.broken == ({"bottom"} if fence else set())
        if each.carrier.columns is None:
            assert each.plate.x0 <= seen.part.x0 and each.plate.x1 >= seen.part.x1 and each.columns[0] < 0
            assert {"left", "right"} <= each.broken
        x, y = each.carrier.compute_hole_center(0, 0, each.travelled)
        for hole in each.list_holes():
            assert hole.center == pytest.approx((x + hole.column * PITCH[0], y + hole.row * PITCH[1]))
        assert each.named_rows[0] == (0, pytest.approx(y)) and each.named_columns[0][0] >= 0


@EACH
def test_a_plate_with_limits_ends_there(held: Held) -> None:
    """Half a pitch beyond its first hole, however far the part reaches beyond that."""
    limits = {"columns": 6, "rows": 6} if held.directions else {"rows": 6}
    held, seen = far_out(held, **limits)
    for each in seen.carriers:
        assert each.rows[0] == 0 and each.rows[-1] <= 5 and each.columns[0] >= 0 and each.columns[-1] <= 5
        assert "bottom" not in each.broken
        if not held.made.startswith("fence"):
            assert each.plate.y0 == pytest.approx(each.carrier.offset[1] - 0.5 * PITCH[1])
        if held.directions:
            assert each.plate.x0 == pytest.approx(-0.5 * PITCH[0]) and "left" not in each.broken


@pytest.mark.thinned(3)
@EACH
def test_holes_keep_their_names(held: Held) -> None:
    """Column A and row 1 are named at hole A1, in the picture and in a drawing for a CAM system; none before them is."""
    held, seen = far_out(held)
    origins = [each.carrier.compute_hole_center(0, 0, each.travelled) for each in seen.carriers]
    svg = draw_fixture(held.fixture, held.workpiece, held.toolkit)
    (group,), (names,) = by_class(svg, "part"), by_class(svg, "hole-names")
    places = [
        (text.text, *to_model(group, float(text.attrib["x"]), float(text.attrib["y"])))
        for text in names.iter(f"{NAMESPACE}text")
    ]
    letters = [(name, x) for name, x, _ in places if name and name.isalpha() and name.isupper()]
    rows = [(int(name), y) for name, _, y in places if name and name.isdigit()]
    assert letters and rows and min(row for row, _ in rows) == 1
    for name, x in letters:
        column = ord(name) - ord("A")
        # Letters of jaws that all but meet stand a little beside their column.
        assert any(abs(origin[0] + column * PITCH[0] - x) < 1.0 for origin in origins)
    for row, y in rows:
        assert any(abs(origin[1] + (row - 1) * PITCH[1] - y) < 2.5 for origin in origins)
    space = ezdxf.read(
        StringIO(make_setup_dxf(held.fixture, held.workpiece, held.toolkit).decode())
    ).modelspace()  # type: ignore[attr-defined]
    texts = [(text.dxf.text, text.dxf.align_point) for text in space if text.dxftype() == "TEXT"]
    centers = [
        circle.dxf.center for circle in space if circle.dxftype() == "CIRCLE" and "HOLES" in circle.dxf.layer
    ]
    for each, (x, y) in zip(seen.carriers, origins, strict=True):
        assert any(words == "1" and abs(at.y - y) < 1e-6 for words, at in texts)
        assert each.columns[0] > 0 or any(words == "A" and abs(at.x - x) < 1e-6 for words, at in texts)
        assert len([at for at in centers if at.y < y - 1e-6]) > 0 or held.made.startswith("fence")
    assert all(words for words, _ in texts)
