"""Pictures, sheet, DXF and pin list of a part that two clamps hold: five pegs, a body and a stroke for each clamp."""

from __future__ import annotations

import re
from datetime import date
from functools import cache
from math import hypot

import pytest
from sheet_reading import collisions
from svg_reading import by_class, texts

from workhold import Load, Plate, Restrictions, Result, Workpiece, design, load
from workhold.cli.tables import count_fixtures_in_words, tabulate_fixture_setup, tabulate_result
from workhold.drawing import SheetDetails, draw_fixture, draw_sheet, draw_thumbnails
from workhold.files.dxf.writer import make_setup_dxf
from workhold.files.result.fixture_text import write_pin_list
from workhold.listing.identity import make_entries
from workhold.model.clamps import describe_tightening_order
from workhold.model.setup import list_length_settings
from workhold.model.shown import find_shown
from workhold.statics.loads import compute_load_cases
from workhold.units import MILLIMETRE

RECTANGLE = Workpiece.from_loops("rectangle", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])
PAIRS = {
    "across": (("-x", "-y"),),
    "upward": (("-x", "+y"),),
    "doubled": (("-y", "-y"),),
}


@cache
def held(pair: str = "across", bolted: bool = True) -> Result:
    """The rectangle as it lies in its drawing, or in any way where two clamps push the same way."""
    plate = Plate(
        pitch=20,
        peg_radius=3,
        clamp_radius=5,
        travel=(10, 40) if bolted else None,
        clamps=2,
        directions=PAIRS[pair],
    )
    angles = () if pair == "doubled" else ((-0.001, 0.001),)
    return design(RECTANGLE, plate, restrictions=Restrictions(angles=angles), best=20)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("bolted", [True, False])
@pytest.mark.parametrize("pair", list(PAIRS))
def test_each_clamp_has_its_own_length(pair: str, bolted: bool) -> None:
    """Two settings, each from its clamp's hole to its tip; both are drawn with their words, and none hides another."""
    result = held(pair, bolted)
    fixture, plate = result[0], result.toolkit
    settings, seen = list_length_settings(fixture, plate), find_shown(fixture, plate, RECTANGLE)
    assert [setting.tip for setting in settings] == list(fixture.pegs[3:])
    assert [one.setting for one in seen.measured] == list(settings) and len(seen.clamps) == 2
    for setting, clamp in zip(settings, seen.clamps, strict=True):
        if clamp.hole is not None:
            ahead = hypot(clamp.tip.x - clamp.hole[0], clamp.tip.y - clamp.hole[1])
            assert setting.length == pytest.approx(ahead) and 10 - 1e-9 <= ahead <= 40 + 1e-9
    svg = draw_fixture(fixture, RECTANGLE, plate)
    assert len(by_class(svg, "peg")) == 5
    assert len(by_class(svg, "clamp-body")) == (2 if bolted else 0)
    words = texts(svg)
    for setting in settings:
        assert f"{setting.sign} = {MILLIMETRE.format_length(setting.length)}".replace("-", "−") in words
    assert {peg.hole for peg in fixture.pegs} <= set(words)
    assert describe_tightening_order(fixture)[:20] in " ".join(words)
    assert len(by_class(draw_thumbnails([fixture], RECTANGLE, plate, ["one"]), "peg")) == 5


def sheet_words(result: Result, **details: object) -> str:
    """Everything on the sheet of the first fixture."""
    told = SheetDetails(1, len(result), date(2026, 1, 2), "0" * 64, "0.1.0", **details)  # type: ignore[arg-type]
    pages = draw_sheet(result[0], result.workpiece, result.toolkit, told)
    assert not [pair for page in pages for pair in collisions(page)]
    return " ".join(" ".join(texts(page)) for page in pages)


@pytest.mark.thorough
@pytest.mark.parametrize("pair", list(PAIRS))
def test_the_sheet_tells_both_clamps_and_their_order(pair: str) -> None:
    """Where each is bolted, how to tighten them, and forces that make up the one given."""
    result = held(pair)
    words = sheet_words(result, jaw_force=1000.0)
    for tip in result[0].pegs[3:]:
        assert f"Clamp bolted in {tip.hole.removeprefix('clamp ')}" in words
    assert "Order of tightening" in words
    first, second = (float(number) for number in re.findall(r"clamp force (\d+) N", words))
    assert first + second == pytest.approx(1000.0, abs=1.0)


def test_a_sheet_with_much_to_say_still_has_a_plan() -> None:
    """With loads and warnings the words that must stand beside the plan leave it room, or go to the second page."""
    result = held()
    loads = [Load(points=((50.0, 30.0),), force=200.0, name=f"cut {k}") for k in range(6)]
    cases = compute_load_cases(result[0], RECTANGLE, result.toolkit, loads, 5000.0)
    words = sheet_words(result, jaw_force=5000.0, loads=cases, others=3, part_name="a long name " * 12)
    assert "Order of tightening" in words and "The clamp force is the sum of both clamps" in words


def test_files_have_both_clamps() -> None:
    """The DXF names both strokes and both clamps; the pin list has the locators alone."""
    result = held()
    fixture, plate = result[0], result.toolkit
    drawing = make_setup_dxf(fixture, RECTANGLE, plate).decode()
    for setting in list_length_settings(fixture, plate):
        assert f"{setting.sign} = {setting.length:.6g} mm" in drawing
    assert all(peg.hole in drawing for peg in fixture.pegs)
    assert write_pin_list(fixture, plate, MILLIMETRE, None, None).count("\n") == 4


def test_the_terminal_tells_pairs_seats_and_order() -> None:
    """Five pegs in two columns, the number of pairs at the seat, both strokes; and the ending sentence."""
    result = held()
    fixture = result[0]
    table = tabulate_result(result, make_entries(result), 5)
    headings = [column.lstrip(">") for column in table.columns]
    row = dict(zip(headings, table.rows[0], strict=True))
    assert row["locators"].split() == [peg.hole for peg in fixture.pegs[:3]]
    assert [f"clamp {place}" for place in row["clamps"].split()] == [peg.hole for peg in fixture.pegs[3:]]
    assert fixture.pair is not None and row["best of"] == str(fixture.pair.count)
    assert row["stroke mm"].split() == [
        f"{setting.length:.1f}" for setting in list_length_settings(fixture, result.toolkit)
    ]
    assert max(map(len, table.fit_to_width(80).lines[:2])) <= 80 and "clamp freedom deg" in headings
    assert f"the best of {result.pairs} pairs of clamps at each seat" in count_fixtures_in_words(result)
    said = [part for part in tabulate_fixture_setup(fixture, result.toolkit, 1, 1) if isinstance(part, str)]
    assert describe_tightening_order(fixture) in said and sum("bolted in" in line for line in said) == 2


EXAMPLES = {
    "rectangle": ({0, 2}, {1, 3}, ()),
    "nema34": (None, None, (8, 9, 10, 11, 12)),
    "bracket": ({0}, {7}, ()),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", list(EXAMPLES))
def test_a_machinist_would_set_it_so(name: str) -> None:
    """Of each example the long side lies on two dowels, a side square to it on one, the clamps push against both, and no
    torque wrench is needed (3-2-1)."""
    long, short, avoid = EXAMPLES[name]
    part = load(f"examples/{name}.dxf")
    plate = Plate(pitch=20, peg_radius=3, clamp_radius=5, travel=(10, 40), clamps=2)
    fixture = design(part, plate, restrictions=Restrictions(avoid=avoid), best=1)[0]
    faces = [peg.face for peg in fixture.pegs[:3]]
    (two,) = {face for face in faces if faces.count(face) == 2}
    (one,) = set(faces) - {two}
    assert (long is None or two in long) and (short is None or one in short)
    assert (
        fixture.quality["tilt"] == 0
        and fixture.quality["warnings"] == 0
        and fixture.quality["clamp_freedom"] > 70
    )
    # Nothing leans: where the clamps push, the locators that face them press.
    ways = [peg.carrier for peg in fixture.pegs[3:]]
    assert ways == ["clamp -x", "clamp -y"] and len(set(faces) & {peg.face for peg in fixture.pegs[3:]}) == 0


@pytest.mark.thorough
def test_no_label_hides_a_dimension() -> None:
    """No framed name and no number of a face covers a length to set: neither its line nor its arrows."""
    strip = Workpiece.from_loops("strip", [[[0, 0, 0], [200, 0, 0], [200, 12, 0], [0, 12, 0]]])
    plate = Plate(
        pitch=20, peg_radius=3, clamp_radius=5, travel=(10, 40), clamps=2, directions=PAIRS["across"]
    )
    for fixture in design(strip, plate, best=12)[:12]:
        svg = draw_fixture(fixture, strip, plate)
        lines = [
            [float(word) for word in re.findall(r"-?[\d.]+", piece.attrib["d"])]
            for (group,) in [by_class(svg, "opening")]
            for piece in group
            if "d" in piece.attrib
        ]
        frames = [
            [float(piece.attrib[name]) for name in ("x", "y", "width", "height")]
            for (group,) in [by_class(svg, "labels")]
            for piece in group
            if "width" in piece.attrib
        ]
        assert lines and frames
        for line in lines:
            xs, ys = line[::2], line[1::2]
            for x, y, width, height in frames:
                clear_x = max(xs) < x or x + width < min(xs)
                assert clear_x or max(ys) < y or y + height < min(ys)
