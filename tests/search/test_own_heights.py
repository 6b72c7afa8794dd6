"""Carriers with heights of their own: their contacts lie on their own outlines, and the lists stay complete."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from itertools import product
from math import pi
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

import slow_plate
from own_heights import BASE, FOOT, ROOF, STEM, stepped
from slow_fence import slow_fence
from toolkit_results import NOTCHED, assert_all_proven, part
from workhold import Fence, FlatJaw, InputError, OpeningVise, Plate, Query, Restrictions, Result, Vise, design
from workhold.algebra import find_fixtures_by_algebra
from workhold.fixels.toolkit import Toolkit
from workhold.verification import verify

TIP, LOW_WALL, LEFT, RIGHT = (10.0, 18.0), (0.0, 4.0), (0.0, 6.0), (11.0, 20.0)
PLATE = Plate(pitch=(14, 12), peg_radius=3, clamp_radius=4, columns=4, rows=4, directions=("-x", "+y"))
VISE = Vise(pitch=(12, 11), columns=2, peg_radius=2.5, min_gap=9)
FENCE = Fence(pitch=(14, 12), peg_radius=3, wall_offset=7, clamp_radius=4)
FLAT_JAW = FlatJaw(pitch=(13, 11), peg_radius=2.5)
# Every kind with all heights that it can have.
OWN: dict[str, tuple[Toolkit, dict[str, Any]]] = {
    "vise": (
        attrs.evolve(VISE, left_heights=LEFT, right_heights=RIGHT),
        {"left": (LEFT, FOOT), "right": (RIGHT, STEM)},
    ),
    "right jaw": (attrs.evolve(VISE, right_heights=RIGHT), {"right": (RIGHT, STEM)}),
    "plate": (attrs.evolve(PLATE, clamp_heights=TIP), {"clamp": (TIP, STEM)}),
    "roof": (attrs.evolve(PLATE, clamp_heights=TIP), {"clamp": (TIP, ROOF)}),
    "stroke": (
        Plate(pitch=(20, 17), peg_radius=3, clamp_radius=4, travel=(6.0, 40.0), clamp_heights=TIP),
        {"clamp": (TIP, STEM)},
    ),
    "locators": (
        attrs.evolve(PLATE, locator_heights=LEFT, clamp_heights=TIP),
        {"plate": (LEFT, FOOT), "clamp": (TIP, STEM)},
    ),
    "two clamps": (
        attrs.evolve(PLATE, clamps=2, directions=(("-x", "-y"),), clamp_heights=TIP),
        {"clamp": (TIP, STEM)},
    ),
    "fence": (
        attrs.evolve(FENCE, clamp_heights=TIP, wall_heights=LOW_WALL),
        {"clamp": (TIP, STEM), "wall": (LOW_WALL, FOOT)},
    ),
    "fence with two clamps": (
        Fence(
            pitch=(14, 12),
            peg_radius=3,
            wall_offset=7,
            clamps=2,
            directions=(("-x", "-y"),),
            clamp_heights=TIP,
            wall_heights=LOW_WALL,
        ),
        {"clamp": (TIP, STEM), "wall": (LOW_WALL, FOOT)},
    ),
    "flat jaw": (attrs.evolve(FLAT_JAW, wall_heights=LOW_WALL), {"wall": (LOW_WALL, FOOT)}),
}
HELD = pytest.mark.parametrize("name", OWN)


def held(name: str) -> Result:
    """What holds the stepped part."""
    toolkit, own = OWN[name]
    return design(stepped(own), toolkit)


@pytest.mark.thorough
@pytest.mark.sampled(2)
@HELD
def test_every_fixture_is_proven_against_the_outline_of_each_carrier(name: str, tmp_path: Path) -> None:
    """In the file and read back, too; and there are some."""
    result = held(name)
    assert result.complete and result.proof is not None and result.proof.undecided == ()
    assert len(result) > 10
    assert_all_proven(result, tmp_path)


@pytest.mark.thinned(3)
@HELD
def test_pegs_touch_faces_of_their_own_outline(name: str) -> None:
    """Their numbers are those of it, counted on after the part's."""
    toolkit, own = OWN[name]
    result = held(name)
    first, numbers = len(BASE), dict[str, range]()
    for role in toolkit.heights:
        numbers[role] = range(first, first + len(own[role][1]))
        first += len(own[role][1])
    for fixture in result:
        for peg in fixture.pegs:
            assert peg.face in numbers.get(peg.carrier.partition(" ")[0], range(len(BASE)))


PRISMS: dict[str, tuple[Toolkit, dict[str, Any]]] = {
    "vise": (VISE, {"right_heights": RIGHT}),
    "opening vise": (OpeningVise(pitch=(9, 8), columns=5, peg_radius=2, min_gap=4), {"left_heights": LEFT}),
    "plate": (PLATE, {"clamp_heights": TIP}),
    "two clamps": (attrs.evolve(PLATE, clamps=2, directions=(("-x", "-y"),)), {"clamp_heights": TIP}),
    "fence": (FENCE, {"wall_heights": LOW_WALL, "locator_heights": LEFT}),
    "flat jaw": (FLAT_JAW, {"jaw_heights": RIGHT}),
}


def key_of(fixture: Any, count: int) -> tuple[Any, ...]:
    """A fixture, whichever outline of so many segments its faces are of."""
    places = (round(value, 6) for value in (fixture.pose.theta_deg, fixture.pose.x, fixture.pose.y))
    return tuple((peg.carrier, peg.hole, peg.face % count) for peg in fixture.pegs), *places


@pytest.mark.thorough
@pytest.mark.thinned(6)
@pytest.mark.parametrize("name", PRISMS)
def test_a_prism_gives_the_same_list_whatever_the_heights(name: str) -> None:
    """Of a drawing there is one outline; of a solid that is a prism all are alike.

    Of a vise whose jaws differ, half a turn of everything makes another fixture: each comes twice then.
    """
    toolkit, heights = PRISMS[name]
    other, loop = attrs.evolve(toolkit, **heights), [*NOTCHED]
    list_of_all = design(part(loop), toolkit)
    usual = {key_of(one, len(loop)) for one in list_of_all}
    for workpiece in (
        part(loop),
        stepped({role: (ends, loop) for role, ends in other.heights.items()}, loop),
    ):
        found = [key_of(one, len(loop)) for one in design(workpiece, other)]
        assert len(set(found)) == len(found) > 5
        assert usual <= set(found)
        more = list_of_all.counts.get("I", 0) if toolkit.symmetries else 0
        assert len(found) == len(usual) + more


@pytest.mark.thorough
@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("name", "rows"), [("plate", 3), ("two clamps", 3), ("roof", 3), ("plate", 4), ("roof", 4)]
)
def test_a_slow_search_of_a_plate_finds_the_same(name: str, rows: int) -> None:
    """By functions of the orientation on a grid, locators on one outline and clamps on another."""
    toolkit, own = OWN[name]
    assert isinstance(toolkit, Plate)
    plate = attrs.evolve(toolkit, columns=3, rows=rows)
    workpiece = stepped(own, clamp=[2])
    result = design(workpiece, plate, listing=None if plate.clamps == 1 else "all")
    slow = slow_plate.slow_plate(workpiece, plate, workpiece.find_outline("clamp")[0])
    assert slow_plate.seen(result) == slow
    assert len(slow) > 5


def fence_places(result: Result) -> set[tuple[Any, ...]]:
    """Fixtures of a fence without the numbers of faces, as the slow search tells them."""
    out = set()
    for fixture in result:
        locator, left, _, tip = fixture.pegs
        line = tip.row if fixture.direction.endswith("x") else tip.column - locator.column
        places = (round(v, 3) + 0.0 for v in (locator.x - left.x, tip.x - left.x, tip.y))
        out.add((fixture.direction, locator.row, line, *places))
    return out


@pytest.mark.thorough
def test_a_slow_search_of_a_fence_finds_the_same() -> None:
    """The part lies flush with one outline, the locator touches another and the clamp a third."""
    toolkit, own = OWN["fence"]
    assert isinstance(toolkit, Fence)
    workpiece = stepped(own)
    slow = slow_fence(workpiece, toolkit, *(workpiece.find_outline(role)[0] for role in ("clamp", "wall")))
    assert fence_places(design(workpiece, toolkit)) == {(way, *rest) for way, _, _, *rest in slow}


def test_three_left_pegs_and_a_right_one_are_three_locators_and_a_clamp() -> None:
    """Type II of a vise is what a plate holds with a clamp in -x that is far enough to the right (TOOLKITS.md)."""
    vise = Vise(pitch=(12, 11), columns=2, peg_radius=2.5, min_gap=9, left_heights=LEFT, right_heights=RIGHT)
    plate = Plate(
        pitch=(12, 11),
        peg_radius=2.5,
        directions=("-x",),
        columns=None,
        locator_heights=LEFT,
        clamp_heights=RIGHT,
    )
    held_by_vise = design(stepped({"left": (LEFT, FOOT), "right": (RIGHT, STEM)}), vise, types=("II",))
    held_by_plate = design(stepped({"plate": (LEFT, FOOT), "clamp": (RIGHT, STEM)}), plate)

    def seat(fixture: Any) -> tuple[Any, ...]:
        locators, tip = fixture.pegs[:3], fixture.pegs[3]
        column, row = min(peg.column for peg in locators), min(peg.row for peg in locators)
        holes = sorted((peg.column - column, peg.row - row) for peg in locators)
        x = min(peg.x for peg in locators)
        return (*map(tuple, holes), round(fixture.pose.theta_deg, 5), tip.row - row, round(tip.x - x, 5))

    wanted = {
        seat(one)
        for one in held_by_plate
        if one.pegs[3].x - max(peg.x for peg in one.pegs[:3]) >= 9 - 1e-9
        and max(peg.column for peg in one.pegs[:3]) - min(peg.column for peg in one.pegs[:3]) < 2
    }
    found = [seat(one) for one in held_by_vise]
    assert set(found) == wanted and len(found) == len(wanted) > 10


def lattice_pairs(vise: Vise, part: Any) -> Iterable[tuple[tuple[int, int], Any, Any, int]]:
    """Steps between two pegs of a jaw, carriers of both and a branch, each pair of pegs in one order."""
    faces = [slow_plate.Carrier.of(face, vise.peg_radius) for face in part.faces]
    steps = [
        (i, j)
        for i, j in product(range(vise.columns), range(-8, 9))
        if (i, j) > (0, 0) and np.hypot(i * vise.pitch[0], j * vise.pitch[1]) < 110
    ]
    return product(steps, faces, faces, (0, 1))


@pytest.mark.thorough
def test_two_left_pegs_and_two_right_ones_are_found_by_a_slow_search() -> None:
    """Chords of the left pegs' outline and of the right pegs', whose rows differ by whole pitches.

    The difference of their heights is a function of the orientation, whose zeros are found on a grid. Two pegs of
    one jaw on one face slide along it, and are left to other tests.
    """
    vise = Vise(pitch=(22, 15), columns=1, peg_radius=2.5, min_gap=9, left_heights=LEFT, right_heights=RIGHT)
    workpiece = stepped({"left": (LEFT, FOOT), "right": (RIGHT, STEM)})
    result = design(workpiece, vise, types=("I",))
    left, right = (workpiece.find_outline(role)[0] for role in ("left", "right"))
    plate = Plate(pitch=vise.pitch, peg_radius=2.5, columns=2, rows=2)
    looked, center = slow_plate.Searched(left, plate, right), np.array(workpiece.center)
    looked.center = center
    grid, pitch = looked.grid, np.array(vise.pitch)
    turned = slow_plate.turns(grid)
    found = set()

    def chords(part: Any) -> list[tuple[Any, ...]]:
        out = []
        for step, one, other, branch in lattice_pairs(vise, part):
            if slow_plate.are_degenerate(one, other, float(np.hypot(*(step * pitch)))):
                continue
            shift = turned @ (step * pitch)
            u = slow_plate.on_both(one, other, shift, branch)
            with np.errstate(invalid="ignore"):
                near = looked.near(one, u, 0.5) & looked.near(other, u + shift, 0.5)
            if near.any():
                out.append((step, one, other, branch, near | np.roll(near, 1) | np.roll(near, -1)))
        return out

    ours, theirs = chords(left), chords(right)
    for a, b in product(ours, theirs):
        (s, a1, a2, ba, na), (t, b1, b2, bb, nb) = a, b
        both = na & nb
        if not both.any():
            continue

        def rise(psi: Any, a: Any = a, b: Any = b, k: int = 0) -> Any:
            turn = slow_plate.turns(psi)
            u = slow_plate.on_both(a[1], a[2], turn @ (a[0] * pitch), a[3])
            w = slow_plate.on_both(b[1], b[2], turn @ (b[0] * pitch), b[3])
            return ((w - u) * turn[:, :, 1]).sum(axis=1) - k * pitch[1]

        heights = rise(grid[both]) / pitch[1]
        if not np.isfinite(heights).any():
            continue
        for k in range(int(np.nanmin(heights)) - 1, int(np.nanmax(heights)) + 2):
            for psi in slow_plate.zeros(partial(rise, k=k), grid[both]):
                at = np.array([psi])
                turn = slow_plate.turns(at)[0]
                u = slow_plate.on_both(a1, a2, (turn @ (s * pitch))[None], ba)[0]
                w = slow_plate.on_both(b1, b2, (turn @ (t * pitch))[None], bb)[0]
                places = [(a1, u), (a2, u + turn @ (s * pitch)), (b1, w), (b2, w + turn @ (t * pitch))]
                if not np.isfinite([q for _, q in places]).all() or abs(float(rise(at, k=k)[0])) > 1e-6:
                    continue
                outlines = (left, left, right, right)
                if not all(
                    abs(c.misfit(q)) < 1e-7 and looked.touches(c, q, 2.5, own)
                    for (c, q), own in zip(places, outlines, strict=True)
                ):
                    continue
                across = [float(q @ turn[:, 0]) for _, q in places]
                if min(across[2:]) - max(across[:2]) < vise.min_gap - 1e-9:
                    continue
                wrenches = np.stack([looked.wrench(c, q) for c, q in places], axis=1)
                null = np.linalg.svd(wrenches)[2][-1]
                null = null * np.sign(null.sum())
                # The right pegs push the part to the left.
                pushed = sum(
                    f * -float(c.normal(q) @ turn[:, 0])
                    for f, (c, q) in zip(null[2:], places[2:], strict=True)
                )
                if null.min() > 1e-9 and pushed < 0:
                    angle = round((-psi + 0.1234) % (2 * pi), 4)
                    found.add((s, t, k, angle, round(float((w - u) @ turn[:, 0]) + 0.01234, 3)))
    assert type_one(result) == found
    assert len(found) > 10


def type_one(result: Result) -> set[tuple[Any, ...]]:
    """Fixtures of type I as the slow search tells them: steps, rows between the jaws, angle, and distance of both."""
    out = set()
    for fixture in result:
        jaws = [
            sorted(
                (peg for peg in fixture.pegs if peg.carrier == name), key=lambda peg: (peg.column, peg.row)
            )
            for name in ("left", "right")
        ]
        steps = [(two.column - one.column, two.row - one.row) for one, two in jaws]
        (one, _), (other, _) = jaws
        if any(first.face == second.face for first, second in jaws):
            continue
        angle = round((fixture.pose.theta_deg * pi / 180 + 0.1234) % (2 * pi), 4)
        out.add((*steps, other.row - one.row, angle, round(other.x - one.x + 0.01234, 3)))
    return out


@pytest.mark.thorough
def test_jaws_of_the_same_heights_meet_one_outline() -> None:
    """It has one set of numbers, half a turn swaps the jaws, and the list is that of a prism over it."""
    vise = attrs.evolve(VISE, left_heights=LEFT, right_heights=LEFT)
    result = design(stepped({"left": (LEFT, FOOT), "right": (LEFT, FOOT)}), vise)
    alone = design(part(FOOT), VISE)
    assert {key_of(one, 1) for one in result} == {key_of(one, 1) for one in alone}
    assert {int(face) - len(BASE) for face in result.table.face.ravel()} == set(range(len(FOOT)))
    assert verify(result).proven == len(result) > 10


@pytest.mark.parametrize("name", ["vise", "plate", "locators"])
def test_the_algebra_does_without_them_in_a_sentence(name: str) -> None:
    """The paper's polynomials know one outline."""
    toolkit, own = OWN[name]
    with pytest.raises(InputError, match="carriers are not alike"):
        find_fixtures_by_algebra(Query(stepped(own), toolkit))


@pytest.mark.thorough
def test_a_peg_on_a_face_of_another_outline_is_refuted() -> None:
    """And a clamp that enters its own outline, though it is clear of the part's."""
    result = held("plate")
    assert verify(result).refuted == 0
    table = result.table
    swapped = attrs.evolve(table, face=np.where(table.face >= len(BASE), 0, table.face).astype(np.int32))
    assert verify(attrs.evolve(result, table=swapped)).proven == 0
    wider = stepped({"clamp": (TIP, ROOF)})
    other = attrs.evolve(result, query=attrs.evolve(result.query, workpiece=wider))
    assert verify(other).proven == 0


@pytest.mark.thorough
def test_an_avoided_face_is_avoided_on_every_outline_over_it() -> None:
    """Faces of the solid that two outlines share are avoided in both; others of the clamp by their own number."""
    toolkit, _ = OWN["plate"]
    workpiece = stepped({"clamp": (TIP, STEM)})
    over = [(k,) for k in range(len(BASE))]
    (role, clamp), first = workpiece.outlines[0], len(BASE)
    assert workpiece.solid is not None and clamp.solid is not None
    shared = attrs.evolve(
        workpiece,
        solid=attrs.evolve(workpiece.solid, faces=over),
        outlines=((role, attrs.evolve(clamp, solid=attrs.evolve(clamp.solid, faces=over))),),
    )
    for avoid, faces in ([2], {2, first + 2}), ([first + 3], {3, first + 3}):
        result = design(shared, toolkit, restrictions=Restrictions(avoid=avoid))
        assert faces.isdisjoint(set(result.table.face.ravel().tolist())) and len(result) > 0
        assert verify(result).refuted == 0
    usual = design(shared, toolkit)
    fewer = attrs.evolve(usual, query=attrs.evolve(usual.query, restrictions=Restrictions(avoid=[2])))
    assert verify(fewer).refuted > 0
    alone = design(workpiece, toolkit, restrictions=Restrictions(avoid=[first + 1]))
    assert first + 1 not in alone.table.face and 1 in alone.table.face
    with pytest.raises(InputError, match="no face 40"):
        design(workpiece, toolkit, restrictions=Restrictions(avoid=[40]))


def test_a_solid_that_was_read_without_the_heights_is_refused_with_a_way_out() -> None:
    """Also one that was read with others; and outlines that no carrier meets are left out."""
    toolkit, own = OWN["plate"]
    for workpiece in (stepped({}), stepped({"clamp": ((9.0, 18.0), STEM)})):
        with pytest.raises(InputError, match=r"touches from 10 to 18 mm.*heights=toolkit.heights"):
            Query(workpiece, toolkit)
    assert Query(stepped(own), PLATE).workpiece.outlines == ()


def test_seating_is_refused_in_a_sentence() -> None:
    """It is worked out for one outline."""
    toolkit, own = OWN["plate"]
    with pytest.raises(InputError, match="the clamp has heights of its own"):
        design(stepped(own), toolkit, seating=5)
