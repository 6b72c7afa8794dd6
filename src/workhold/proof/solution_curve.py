"""Solutions of a box on the one curve that can have any, found in one unknown by Taylor's theorem.

In the frame of a box's singular vectors (``proof.singular_frame``) three combined contact equations determine
the first three coordinates q. The fourth coordinate t is determined badly. So q is a function of t, and what
is left of the equations is f(t) = F_4(q(t), t) = 0 (the reduction of Lyapunov and Schmidt). About 0

    f(t) = f_0 + f_1 t + ... + f_(n-1) t^(n-1) + r t^n

where f_k is the derivative of order k over k!, at 0, and r is that of order n somewhere between 0 and t. So
it is for each q. The derivatives are those of the implicit function, as power series, at a point or over the
box at once in ball arithmetic. Roots that are double or triple but for rounding are so decided in some tens
of parts of one unknown. Boxes of four unknowns take thousands.

References: M. Golubitsky, D. G. Schaeffer, *Singularities and Groups in Bifurcation Theory I*, Springer 1985,
chapter VII (the reduction); K. Makino, M. Berz, "Taylor models and other validated functional inclusion
methods", International Journal of Pure and Applied Mathematics 4 (2003) 379-456.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from attrs import frozen
from flint import arb, arb_mat, arb_series, ctx

from workhold.kernels.base.tables import Limits
from workhold.proof.ball_contacts import compute_contact_values, is_empty
from workhold.proof.singular_frame import SingularFrame, cut_in_thirds, is_smaller, newton_step

__all__ = ["SolutionCurve", "TaylorForm", "find_roots_on_curve"]

# The order n of the remainder: two more than that of the triple roots that whole numbers make.
ORDER = 5
# Steps in which a box is made smaller about the curve, and parts of the curve that are looked at.
MOST_STEPS = 12
MOST_PARTS = 600
# A curve is expanded anew where its remainder blurs a value by more than this part of how it varies.
BLUR = 0.01
# Parts of a curve are made smaller by Newton's method so often.
REFINEMENTS = 8
# Roots that are not known to this, in mm, are looked for again so often, on the curve about them.
SHARP, SHARPENINGS = 1e-20, 3


@frozen(eq=False)
class TaylorForm:
    """A function of one unknown t about 0.

    Parameters
    ----------
    terms : n balls, the coefficients at 0.
    last : the coefficient of order n anywhere in the range.
    """

    terms: Sequence[arb]
    last: arb

    def at(self, t: arb) -> arb:
        """The values on a ball in the range."""
        value = self.last
        for term in reversed(self.terms):
            value = value * t + term
        return value

    def slope(self, t: arb) -> arb:
        """The derivatives on a ball in the range, whose remainder is of the same derivative of order n."""
        order = len(self.terms)
        value = order * self.last
        for k in range(order - 1, 0, -1):
            value = value * t + k * self.terms[k]
        return value


@frozen(eq=False)
class SolutionCurve:
    """The curve on which three combined contact equations hold, near a point of it.

    Parameters
    ----------
    center : the fourth coordinate of the frame at the point.
    unknowns : the three well determined coordinates, as functions of the fourth from there.
    rest : the fourth combined equation on the curve.
    """

    center: arb
    unknowns: Sequence[TaylorForm]
    rest: TaylorForm

    def place(self, t: arb) -> list[arb]:
        """The part of the frame's coordinates that the curve passes for the last one in a ball."""
        return [*(unknown.at(t - self.center) for unknown in self.unknowns), t]

    def value(self, t: arb) -> arb:
        """The fourth equation on a ball."""
        return self.rest.at(t - self.center)

    def slope(self, t: arb) -> arb:
        return self.rest.slope(t - self.center)

    def has_zero(self, t: arb) -> bool:
        """Whether the fourth equation may hold in a ball, by the mean value theorem as well."""
        middle = arb(t.mid())
        return bool(
            self.value(t).contains(0) and (self.value(middle) + self.slope(t) * (t - middle)).contains(0)
        )

    def is_blurred(self, t: arb) -> bool:
        """Whether the equation in the middle of a ball is not known much better than throughout."""
        return bool(self.value(arb(t.mid())).rad() > BLUR * self.value(t).rad())


@contextmanager
def set_series_terms(count: int) -> Iterator[None]:
    """Power series are worked with to so many terms."""
    before, ctx.cap = ctx.cap, count
    try:
        yield
    finally:
        ctx.cap = before


def find_roots_on_curve(frame: SingularFrame, limits: Limits) -> list[list[arb]] | None:
    """Finds all solutions of a box that may be fixtures, each alone in a part of the box.

    None where the well determined coordinates are not shown to be a function of the other one, or where f
    vanishes so nearly that ``MOST_PARTS`` parts do not decide.
    """
    *well, t = frame.start()
    well, is_curve = bound_along_curve(frame, well, t)
    whole = find_curve_about(frame, well, t) if is_curve else None
    if whole is None:
        return None
    waiting, roots = [(whole, t)], list[tuple[SolutionCurve, arb]]()
    for _ in range(MOST_PARTS):
        if not waiting:
            return [sharpened(frame, curve.place(root)) for curve, root in roots]
        curve, t = waiting.pop()
        if not curve.has_zero(t):
            continue
        found = newton(curve, t)
        if found is None:
            place = curve.place(t)
            if not is_empty(frame.box, frame.places(place), limits):
                if curve.is_blurred(t):
                    curve = find_curve_about(frame, place[:3], t) or curve
                waiting += [(curve, part) for (part,) in cut_in_thirds([t])]
        elif not any(is_same(whole, known, root) for _, known in roots for root in found):
            roots += [(curve, root) for root in found]
    return None


def is_same(curve: SolutionCurve, one: arb, other: arb) -> bool:
    """Whether two balls with one root each have the same one, which is in two parts that overlap."""
    return bool(one.overlaps(other)) and not curve.slope(one.union(other)).contains(0)


def newton(curve: SolutionCurve, t: arb) -> list[arb] | None:
    """A small part of a ball with the one root in it, or none; None where it may have several or none."""
    if curve.slope(t).contains(0):
        return None
    is_root = False
    for _ in range(REFINEMENTS):
        middle = arb(t.mid())
        image = middle - curve.value(middle) / curve.slope(t)
        if not image.overlaps(t):
            return []
        is_root = is_root or t.contains_interior(image)
        smaller = image if t.contains(image) else t.intersection(image)
        if not is_smaller([smaller], [t]):
            break
        t = smaller
    return [t] if is_root else None


def sharpened(frame: SingularFrame, place: list[arb]) -> list[arb]:
    """The place of one root known better, on the curve expanded there."""
    for _ in range(SHARPENINGS):
        curve = find_curve_about(frame, place[:3], place[3])
        found = newton(curve, place[3]) if curve is not None and place[3].rad() > SHARP else None
        if curve is None or not found:
            break
        place = curve.place(found[0])
    return place


def find_curve_about(frame: SingularFrame, well: list[arb], t: arb) -> SolutionCurve | None:
    """The curve where its last coordinate is in a ball; it is known to be there, and where the others are."""
    middle = arb(t.mid())
    whole, begun = bound_along_curve(frame, well, t)[0], bound_along_curve(frame, well, middle)[0]
    with set_series_terms(ORDER + 1):
        at_middle, anywhere = expand_power_series(frame, begun, middle), expand_power_series(frame, whole, t)
    if at_middle is None or anywhere is None:
        return None
    forms = [TaylorForm(near[:ORDER], far[ORDER]) for near, far in zip(at_middle, anywhere, strict=True)]
    return SolutionCurve(middle, forms[:3], forms[3])


def bound_along_curve(frame: SingularFrame, well: list[arb], t: arb) -> tuple[list[arb], bool]:
    """The part of three coordinates that is passed for the fourth in a ball, and whether by a curve.

    It is by one where a step of Hansen and Sengupta in three unknowns maps the part into its own inside, for
    every t alike: exactly one point for each. By the implicit function theorem these make a smooth curve.
    """
    is_curve, middle_t = False, arb(t.mid())
    for _ in range(MOST_STEPS):
        middle = [arb(p.mid()) for p in well]
        slopes = frame.slopes(frame.places([*well, t]))
        values = frame.values([*middle, middle_t])
        inverse = inverse_of(slopes, middle=True)
        if inverse is None:
            break
        off = inverse * arb_mat(3, 1, [values[k] + slopes[k][3] * (t - middle_t) for k in range(3)])
        matrix = inverse * arb_mat([row[:3] for row in slopes[:3]])
        if any(matrix[k, k].contains(0) for k in range(3)):
            break
        out, inside = newton_step(well, off.entries(), matrix.tolist())
        if out is None:
            break
        is_curve, before, well = is_curve or inside, well, out
        if not is_smaller(well, before):
            break
    return well, is_curve


def inverse_of(slopes: Sequence[Sequence[arb]], middle: bool = False) -> Any:
    """The inverse of the Jacobian of three equations and coordinates, or an exact one near it."""
    matrix = arb_mat([row[:3] for row in slopes[:3]])
    try:
        return matrix.mid().inv().mid() if middle else matrix.inv()
    except ZeroDivisionError:
        return None


def expand_power_series(frame: SingularFrame, well: list[arb], t: arb) -> list[list[arb]] | None:
    """Coefficients of q_1, q_2, q_3 and f about a point of the curve, or about all points in a part of it.

    The residual of order k of the three equations is linear in the coefficients of order k. So these are
    found one after the other.
    """
    inverse = inverse_of(frame.slopes(frame.places([*well, t])))
    if inverse is None:
        return None
    terms, last = [[value] for value in well], arb_series([t, 1])
    for k in range(1, ORDER + 1):
        values = compute_series_values(frame, [*(arb_series(known) for known in terms), last])
        steps = (inverse * arb_mat(3, 1, [value[k] for value in values[:3]])).entries()
        for known, step in zip(terms, steps, strict=True):
            known.append(-step)
    rest = compute_series_values(frame, [*(arb_series(known) for known in terms), last])[3]
    return [*terms, [rest[k] for k in range(ORDER + 1)]]


def compute_series_values(frame: SingularFrame, place: Sequence[Any]) -> list[Any]:
    """The combined contact equations at power series of the frame's coordinates."""
    turn, *steps = product(frame.turning, place)
    unknowns = [m + s for m, s in zip(frame.box.middle, [turn / frame.length, *steps], strict=True)]
    return product(frame.combining, compute_contact_values(frame.box, unknowns))


def product(matrix: Any, vector: Sequence[Any]) -> list[Any]:
    """A 4 x 4 matrix of balls times a vector of power series."""
    rows = matrix.tolist()
    return [sum((a * b for a, b in zip(row, vector, strict=True)), arb_series([0])) for row in rows]
