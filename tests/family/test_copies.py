"""Copies on a plate: clear of each other by another library's geometry, and the most by trying everything."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np
import pytest
from sheet_reading import collisions, page_of, words_of
from svg_reading import by_class

from workhold import Fence, Fixture, Plate, Query, Result, Vise, Workpiece, answer
from workhold.errors import InputError
from workhold.family import copies as module
from workhold.family.copies import (
    PackedCopies,
    draw_copies,
    find_too_near_shifts,
    list_places_on_plate,
    make_copies,
    pack_copies,
)

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

LEVER = Workpiece.from_loops(
    "lever",
    [
        [[0, 0, 0], [60, 0, 0.4], [60, 22, 0], [20, 40, 0], [0, 35, -0.2]],
        [[12, 12, 0], [24, 12, 0], [18, 24, 0]],
    ],
)
BAR = Workpiece.from_loops("bar", [[[0, 0, 0], [50, 0, 0], [50, 28, 0], [0, 28, 0]]])
HELD = {
    "strokes": (LEVER, Plate(pitch=20, peg_radius=3, travel=(10, 35))),
    "tips alone": (LEVER, Plate(pitch=20, peg_radius=3, directions=["-x"])),
    "two clamps": (BAR, Plate(pitch=20, peg_radius=3, clamps=2, travel=(10, 35))),
    "fence": (BAR, Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2, travel=(10, 35))),
}


@pytest.fixture(scope="module")
def results() -> dict[str, Result]:
    """The best fixtures of each part."""
    return {name: answer(Query(part, toolkit, best=3), threads=1) for name, (part, toolkit) in HELD.items()}


def shapes(fixture: Fixture, part: Workpiece, toolkit: Plate) -> tuple[Any, Any]:
    """The part and its pegs and clamps as shapely has them."""
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    loops = []
    for loop in part.loop_segments:
        placed = [fixture.pose.carry(segment) for segment in loop]
        loops.append([s.compute_point(s.half_extent * (2 * k / 64 - 1)) for s in placed for k in range(64)])
    bodies = []
    for peg in fixture.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        if carrier.is_wall:
            continue
        start = (peg.x, peg.y)
        if carrier.on is not None and carrier.has_a_hole:
            start = carrier.compute_hole_center(peg.column, peg.row)
        bodies.append(shapely.LineString([start, (peg.x, peg.y)]).buffer(carrier.peg_radius, quad_segs=64))
    return shapely.Polygon(loops[0], loops[1:]), shapely.union_all(bodies)


@pytest.mark.thorough
@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize("gap", [0.5, 7.0])
def test_what_is_too_near_is_so_by_another_library(results: dict[str, Result], name: str, gap: float) -> None:
    from shapely.affinity import translate

    result = results[name]
    toolkit = result.toolkit
    assert isinstance(toolkit, Plate)
    part, bodies = shapes(result[0], result.workpiece, toolkit)
    near = find_too_near_shifts(result[0], result.workpiece, toolkit, gap, (8, 6))
    assert (0, 0) in near
    for i in range(-8, 9):
        for j in range(-6, 7):
            if (i, j) == (0, 0):
                continue
            x, y = i * toolkit.pitch[0], j * toolkit.pitch[1]
            other, others = translate(part, x, y), translate(bodies, x, y)
            room = min(part.distance(other) - gap, part.distance(others) - gap, bodies.distance(other) - gap)
            room = min(room, inf if bodies.disjoint(others) else -1.0)
            # Within a hundredth of the gap, chords of two kinds may differ.
            if abs(room) > 0.01:
                assert ((i, j) in near) == (room < 0), (i, j, room)


def test_pegs_keep_clear_of_pegs_however_far_the_parts_are_apart(
    results: dict[str, Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pegs of 18 mm on holes 17 mm apart overlap; their parts, of 1 mm, would not be near each other."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    outline = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    bodies = module.CopyOutlines(outline, np.array([[[0.5, 0.5], [0.5, 0.5]]]), np.array([9.0]))
    monkeypatch.setattr(module, "collect_bodies", lambda *given: bodies)
    result = results["tips alone"]
    near = find_too_near_shifts(result[0], result.workpiece, Plate(pitch=17, peg_radius=3), 0.5, (3, 3))
    assert near == {(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)}


def most_by_trying(places: list[tuple[int, int]], near: set[tuple[int, int]]) -> int:
    """The most places no two of which are too near, by trying everything."""
    if not places:
        return 0
    (i, j), *rest = places
    free = [(a, b) for a, b in rest if (i - a, j - b) not in near]
    if len(free) == len(rest):
        return 1 + most_by_trying(free, near)
    return max(1 + most_by_trying(free, near), most_by_trying(rest, near))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "size"),
    [("strokes", (12, 7)), ("two clamps", (9, 8)), ("fence", (16, 6)), ("tips alone", (11, 8))],
)
def test_no_more_fit_by_trying_everything(
    results: dict[str, Result], name: str, size: tuple[int, int]
) -> None:
    result = results[name]
    for fixture in result[:2]:
        packing = pack_copies(fixture, result.workpiece, result.toolkit, *size)
        places = list_places_on_plate(fixture, result.toolkit, *size)
        near = find_too_near_shifts(fixture, result.workpiece, result.toolkit, 1.0, (size[0], size[1]))
        assert set(packing.shifts) <= set(places)
        assert all(
            (a - c, b - d) not in near
            for a, b in packing.shifts
            for c, d in packing.shifts
            if (a, b) != (c, d)
        )
        assert len(packing.shifts) == packing.at_most == most_by_trying(places, near)
        assert list(packing.shifts) == sorted(packing.shifts, key=lambda shift: (shift[1], shift[0]))


def test_copies_stand_on_the_plate(results: dict[str, Result]) -> None:
    result = results["two clamps"]
    packing = pack_copies(result[0], result.workpiece, result.toolkit, 12, 9)
    assert len(packing.shifts) > 2
    for fixture in make_copies(result.table.take(slice(0, 1)), result.toolkit, result.workpiece, packing):
        assert all(0 <= peg.column < 12 and 0 <= peg.row < 9 for peg in fixture.pegs)
    # A fence has its rows from the wall.
    fence = results["fence"]
    assert {j for _, j in pack_copies(fence[0], fence.workpiece, fence.toolkit, 20, 9).shifts} == {0}


@pytest.mark.thorough
def test_where_time_is_over_what_is_known_is_told(
    results: dict[str, Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    result = results["strokes"]
    proven = pack_copies(result[0], result.workpiece, result.toolkit, 20, 14)
    hasty = pack_copies(result[0], result.workpiece, result.toolkit, 20, 14, seconds=0.0)
    assert 0 < len(hasty.shifts) <= len(proven.shifts) <= hasty.at_most
    monkeypatch.setattr(module, "MOST_PLACES", 3)
    large = pack_copies(result[0], result.workpiece, result.toolkit, 20, 14)
    assert 0 < len(large.shifts) <= len(proven.shifts) <= large.at_most


def test_refusals(results: dict[str, Result]) -> None:
    result = results["strokes"]
    with pytest.raises(InputError, match="a plate of 2 × 2 holes does not hold this fixture once: it takes"):
        pack_copies(result[0], result.workpiece, result.toolkit, 2, 2)
    vise = answer(Query(LEVER, Vise(pitch=10, columns=1, peg_radius=3), best=1), threads=1)
    with pytest.raises(InputError, match="a vise holds one part"):
        pack_copies(vise[0], LEVER, vise.toolkit, 9, 9)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", HELD)
def test_the_plate_is_drawn_with_every_copy(results: dict[str, Result], name: str) -> None:
    result = results[name]
    packing = PackedCopies(pack_copies(result[0], result.workpiece, result.toolkit, 14, 8).shifts, 9)
    copies = make_copies(result.table.take(slice(0, 1)), result.toolkit, result.workpiece, packing)
    svg = draw_copies(copies, result.workpiece, result.toolkit, (14, 8))
    assert len(by_class(svg, "copy")) == len(packing.shifts)
    (holes,) = by_class(svg, "holes")
    assert len(holes) == 14 * 8
    assert all(page_of(svg).contains(box) for _, box in words_of(svg))
    assert not collisions(svg)
