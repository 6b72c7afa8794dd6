"""A part turned over: the mirrored part with mirrored rules has the mirrored fixtures."""

from __future__ import annotations

import numpy as np
import pytest

from family_parts import shop_parts
from workhold import InputError, Load, Plate, Query, Restrictions, Vise, Workpiece, answer, circle_zone
from workhold.family.family import MemberRequest, make_family
from workhold.family.members import RANKINGS, make_other_side_query, mirror_zero
from workhold.family.patterns import list_holes
from workhold.model.quality import LOAD_REACTION, LOCATION_ERROR
from workhold.model.setup import PartZero, choose_part_zero
from workhold.model.solid import SolidOutline
from workhold.verification import Judge

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

# Of lines and arcs, with a hole, unlike its mirror image.
LEVER = Workpiece.from_loops(
    "lever",
    [
        [[0, 0, 0], [60, 0, 0.4], [60, 22, 0], [20, 40, 0], [0, 35, -0.2]],
        [[12, 12, 0], [24, 12, 0], [18, 24, 0]],
    ],
)
LOAD = Load([(50, 12)], 200.0, (20.0, 70.0), moment=300.0)


def lever_query(restrictions: Restrictions) -> Query:
    """What is asked for the lever, under a load."""
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    return Query(LEVER, vise, restrictions=restrictions, rank_by=["location_error"], loads=[LOAD])


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    "restrictions",
    [Restrictions(), Restrictions(avoid=(4,)), Restrictions(zones=[circle_zone(70.0, 11.0, 5.0)])],
    ids=["nothing", "face", "zone"],
)
def test_the_other_side_has_the_mirrored_fixtures(restrictions: Restrictions) -> None:
    query = lever_query(restrictions)
    one, other = answer(query, threads=1), answer(make_other_side_query(query), threads=1)
    free = answer(lever_query(Restrictions()), threads=1)
    assert len(one) == len(other) > 0 and (len(one) < len(free)) == bool(restrictions)
    # Half a turn of everything chooses among two forms of one fixture, with a location error each: type I is left out.
    mine, theirs = (
        np.sort(
            np.round(result.table.quality[result.table.arrangement == 1], 6)[
                :, [LOCATION_ERROR, LOAD_REACTION]
            ],
            axis=0,
        )
        for result in (one, other)
    )
    assert len(mine) > 0
    assert mine == pytest.approx(theirs, rel=1e-4)
    assert np.sort(one.table.quality[:, LOAD_REACTION]) == pytest.approx(
        np.sort(other.table.quality[:, LOAD_REACTION]), rel=1e-6
    )


def test_turned_over_twice_it_is_as_before() -> None:
    query = lever_query(
        Restrictions(avoid=(1, 6), zones=[circle_zone(70.0, 11.0, 5.0)], angles=[(-10.0, 30.0)])
    )
    again = make_other_side_query(make_other_side_query(query))
    assert [loop.tolist() for loop in again.workpiece.loops] == [loop.tolist() for loop in LEVER.loops]
    assert again.restrictions.avoid == query.restrictions.avoid and again.restrictions.angles == (
        (-10.0, 30.0),
    )
    assert again.loads == query.loads
    turned = make_other_side_query(query)
    before, after = ({face.number: face.segment for face in part.faces} for part in (LEVER, turned.workpiece))
    for number, image in zip(query.restrictions.avoid, reversed(turned.restrictions.avoid), strict=True):
        x, y = before[number].compute_point(0.0)
        assert any(
            after[k].compute_point(0.0) == pytest.approx((-x, y)) for k in turned.restrictions.avoid
        ), image


def test_the_zero_is_the_same_point_of_the_part() -> None:
    zero = choose_part_zero(LEVER, "hole 1")
    other = mirror_zero(zero)
    assert other == PartZero((-zero.point[0], zero.point[1]), zero.words)
    turned = MemberRequest("lever", lever_query(Restrictions())).turn_over(None)
    assert turned.zero == PartZero((0.0, 0.0), "origin of the drawing")
    assert turned.zero.point == pytest.approx(mirror_zero(choose_part_zero(LEVER)).point)
    assert turned.name == "lever, side 2"
    assert MemberRequest("lever", lever_query(Restrictions()), zero=zero).turn_over(None).zero == other


def test_the_other_side_of_a_solid_is_that_which_is_read() -> None:
    """Its faces to avoid are those of the same faces of the solid; zones and zero are mirrored as those of drawings."""
    toolkit = Plate(pitch=10, peg_radius=3)
    here, there = (
        [(0, 0, 0), (62, 0, 0), (62, 31, 0), (0, 38, 0)],
        [(-62, 0, 0), (0, 0, 0), (0, 38, 0), (-62, 31, 0)],
    )
    bands = [(0.0, 30.0)] * 4
    solid = SolidOutline("z", 30, 30, 0.5, 1, bands, [(7,), (8,), (9, 5), (6,)])
    turned = SolidOutline("-z", 30, 30, 0.5, 1, bands, [(7,), (6,), (5,), (8,)])
    part, other = (
        Workpiece.from_loops("part", [loop], solid=one) for loop, one in ((here, solid), (there, turned))
    )
    asked = Restrictions(avoid=(2, 3), zones=[circle_zone(70.0, 11.0, 5.0)])
    query = Query(part, toolkit, restrictions=asked, rank_by=RANKINGS[1])
    side = MemberRequest("part", query, zero=choose_part_zero(part, "corner")).turn_over(other)
    assert (side.name, side.query.workpiece.name) == ("part, side 2", "part, side 2")
    assert side.query.workpiece.solid == turned and side.query.restrictions.avoid == (1, 2)
    assert side.query.restrictions.zones[0].loop[:, 0].min() == pytest.approx(-75.0)
    assert side.zero is not None and side.zero.point == (0.0, 0.0)
    with pytest.raises(InputError, match="give both sides as parts of their own"):
        make_other_side_query(query)


def test_both_sides_share_pins() -> None:
    parts = [
        MemberRequest(p.name, Query(p, Vise(pitch=10, columns=2, peg_radius=3), rank_by=RANKINGS[1]))
        for p in shop_parts(2)
    ]
    family = make_family([side for one in parts for side in (one, one.turn_over(None))], threads=1)
    assert [one.name for one in family.members] == [
        "ell-1",
        "ell-1, side 2",
        "bracket-2",
        "bracket-2, side 2",
    ]
    judges = {id(one): Judge(one.query) for one in family.members}
    for plan in family.plans:
        held = [one for setup in plan.setups for one in setup.holdings]
        assert len(held) == 4
        assert all(judges[id(one.member)].rule_on(one.fixture).verdict == "proven" for one in held)
    assert len(family.plans[0].setups) == 1


@pytest.mark.thorough
@pytest.mark.parametrize(
    "toolkit", [Plate(pitch=20, peg_radius=3, clamps=2), Vise(pitch=10, columns=2, peg_radius=3)]
)
def test_with_the_same_zero_a_set_up_has_one(toolkit: Plate | Vise) -> None:
    ranking = RANKINGS[toolkit.travel_count]
    # Rectangles of one height: a common corner can lie at one place.
    parts = [
        Workpiece.from_loops(str(w), [[[0, 0, 0], [w, 0, 0], [w, 45.0, 0], [0, 45.0, 0]]])
        for w in (60.0, 63.0, 71.5, 84.0)
    ]
    asked = [MemberRequest(part.name, Query(part, toolkit, rank_by=ranking)) for part in parts]
    free, strict = make_family(asked, threads=1), make_family(asked, same_zero=True, threads=1)
    assert len(strict.members) == 4
    for plan in strict.plans:
        for setup in plan.setups:
            places = [one.fixture.pose.apply(*one.member.zero.point) for one in setup.holdings]
            turns = [one.fixture.pose.theta_deg for one in setup.holdings]
            assert np.ptp(np.array(places), axis=0) == pytest.approx([0.0, 0.0], abs=2e-3)
            assert np.ptp(turns) == pytest.approx(0.0, abs=2e-4)
            assert len({tuple(list_holes(one.row, toolkit)) for one in setup.holdings}) == 1
        best = min(point.loss for point in free.points if point.setups <= plan.point.setups)
        assert best <= plan.point.loss
    assert len(strict.plans[-1].setups) >= len(free.plans[-1].setups)
    if isinstance(toolkit, Plate):
        # Beside the common corner the rest of the part may be any.
        assert strict.points[0].setups < 4


def test_rounding_does_not_part_what_is_at_one_place() -> None:
    from attrs import evolve

    from workhold.family.patterns import encode_zeros

    result = answer(Query(shop_parts(1)[0], Vise(pitch=10, columns=1, peg_radius=3)), threads=1)
    table, zero = result.table, PartZero((3.0, 4.0), "")
    words = encode_zeros(table, result.toolkit, zero)
    for hair in (1e-9, -1e-9):
        near = evolve(table, position=table.position + hair, theta=np.abs(table.theta + hair * 1e-3))
        assert (encode_zeros(near, result.toolkit, zero) == words).mean() > 0.999
    assert (encode_zeros(evolve(table, position=table.position + 0.002), result.toolkit, zero) != words)[
        :, :2
    ].all()
    whole = evolve(table, theta=np.full(len(table), 2 * np.pi - 1e-12))
    none = evolve(table, theta=np.zeros(len(table)))
    assert (encode_zeros(whole, result.toolkit, zero) == encode_zeros(none, result.toolkit, zero)).all()
    # Where the pegs stand is of no account, only where the part lies from them.
    lifted = evolve(table, row=table.row + 3, position=table.position + np.array([0.0, 30.0]))
    assert (encode_zeros(lifted, result.toolkit, zero) == words).all()
