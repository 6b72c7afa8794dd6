"""What shows of a toolkit: holes where they are, plates apart, whichever way something slides."""

from __future__ import annotations

from itertools import combinations
from math import cos, hypot, pi, radians, sin
from typing import ClassVar

import numpy as np
import pytest
from attrs import evolve, frozen
from hypothesis import given
from hypothesis import strategies as st

import workhold
from workhold import Fixture, Load, OpeningVise, Peg, Pose, StrapPlate, Vise, Workpiece
from workhold.errors import InputError
from workhold.fixels.carrier import HoleSelection
from workhold.fixels.toolkit import Arrangement, Carrier, Symmetry, Toolkit, Travel
from workhold.geometry.segment import Box
from workhold.model.shown import ShownSetUp, bound_placed_parts, find_shown, find_shown_beside

WAYS = {"+x": 0.0, "+y": pi / 2, "-x": pi, "-y": -pi / 2}


@frozen
class Plates(Toolkit):
    """Carriers as they are told."""

    kind: ClassVar[str] = "plates"
    arrangements: ClassVar[tuple[Arrangement, ...]] = (Arrangement("I", (2, 2)),)
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = ()
    gap: float | None
    all: tuple[Carrier, ...]

    @property
    def carriers(self) -> tuple[Carrier, ...]:
        """As told."""
        return self.all


def pegs_in(toolkit: Toolkit, travelled: float, *holes: tuple[str, int, int]) -> Fixture:
    """A fixture with pegs in holes, on no part."""
    carriers = {carrier.name: carrier for carrier in toolkit.carriers}
    pegs = [
        Peg(name, column, row, *carriers[name].compute_hole_center(column, row, travelled), 0, 0.5)  # type: ignore[arg-type]
        for name, column, row in holes
    ]
    return Fixture("I", tuple(pegs), Pose(0.0, 0.0, 0.0), travelled, {})  # type: ignore[arg-type]


def two_plates(way: str) -> Plates:
    """A plate that stands still, and one that slides away from it."""
    still = Carrier("base", (10.0, 12.0), 4, 5, 3.0, 3.0)
    x, y = {"+x": (30.0, 0.0), "+y": (0.0, 48.0), "-x": (-30.0, 0.0), "-y": (0.0, -48.0)}[way]
    return Plates(
        None, (still, evolve(still, name="slide", offset=(x, y), travel=Travel(WAYS[way], 0.0, None)))
    )


def apart(one: Box, other: Box) -> bool:
    """Whether two boxes share no area."""
    return one.compute_overlap_area(other) == 0


def check(seen: ShownSetUp) -> None:
    """Every hole lies on its plate's side of the gap, every peg in a hole that is marked as used, and plates are apart."""
    for one, other in combinations(seen.carriers, 2):
        assert apart(one.plate, other.plate)
    for each in seen.carriers:
        holes = {hole.center: hole for hole in each.list_holes()}
        assert len(holes) == len(each.columns) * len(each.rows)
        assert all(each.plate.contains(Box(*center, *center)) for center in holes)
        assert {(hole.column, hole.row) for hole in holes.values() if hole.used} == {
            (p.column, p.row) for p in each.pegs
        }
        assert all(holes[peg.x, peg.y].used for peg in each.pegs)


@pytest.mark.parametrize("way", list(WAYS))
@pytest.mark.parametrize("travelled", [0.5, 15.0, 80.0])
def test_a_plate_may_slide_either_way_along_either_axis(way: str, travelled: float) -> None:
    """Plates stay apart, the travel is measured from where it begins to where it ends, and clamping undoes it."""
    toolkit = two_plates(way)
    fixture = pegs_in(toolkit, travelled, ("base", 1, 1), ("base", 2, 3), ("slide", 0, 0), ("slide", 2, 1))
    seen = find_shown_beside(Box(0.0, 0.0, 20.0, 30.0), fixture, toolkit)
    check(seen)
    (base, slide), (measured,) = seen.carriers, seen.measured
    start, end = measured.axes
    moved = np.array(end[0]) - np.array(start[0])
    along = 1 if way[1] == "y" else 0
    assert measured.is_upright == bool(along) and measured.setting.length == travelled
    assert moved[along] == pytest.approx(travelled * (1 if way[0] == "+" else -1))
    assert slide.clamping is not None and slide.clamping[along] * moved[along] < 0
    assert base.clamping is None and not seen.clamps
    towards = {"+x": "right", "-x": "left", "+y": "top", "-y": "bottom"}[way]
    back = {"right": "left", "left": "right", "top": "bottom", "bottom": "top"}[towards]
    assert base.facing == {towards} and slide.facing == {back}
    assert {base.names_at, slide.names_at} == ({"left"} if along else {"left", "right"})


def test_a_plate_alone_faces_nothing() -> None:
    """One carrier that stands still: nothing is measured, rows are named at the left, half a pitch is left all round."""
    toolkit = Plates(None, two_plates("+x").all[:1])
    fixture = pegs_in(toolkit, 0.0, ("base", 0, 0), ("base", 3, 0), ("base", 0, 4), ("base", 3, 4))
    seen = find_shown_beside(Box(5.0, 5.0, 25.0, 40.0), fixture, toolkit)
    check(seen)
    assert (
        seen.measured == () and seen.carriers[0].facing == frozenset() and seen.carriers[0].names_at == "left"
    )
    assert seen.carriers[0].plate == Box(-5.0, -6.0, 35.0, 54.0) and seen.carriers[0].broken == frozenset()


@pytest.mark.parametrize(
    ("wide", "columns", "rows"), [(4, range(9, 16), range(9, 16)), (28, range(8, 41), range(9, 16))]
)
def test_holes_show_a_pitch_around_what_is_held_or_a_fourteenth_of_it(
    wide: int, columns: range, rows: range
) -> None:
    """Four columns of 10 mm ask for one more at either side, 28 of them for two, and rows of 12 mm for one."""
    plate = Carrier("base", (10.0, 12.0), 60, 60, 3.0, 3.0)
    fixture = pegs_in(Plates(None, (plate,)), 0.0, ("base", 10, 10), ("base", 10 + wide, 14))
    (seen,) = find_shown_beside(Box(110.0, 125.0, 130.0, 165.0), fixture, Plates(None, (plate,))).carriers
    assert (seen.columns, seen.rows) == (columns, rows)


@pytest.mark.parametrize(("kind", "clamping"), [(Vise, (-1.0, 0.0)), (OpeningVise, (1.0, 0.0))])
def test_the_clamping_direction_is_the_toolkits(kind: type[Vise], clamping: tuple[float, float]) -> None:
    """A vise clamps towards less separation, an opening vise towards more; holes are those of its jaws."""
    vise = kind(
        pitch=10,
        columns=3,
        peg_radius=3,
        row_offset=2.0,
        blocked=(HoleSelection("left", 2, 1), HoleSelection("right", 0)),
    )
    fixture = pegs_in(vise, 36.0, ("left", 2, 0), ("left", 1, 4), ("right", 1, 1), ("right", 1, 3))
    seen = find_shown_beside(Box(21.0, 0.0, 55.0, 40.0), fixture, vise)
    check(seen)
    left, right = seen.carriers
    assert (left.clamping, right.clamping) == (None, clamping)
    (measured,) = seen.measured
    assert (measured.setting.start, measured.setting.end) == ((20.0, 2.0), (56.0, 2.0))
    assert [(hole.column, hole.row) for hole in left.list_holes() if hole.blocked] == [(2, 1)]
    assert {hole.column for hole in right.list_holes() if hole.blocked} == {0}
    assert left.columns[-1] == 2 and right.columns[0] == 0


def test_of_many_holes_those_near_the_pegs_are_left() -> None:
    """A pitch of 0.5 mm would give thousands; what is left lies within three columns and rows of a peg."""
    fine = Vise(pitch=0.5, columns=200, peg_radius=0.2)
    fixture = pegs_in(fine, 50.0, ("left", 199, 0), ("left", 150, 60), ("right", 0, 0), ("right", 60, 80))
    for each in find_shown_beside(Box(100.0, 0.0, 149.0, 40.0), fixture, fine).carriers:
        near = each.list_holes(2000)
        assert len(near) <= 49 * len(each.pegs) < len(each.list_holes())
        for hole in near:
            away = [max(abs(hole.column - peg.column), abs(hole.row - peg.row)) for peg in each.pegs]
            assert min(away) <= 3


@pytest.mark.thorough
@given(theta=st.floats(0.0, 2 * pi), x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_extents_are_those_of_the_placed_part(theta: float, x: float, y: float) -> None:
    """A half disc with a bitten edge: the box found is that of a thousand points of every placed segment."""
    part = Workpiece.from_loops(
        "half disc", [[[0, 0, 0.4], [20, 0, 1.0], [0, 0.5, 0]], [[8, 1, 1], [9, 1, 1]]]
    )
    ((x0, y0, x1, y1),) = bound_placed_parts(part, *np.array([[theta], [x], [y]]))
    points = np.array(
        [
            segment.compute_point(segment.half_extent * share)
            for segment in part.segments
            for share in np.linspace(-1, 1, 1001)
        ]
    )
    placed = points @ np.array([[cos(theta), sin(theta)], [-sin(theta), cos(theta)]]) + [x, y]
    assert (*placed.min(axis=0), *placed.max(axis=0)) == pytest.approx((x0, y0, x1, y1), abs=2e-4)
    assert x0 <= placed[:, 0].min() + 1e-9 and y1 >= placed[:, 1].max() - 1e-9
    fixture = evolve(pegs_in(Vise(pitch=9, columns=1, peg_radius=1), 30.0), pose=Pose(theta * 180 / pi, x, y))
    assert find_shown(fixture, Vise(pitch=9, columns=1, peg_radius=1), part).part.x0 == pytest.approx(x0)


@given(theta=st.floats(-400.0, 400.0), x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_a_pose_and_its_way_back(theta: float, x: float, y: float) -> None:
    """R(theta) q + t, undone by the inverse; directions turn without moving, arrays go as points do."""
    pose = Pose(theta, x, y)
    there = pose.apply(3.0, -4.0)
    assert there == pytest.approx(
        (
            3 * cos(radians(theta)) + 4 * sin(radians(theta)) + x,
            3 * sin(radians(theta)) - 4 * cos(radians(theta)) + y,
        )
    )
    assert pose.inverse.apply(*there) == pytest.approx((3.0, -4.0), abs=1e-12)
    assert hypot(*pose.turn(3.0, -4.0)) == pytest.approx(5.0)
    assert pose.inverse.turn(*pose.turn(3.0, -4.0)) == pytest.approx((3.0, -4.0))
    many = np.column_stack(pose.apply(np.array([3.0, 0.0]), np.array([-4.0, 0.0])))
    assert many == pytest.approx(np.array([there, (x, y)]))


@pytest.mark.parametrize("row", [10**5, 2**31 - 1])
def test_too_many_holes_are_not_shown(row: int) -> None:
    """Two pegs far apart, and a part far away, are refused before any hole is counted."""
    vise = Vise(pitch=10, columns=3, peg_radius=2)
    far = pegs_in(vise, 30.0, ("left", 0, 0), ("left", 1, row), ("right", 0, 0), ("right", 1, 1))
    near = pegs_in(vise, 30.0, ("left", 0, 0), ("left", 1, 3), ("right", 0, 0), ("right", 1, 1))
    assert len(find_shown_beside(Box(0.0, 0.0, 50.0, 50.0), near, vise).carriers) == 2
    for part, fixture in ((Box(0.0, 0.0, 50.0, 50.0), far), (Box(0.0, 10.0 * row, 50.0, 1e300), near)):
        with pytest.raises(InputError, match="too many to show"):
            find_shown_beside(part, fixture, vise)


@pytest.mark.parametrize(("peg_radius", "hole"), [(3.0, 3.0), (4.9, 4.2), (0.5001, 0.5001), (0.0, 10 / 7)])
def test_a_hole_is_drawn_as_large_as_its_peg(peg_radius: float, hole: float) -> None:
    """Neighbouring holes stay apart where pegs nearly overlap, and pegs that are points have holes to be seen."""
    toolkit = Vise(pitch=(10, 14), columns=2, peg_radius=peg_radius)
    fixture = pegs_in(toolkit, 20.0, ("left", 0, 0), ("left", 1, 2), ("right", 0, 0), ("right", 1, 1))
    seen = find_shown_beside(Box(0.0, 0.0, 20.0, 30.0), fixture, toolkit)
    assert [each.hole_radius for each in seen.carriers] == pytest.approx([hole, hole])


def test_a_pose_takes_arrays_of_points() -> None:
    """As rows they go the same way as their coordinates, by its matrix, and back by its inverse; text is refused."""
    pose, points = Pose(33.0, 4.0, -7.0), np.array([[1.0, 2.0], [-3.0, 0.5], [8.0, 8.0]])
    there = pose.apply(points)
    assert np.array_equal(there, np.column_stack(pose.apply(points[:, 0], points[:, 1])))
    assert there == pytest.approx((pose.matrix @ np.column_stack([points, np.ones(3)]).T)[:2].T)
    assert pose.inverse.apply(there) == pytest.approx(points) and pose.apply([1, 2]) == pytest.approx(
        there[0]
    )
    assert pose.turn(points) == pytest.approx(there - (4.0, -7.0))
    with pytest.raises(InputError, match="a coordinate cannot be '1'"):
        pose.apply([("1", 2)])
    with pytest.raises(InputError, match="theta deg cannot be '33'"):
        Pose("33", 0, 0)  # type: ignore[arg-type]


@pytest.mark.thorough
@pytest.mark.parametrize("over", ["plate", "supports"])
def test_bolts_of_straps_and_supports_show(over: str) -> None:
    """Also those that stand beyond locators and part."""
    plate = StrapPlate(20, 3, over=over, reach=(55, 60))
    block = Workpiece.from_points("block", [(0, 0), (100, 0), (100, 60), (0, 60)])
    load = Load(points=(50, 30), force=300, directions=20)
    fixture = workhold.design(block, plate, loads=[load], thickness=25, strapped=1, best=1)[0]
    (seen,) = find_shown(fixture, plate, block).carriers
    holes = {one.hole for one in fixture.hold.straps} | set(fixture.hold.supports)
    assert holes and holes < seen.used
    assert holes <= {(column, row) for column in seen.columns for row in seen.rows}
