"""Circles and arcs that came as chords: the remark says which fit helps, and it does."""

from __future__ import annotations

import json
import re
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import pytest
from reading_helpers import read_dxf, read_svg

from workhold import Workpiece, load
from workhold.files.part.load import read_workpiece


def polygon(sides: int, radius: float = 26.0) -> list[tuple[float, float]]:
    """The corners of a regular polygon."""
    return [(radius * cos(2 * pi * k / sides), radius * sin(2 * pi * k / sides)) for k in range(sides)]


def fit_named(remarks: Any) -> float:
    """The fit that a remark names."""
    (said,) = [remark for remark in remarks if "straight pieces" in remark]
    found = re.search(r"give fit ([\d.]+)", said)
    assert found is not None
    return float(found[1])


@pytest.mark.thorough
@pytest.mark.parametrize("sides", [16, 24, 57, 200])
def test_a_circle_of_chords_becomes_one_with_the_fit_named(tmp_path: Path, sides: int) -> None:
    """From JSON, DXF, SVG and corners."""
    corners = polygon(sides)
    path = tmp_path / "part.json"
    path.write_text(json.dumps({"units": "mm", "loops": [[[x, y, 0] for x, y in corners]]}))
    points = " ".join(f"{x} {y}" for x, y in corners)

    def draw(space: Any) -> None:
        space.add_lwpolyline(corners, close=True)

    ways = [
        lambda **fit: read_workpiece(path, **fit),
        lambda **fit: read_dxf(tmp_path, draw, **fit),
        lambda **fit: read_svg(tmp_path, f'<polygon points="{points}"/>', unit="mm", **fit),
    ]
    for read in ways:
        loaded = read()
        assert len(loaded.workpiece.faces) == sides
        again = read(fit=fit_named(loaded.remarks))
        assert len(again.workpiece.faces) == 1
        assert not any("straight pieces" in remark for remark in again.remarks)
    part = Workpiece.from_points("part", corners)
    assert len(Workpiece.from_points("part", corners, fit=fit_named(part.remarks)).faces) == 1


def test_round_corners_of_chords_are_named_too(tmp_path: Path) -> None:
    """Four chords a quarter turn, as buffers of other libraries make them."""
    corners = []
    for k, (x, y) in enumerate([(55, 35), (5, 35), (5, 5), (55, 5)]):
        corners += [(x + 5 * cos(pi / 2 * (k + j / 4)), y + 5 * sin(pi / 2 * (k + j / 4))) for j in range(5)]
    part = Workpiece.from_points("part", corners)
    assert "radius 5 mm" in part.remarks[0]
    assert len(Workpiece.from_points("part", corners, fit=fit_named(part.remarks)).faces) == 8


@pytest.mark.parametrize("sides", [3, 4, 6, 8, 12, 15])
def test_polygons_are_polygons(sides: int) -> None:
    """A knob of twelve sides is one."""
    part = Workpiece.from_points("knob", polygon(sides))
    assert len(part.faces) == sides and part.remarks == ()


def test_a_large_polygon_of_few_sides_is_one(tmp_path: Path) -> None:
    """Sixteen sides more than half a millimetre inside their circle; a large circle of many chords is a circle."""
    assert Workpiece.from_points("table", polygon(16, 60)).remarks == ()
    assert fit_named(Workpiece.from_points("ring", polygon(64, 900)).remarks) > 1


def test_other_parts_of_a_geometry_are_told(tmp_path: Path) -> None:
    """In Python the workpiece says how many parts there are, and part_number takes another."""

    class Ring:
        geom_type = "LinearRing"

        def __init__(self, x: float, size: float) -> None:
            self.coords = [(x, 0), (x + size, 0), (x + size, size), (x, size), (x, 0)]

    class Polygon:
        geom_type, interiors, __geo_interface__ = "Polygon", (), {}

        def __init__(self, x: float, size: float) -> None:
            self.exterior = Ring(x, size)

    class Several:
        geom_type, __geo_interface__ = "MultiPolygon", {}
        geoms = (Polygon(0, 60), Polygon(80, 20), Polygon(120, 10))

    part = load(Several())
    assert "3 separate parts" in part.remarks[0] and "part_number" in part.remarks[0]
    assert load(Several(), part_number=2).bounds == pytest.approx((80, 0, 100, 20))
