"""Decisions in ball arithmetic (python-flint) on candidates that double precision leaves open.

A candidate is a box of the four unknowns (psi, tail x, tail y, separation) that holds the exact contact, if
there is one. It is made smaller by two rules of one or two unknowns (``ball_contacts.narrow_box``), and by
the contacts of three standing pegs alone (:func:`narrow_to_contacts`). These often fix the pose when the
moving peg only grazes its feature. Then the box is turned into the frame of ``proof.singular_frame``. There,
boxes in which some contact equation has no zero, or in which some rule is broken everywhere, are dropped. The
interval Newton method (Hansen and Sengupta) makes the others smaller. It shows that there is none or exactly
one solution. The remaining boxes are cut in three. If ``FEW_BOXES`` do not decide, all solutions are usually
on one curve, on which ``proof.solution_curve`` finds them. Boxes left after ``MOST_BOXES`` stay undecided.
Solutions are judged at rising precision.

References: E. Hansen, S. Sengupta, "Bounding solutions of systems of equations using interval analysis",
BIT 21 (1981) 203-211; F. Johansson, "Arb", IEEE Transactions on Computers 66 (2017) 1281-1292.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce

from attrs import evolve, frozen
from flint import arb, ctx

from workhold.kernels.base.tables import Limits
from workhold.model.search_report import AT_AN_EDGE, NEARLY_DOUBLE
from workhold.proof.ball_contacts import (
    CandidateBox,
    compute_contact_values,
    compute_slacks,
    compute_wrench_minors,
    is_empty,
    measure_extent,
    narrow_box,
    place_contacts,
)
from workhold.proof.singular_frame import (
    SingularFrame,
    cut_in_thirds,
    decouple_equations,
    is_smaller,
    take_newton_step,
)
from workhold.proof.solution_curve import find_roots_on_curve

__all__ = ["BoxOutcome", "find_solutions"]

PRECISIONS = (128, 256, 512)
# So many boxes take about as long as to find the curve; most solutions take fewer.
FEW_BOXES, MOST_BOXES = 40, 10000
# A root is not refined further than to so many units in the last place of a mm, at the precision in force.
SHARP = 2.0**24
# Rounds in which standing pegs make a box smaller.
MOST_STEPS = 60
# Cuts of the separation once these fix the pose.
FEW_CUTS = 120


@frozen
class BoxOutcome:
    """The outcome of deciding a box.

    Parameters
    ----------
    fixtures : middles (psi, tail x, tail y, separation) of solutions proven to be fixtures.
    reason : why the box is undecided, empty where it is decided.
    """

    fixtures: tuple[tuple[float, float, float, float], ...]
    reason: str


def find_solutions(
    box: CandidateBox, limits: Limits, is_stopped: Callable[[], bool] = lambda: False
) -> BoxOutcome | None:
    """Return every fixture in a box, or the reason why the box stays undecided; None when the work was
    stopped before."""
    if is_stopped():
        return None
    with ctx.workprec(PRECISIONS[0]):
        smaller_box = narrow_box(box, limits)
        if smaller_box is not None and box.standing == 3:
            smaller_box = narrow_to_contacts(smaller_box, limits)
        if smaller_box is None:
            return BoxOutcome((), "")
        frame = SingularFrame.from_box(smaller_box, limits)
        roots = isolate_roots_in_boxes(frame, limits, is_stopped, FEW_BOXES)
        if roots is None:
            roots = find_roots_on_curve(frame, limits)
        if roots is None:
            roots = isolate_roots_in_boxes(frame, limits, is_stopped, MOST_BOXES)
    if roots is None:
        return None if is_stopped() else BoxOutcome((), NEARLY_DOUBLE)
    return judge_solutions(frame, roots, limits)


def narrow_to_contacts(box: CandidateBox, limits: Limits) -> CandidateBox | None:
    """Return the part of a box in which three standing pegs and then the moving peg may touch; None for no
    part.

    The equations of the standing pegs do not contain the separation. First each is solved for each unknown,
    which needs no inverse for a wide box. Then all are combined by the inverse of their Jacobian at its
    middle. If that fixes the pose, the separation is bisected repeatedly.
    """
    place = [arb(middle, reach) for middle, reach in zip(box.middle, box.reach, strict=True)]
    for _ in range(MOST_STEPS):
        before = place[:3]
        for turn in range(4):
            middle = [arb(one.mid()) for one in place[:3]]
            values = compute_contact_values(box, [*middle, place[3]])[:3]
            slopes = [row[:3] for row in place_contacts(box, place).slopes[:3]]
            if turn < 3:
                values, slopes = values[turn:] + values[:turn], slopes[turn:] + slopes[:turn]
            elif (combined := decouple_equations(values, slopes)) is not None:
                values, slopes = combined
            else:
                break
            closer, _ = take_newton_step(place[:3], values, slopes)
            if closer is None:
                return None
            place[:3] = closer
        if not is_smaller(place[:3], before):
            break
    waiting = [place[3]]
    for _ in range(FEW_CUTS):
        if not waiting:
            break
        part = waiting.pop()
        if not is_empty(box, place_contacts(box, [*place[:3], part]), limits):
            waiting += [arb(part.mid() + side * part.rad() / 2, part.rad() / 2) for side in (-1, 1)]
    if not waiting:
        return None
    place[3] = reduce(arb.union, waiting)
    middles, reaches = zip(*map(measure_extent, place), strict=True)
    return evolve(box, middle=middles, reach=reaches)


def isolate_roots_in_boxes(
    frame: SingularFrame, limits: Limits, is_stopped: Callable[[], bool], most: int
) -> list[list[arb]] | None:
    """Return parts of a box, in the frame's coordinates, with exactly
    one solution each, which hold all fixtures.

    Return None where that takes more than ``most`` boxes, or when stopped.
    """
    waiting, roots = [frame.make_start_box()], list[list[arb]]()
    for _ in range(most):
        if not waiting:
            return roots
        if is_stopped():
            return None
        place = waiting.pop()
        here = frame.compute_contacts(place)
        if is_empty(frame.box, here, limits):
            continue
        smaller, unique = frame.narrow(place, here)
        if smaller is not None and not unique and not is_smaller(smaller, place):
            smaller, unique = frame.narrow(smaller, frame.compute_contacts(smaller), regular=True)
        if smaller is not None and unique:
            roots.append(smaller)
        elif smaller is not None:
            waiting += [smaller] if is_smaller(smaller, place) else cut_in_thirds(smaller)
    return None


def judge_solutions(frame: SingularFrame, roots: list[list[arb]], limits: Limits) -> BoxOutcome:
    """Return the outcome of a box from parts with one solution each:
    each is judged by the rules, at rising precision.
    """
    fixtures: list[tuple[float, float, float, float]] = []
    reason = ""
    for root in roots:
        verdict = 0
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                root = refine_solution(frame, root)
                unknowns = frame.compute_unknowns(root)
                here = place_contacts(frame.box, unknowns)
                values = compute_slacks(
                    frame.box, here, compute_wrench_minors(here, limits.wrench_length), limits
                )
                verdict = -1 if any(v < 0 for v in values) else int(all(v > 0 for v in values))
            if verdict != 0:
                break
        if verdict == 0:
            reason = AT_AN_EDGE
        if verdict > 0:
            psi, x, y, separation = (float(u.mid()) for u in unknowns)
            fixtures.append((psi, x, y, separation))
    return BoxOutcome(tuple(fixtures), reason)


def refine_solution(frame: SingularFrame, root: list[arb]) -> list[arb]:
    """Return a smaller box around a proven solution, to the precision in force, by steps that each gain a
    binary digit or more.

    The part returned holds the solution, and is ``root`` itself where no step helps.
    """
    for _ in range(12):
        if max(float(p.rad()) for p in root) < SHARP * 0.5**ctx.prec:
            break
        closer, _ = frame.narrow(root, frame.compute_contacts(root))
        if closer is not None and not is_smaller(closer, root, 0.5):
            closer, _ = frame.narrow(root, frame.compute_contacts(root), regular=True)
        if closer is None or not is_smaller(closer, root, 0.5):
            break
        root = closer
    return root
