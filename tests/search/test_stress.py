"""Parts next to a degenerate case, far away, tiny, with very fine and very coarse lattices: each with its expected answer.

The answer for a part next to a degenerate one comes from the degenerate one: each of its fixtures is carried over by
solving its four contact equations anew in ball arithmetic (``stress_parts.carried_over``), which shares nothing with the
search. What is proven there must be listed, and what is listed must be proven.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest
import stress_parts as parts

from fixture_sets import Judge, assert_same, listed, mirrored, missing, near_an_end, turned
from workhold import Fixture, Result, Vise, Workpiece, design
from workhold.algebra import find_fixtures_by_algebra
from workhold.contact.features import list_contact_features
from workhold.verification import verify

pytestmark = pytest.mark.thorough

Family = Callable[[float], Workpiece]
HAIRS = [1e-6, 1e-9, 1e-12]
BOTH_WAYS = [1e-6, 1e-9, 1e-12, -1e-6, -1e-9, -1e-12]


@cache
def fixtures_of(family: Family, change: float, vise: Vise) -> Result:
    """The search's result for a member of a family."""
    return design(family(change), vise)


def resting_on(result: Result, *faces: int) -> int:
    """How many fixtures have one jaw's pegs on all the given faces."""
    table = result.table
    count = 0
    for jaws, touched in zip(result.toolkit.find_peg_carriers(table.arrangement), table.face, strict=True):
        count += any(set(faces) <= set(touched[jaws == jaw].tolist()) for jaw in (0, 1))
    return count


def assert_holds(result: Result) -> None:
    """Verification refutes nothing but what is marginal, and the independent checker finds no fault in some fifty."""
    judge = Judge(result.workpiece, result.toolkit)
    fixtures = listed(result)
    some = fixtures[:: len(fixtures) // 50 + 1]
    assert [fault for fixture in some for fault in judge.check(fixture)[0]] == []
    refuted = [fixtures[item.index] for item in verify(result).unproven if item.verdict == "refuted"]
    assert [f for f in refuted if not judge.check(f)[1] and not near_an_end(judge, f)] == []


def assert_follows(family: Family, change: float, vise: Vise, stiffness: float = 1e3) -> Result:
    """The part changed by a hair has the fixtures of the unchanged one, each within ``stiffness`` times the hair.

    Both ways: all fixtures of the unchanged part are proven for the changed one and listed there; what is listed there
    and proven for the unchanged part is listed for that.
    """
    exact, near = fixtures_of(family, 0.0, vise), fixtures_of(family, change, vise)
    carried = parts.carried_over(exact, near.workpiece, vise)
    assert {c.verdict for c in carried} == {"proven"}
    assert max(c.moved for c in carried) < stiffness * abs(change) + 1e-9
    assert missing(listed(near), listed([c.fixture for c in carried]), Judge(near.workpiece, vise)) == []
    back = [c.fixture for c in parts.carried_over(near, exact.workpiece, vise) if c.verdict == "proven"]
    assert missing(listed(exact), listed(back), Judge(exact.workpiece, vise)) == []
    assert_holds(near)
    return near


def assert_engines_agree(result: Result) -> None:
    """The paper's algebra lists the same fixtures, apart from marginal ones."""
    judge = Judge(result.workpiece, result.toolkit)
    assert_same(listed(result), listed(find_fixtures_by_algebra(result.query)), judge)


@pytest.mark.parametrize("tilt", HAIRS)
@pytest.mark.parametrize("family", [parts.stepped, parts.strip])
def test_nearly_parallel_faces(family: Family, tilt: float) -> None:
    """Two faces that look the same way, or opposite ways, parallel to within a hair: the fixtures are those of parallel
    faces, among them such as rest two pegs of one jaw on both faces and stand there by sliding."""
    vise = Vise(pitch=12, columns=1, peg_radius=2)
    near = assert_follows(family, tilt, vise)
    assert family is parts.strip or resting_on(near, 0, 2) >= 3
    assert_engines_agree(near)


@pytest.mark.parametrize("change", BOTH_WAYS)
def test_arcs_of_nearly_equal_radius_one_step_apart(change: float) -> None:
    """Two arcs with centres exactly a lattice step apart, equal in radius to within a hair: the fixtures are those of equal
    arcs, among them one with both left pegs on the two arcs. There the chord swings half way round within an angle of the
    order of the hair. The algebra lists nothing else."""
    near = assert_follows(parts.two_bumps, change, Vise(pitch=10, columns=1, peg_radius=1))
    assert resting_on(near, 0, 2) == 1
    algebra = find_fixtures_by_algebra(near.query)
    assert missing(listed(near), listed(algebra), Judge(near.workpiece, near.toolkit)) == []


def spread_bumps(change: float) -> Workpiece:
    """Two equal bumps with centres 10 mm and a hair apart."""
    return parts.two_bumps(center_change=change)


@pytest.mark.parametrize("change", BOTH_WAYS)
def test_equal_arcs_nearly_one_step_apart(change: float) -> None:
    """The same where the radii are equal and the centres are a step and a hair apart."""
    near = assert_follows(spread_bumps, change, Vise(pitch=10, columns=1, peg_radius=1))
    assert resting_on(near, 0, 2) == 1
    algebra = find_fixtures_by_algebra(near.query)
    assert missing(listed(near), listed(algebra), Judge(near.workpiece, near.toolkit)) == []


@pytest.mark.parametrize("change", BOTH_WAYS)
def test_a_chord_nearly_square_to_a_side_at_the_far_side_of_an_arc(change: float) -> None:
    """A line and an arc for which both tangencies of a chord fall together but for a hair: nothing is lost or added."""
    near = assert_follows(parts.lug, change, Vise(pitch=10, columns=1, peg_radius=2))
    assert len(near) == 31
    assert_engines_agree(near)


@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-5])
def test_a_nearly_concentric_ring(off: float) -> None:
    """A hole off the centre by a hair: the four forces of a clamped wall balance whatever the hair, so the closure margins
    stay, and the fixtures are those of a hole 0.1 mm off, carried over a tenth of the way at a time. (From a millionth of a
    millimetre on the wrenches no longer span: their minors are at the edge, 1e-7.)"""
    vise = Vise(pitch=10, columns=1, peg_radius=3)
    held: list[Fixture] = list(fixtures_of(parts.ring, 0.1, vise))
    part, distance = parts.ring(0.1), 0.1
    while distance > 1.001 * off:
        distance /= 10
        part = parts.ring(distance)
        carried = parts.carried_over(held, part, vise)
        assert {c.verdict for c in carried} == {"proven"}
        held = [c.fixture for c in carried]
    near = design(parts.ring(distance), vise)
    assert_holds(near)
    assert len(held) == 10
    assert missing(listed(near), listed(held), Judge(near.workpiece, vise)) == []
    assert len(near) == len(held)


CROWNED = Vise(pitch=10, columns=1, peg_radius=3)
# The extremes are tried by every run, all by ``make prove``.
EXTREMES = [1e-2, 3e-6]
BULGES = [1e-3, 1e-4, 1e-5, -1e-2, -1e-3, -1e-4, -1e-5, -3e-6]


@pytest.mark.parametrize(
    "bulge", [*EXTREMES, *(pytest.param(bulge, marks=pytest.mark.prove) for bulge in BULGES)]
)
def test_a_crowned_edge_costs_like_an_arc(bulge: float) -> None:
    """However shallow the arc, the search ends with everything decided, and looks at a few times the contacts of the
    straight plate. (Below bulges of 1e-5, beyond radii of 10 km here, the figures of a fixture are known to less than the
    seven digits that verification wants.)"""
    straight, near = fixtures_of(parts.crowned, 0.0, CROWNED), fixtures_of(parts.crowned, bulge, CROWNED)
    assert straight.proof is not None and near.proof is not None
    assert near.complete and near.proof.undecided == ()
    assert near.proof.candidates < 4 * straight.proof.candidates
    if abs(bulge) > 5e-6:
        assert_holds(near)


@pytest.mark.parametrize(
    "bulge", [-1e-5, *(pytest.param(bulge, marks=pytest.mark.prove) for bulge in (1e-4, 1e-5, -1e-4))]
)
def test_fixtures_of_a_crowned_edge_become_those_of_a_straight_one(bulge: float) -> None:
    """All fixtures of the straight plate follow. What there is besides holds by the slope of the crown alone: all four pegs
    stand on it and the side opposite, whose lines of action are parallel without it, or some peg has a share of the force
    that goes with it."""
    near = assert_follows(parts.crowned, bulge, CROWNED, stiffness=1e5)
    carried = parts.carried_over(near, parts.crowned(0.0), CROWNED)
    added = [fixture for fixture, there in zip(near, carried, strict=True) if there.verdict != "proven"]
    assert len(near) - len(added) == len(fixtures_of(parts.crowned, 0.0, CROWNED))
    assert added
    for fixture in added:
        on_both = {peg.face for peg in fixture.pegs} == {0, 2}
        assert on_both or fixture.quality["closure_margin"] < 100 * abs(bulge)


@pytest.mark.prove
@pytest.mark.parametrize("bulge", [1e-2, 1e-3, 1e-4])
def test_the_algebra_finds_the_same_on_a_crowned_edge(bulge: float) -> None:
    assert_engines_agree(fixtures_of(parts.crowned, bulge, CROWNED))


@pytest.mark.parametrize("bulge", [1.9e-6, 1e-7, 1e-9, -1e-9])
def test_a_crown_too_low_to_be_drawn_is_none(bulge: float) -> None:
    straight, near = fixtures_of(parts.crowned, 0.0, CROWNED), fixtures_of(parts.crowned, bulge, CROWNED)
    assert list(near) == list(straight)
    said = "1 arc that is nowhere farther than 1e-06 mm, or a millionth of its length, from a line taken for one."
    assert near.workpiece.remarks == (said,)


@pytest.mark.parametrize("count", [16, 64])
@pytest.mark.parametrize("off", [1e-9, 1e-8, 1e-7, 1e-6])
def test_a_circle_cut_into_arcs_is_a_circle(count: int, off: float) -> None:
    """A hair less than the reading tells apart: one face, which nothing holds, and the reason is told."""
    part = parts.cut_circle(count, off)
    assert len(part.faces) == 1
    assert part.remarks[0].startswith(f"{count} arcs that are nowhere farther than 1e-06 mm from one circle")
    assert Workpiece.from_loops(part.name, part.loops) == part
    result = design(part, Vise(pitch=8, columns=2, peg_radius=3))
    assert result.complete and len(result) == 0
    assert ["meet in that point" in str(note) for note in result.notes] == [True]


def test_a_circle_cut_into_arcs_that_a_drawing_tells_apart() -> None:
    """Its arcs stay what they are, and every contact is decided."""
    part = parts.cut_circle(16, 1e-4)
    assert len(part.faces) == 16 and part.remarks == ()
    result = design(part, Vise(pitch=8, columns=2, peg_radius=3))
    assert result.complete and result.proof is not None and result.proof.undecided == ()
    assert_holds(result)


# Each hair with one shape at least, each shape with a hair of either sign; all by ``make prove``.
SHAPES_AND_HAIRS = [
    *((parts.bracket_with_fillet, play) for play in (1e-3, 1e-9, -1e-9, -1e-3)),
    *((family, play) for family in (parts.notched, parts.slotted) for play in (1e-6, -1e-6)),
    *(
        pytest.param(family, play, marks=pytest.mark.prove)
        for family in (parts.notched, parts.slotted)
        for play in (1e-3, 1e-9, -1e-9, -1e-3)
    ),
    *(pytest.param(parts.bracket_with_fillet, play, marks=pytest.mark.prove) for play in (1e-6, -1e-6)),
]


@pytest.mark.parametrize(("family", "play"), SHAPES_AND_HAIRS)
def test_a_concave_arc_a_hair_larger_or_smaller_than_a_peg(family: Family, play: float) -> None:
    """A concave arc larger than a peg keeps a feature, however small, and one smaller has none; what does not touch it or
    its slot stays the same. (Within a millionth of the peg's radius the slot may count or not.)"""
    vise = Vise(pitch=10, columns=1, peg_radius=3)
    part = family(3.0 + play)
    arcs = {face.number for face in part.faces if face.number >= 3} & {3, 4} & concave(part)
    has_feature = bool(arcs & {feature.face for feature in list_contact_features(part, vise.peg_radius)})
    assert has_feature == (play > 0) or abs(play) <= 1e-9
    near, open_wide = fixtures_of(family, 3.0 + play, vise), fixtures_of(family, 3.001, vise)
    assert_holds(near)
    assert_engines_agree(near)
    hidden = {3, 4, 5} if family is parts.slotted else set[int]()
    if hidden and play < -1e-8:
        assert not hidden & set(near.table.face.ravel().tolist())
    stays = [f for f in open_wide if play > 1e-8 or not hidden & {peg.face for peg in f.pegs}]
    carried = parts.carried_over(stays, part, vise)
    assert {c.verdict for c in carried} == {"proven"}
    assert missing(listed(near), listed([c.fixture for c in carried]), Judge(part, vise)) == []


def concave(part: Workpiece) -> set[int]:
    """Numbers of the concave arcs of a part's outline."""
    return {k for k, (_, _, bulge) in enumerate(part.loops[0].tolist()) if bulge < 0}


@pytest.mark.parametrize("play", [1e-2, 1e-4, 1e-5, 1e-6, 1e-9])
def test_a_peg_in_a_notch_that_fits_it(play: float) -> None:
    """A fixture planted with a peg in the middle of a concave arc a hair larger than itself is listed with a contact on that
    arc, whose feature is of the size of the hair; below 1e-6 mm every contact on it is marginal."""
    part, vise, planted = parts.held_in_notch(play)
    judge = Judge(part, vise)
    assert judge.check(planted)[0] == []
    result = design(part, vise)
    assert_holds(result)
    assert play <= 1e-6 or missing(listed(result), [planted], judge) == []
    assert_engines_agree(result)


def eccentric_ring(change: float) -> Workpiece:
    """A ring whose hole is 8 mm off its centre."""
    return parts.ring(8.0 + change)


FAR = [
    (parts.two_bumps, 10.0, 1.0, 20),
    (parts.lug, 10.0, 2.0, 31),
    (parts.stepped, 12.0, 2.0, 43),
    (eccentric_ring, 10.0, 3.0, 40),
]


@pytest.mark.parametrize(("family", "pitch", "radius", "count"), FAR)
def test_ten_metres_from_the_origin(family: Family, pitch: float, radius: float, count: int) -> None:
    """A part drawn turned and 1e4 mm from the origin has the same fixtures, although its coordinates are rounded to
    2e-12 mm, which turns exact coincidences into near ones."""
    vise = Vise(pitch=pitch, columns=1, peg_radius=radius)
    here = fixtures_of(family, 0.0, vise)
    turn, x, y = 0.3, 1e4, -1e4
    there = design(parts.redrawn(here.workpiece, turn, x, y), vise)
    assert len(here) == len(there) == count
    back = turned(listed(there), -turn)
    for fixture in back:
        theta = radians(fixture["pose"]["theta_deg"] - np.degrees(turn))
        fixture["pose"]["x"] += cos(theta) * x - sin(theta) * y
        fixture["pose"]["y"] += sin(theta) * x + cos(theta) * y
    assert_same(back, listed(here), Judge(here.workpiece, vise))
    assert_holds(there)


@pytest.mark.parametrize(("family", "pitch", "radius", "count"), FAR)
def test_half_a_millimetre_across(family: Family, pitch: float, radius: float, count: int) -> None:
    """A part of half a millimetre, its vise scaled with it, has the fixtures of the part a hundred times as large."""
    vise = Vise(pitch=pitch, columns=1, peg_radius=radius)
    large = fixtures_of(family, 0.0, vise)
    small = design(
        parts.redrawn(large.workpiece, scale=0.01),
        Vise(pitch=pitch * 0.01, columns=1, peg_radius=radius * 0.01),
    )
    assert len(large) == len(small) == count
    assert_same(parts.resized(listed(small), 100.0), listed(large), Judge(large.workpiece, vise))
    assert_holds(small)


def test_a_pitch_of_a_hundredth_of_the_part() -> None:
    """On a lattice a hundred times finer than the part few rows are enough for many fixtures: all stand up, those of three
    rows are those of five rows that span no more, and the algebra lists the same."""
    part = parts.workpiece("triangle", [[[0, 0, 0], [100, 7, 0], [31, 62, 0]]])
    five, three = (design(part, Vise(pitch=1, columns=1, peg_radius=0.4, rows=rows)) for rows in (5, 3))
    assert len(five) > 100
    assert len(three) == int((np.ptp(five.table.row, axis=1) < 3).sum()) > 0
    assert_holds(five)
    assert_engines_agree(three)


@pytest.mark.parametrize("pitch", [14.0, 31.0, 1e3])
def test_a_pitch_larger_than_the_part_and_its_pegs(pitch: float) -> None:
    """Where the next hole is farther than the part with a peg on either side reaches, no jaw has two contacts: no fixture,
    nothing refused. At 14 mm pegs still reach, but only about the ends, where they hold nothing."""
    part = parts.workpiece("chip", [[[0, 0, 0], [20, 1, 0], [17, 14, 0.2], [3, 12, 0]]])
    result = design(part, Vise(pitch=pitch, columns=1, peg_radius=5))
    assert result.counts == {"I": 0, "II": 0}
    assert result.complete
    assert_engines_agree(result)


def test_a_chip_between_four_large_pegs() -> None:
    """A part smaller than the pitch sits in the middle of four pegs that nearly touch one another: two fixtures."""
    outline: list[list[float]] = [[1.91, 4.27, 0], [-3.85, 3.02, 0], [-2.87, -2.53, 0], [2.86, -1.63, 0]]
    result = design(parts.workpiece("chip", [outline]), Vise(pitch=10, columns=1, peg_radius=4.5))
    assert result.counts == {"I": 2, "II": 0}
    assert_holds(result)
    assert_engines_agree(result)


@pytest.mark.parametrize(("width", "height"), [(50.0, 30.0), (44.0, 24.0)])
def test_a_rectangle_on_the_lattice(width: float, height: float) -> None:
    """A rectangle whose sides, or whose sides moved out by the pegs, are whole pitches: a half turn of the part and a mirror
    image of part and vise carry the set of fixtures into itself, and the algebra lists the same."""
    x, y = width / 2, height / 2
    part = parts.workpiece("rectangle", [[[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]]])
    vise = Vise(pitch=10, columns=2, peg_radius=3)
    result = design(part, vise)
    judge, here = Judge(part, vise), listed(result)
    assert len(here) > 100
    assert_holds(result)
    assert_same(turned(here, pi, lambda face: (face + 2) % 4), here, judge)
    assert_same(mirrored(here, lambda face: {0: 2, 2: 0}.get(face, face)), here, judge)
    assert_engines_agree(result)


def test_a_regular_24_gon() -> None:
    """A turn by a side carries the set of fixtures into itself, so there are 12 or 24 of each sort; the algebra lists the
    same."""
    part, vise = parts.regular(24, 30.0), Vise(pitch=20, columns=1, peg_radius=2)
    result = design(part, vise)
    assert result.counts == {"I": 120, "II": 0}
    assert 24 * result.distinct["I"] >= 120 >= 12 * result.distinct["I"]
    assert_holds(result)
    here = listed(result)
    assert_same(turned(here, 2 * pi / 24, lambda face: (face + 1) % 24), here, Judge(part, vise))
    assert_engines_agree(result)


@pytest.mark.parametrize(("x", "y"), [(0.0, 0.0), (1e4, -7e3), (0.1, 0.7)])
def test_a_full_circle_has_no_fixture(x: float, y: float) -> None:
    """All lines of action meet in the centre, wherever it is and however it is rounded: no fixture,
    and the reason is told."""
    part = parts.workpiece("disc", [parts.disc(20.0, x, y)])
    result = design(part, Vise(pitch=7, columns=2, peg_radius=3))
    assert result.counts == {"I": 0, "II": 0}
    assert result.complete
    assert ["meet in that point" in str(note) for note in result.notes] == [True]


def test_a_ring_held_from_inside_and_outside() -> None:
    """Forces on one circle meet in its centre, so each fixture has exactly two pegs on each circle. Of Type I most have one
    jaw in the hole and the other outside, and clamp the wall; two have one peg in the hole on either jaw."""
    vise = Vise(pitch=10, columns=1, peg_radius=3)
    result = design(parts.ring(8.0), vise)
    assert result.counts == {"I": 14, "II": 26}
    inside = result.table.face == 2
    assert (inside.sum(axis=1) == 2).all()
    on_left = (inside & (vise.find_peg_carriers(result.table.arrangement) == 0)).sum(axis=1)
    assert (on_left[result.table.arrangement == 0] == 1).sum() == 2
    assert_holds(result)
    assert_engines_agree(result)
