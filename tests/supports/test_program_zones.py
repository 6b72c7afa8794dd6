"""A program's keep-outs for pads and for the clamp on top are those that a walk along it finds, 0.02 mm fine."""

from __future__ import annotations

from itertools import product
from math import cos, inf, pi, sin
from random import Random

import numpy as np
import pytest
from attrs import evolve
from numpy.typing import NDArray

from shown_words import last_paragraph
from slow_program import OFF, THICKNESS, TOOLS, Row, path, program_of, random_program, walked
from workhold import Program, Query, Vise, Workpiece, answer, circle_zone
from workhold.geometry.loop import make_loop_segments
from workhold.model.requirements import make_zone
from workhold.model.support_request import SupportRequest
from workhold.supports.choosing import WorkLimit
from workhold.supports.clamp_point import ClampPlaces, find_point_on_curve
from workhold.supports.faces import FaceBorders, TouchableFace, offset_curves
from workhold.supports.forces import Triangles
from workhold.supports.listing import find_supports, yield_supports
from workhold.supports.program import FINEST, MOST_ABOVE, add_program_zones, make_capsule

Array = NDArray[np.float64]
PART = Workpiece.from_points("plate", [(0, 0), (60, 0), (60, 40), (0, 40)])
TIP, PAD = 5.0, 4.0
# Heights of the clamp over the part, and radii in tips, as it is drawn.
CLAMP = ((0.0, 3.0, 1.0), (3.0, 21.0, 1.0), (21.0, 27.0, 1.5))


def grid(step: float = 1.37) -> Array:
    """Points (N, 2) all over the part."""
    x0, y0, x1, y1 = PART.bounds
    return np.array(list(product(np.arange(x0, x1, step), np.arange(y0, y1, step))))


def walk_room(program: Program, points: Array, slabs: list[tuple[float, float, float]]) -> Array:
    """The least distance (N,) of tools from upright cylinders about points, given as low, high and radius."""
    places, numbers = walked(program)
    least = np.full(len(points), inf)
    for tool in np.unique(program.moves.tool).tolist():
        mine = places[program.moves.tool[numbers] == tool]
        for cylinder, (low, high, radius) in product(TOOLS[tool].cylinders, slabs):
            there = mine[(mine[:, 2] + cylinder.low <= high) & (mine[:, 2] + cylinder.high >= low), :2]
            if not len(there):
                continue
            for k in range(len(points)):
                away = np.hypot(there[:, 0] - points[k, 0], there[:, 1] - points[k, 1]).min()
                least[k] = min(least[k], away - cylinder.radius - radius)
    return least


def rooms(program: Program, points: Array) -> tuple[Array, Array]:
    """By how much pads and tips at points keep the rules of the faces with the program's zones."""
    asked = SupportRequest(THICKNESS, PAD, TIP)
    request = add_program_zones(asked, PART, program)
    bottom, top = (
        TouchableFace.from_loops(PART.loops, [zone.loop for zone in zones])
        for zones in (request.bottom_zones, request.top_zones)
    )
    return bottom.measure_room(points) - PAD, top.measure_room(points) - TIP


@pytest.mark.thorough
@pytest.mark.sampled(2)
@pytest.mark.parametrize("number", range(12))
def test_zones_leave_what_a_walk_leaves(number: int) -> None:
    """Every place that is left keeps the clearance; every place that keeps a little more is left."""
    program = random_program(Random(4700 + number), PART, clearance=(0.0, 1.0, 2.5)[number % 3])
    points = grid()
    face = TouchableFace.from_loops(PART.loops).measure_room(points)
    below, above = rooms(program, points)
    clamp = [(THICKNESS + low, THICKNESS + high, share * TIP) for low, high, share in CLAMP]
    for found, slabs, disc in ((below, [(-inf, 0.0, PAD)], PAD), (above, clamp, TIP)):
        walk = walk_room(program, points, slabs) - program.clearance
        assert (walk[found >= 0.0] > -OFF).all()
        sure = (face - disc >= 0.0) & (walk > 2 * FINEST[0] + OFF)
        assert (found[sure] >= -1e-9).all()


def test_a_drill_through_keeps_pads_away_and_a_blind_one_does_not() -> None:
    """A pad keeps clearance, the drill's radius and its own from a hole that comes out below."""
    x, y = PART.center
    for bottom, wide in ((-2.0, 2.0 + 1.0 + PAD), (3.0, 0.0)):
        program = program_of(path(3, [(x, y, THICKNESS + 1.0), (x, y, bottom)]))
        off = np.arange(0.05, 12.0, 0.1)
        turns = [np.array([cos(turn), sin(turn)]) for turn in np.arange(0, 2 * pi, 0.7)]
        for way in turns:
            below, _ = rooms(program, np.array([x, y]) + off[:, None] * way)
            assert np.abs(off[below >= 0.0].min() - max(wide + 2 * FINEST[0], 0.05)) <= 0.1


def test_a_program_high_above_all_leaves_everything() -> None:
    """Moves above the clamp and above the part make no zone."""
    program = program_of([(1, False, (0.0, 0.0, 60.0), (50.0, 30.0, 60.0), 0.0)])
    asked = SupportRequest(THICKNESS, PAD, TIP)
    assert add_program_zones(asked, PART, program) == asked
    assert add_program_zones(asked, PART, None) is asked


def test_own_zones_stay_and_nothing_is_added_twice() -> None:
    """What the user keeps out stays kept out; a request that has the zones already stays as it is."""
    own = SupportRequest(THICKNESS, PAD, TIP, bottom_zones=[circle_zone(5, 5, 2)])
    program = random_program(Random(3), PART)
    first = add_program_zones(own, PART, program)
    assert first.bottom_zones[0] == own.bottom_zones[0]
    assert add_program_zones(first, PART, program) == first


@pytest.mark.parametrize("bulge", [0.0, 0.03, 0.4, -0.4, 0.98, -0.98, 1.0])
@pytest.mark.parametrize("radius", [0.5, 3.0, 9.0, 40.0])
def test_capsules_hold_what_is_nearer_than_their_radius(bulge: float, radius: float) -> None:
    """Signed distances from the border are distances from the path, less the radius, also inside bends."""
    start, end = (3.0, 1.0), (11.0, 6.0)
    loop = tuple(
        make_loop_segments(np.array(make_zone(make_capsule(((*start, bulge), (*end, 0.0)), radius)).loop))
    )
    span = program_of([(1, True, (*start, 0.0), (*end, 0.0), bulge)])
    line = walked(span)[0][:, :2]
    points = np.random.default_rng(4).uniform(-15, 25, (400, 2))
    away = np.hypot(*np.moveaxis(points[:, None] - line, -1, 0)).min(axis=1)
    inside = FaceBorders((loop,)).contains(points)[:, 0]
    sure = np.abs(away - radius) > OFF
    assert (inside == (away < radius))[sure].all()


def many_passes() -> list[Row]:
    """A contour of hundreds of short moves about the part's middle, above its top."""
    turns = np.linspace(0.0, 2 * pi, 600)
    x, y = PART.center
    return path(1, [(x + 14 * cos(t) + 2 * cos(9 * t), y + 9 * sin(t), THICKNESS + 1.0) for t in turns])


def test_many_pieces_become_few_zones_that_leave_nothing_in_the_way() -> None:
    """Zones stay few whatever the program has; places that are left keep the clearance."""
    program = program_of(many_passes())
    request = add_program_zones(SupportRequest(THICKNESS, PAD, TIP), PART, program)
    assert len(request.top_zones) <= MOST_ABOVE
    points = grid(2.3)
    _, above = rooms(program, points)
    walk = walk_room(program, points, [(THICKNESS, THICKNESS + 21.0, TIP)]) - program.clearance
    assert (walk[above >= 0.0] > -OFF).all()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("number", range(6))
def test_the_clamps_place_is_the_best_of_a_fine_grid(number: int) -> None:
    """Free pieces of borders hold the best place: no place of a grid 0.4 mm fine that is left is any better."""
    program = program_of(many_passes()) if number % 2 else random_program(Random(91 + number), PART)
    request = add_program_zones(SupportRequest(THICKNESS, PAD, TIP), PART, program)
    face = TouchableFace.from_loops(PART.loops, [zone.loop for zone in request.top_zones])
    places = ClampPlaces(face, TIP, None)
    random = np.random.default_rng(number)
    corners = random.uniform((0, 0), (60, 40), (40, 3, 2))
    sides = corners[:, 1:] - corners[:, :1]
    area = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    corners = np.where(area[:, None, None] < 0, corners[:, ::-1], corners)[np.abs(area) > 100]
    triangles = Triangles.from_corners(corners)
    reach = random.uniform(-1.0, 3.0, (len(corners), 3))
    reach[:, 0] = np.abs(reach[:, 0]) + 0.1
    points, value = places.find_best(triangles, reach, 1.0)
    around = grid(0.4)
    around = around[(face.measure_room(around) >= TIP)]
    shares = triangles.compute_shares(np.broadcast_to(around, (len(corners), *around.shape)))
    well = (shares / triangles.steepness[:, None]).min(axis=2) >= 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        on_grid = np.where(well, (np.maximum(reach, 0.0)[:, None] / shares).max(axis=2), np.inf)
    found = np.isfinite(value)
    assert found.any() or not well.any()
    assert (value <= on_grid.min(axis=1, initial=np.inf) * (1 + 1e-9)).all()
    at = triangles.take(np.flatnonzero(found))
    assert (face.measure_room(points[found]) >= TIP - 1e-8).all()
    assert (at.measure_side_distances(points[found]).min(axis=1) >= 1.0 - 1e-8).all()


@pytest.mark.thorough
def test_a_limit_of_the_work_stops_at_the_same_fixture_every_time() -> None:
    """So many places and no more; what is listed before is what it is without a limit."""
    program = program_of(many_passes())
    query = Query(PART, Vise(8, 4, 3), program=program, peg_height=4.0, best=6)
    fixtures = list(answer(query))
    request = SupportRequest(THICKNESS, PAD, TIP)
    counted = WorkLimit(10**12)
    whole = list(yield_supports(fixtures, query, request, cancel=counted))
    assert len(whole) == len(fixtures) and not any(one.stopped for one in whole) and counted.done > 0
    for share in (2, 3):
        first, second = (
            list(yield_supports(fixtures, query, request, cancel=WorkLimit(counted.done // share)))
            for _ in range(2)
        )
        assert [one.triples for one in first] == [one.triples for one in second]
        assert len(first) < len(whole) and first[-1].stopped and not any(one.stopped for one in first[:-1])
        assert [one.triples for one in first[:-1]] == [one.triples for one in whole[: len(first) - 1]]


def test_a_top_that_is_machined_all_over_is_said_to_be() -> None:
    """Where tools leave no place for a tip the reason is the program, not the triangles of the holes."""
    passes = [
        (x, y, THICKNESS - 1.0) for k, y in enumerate(range(2, 40, 3)) for x in ((0, 60), (60, 0))[k % 2]
    ]
    query = Query(PART, Vise(8, 4, 3), program=program_of(path(1, passes)), peg_height=4.0, best=1)
    (fixture, *_) = list(answer(query))
    found = find_supports(fixture, query, SupportRequest(THICKNESS, PAD, TIP))
    assert not found.triples
    sentence = last_paragraph(found)
    assert "the tools of the program and the keep-outs leave no place on the upper face" in sentence


@pytest.mark.parametrize("number", [1, 2, 5])
def test_boxes_of_rapid_moves_count_inside(number: int) -> None:
    """With rapid moves anywhere in the box of their ends nothing is left inside it, at any height of theirs."""
    (x, y), off = PART.center, 3.0 + number
    rows: list[Row] = [
        (1, False, (x - off, y - off, THICKNESS + 5.0), (x + off, y + off, THICKNESS + 5.0), 0.0)
    ]
    program = program_of(rows, rapid="box")
    points = grid(0.9)
    _, above = rooms(program, points)
    dx, dy = (np.maximum(np.abs(points[:, k] - (x, y)[k]) - off, 0.0) for k in (0, 1))
    # The shank of 5 mm passes the knob.
    slack = np.hypot(dx, dy) - 5.0 - 1.0 - 1.5 * TIP
    face = TouchableFace.from_loops(PART.loops).measure_room(points) - TIP
    assert (slack[above >= 0.0] > -0.02).all()
    assert (above[(slack > 0.03) & (face >= 0.0)] >= -1e-9).all()


@pytest.mark.thorough
def test_supports_of_a_fixture_with_a_program_keep_off_what_it_sweeps() -> None:
    """Pads and tip of every set listed are clear of a walk; without the program there are more sets."""
    holes = ((12.0, 12.0), (48.0, 28.0))
    rows = [row for x, y in holes for row in path(3, [(x, y, 13.0), (x, y, -0.5)])]
    program = program_of(rows)
    query = Query(PART, Vise(8, 4, 3), program=program, peg_height=4.0, best=3)
    (fixture, *_) = list(answer(query))
    request = SupportRequest(THICKNESS, PAD, TIP)
    found = find_supports(fixture, query, request)
    free = find_supports(fixture, evolve(query, program=None, peg_height=None, rank_by=None), request)
    assert 0 < len(found.triples) < len(free.triples)
    pads = np.array([[pad.x, pad.y] for one in found.triples for pad in one.supports])
    tips = np.array([one.best.at for one in found.triples])
    clamp = [(THICKNESS + low, THICKNESS + high, share * TIP) for low, high, share in CLAMP]
    assert (walk_room(program, pads, [(-inf, 0.0, PAD)]) >= 1.0 - OFF).all()
    assert (walk_room(program, tips, clamp) >= 1.0 - OFF).all()
    assert found.request.bottom_zones and found.request.top_zones


def crowded() -> tuple[TouchableFace, ClampPlaces]:
    """A face with forty round zones on it, and where a tip may stand."""
    random = np.random.default_rng(11)
    middles = random.uniform((-3, -3), (63, 43), (40, 2))
    face = TouchableFace.from_loops(PART.loops, [circle_zone(x, y, 0.6).loop for x, y in middles.tolist()])
    return face, ClampPlaces(face, 3.0, None)


@pytest.mark.thorough
def test_zones_some_at_a_time_are_what_they_are_together() -> None:
    """Only those near a point are looked at; what is near to their box from outside counts."""
    face, places = crowded()
    points = np.random.default_rng(12).uniform((-8, -8), (68, 48), (4000, 2))
    assert len(face.zone_groups) > 2
    _, off = face.measure_rooms(points)
    assert (face.find_off_zones(points, 3.0, 0.0) == (off >= 3.0)).all()
    assert (places.find_allowed(points) == (face.measure_room(points) >= 3.0 - 1e-9)).all()
    assert 100 < places.find_allowed(points).sum() < 3000


@pytest.mark.thorough
def test_free_pieces_hold_all_places_on_borders() -> None:
    """Also where a piece goes on over the angle at which counting begins, and all of a circle without corners."""
    _, places = crowded()
    alone = TouchableFace.from_loops(PART.loops, [circle_zone(30, 20, 1.0).loop])
    for own in (places, ClampPlaces(alone, 3.0, None)):
        assert len(own.bent)
        for curve, (low, high) in zip(own.bent.curves, own.bent.spans, strict=True):
            inner = np.linspace(low, high, 9)[1:-1]
            assert own.find_allowed(np.stack([find_point_on_curve(curve, at, True) for at in inner])).all()
        for curve in np.unique(own.bent.curves, axis=0):
            around = np.linspace(-pi, pi, 721)
            points = np.stack([find_point_on_curve(curve, at, True) for at in around])
            free = points[own.find_allowed(points)]
            mine = np.flatnonzero((own.bent.curves == curve).all(axis=1))
            kept = own.bent.mask_points_off_pieces(np.repeat(free[:, None], len(own.bent), axis=1), True)[
                :, mine, 0
            ]
            assert np.isfinite(kept).any(axis=1).all()


def test_a_disc_rolls_round_corners_alone() -> None:
    """A circle about each corner of a border; none where it goes on smoothly, unless a hollow is too narrow."""
    turns = np.arange(8) * pi / 4
    octagon = tuple(make_loop_segments(np.array([(10 * cos(t), 10 * sin(t), 0.0) for t in turns])))
    assert len(offset_curves(octagon, 2.0, left=False)[1]) == 8
    slot = tuple(
        make_loop_segments(np.array(make_zone(make_capsule(((0.0, 0.0, 0.0), (9.0, 0.0, 0.0)), 2.0)).loop))
    )
    lines, circles = offset_curves(slot, 3.0, left=False)
    assert (len(lines), len(circles)) == (2, 2) and all(radius == 5.0 for *_, radius in circles)
    # From within the ends are too narrow for the disc, and it may touch their joints.
    assert len(offset_curves(slot, 3.0, left=True)[1]) == 4
