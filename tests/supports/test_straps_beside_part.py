"""Straps on solids: bars clear what rises beside the face that they press on, and bolts what juts out above."""

from __future__ import annotations

import json
from math import hypot

import numpy as np
import pytest

pytest.importorskip("OCP", reason="the extra 'step' is not installed")

from step_shapes import box, cylinder, fused

import workhold
from solid_truth import distance
from top_examples import pillow_block
from workhold import Load, StrapPlate, load
from workhold.model.pose import Pose
from workhold.supports.faces import LevelRegions
from workhold.supports.strap_places import find_bolt_holes, find_strap_places
from workhold.supports.straps import StrapSearch, make_question
from workhold.supports.straps_beside_part import are_beside_part, are_beside_rising, keep_clear_of_regions
from workhold.verification import verify_file
from workhold.verification.strapped import StrapJudge

RADIUS = 6.0


def rail():
    """A plate 12 high with a rib 40 high along its middle, and a cap on the rib that juts out over the end."""
    body = fused(box(120, 70, 12), box(110, 10, 40, (0, 30, 0)))
    return fused(body, box(50, 20, 8, (90, 25, 32)))


PARTS = {"pillow block": (pillow_block, 13.0), "rail": (rail, 11.0)}
PLATES = {
    "plate": StrapPlate(15, 3, 14, 10, reach=(20, 70)),
    "supports": StrapPlate(15, 3, 14, 10, reach=(20, 70), over="supports", supports={"height": 10}),
}


@pytest.fixture(scope="module")
def solids():
    return {name: (make(), load(make(), name=name, peg_height=high)) for name, (make, high) in PARTS.items()}


def designed(part, over, **asked):
    x0, y0, _, y1 = part.bounds
    push = Load(points=((x0 + 12, (y0 + y1) / 2),), force=200, directions=0)
    return workhold.design(part, PLATES[over], loads=[push], strapped=2, best=2, **asked)


def list_bar_points(fixture, bolts, one):
    """Points of a strap's axis from its tip to its heel, its bolt's place, and its face's height, in the part's frame."""
    x, y = bolts.compute_hole_center(*one.hole)
    far = hypot(x - one.at[0], y - one.at[1])
    shares = np.linspace(0.0, 1.0 + 2 * RADIUS / far, 25)
    at = [(one.at[0] + s * (x - one.at[0]), one.at[1] + s * (y - one.at[1])) for s in shares]
    back = fixture.pose.inverse
    return [back.apply(*point) for point in at], back.apply(float(x), float(y))


@pytest.mark.thorough
@pytest.mark.parametrize("over", PLATES)
@pytest.mark.parametrize("name", PARTS)
def test_bars_and_bolts_meet_nothing_that_the_library_sees(solids, name, over, tmp_path):
    """Cylinders as wide as the bar, from the face under the tip upward, and as thick as the bolt at all heights."""
    shape, part = solids[name]
    result = designed(part, over)
    raised = 10.0 if over == "supports" else 0.0
    seen = 0
    for fixture in result:
        for one in fixture.hold.straps:
            points, bolt = list_bar_points(fixture, result.toolkit.strap_set.bolts, one)
            z = one.height - raised
            assert z < 30
            for x, y in points:
                assert distance(cylinder(RADIUS - 1e-3, 60, (x, y, z + 1e-3)), shape) > 1e-6
            assert distance(cylinder(3 - 1e-3, 90, (*bolt, -1)), shape) > 1e-6
            seen += 1
    assert seen >= 2
    path = tmp_path / "solid.json"
    workhold.save(result, path)
    outcome = verify_file(path)
    assert not outcome.unproven and outcome.holds


@pytest.mark.thorough
def test_fewer_places_are_left_beside_what_rises(solids):
    """Of places for tips on the feet, those are left out whose bars cross the body, and no other."""
    for name in PARTS:
        _, part = solids[name]
        result = workhold.design(part, PLATES["plate"], strapped=1, best=1)
        search = StrapSearch(result[0], result.query, make_question(result.query))
        every = find_strap_places(result[0], part, result.toolkit, search.asked.request, search.asked.straps)
        kept = {
            (*hole, *at)
            for hole, at in zip(search.places.hole.tolist(), search.places.at.tolist(), strict=True)
        }
        assert 0 < len(kept) < len(every)


@pytest.mark.thorough
def test_a_strap_that_crosses_the_body_is_seen(solids, tmp_path):
    """A file whose strap lies across the body, and one whose bolt stands below what juts out."""
    _, part = solids["rail"]
    result = designed(part, "plate")
    workhold.save(result, tmp_path / "rail.json")
    text = (tmp_path / "rail.json").read_text()
    fixture, bolts = result[0], result.toolkit.strap_set.bolts
    wanted = {"runs into what rises": None, "has its bolt in what juts out": None}
    for column in range(14):
        for row in range(10):
            x, y = (float(one) for one in bolts.compute_hole_center(column, row))
            bolt = fixture.pose.inverse.apply(x, y)
            if 123 < bolt[0] < 140 and 25 < bolt[1] < 45:
                wanted["has its bolt in what juts out"] = (column, row, (90.0, 12.0))
            if 10 < bolt[0] < 100 and 74 < bolt[1] < 92:
                wanted["runs into what rises"] = (column, row, (bolt[0], 10.0))
    free, _ = find_bolt_holes(fixture, part, result.toolkit, make_question(result.query).straps)
    assert wanted["has its bolt in what juts out"][:2] not in {tuple(one) for one in free.tolist()}
    for words, place in wanted.items():
        assert place is not None, words
        column, row, at = place
        data = json.loads(text)
        strap = data["fixtures"][0]["straps"][0]
        strap["hole"], strap["at"] = [column, row], list(fixture.pose.apply(*at))
        strap["heel"] = 12.0
        (tmp_path / "faulty.json").write_text(json.dumps(data))
        (broken, *_), query = workhold.open(tmp_path / "faulty.json"), result.query
        said = list(StrapJudge(query).find_strap_faults(broken, broken.hold))
        assert any(words in fault for fault in said), (words, said)


@pytest.mark.thorough
def test_capsules_keep_off_regions():
    """Against distances of many points of their axes."""
    square = np.array([(0, 0, 0), (40, 0, 0), (40, 30, 0), (20, 30, 0.6), (0, 30, 0)], float)
    regions = LevelRegions.from_loops([square], [7.0])
    random = np.random.default_rng(3)
    starts, ends = random.uniform(-60, 90, (2, 400, 2))
    clear = keep_clear_of_regions(regions, 7.0, starts, ends, 6.0)
    shares = np.linspace(0, 1, 2001)[:, None]
    for start, end, is_clear in zip(starts, ends, clear, strict=True):
        least = regions.measure_distances(7.0, start + shares * (end - start)).min()
        assert is_clear == (least >= 6.0) or abs(least - 6.0) < 0.03
    assert 50 < clear.sum() < 350
    assert keep_clear_of_regions(regions, 8.0, starts, ends, 6.0).all()
    for away, is_clear in ((6.03, True), (6.0, False), (5.99, False)):
        beside = np.array([[[-away, -50.0]], [[-away, 80.0]]])
        assert keep_clear_of_regions(regions, 7.0, *beside, 6.0).tolist() == [is_clear]


def test_bolts_keep_off_what_juts_out(solids):
    _, part = solids["rail"]
    at = np.array([(130.0, 35.0), (130.0, 60.0), (60.0, 35.0), (143.5, 35.0), (142.5, 35.0)])
    assert are_beside_part(part, at, 3.0).tolist() == [False, True, False, True, False]
    flat = workhold.Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
    assert are_beside_part(flat, at, 3.0).all()


@pytest.mark.thorough
def test_the_heel_behind_the_bolt_keeps_off_the_rib(solids):
    """The bar ends one width behind its bolt: there it runs into the rib at 30, or ends at 27."""
    _, part = solids["rail"]
    result = workhold.design(part, PLATES["plate"], strapped=1, best=1)
    request, still = make_question(result.query).request, Pose(0.0, 0.0, 0.0)
    tip, bolt = np.array([(60.0, 8.0), (60.0, 8.0)]), np.array([(60.0, 16.0), (60.0, 9.0)])
    clear = are_beside_rising(request, still, tip, bolt, np.array([12.0, 12.0]), RADIUS)
    assert clear.tolist() == [False, True]
