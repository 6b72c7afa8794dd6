"""Pictures of a dowel plate: one plate, three locators, and a clamp as it is bolted and as it pushes."""

from __future__ import annotations

from math import hypot

import pytest
from attrs import evolve
from plate_examples import PITCH, WAYS, on_plate, towards
from sheet_reading import collisions
from svg_reading import by_class, matrix, texts, to_model

from workhold.drawing import draw_fixture, draw_thumbnails
from workhold.model.shown import find_shown
from workhold.units import INCH, MILLIMETRE, Unit

BOLTED = pytest.mark.parametrize("bolted", [True, False], ids=["bolted", "line"])


@pytest.mark.parametrize("way", WAYS)
@BOLTED
def test_what_shows_of_a_clamp_is_where_it_is(way: str, bolted: bool) -> None:
    """One plate; the clamp pushes its way, its tip lies ahead of its hole by the stroke, and its hole or line is used."""
    fixture, workpiece, plate = on_plate(way, bolted)
    seen = find_shown(fixture, plate, workpiece)
    (lattice,), (clamp,), (measured,) = seen.carriers, seen.clamps, seen.measured
    assert clamp.clamping == towards(way)
    tip, (dx, dy) = fixture.pegs[3], clamp.clamping
    assert {(peg.column, peg.row) for peg in fixture.pegs[:3]} <= lattice.used
    assert (tip.row in lattice.used_rows) and (bolted or way[1] == "x" or tip.column in lattice.used_columns)
    if bolted:
        assert clamp.hole is not None and (tip.column, tip.row) in lattice.used
        ahead = (tip.x - clamp.hole[0], tip.y - clamp.hole[1])
        assert ahead == pytest.approx((measured.setting.length * dx, measured.setting.length * dy), abs=1e-9)
        assert 10 <= measured.setting.length <= 30 and measured.setting.sign == "stroke"
    else:
        assert clamp.hole is None and len(lattice.used) == 3
        assert (measured.setting.sign, measured.setting.length) == (way[1], tip.x if way[1] == "x" else tip.y)
    one, other = (low for low, _ in measured.axes)
    along = 1 if measured.is_upright else 0
    assert abs(other[along] - one[along]) == pytest.approx(abs(measured.setting.length))


@pytest.mark.parametrize("way", WAYS)
def test_a_body_is_a_capsule_from_its_hole_to_its_tip(way: str) -> None:
    """Its outline is closed, runs counter-clockwise, and every point of it is one radius from the axis."""
    fixture, workpiece, plate = on_plate(way)
    (clamp,) = find_shown(fixture, plate, workpiece).clamps
    body = clamp.make_outline()
    points = [
        piece.compute_point(share * piece.half_extent) for piece in body for share in (-1.0, -0.3, 0.4, 1.0)
    ]
    (ax, ay), (bx, by), (dx, dy) = clamp.back, (clamp.tip.x, clamp.tip.y), clamp.clamping
    length = hypot(bx - ax, by - ay)
    for x, y in points:
        share = max(0.0, min(length, (x - ax) * dx + (y - ay) * dy))
        assert hypot(x - ax - share * dx, y - ay - share * dy) == pytest.approx(clamp.carrier.peg_radius)
    ends = [(piece.end, after.start) for piece, after in zip(body, body[1:] + body[:1], strict=True)]
    assert all(one == pytest.approx(other) for one, other in ends)
    assert (
        sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1], strict=True)) > 0
    )


@pytest.mark.thinned(8)
@pytest.mark.parametrize("way", WAYS)
@BOLTED
@pytest.mark.parametrize("size", [0.01, 1.0, 40.0], ids=["tiny", "usual", "huge"])
def test_a_picture_shows_tip_body_and_bolt_to_scale(way: str, bolted: bool, size: float) -> None:
    """The pegs stand where the model has them, and the bolt in the hole that the panel names; or there is a line."""
    held = on_plate(way, bolted, size)
    fixture = held[0]
    svg = draw_fixture(*held, title="Fixture 1")
    (group,) = by_class(svg, "pegs")
    for peg, circle in zip(fixture.pegs, by_class(svg, "peg"), strict=True):
        x, y = to_model(group, float(circle.attrib["cx"]), float(circle.attrib["cy"]))
        assert hypot(x - peg.x, y - peg.y) < 1e-3 * size * PITCH
        assert float(circle.attrib["r"]) / matrix(group)[0] == pytest.approx(held[2].peg_radius, rel=1e-3)
    assert (len(by_class(svg, "bolt")) - 1, len(by_class(svg, "clamp-line"))) == (
        (1, 0) if bolted else (-1, 1)
    )
    words = texts(svg)
    if bolted:
        bolt = by_class(svg, "bolt")[0]
        x, y = to_model(group, float(bolt.attrib["cx"]), float(bolt.attrib["cy"]))
        tip = fixture.pegs[3]
        assert (x, y) == pytest.approx(
            (size * PITCH * tip.column, size * PITCH * tip.row), abs=1e-3 * size * PITCH
        )
        assert "Clamp bolted in" in words and fixture.pegs[3].hole.removeprefix("clamp ") in words
    assert fixture.pegs[3].hole in words


@pytest.mark.thinned(8)
@pytest.mark.sampled(2)
@pytest.mark.parametrize("way", WAYS)
@BOLTED
@pytest.mark.parametrize("unit", [MILLIMETRE, INCH], ids=["mm", "inch"])
@pytest.mark.parametrize("endless", [False, True], ids=["plate", "endless"])
def test_no_words_cover_others_and_none_speak_of_jaws(
    way: str, bolted: bool, unit: Unit, endless: bool
) -> None:
    """Words do not collide, the vise's are not used, and no opening S is dimensioned."""
    held = on_plate(way, bolted, endless=endless)
    pages = [
        draw_fixture(*held, title="Fixture 1", unit=unit),
        draw_thumbnails([held[0]] * 5, *held[1:], list("12345"), unit=unit),
    ]
    for svg in pages:
        assert collisions(svg) == []
        words = " ".join(texts(svg)).lower()
        assert not any(
            word in words for word in ("jaw", "vise", "s =", "l-a1", "sliding", "closing", "type ")
        )


@pytest.mark.parametrize("way", WAYS)
def test_the_line_of_a_clamp_is_named_as_used(way: str) -> None:
    """A row, or a column, in which only the clamp's tip moves counts as used, and no other does by it."""
    fixture, workpiece, plate = on_plate(way, bolted=False)
    tip = evolve(fixture.pegs[3], **({"row": 6} if way[1] == "x" else {"column": 6}))
    (lattice,) = find_shown(evolve(fixture, pegs=(*fixture.pegs[:3], tip)), plate, workpiece).carriers
    rows, columns = {peg.row for peg in fixture.pegs[:3]}, {peg.column for peg in fixture.pegs[:3]}
    assert (lattice.used_rows, lattice.used_columns) == (
        (rows | {6}, columns) if way[1] == "x" else (rows, columns | {6})
    )
