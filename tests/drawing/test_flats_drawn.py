"""Pegs with a flat as they are drawn and told: each flat lies on its face, and the sheet says which way it looks."""

from __future__ import annotations

import re
from datetime import date
from functools import cache
from io import StringIO
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from sheet_reading import collisions
from svg_reading import by_class, texts
from typer.testing import CliRunner

from workhold import Plate, Result, Vise, Workpiece, design, save
from workhold.cli.main import app
from workhold.drawing import SheetDetails, draw_fixture, draw_sheet
from workhold.files.dxf.writer import make_setup_dxf
from workhold.files.result.fixture_text import write_pin_list
from workhold.fixels.pegs import PegFlat, make_peg_outline
from workhold.geometry.segment import Line
from workhold.units import MILLIMETRE

NOTCHED = Workpiece.from_loops(
    "notched", [[[0, 0, 0], [58, 0, 0], [58, 26, 0], [44, 40, 0], [20, 40, 0.3], [0, 40, 0]]]
)
VISE = Vise((9, 8), 2, 2.5, flat=1.5)


@cache
def held(toolkit: Vise | Plate) -> Result:
    """The part in it, with pegs on an arc too."""
    return design(NOTCHED, toolkit, best=200)


@cache
def mixed() -> int:
    """A fixture that touches the arc."""
    return next(k for k, one in enumerate(held(VISE)) if None in [peg.flat_deg for peg in one.pegs])


def test_an_outline_is_a_circle_cut_off() -> None:
    """A chord so far from the centre, looking that way, and the rest of the circle."""
    arc, chord = make_peg_outline((10.0, 5.0), 3.0, PegFlat(1.5), 90.0)
    assert isinstance(chord, Line) and chord.start[1] == pytest.approx(6.5) == chord.end[1]
    assert chord.end[0] == pytest.approx(10 - np.sqrt(9 - 2.25)) and chord.start[0] > 12
    assert np.allclose(arc.compute_point(arc.half_extent), chord.start) and np.allclose(
        arc.compute_point(-arc.half_extent), chord.end
    )
    assert np.allclose(arc.compute_point(0.0), (10, 2))
    assert (
        len(make_peg_outline((0.0, 0.0), 3.0, PegFlat(1.5), None))
        == len(make_peg_outline((0.0, 0.0), 3.0, PegFlat(3.0), 0.0))
        == 1
    )


def test_pictures_and_sheet_show_them(tmp_path: Path) -> None:
    """Flats as paths, what is round as circles; the table has a column for them, and nothing covers anything."""
    result, number = held(VISE), mixed()
    fixture = result[number]
    flats = sum(peg.flat_deg is not None for peg in fixture.pegs)
    details = SheetDetails(number + 1, len(result), date(2026, 11, 22), "0" * 64, "0.1.0")
    pages = draw_sheet(fixture, NOTCHED, VISE, details)
    for page in (draw_fixture(fixture, NOTCHED, VISE), pages[0]):
        tags = [element.tag.rpartition("}")[2] for element in by_class(page, "peg")]
        assert (tags.count("path"), tags.count("circle")) == (flats, 4 - flats)
    words = [word for page in pages for word in texts(page)]
    assert all(f"{peg.flat_deg:.2f}°" in words for peg in fixture.pegs if peg.flat_deg is not None)
    assert "–" in words and any("flat: which way it looks" in word for word in words)
    assert all(collisions(page) == [] for page in pages)
    save(result, tmp_path / "r.json")
    shown = CliRunner().invoke(app, ["show", str(tmp_path / "r.json"), str(number + 1)]).stdout
    assert re.search(r"^hole +jaw +x mm +y mm +face +flat at", shown, re.MULTILINE)


def test_files_have_them() -> None:
    """In the set-up as DXF each flat is a straight piece on its face, and the list of pins has its angle."""
    result, number = held(VISE), mixed()
    fixture = result[number]
    space = ezdxf.read(StringIO(make_setup_dxf(fixture, NOTCHED, VISE).decode())).modelspace()
    drawn = [entity for entity in space if entity.dxf.layer.startswith("PEGS")]
    flat = [peg for peg in fixture.pegs if peg.flat_deg is not None]
    polylines = [entity for entity in drawn if entity.dxftype() == "LWPOLYLINE"]
    assert len(polylines) == len(flat) and len(drawn) == 4
    faces = {face.number: face.segment for face in NOTCHED.faces}
    for peg, polyline in zip(flat, polylines, strict=True):
        normal = np.array(fixture.pose.turn(*faces[peg.face].compute_normal()))
        start = np.array(fixture.pose.apply(*faces[peg.face].start))
        ends = [np.array(point[:2]) for point in polyline.get_points("xyb")]
        assert all(abs((end - start) @ normal) < 1e-6 for end in ends)
    rows = [line.split(",") for line in write_pin_list(fixture, VISE, MILLIMETRE, None, None).splitlines()]
    assert rows[0][-1] == "flat_deg"
    assert [row[-1] for row in rows[1:]] == [
        "" if peg.flat_deg is None else f"{peg.flat_deg:.4f}" for peg in fixture.pegs
    ]


def test_a_clamp_has_none() -> None:
    """Locators with flats, the clamp's tip round."""
    plate = Plate((16, 14), 3, flat=2, columns=4, rows=4, travel=(4, 40))
    fixture = held(plate)[0]
    assert fixture.pegs[3].flat_deg is None and any(peg.flat_deg is not None for peg in fixture.pegs[:3])
    rows = [line.split(",") for line in write_pin_list(fixture, plate, MILLIMETRE, None, None).splitlines()]
    assert len(rows) == 4 and rows[0][-1] == "flat_deg"
