"""Contacts whose wrenches exact lengths make dependent are recognized by their features and holes, and no others are."""

from __future__ import annotations

from math import cos, hypot, sin, sqrt
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold import Plate, Query, Vise, Workpiece, answer, design, verify
from workhold.contact.problem import Problem
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.base.feature import IS_ARC, RADIUS, X, Y
from workhold.kernels.contact.record import (
    COLUMNS,
    FEATURES,
    LARGEST_RADIUS,
    PSI,
    REACH,
    RECORD_LENGTH,
    ROWS,
    SEPARATION,
    STANDING,
    TAIL_X,
    TAIL_Y,
)
from workhold.kernels.proof.interval_newton import compute_jacobians
from workhold.listing import collector
from workhold.proof import deciding
from workhold.proof.degenerate import (
    TouchedFeatures,
    are_antipodal,
    are_lined_up,
    are_sliding,
    are_turning,
    cannot_hold,
)

Array = NDArray[np.float64]
LENGTH = 60.0
PSI_OF_ALL = 0.3
# A length off by this much is another length, and what rounding makes of one is not.
OFF, ROUNDED = 1e-6, 1e-14


def arc(center: complex, radius: float, place: complex) -> TouchedFeatures:
    """A peg on an arc."""
    return TouchedFeatures(
        *(np.array([value]) for value in (True, center + 0j, 1.0 + 0j, radius, place + 0j))
    )


def line(point: complex, axis: complex, place: complex) -> TouchedFeatures:
    """A peg on a line."""
    return TouchedFeatures(
        *(np.array([value]) for value in (False, point + 0j, axis / abs(axis) + 0j, 0.0, place + 0j))
    )


def near(tail: complex, psi: float = PSI_OF_ALL) -> Array:
    """The record of pegs that turn by psi, the first of them at a place on the part."""
    row = np.zeros((1, RECORD_LENGTH))
    row[0, PSI:] = psi, tail.real, tail.imag, 0.0, 1e-4, 1e-3
    return row


@pytest.mark.parametrize("apart", [0.0, 7.0, 50.0])
@pytest.mark.parametrize(("one", "two"), [(20.0, 20.0), (12.0, 5.0), (5.0, 30.0)])
@pytest.mark.parametrize("off", [-OFF, 0.0, ROUNDED, OFF])
def test_a_pair_as_far_apart_or_as_near_as_two_arcs_allow_is_antipodal(
    apart: float, one: float, two: float, off: float
) -> None:
    """The ends of the range are those that trying shows."""
    angles = np.linspace(0.0, 2.0 * np.pi, 721)
    ends = np.abs(apart + two * np.exp(1j * angles)[:, None] - one * np.exp(1j * angles)[None, :])
    for length in (ends.min(), ends.max()):
        # A least of 0 is taken at no angle tried, and by no two pegs.
        if length > 0.5:
            found = are_antipodal(arc(0, one, 3), arc(1j * apart, two, 3 + (length + off) * 1j))
            assert bool(found[0]) == (abs(off) <= ROUNDED)


@pytest.mark.parametrize("off", [-OFF, 0.0, ROUNDED, OFF])
def test_a_pair_as_near_as_a_line_and_an_arc_allow_is_antipodal(off: float) -> None:
    """So is one across parallel lines; a pair on one line or on lines at an angle is not."""
    exact = abs(off) <= ROUNDED
    for pair in (
        (line(0, 1 + 1j, 0), arc(9 * (1j - 1) / sqrt(2), 4.0, (5 + off) * 1j)),
        (
            line(2, 1 + 1j, 0),
            line(2 + 7 * (1j - 1), 1 + 1j, 7 * sqrt(2) + off),
        ),
    ):
        assert bool(are_antipodal(*pair)[0]) == bool(are_antipodal(*pair[::-1])[0]) == exact
    assert not are_antipodal(line(0, 1, 0), line(20, 1, 20))[0]
    assert not are_antipodal(line(0, 1, 0), line(20, 1 + 1j, 20))[0]


def turned(third: TouchedFeatures) -> bool:
    """Whether a third peg, at (20, 0), goes past what it touches: the others are at (0, 0), 5 mm from a centre that is 3 mm
    to their right and 4 mm up, and at (3, 24), 20 mm from it. Parts' frames are turned by psi."""
    seen = complex(cos(PSI_OF_ALL), sin(PSI_OF_ALL)) * (3 + 4j)
    one, two = arc(7 - 2j, 5.0, 0), arc(7 - 2j, 20.0, 3 + 24j)
    record = near(7 - 2j - seen)
    found = {bool(are_turning(record, *pair, third, LENGTH)[0]) for pair in ((one, two), (two, one))}
    assert len(found) == 1
    return found.pop()


@pytest.mark.parametrize("off", [-OFF, 0.0, ROUNDED, OFF])
def test_a_third_peg_that_turns_past_a_feature_passes_its_normal_through_the_centre(off: float) -> None:
    """Lines as far from the centre as the peg; arcs outside, inside and around its way, and about the centre itself."""
    way, center, exact = hypot(17, 4) + off, 7 - 2j, abs(off) <= ROUNDED
    beside = complex(cos(1.0), sin(1.0))
    assert turned(line(center + way * beside + 3j * beside, 1j * beside, 20)) == exact
    assert turned(arc(center + (way + 6.0) * beside, 6.0, 20)) == exact
    assert turned(arc(center + (way - 6.0) * beside, 6.0, 20)) == exact
    assert turned(arc(center + 6.0 * beside, way + 6.0, 20)) == exact
    assert turned(arc(center, way, 20)) == exact
    # On the other side of the chord the centre is another.
    mirrored = abs(3 + 4j - 2 * (3 + 4j)) + off
    assert not turned(line(center + mirrored * beside, 1j * beside, 20))


@pytest.mark.parametrize("off", [-OFF, 0.0, ROUNDED, OFF])
@pytest.mark.parametrize("gap", [0.0, 6.0, -6.0])
@pytest.mark.parametrize("outside", [1, -1])
def test_a_third_peg_that_slides_past_an_arc_has_a_parallel_normal(
    off: float, gap: float, outside: int
) -> None:
    """Pegs on one line or on two parallel ones, and one on an arc whose centre is its radius from the peg's way."""
    axis, radius = complex(cos(0.4), sin(0.4)), 11.0
    # Pegs (0, 0), (10, 0), (3, 20), turned so that the second is off the first's line by the gap.
    along = sqrt(100.0 - gap * gap)
    turn = (along - 1j * gap) * axis / 10
    way = (turn * (3 + 20j) / axis).imag
    center = (5 + 1j * (way + outside * (radius + off))) * axis
    one, two = line(4 * axis, axis, 0), line((9 - 1j * gap) * axis, -axis, 10)
    for psi, expected in ((np.angle(turn), abs(off) <= ROUNDED), (np.angle(turn) + 0.1, False)):
        found = {
            bool(are_sliding(near(0, float(psi)), *pair, arc(center, radius, 3 + 20j))[0])
            for pair in ((one, two), (two, one))
        }
        assert found == {expected}


# Two bores of 1 mm more than the pegs, 20 mm apart, in a part that is turned by 0.7.
BORE, BORES, TURN = 3 - 4j, 1.0, complex(cos(0.7), sin(0.7))


def lined(
    third: TouchedFeatures, tail: complex, psi: float = 0.7, apart: float = 20.0, other: float = BORES
) -> bool:
    """Whether pegs at (0, 0) and (20, 0) in two bores touch them on one line where a third one touches."""
    one, two = arc(BORE, BORES, 0), arc(BORE + apart * TURN, other, 20)
    record = near(tail, psi)
    record[0, REACH:] = 1e-6
    found = {bool(are_lined_up(record, *pair, third, LENGTH)[0]) for pair in ((one, two), (two, one))}
    assert len(found) == 1
    return found.pop()


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("off", [-OFF, 0.0, 1e-16, OFF])
def test_a_third_peg_that_touches_where_two_normals_are_on_one_line_makes_a_double_root(
    side: int, off: float
) -> None:
    """On a line or an arc; not where the two touch elsewhere, where they are otherwise apart, or where it may stay."""
    tail, exact, place = BORE + side * BORES * TURN, abs(off) < 1e-12, 5 + 30j
    third = tail + place * TURN
    for angle in (0.6, 1.5, -1.0):
        normal = TURN * 1j * complex(cos(angle), sin(angle))
        on_line, on_arc = (
            line(third + off * normal + 4j * normal, 1j * normal, place),
            arc(third + (6.0 + off) * normal, 6.0, place),
        )
        for one in (on_line, on_arc):
            assert lined(one, tail) == lined(one, tail, psi=0.7 + 1e-5) == exact
            assert not lined(one, tail + 0.5 * TURN)
            assert not lined(one, tail, psi=0.72)
            assert not lined(one, tail, apart=20.0 + 1e-9)
            assert not lined(one, tail, other=BORES + 1e-9)
    # Around the circle the third peg stays on a line across the bores' own.
    assert not lined(line(third, 1j * TURN, place), tail)
    # As the part turns it stays on a line through what it turns about.
    pivot = BORE + 10 * TURN + side * BORES / 2 * TURN
    assert not lined(line(third, 1j * (third - pivot), place), tail)
    # So it nearly does on a line turned from that by little: other solutions are not excluded.
    assert not lined(line(third, 1j * (third - pivot) * (1 + 1e-5j), place), tail)
    assert lined(line(third, 1j * (third - pivot) * (1 + 0.1j), place), tail)


def test_a_root_that_is_lined_up_is_the_only_one_nearby() -> None:
    """On both ways in which two pegs touch their bores the third one is off its feature everywhere else nearby."""
    tail, place = BORE + BORES * TURN, 5 + 30j
    normal = TURN * 1j * complex(cos(0.6), sin(0.6))
    axis = 1j * normal
    point = tail + place * TURN

    def off(first: complex, psi: float) -> float:
        """How far the third peg is from its line."""
        peg = first + place * complex(cos(psi), sin(psi))
        return abs(((peg - point).conjugate() * (axis * 1j)).real)

    for small in (1e-4, -1e-4, 1e-6, -1e-6):
        around = BORE + BORES * TURN * complex(cos(small), sin(small))
        assert off(around, 0.7) > 0.1 * abs(small)
        # The other way: the two touch on either side of their line, turned by half as much.
        half = complex(cos(small / 2), sin(small / 2))
        beside = sqrt(BORES**2 - (20 * sin(small / 2)) ** 2)
        first = BORE - 20 * TURN * (half**2 - 1) / 2 + beside * TURN * half
        assert abs(abs(first - BORE) - BORES) < 1e-12
        assert abs(abs(first + 20 * TURN * half**2 - BORE - 20 * TURN) - BORES) < 1e-12
        assert off(first, 0.7 + small) > 0.1 * abs(small)


def rod(radius: float, half_width: float, half_length: float, hole: float) -> Workpiece:
    """Two round ends about holes, and a straight bar between them."""
    beside = sqrt(radius**2 - half_width**2)
    # tan of a quarter of the sweep, 2 pi less the angle that the bar takes.
    bulge = (radius + beside) / half_width
    x = half_length - beside
    outer = [(-x, -half_width, 0), (x, -half_width, bulge), (x, half_width, 0), (-x, half_width, bulge)]
    holes = [[(c - hole, 0, 1), (c + hole, 0, 1)] for c in (-half_length, half_length)]
    return Workpiece.from_loops("rod", [np.array(loop, float) for loop in (outer, *holes)])


# Round ends of 20 mm with a peg: two of its pegs stand across one, and a third where the other end is tangent to a column.
ACROSS = rod(17, 8, 50, 13)
# A clamp of radius 5 in the hole of 8 mm just grazes it where the part lies in a triangle of 3, 4 and 5.
GRAZED = rod(16, 6, 70, 8)

# A boss about a hole, between fillets of 5 mm to the digits of a file, which a clamp of that radius fills.
TEE = Workpiece.from_loops(
    "tee",
    [
        [
            (-60, 0, 0),
            (60, 0, 0),
            (60, 18, 0),
            (14, 18, -0.41421356),
            (9, 23, 0),
            (9, 78, 1),
            (-9, 78, 0),
            (-9, 23, -0.41421356),
            (-14, 18, 0),
            (-60, 18, 0),
        ],
        [(-5, 78, 1), (5, 78, 1)],
    ],
)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("part", "toolkit"),
    [
        (TEE, Plate(pitch=20, peg_radius=3, clamp_radius=5, clamps=2)),
        (ACROSS, Plate(pitch=20, peg_radius=3, clamp_radius=5)),
        (GRAZED, Plate(pitch=20, peg_radius=3, clamp_radius=5)),
        pytest.param(
            GRAZED, Plate(pitch=20, peg_radius=3, clamp_radius=5, clamps=2), marks=pytest.mark.prove
        ),
    ],
)
def test_nothing_about_a_symmetric_part_is_undecided(part: Workpiece, toolkit: Toolkit) -> None:
    """No number that is not finite is met on the way, nothing is left, and what is listed holds."""
    result = design(part, toolkit, best=10)
    assert result.complete
    assert result.proof is not None
    assert result.proof.undecided == ()
    assert verify(result).proven == len(result) > 0


@pytest.mark.thorough
@pytest.mark.parametrize(
    "toolkit", [Plate(pitch=20, peg_radius=3, clamp_radius=5), Vise(pitch=20, columns=3, peg_radius=3)]
)
def test_no_proven_fixture_is_of_such_a_family(toolkit: Toolkit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Certificates know nothing of the families, and prove no member of one; of what they leave open many are."""
    counts = np.zeros(2, int)

    def both(records: Array, problem: Problem, *rest: Any) -> tuple[Array, Array]:
        proven, left = sifted(records, problem, *rest)
        counts[:] += cannot_hold(proven, problem).sum(), cannot_hold(left, problem).sum()
        return proven, left

    sifted = deciding.sift_records
    monkeypatch.setattr(deciding, "sift_records", both)
    design(GRAZED, toolkit, best=1)
    assert counts[0] == 0


def test_a_box_about_the_centre_of_an_arc_keeps_its_solution() -> None:
    """A peg in the centre of an arc has no normal, so that nothing is known of the place; what is around it stays."""
    problem = Problem.from_query(Query(rod(16, 6, 70, 3.25), Vise(pitch=20, columns=3, peg_radius=3)))
    found: list[Array] = []
    original, rows = deciding.decide_records, problem.rows

    def kept_as_well(*given: Any) -> Any:
        outcome = original(*given)
        found.append(outcome[0])
        return outcome

    small = np.flatnonzero((rows[:, IS_ARC] != 0.0) & (rows[:, RADIUS] < 0.5))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(collector, "decide_records", kept_as_well)
        answer(problem.query)
    proven = np.concatenate(found)
    numbers, pegs = np.nonzero(np.isin(proven[:, FEATURES : FEATURES + 2], small))
    assert len(numbers)
    for row, peg in zip(proven[numbers[:20]], pegs[:20].tolist(), strict=True):
        solution = solved_from(row, peg, 20.0)
        box = solution[None].copy()
        box[0, TAIL_X : TAIL_Y + 1] = rows[int(solution[FEATURES]), [X, Y]]
        box[0, REACH], box[0, LARGEST_RADIUS] = 1e-9, 0.3
        assert np.isfinite(compute_jacobians(box, rows, problem.setting)).all()
        kept, left = deciding.decide_by_interval_newton(box, problem, problem.setting)
        distances = [np.abs(one[PSI:REACH] - solution[PSI:REACH]).max() for one in kept]
        assert len(left) or min(distances, default=1.0) < 1e-9


def solved_from(row: Array, peg: int, pitch: float) -> Array:
    """A record with another standing peg as the first, of a square lattice."""
    out, standing = row.copy(), int(row[STANDING])
    column, line_of = row[COLUMNS + peg], row[ROWS + peg]
    tail = complex(row[TAIL_X], row[TAIL_Y]) + pitch * complex(column, line_of) * np.exp(1j * row[PSI])
    out[COLUMNS : COLUMNS + standing] -= column
    out[ROWS : ROWS + 4] -= line_of
    for first in (FEATURES, COLUMNS, ROWS):
        out[[first, first + peg]] = out[[first + peg, first]]
    out[TAIL_X], out[TAIL_Y], out[SEPARATION] = tail.real, tail.imag, row[SEPARATION] - pitch * column
    return out


def test_only_pegs_of_one_carrier_are_a_fixed_length_apart() -> None:
    """Holes of 16 mm, 140 mm apart, allow pegs of 6 mm to be 150 mm apart, five columns: of one jaw, not of two."""
    problem = Problem.from_query(Query(GRAZED, Vise(pitch=30, columns=6, peg_radius=3)))
    holes = np.flatnonzero((problem.rows[:, IS_ARC] != 0.0) & (problem.rows[:, RADIUS] < 6.0)).tolist()
    sides = np.flatnonzero(problem.rows[:, IS_ARC] == 0.0).tolist()
    for pegs, expected in ((0, 1), True), ((0, 2), False):
        row = np.zeros((1, RECORD_LENGTH))
        row[0, STANDING] = 2.0
        row[0, FEATURES : FEATURES + 4] = *sides, *sides
        for peg, hole, column in zip(pegs, holes, (0.0, 5.0), strict=True):
            row[0, FEATURES + peg], row[0, COLUMNS + peg] = hole, column
        assert cannot_hold(row, problem).tolist() == [expected]
