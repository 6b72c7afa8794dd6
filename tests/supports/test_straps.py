"""Straps over locators: forces against a linear program that shares nothing, the best set, places, and the push."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import workhold
from strap_program import force_by_other_program
from workhold import Load, Plate, Workpiece
from workhold.errors import InputError
from workhold.model.straps import StrapHardware
from workhold.model.support_request import SpatialLoad
from workhold.statics.patches import PressedPolygon
from workhold.supports.straps import SetSearch, StrapQuestion, StrapSearch, make_usual_request

THICK, TIP = 25.0, 6.0
BLOCK = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
ELL = Workpiece.from_points("ell", [(0, 0), (80, 0), (80, 30), (34, 30), (34, 70), (0, 70)])
ROUNDED = Workpiece.from_loops(
    "rounded", [[[0, 0, 0], [70, 0, 1], [70, 50, 0], [0, 50, 0]], [[30, 25, -1], [46, 25, -1]]]
)
LOAD = Load(points=(30, 20), force=100)
PLATE = Plate(pitch=20, peg_radius=3, columns=8, rows=6, clamps=2)


def first_of(part, plate=PLATE):
    return workhold.design(part, plate, best=1)[0]


@pytest.fixture(scope="module")
def block():
    return first_of(BLOCK)


def search_of(fixture, loads=(), count=2, reach=(20.0, 50.0), tip=TIP, **asked):
    query = fixture.listing.result.query
    request = make_usual_request(query, THICK, tip, asked.pop("zones", ()))
    return StrapSearch(
        fixture, query, StrapQuestion(StrapHardware(count, tip, reach), request, tuple(loads), **asked)
    )


@pytest.mark.thorough
@pytest.mark.parametrize("part", [BLOCK, ELL, ROUNDED], ids=lambda part: part.name)
def test_the_force_is_that_of_a_program_that_shares_nothing(part):
    fixture = first_of(part)
    search = search_of(fixture)
    loops = [np.array(loop) for loop in search.foot.loops]
    random = np.random.default_rng(len(part.name))
    x0, y0, x1, y1 = part.bounds
    seen = 0
    for _ in range(16):
        point = (float(random.uniform(x0, x1)), float(random.uniform(y0, y1)))
        way, axial = float(random.uniform(0, 360)), float(random.uniform(-80, 40))
        height = float(random.uniform(5, 25))
        load = SpatialLoad(points=[point], force=300, directions=way, axial=axial, heights=height)
        ours = search_of(fixture, [load], safety=1.0)
        chosen = sorted(random.choice(len(search.places), 2, replace=False).tolist())
        (need,) = ours.compute_needs(chosen)
        turn = np.radians(way + fixture.pose.theta_deg)
        forces = [
            (
                [*fixture.pose.apply(*point), height],
                np.array([300 * np.cos(turn), 300 * np.sin(turn), -axial]),
            )
        ]
        theirs = force_by_other_program(fixture, loops, search.places.at[chosen], forces)
        assert (need is None) == (theirs is None)
        if need is not None:
            seen += 1
            assert need == pytest.approx(theirs, rel=0.03, abs=10.0)
    assert seen >= 3


@pytest.mark.thorough
def test_friction_alone_against_a_push_away_from_the_locators(block):
    # 2 N of friction for each N of a strap, at its tip and below; away from the locators along x.
    load = Load(points=(50, 30), force=300, directions=0)
    for count in (1, 2, 3):
        need = block.straps(THICK, count=count, loads=[load], reach=(20, 50)).clamp_needed
        assert need == pytest.approx(2 * 300 / (count * 2 * 0.1), rel=0.01)


def test_a_push_into_a_locator_asks_for_nothing(block):
    pose, peg = block.pose, block.pegs[0]
    at = pose.inverse.apply(peg.x + 10, peg.y)
    into = SpatialLoad(points=[at], force=400, directions=180 - pose.theta_deg, heights=10)
    assert block.straps(THICK, loads=[into]).clamp_needed == pytest.approx(0.0, abs=1e-6)


@pytest.mark.thorough
def test_the_best_set_is_the_best_of_all(block):
    loads = [SpatialLoad(points=[(20, 15), (85, 50)], force=200, directions=(-20, 70), axial=(-60, 90))]
    search = search_of(block, loads, reach=(20.0, 30.0), zones=(workhold.circle_zone(50, 30, 25),))
    clear = search.find_compatible_pairs()
    pairs = [
        pair
        for pair in combinations(range(len(search.places)), 2)
        if clear[pair] and search.find_pressing_flat(np.array([pair]))[0]
    ]
    assert len(pairs) > 30
    some = pairs[:: max(1, len(pairs) // 60)]
    every = [search.compute_needs(pair)[0] for pair in some]
    found = search.find_best()
    assert found.clamp_needed <= min(one for one in every if one is not None) * (1 + 1e-6)
    chosen = [
        next(
            k
            for k in range(len(search.places))
            if tuple(search.places.hole[k]) == one.hole and np.allclose(search.places.at[k], one.at)
        )
        for one in found.straps
    ]
    assert search.compute_needs(chosen)[0] == pytest.approx(found.clamp_needed, rel=1e-9)


def test_three_straps_are_the_best_of_all(block):
    loads = [SpatialLoad(points=[(80, 50)], force=200, directions=30, axial=-90)]
    search = search_of(block, loads, count=3, reach=(20.0, 20.0), zones=(workhold.circle_zone(50, 30, 28),))
    clear = search.find_compatible_pairs()
    sets = [
        one
        for one in combinations(range(len(search.places)), 3)
        if all(clear[pair] for pair in combinations(one, 2)) and search.find_pressing_flat(np.array([one]))[0]
    ]
    assert sets
    step = max(1, len(sets) // 300)
    assert search.find_best().clamp_needed <= min(
        need for one in sets[::step] if (need := search.compute_needs(one)[0]) is not None
    ) * (1 + 1e-6)


def test_no_part_of_the_best_set_is_ruled_out_by_a_bound(block):
    loads = [SpatialLoad(points=[(80, 50), (10, 5)], force=200, directions=30, axial=-90)]
    search = search_of(block, loads, count=3, reach=(20.0, 20.0), zones=(workhold.circle_zone(50, 30, 26),))
    sets = SetSearch(search)
    chosen = sets.find_least(3)
    assert chosen is not None
    sets.least_force *= 1.001
    for size in (1, 2):
        for taken in combinations(chosen, size):
            assert sets.can_improve(taken, 3 - size)
    sets.least_force = 1e-6
    assert not sets.can_improve(chosen[:2], 1)


@pytest.mark.thorough
def test_twice_the_load_asks_for_twice_the_force_and_friction_helps(block):
    load = SpatialLoad(points=[(80, 50)], force=200, directions=40, axial=-40)
    usual = search_of(block, [load]).find_best().clamp_needed
    assert search_of(block, [load], safety=4.0).find_best().clamp_needed == pytest.approx(2 * usual, rel=1e-6)
    smooth = (("plate", 0.2), ("tip", 0.2))
    assert search_of(block, [load], friction=smooth).find_best().clamp_needed < usual
    assert search_of(block, [load], weight=40.0).find_best().clamp_needed < usual


def test_tips_and_bolts_stand_where_they_can(block):
    zone = workhold.circle_zone(50, 30, 10)
    places = search_of(block, zones=(zone,)).places
    on_part = block.pose.inverse.apply(places.at)
    assert (on_part >= TIP - 1e-9).all()
    assert (on_part <= np.array([100, 60]) - TIP + 1e-9).all()
    assert (np.hypot(*(on_part - [50, 30]).T) >= 10 + TIP - 1e-9).all()
    bolts = block.pose.inverse.apply(places.hole * 20.0)
    beside = np.maximum(np.maximum(-bolts, bolts - [100, 60]), 0.0)
    assert (np.hypot(*beside.T) >= 3 - 1e-9).all()
    apart = np.hypot(*(places.at - places.hole * 20.0).T)
    assert set(apart.round(6)) <= {20.0, 35.0, 50.0}
    turns = np.degrees(np.arctan2(*(places.at - places.hole * 20.0).T[::-1])) % 30
    assert (np.minimum(turns, 30 - turns) < 1e-6).all()
    assert {tuple(one) for one in places.hole}.isdisjoint({(peg.column, peg.row) for peg in block.pegs[:3]})


@pytest.mark.thorough
def test_a_push_by_hand_presses_all_locators(block):
    for part in (BLOCK, ELL, ROUNDED):
        fixture = first_of(part)
        push = fixture.straps(THICK, count=1, loads=[LOAD]).push
        assert push is not None
        way = np.array([np.cos(np.radians(push.direction_deg)), np.sin(np.radians(push.direction_deg))])
        points, inward = fixture.contact_points[:3], -fixture.normals[:3]
        matrix = np.vstack([inward.T, points[:, 0] * inward[:, 1] - points[:, 1] * inward[:, 0]])
        shares = np.linalg.solve(matrix, -np.array([*way, push.at[0] * way[1] - push.at[1] * way[0]]))
        assert shares == pytest.approx(push.shares)
        assert (shares > 0).all()


def test_what_straps_cannot_do_is_said(block):
    vise = workhold.design(BLOCK, workhold.Vise(pitch=10, columns=6, peg_radius=3), best=1)
    if len(vise):
        with pytest.raises(InputError, match="three locators"):
            vise[0].straps(THICK, loads=[LOAD])
    with pytest.raises(InputError, match="give one load"):
        block.straps(THICK)
    with pytest.raises(InputError, match="1 to 4"):
        block.straps(THICK, count=5)
    with pytest.raises(InputError, match="reach from"):
        block.straps(THICK, reach=(40, 20))
    with pytest.raises(InputError, match="safety factor"):
        block.straps(THICK, safety=0, loads=[LOAD])
    assert block.straps(THICK, reach=(1, 2), loads=[LOAD]).straps == ()


def test_no_bolt_stands_behind_a_fence():
    fence = workhold.Fence(pitch=20, peg_radius=3, wall_offset=10, clamps=2)
    search = search_of(first_of(BLOCK, fence), [SpatialLoad.from_planar_load(LOAD)])
    assert search.places.hole[:, 1].min() >= 0
    assert 500 <= search.find_best().clamp_needed < 600


def test_integrals_of_a_foot_are_exact():
    found = PressedPolygon((np.array([(0, 0), (4, 0), (4, 2), (0, 2)], float),)).integrals
    assert found == pytest.approx(np.array([[8, 16, 8], [16, 128 / 3, 16], [8, 16, 32 / 3]]))


def test_a_bolt_keeps_its_radius_from_the_part():
    narrow = first_of(Workpiece.from_points("narrow", [(0, 0), (95, 0), (95, 55), (0, 55)]))
    bolts = narrow.pose.inverse.apply(search_of(narrow).places.hole * 20.0)
    beside = np.hypot(*np.maximum(np.maximum(-bolts, bolts - [95, 55]), 0.0).T)
    assert beside.min() >= 3 - 1e-9


def test_the_safety_factor_is_not_on_the_weight(block):
    lifted = SpatialLoad(points=[block.pose.inverse.apply(53, 33)], axial=-10)
    search = search_of(block, [lifted], safety=2.0, weight=15.0)
    assert search.loads[0][0, 2] == pytest.approx(2 * 10 - 15)
