"""The curve of solutions holds every point where three equations do, and its roots are all solutions of a box."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

import ladders
from exact_chords import exactly
from workhold.kernels.base.tables import Limits
from workhold.proof import solution_curve
from workhold.proof.ball_contacts import CandidateBox
from workhold.proof.interval_newton import PRECISIONS
from workhold.proof.singular_frame import SingularFrame
from workhold.proof.solution_curve import (
    SolutionCurve,
    TaylorForm,
    bound_along_curve,
    find_curve_about,
    find_roots_on_curve,
)

LIMITS = Limits(-100.0, 0.0, 20.0, 9.0, 1.0, 0.0, 0.0)
REST = [0.0, 0.0, 0.0, 0.0]
SHARES = [-1.0, -0.7, -0.2, 1e-4, 0.5, 0.999]


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    """Balls of the first precision."""
    with ctx.workprec(PRECISIONS[0]):
        yield


def folded(rest: float, reach: float, turn: float = 0.0) -> SingularFrame:
    """The ladders a little above their fold, in a box about it."""
    middle = ladders.near(np.pi / 4 + turn, -2.5 + rest)
    wide = (reach, 10 * reach, 10 * reach, 20 * reach)
    return SingularFrame.from_box(
        CandidateBox(ladders.FEATURES, ladders.offsets(-2.5 + rest), 2, middle, wide), LIMITS
    )


def triple(turned: float = 0.0) -> SingularFrame:
    """Pegs of one jaw on a side and the bore of a rounded triangle, of the other on its corner and the bore, of one radius.

    Both moving pegs slide around their arcs alike, and the standing ones turn the part by the square of that: a triple root.
    """
    side = [0.0, -41.0, 0.0, -0.0, -1.0, 34.641, 0.0, 1.0, *REST]
    bore = [1.0, -10.0, 0.0, -0.6, 0.8, np.pi, 11.0, -1.0, *REST]
    corner = [1.0, 30.0, 0.0, 1.0, 0.0, 1.0472, 11.0, 1.0, *REST]
    places = [(0.0, 0.0), (20.0, -20.0), (0.0, -20.0), (-40.0, -20.0 + turned)]
    middle, reach = (0.0, -41.0, 20.0, 82.0), (4.4e-11, 6e-5, 6e-5, 1.2e-4)
    return SingularFrame.from_box(CandidateBox([side, bore, corner, bore], places, 2, middle, reach), LIMITS)


def point(frame: SingularFrame, t: float) -> tuple[list[arb], arb]:
    """The point where three combined equations hold for a fourth coordinate, and the fourth equation, by Newton's method."""
    known = [arb(0), arb(0), arb(0)]
    with ctx.workprec(400):
        for _ in range(9):
            here = frame.compute_contacts([*known, arb(t)])
            values, slopes = frame.evaluate_equations([*known, arb(t)]), frame.evaluate_jacobian(here)
            inverse = arb_mat([row[:3] for row in slopes[:3]]).mid().inv().mid()
            step = inverse * arb_mat(3, 1, values[:3])
            known = [arb((v - s).mid()) for v, s in zip(known, step.entries(), strict=True)]
        return known, frame.evaluate_equations([*known, arb(t)])[3]


def curve_of(frame: SingularFrame) -> SolutionCurve:
    """The curve in the whole box."""
    *well, t = frame.make_start_box()
    well, is_curve = bound_along_curve(frame, well, t)
    curve = find_curve_about(frame, well, t)
    assert is_curve and curve is not None
    return curve


def is_near(ball: arb, number: arb, hair: float = 1e-60) -> bool:
    """Whether a ball holds a number that is known to a hair."""
    return bool(ball.overlaps(arb(number.mid(), hair)))


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize(
    "frame", [folded(1e-6, 1e-3), folded(1e-3, 3e-2), folded(-1e-4, 1e-2, 2e-3), triple()]
)
def test_every_point_of_the_curve_is_in_its_taylor_forms(frame: SingularFrame, share: float) -> None:
    """At a point Newton's method finds the same, and the enclosure is sharp to what the remainder leaves."""
    curve, whole = curve_of(frame), frame.make_start_box()[3]
    t = share * float(whole.rad())
    known, rest = point(frame, t)
    for form, value in zip(curve.unknowns, known, strict=True):
        assert is_near(form.evaluate(arb(t)), value)
    *well, along = frame.make_start_box()
    assert all(
        is_near(part, value)
        for part, value in zip(bound_along_curve(frame, well, along)[0], known, strict=True)
    )
    assert is_near(curve.evaluate_equation(arb(t)), rest)
    assert (
        float(curve.evaluate_equation(arb(t)).rad())
        <= float(abs(curve.rest.last).upper()) * abs(t) ** 5 + 1e-30
    )
    beside = t * (1.0 + 1e-3)
    assert is_near(curve.evaluate_equation(arb(t).union(arb(beside))), rest)
    # Between two points the slope is somewhere that of their chord.
    further = point(frame, beside)[1]
    chord = (further - rest) / (arb(beside) - t)
    assert curve.evaluate_slope(arb(t).union(arb(beside))).overlaps(chord)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("rest", [1e-3, 1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("turn", [0.0, 1e-4, -3e-3])
def test_both_roots_of_a_fold_are_found_once(
    rest: float, turn: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no rule helps each exact solution is in just one part, and these are small."""
    monkeypatch.setattr(solution_curve, "is_empty", lambda *_: False)
    frame = folded(rest, 1e-2, turn) if rest < 1e-3 else folded(rest, 3e-2, turn)
    roots = find_roots_on_curve(frame, LIMITS)
    assert roots is not None and len(roots) == 2
    with exactly():
        exact = [ladders.unknowns(psi, -2.5 + rest) for psi in ladders.orientations(-2.5 + rest)]
    found = sorted(
        (frame.compute_unknowns(root) for root in roots), key=lambda unknowns: float(unknowns[0].mid())
    )
    for unknowns, solution in zip(found, exact, strict=True):
        assert all(abs(float((u - v).mid())) < 1e-15 for u, v in zip(unknowns, solution, strict=True))
        assert all(float(u.rad()) < 1e-18 for u in unknowns)


def test_nothing_is_below_a_fold() -> None:
    assert find_roots_on_curve(folded(-1e-7, 1e-2), LIMITS) == []


def test_a_triple_root_takes_few_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cutting boxes of four unknowns takes thousands. All four normals are parallel at the root: no fixture."""
    monkeypatch.setattr(solution_curve, "MOST_PARTS", 80)
    curve = curve_of(triple())
    assert not curve.rest.terms[3].contains(0)
    assert all(float(abs(term).upper()) < 1e-14 for term in curve.rest.terms[:3])
    assert find_roots_on_curve(triple(), LIMITS) == []


def test_a_triple_root_that_is_not_quite_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """With one row a millionth of a nanometre off, the root stays in the box and becomes simple."""
    monkeypatch.setattr(solution_curve, "is_empty", lambda *_: False)
    roots = find_roots_on_curve(triple(1e-12), LIMITS)
    assert roots is not None and len(roots) in (1, 3)
    for root in roots:
        values = triple(1e-12).compute_contacts(root).values
        assert all(value.contains(0) for value in values)


def test_a_box_with_two_open_directions_has_no_curve() -> None:
    """Along four parallel lines the part slides, and the separation changes nothing."""
    lines = [[0.0, 0.0, float(y), 1.0, 0.0, 60.0, 0.0, 1.0, *REST] for y in (0, 0, 20, 20)]
    places = [(0.0, 0.0), (30.0, 0.0), (0.0, 20.0), (30.0, 20.0)]
    box = CandidateBox(lines, places, 2, (0.0, 0.0, 0.0, 5.0), (1e-3, 1.0, 1.0, 1.0))
    assert find_roots_on_curve(SingularFrame.from_box(box, LIMITS), LIMITS) is None


def test_what_takes_too_many_parts_has_no_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solution_curve, "MOST_PARTS", 1)
    assert find_roots_on_curve(folded(1e-6, 1e-2), LIMITS) is None


def test_the_terms_of_series_are_put_back() -> None:
    """They are one number for the whole process."""
    before, ctx.cap = ctx.cap, 9
    curve_of(triple())
    assert ctx.cap == 9
    ctx.cap = before


def test_roots_of_overlapping_parts_are_one_only_where_the_slope_says_so() -> None:
    """x^2 - 1e-4 has two roots in overlapping balls, x - 1e-2 has one."""
    two = SolutionCurve(arb(0), [], TaylorForm([arb(-1e-4), arb(0), arb(1)], arb(0)))
    one = SolutionCurve(arb(0), [], TaylorForm([arb(-1e-2), arb(1)], arb(0)))
    left, right = arb(-0.01, 0.0101), arb(0.01, 0.0101)
    assert not solution_curve.is_same(two, left, right)
    assert solution_curve.is_same(one, arb(0.01, 0.001), arb(0.011, 0.001))
    assert not solution_curve.is_same(one, arb(0.01, 0.001), arb(0.02, 0.001))


def test_a_root_in_two_parts_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """(t - 1/8) (t + 1/2) is cut at 1/8, and parts overlap there."""
    curve = SolutionCurve(
        arb(0), [TaylorForm([arb(0)], arb(0))] * 3, TaylorForm([arb(-0.0625), arb(0.375)], arb(1))
    )
    monkeypatch.setattr(solution_curve, "bound_along_curve", lambda frame, well, t: (well, True))
    monkeypatch.setattr(solution_curve, "find_curve_about", lambda *_: curve)
    monkeypatch.setattr(solution_curve, "is_empty", lambda *_: False)
    monkeypatch.setattr(SingularFrame, "make_start_box", lambda _: [arb(0), arb(0), arb(0), arb(0, 1)])
    roots = find_roots_on_curve(triple(), LIMITS)
    assert roots is not None
    assert sorted(round(float(root[3]), 12) for root in roots) == [-0.5, 0.125]


def test_the_slope_of_a_form_counts_its_remainder() -> None:
    """That of 2 + 3 t + 5 t^2 + 7 t^3 is 3 + 10 t + 21 t^2."""
    form = TaylorForm([arb(2), arb(3), arb(5)], arb(7))
    assert form.evaluate(arb(2)) == 84 and form.evaluate_slope(arb(2)) == 107


def test_a_part_that_the_curve_leaves_has_none() -> None:
    """The curve bends out of too narrow a part; one that is wide enough it passes from end to end."""
    frame = folded(1e-6, 1e-3)
    *well, t = frame.make_start_box()
    kept, is_curve = bound_along_curve(frame, well, t)
    assert is_curve
    assert not bound_along_curve(frame, [arb(part.mid(), 0.1 * part.rad()) for part in kept], t)[1]
