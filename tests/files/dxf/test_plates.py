"""Drawings of jaw plates read back: every hole once, on its layer, at its place."""

from __future__ import annotations

import io
from pathlib import Path

import ezdxf
import pytest

from workhold.files.dxf.writer import plates_dxf, write_plates_dxf
from workhold.fixels.vise import Vise
from workhold.model.dowels import Bolts, jaw_plates, plate_places

PLATES = jaw_plates(
    Vise(pitch=(10, 12), columns=3, peg_radius=3, rows=4),
    hole_diameter=6.01,
    bolts=Bolts(4.0, ((5.0, 6.0), (15.0, 30.0))),
)


def test_every_hole_is_drawn_at_its_place() -> None:
    """Circles of the diameters given, moved with their plate; the plates do not touch."""
    document = ezdxf.read(io.TextIOWrapper(io.BytesIO(plates_dxf(PLATES)), encoding="utf-8"))
    space = document.modelspace()
    assert document.header["$INSUNITS"] == 4
    for layer, diameter, places in (
        ("DOWEL_HOLES", 6.01, [[center for _, center in plate.holes] for plate in PLATES]),
        ("BOLT_HOLES", 4.0, [list(plate.bolts.places) if plate.bolts else [] for plate in PLATES]),
    ):
        circles = list(space.query(f'CIRCLE[layer=="{layer}"]'))
        assert {circle.dxf.radius for circle in circles} == {diameter / 2}
        found = sorted((round(c.dxf.center.x, 9), round(c.dxf.center.y, 9)) for c in circles)
        moved = [
            (x + right, y) for right, each in zip(plate_places(PLATES), places, strict=True) for x, y in each
        ]
        assert sum(found, ()) == pytest.approx(sum(sorted(moved), ()))
    outlines = list(space.query('LWPOLYLINE[layer=="PLATE"]'))
    assert [outline.closed for outline in outlines] == [True, True]
    extents = [[x for x, *_ in outline.get_points()] for outline in outlines]
    assert max(extents[0]) < min(extents[1])
    names = {text.dxf.text for text in space.query("TEXT")}
    assert {"L-A1", "R-C4"} <= names and "left jaw: 12 dowel holes %%c6.01 mm, 2 bolt holes %%c4 mm" in names


def test_the_same_plates_give_the_same_bytes(tmp_path: Path) -> None:
    """No date and no random number."""
    for name in ("a.dxf", "b.dxf"):
        write_plates_dxf(PLATES, tmp_path / name)
    assert (tmp_path / "a.dxf").read_bytes() == (tmp_path / "b.dxf").read_bytes()
