"""Solutions of a box that lie on one curve, found as roots in one unknown by Taylor's theorem.

In the frame of a box's singular vectors (``proof.singular_frame``) three combined contact equations determine
the first three coordinates q. The fourth coordinate t is determined badly. So q is a function of t, and the
remaining equation is f(t) = F_4(q(t), t) = 0 (the reduction of Lyapunov and Schmidt). About 0

    f(t) = f_0 + f_1 t + ... + f_(n-1) t^(n-1) + r t^n

where f_k is the derivative of order k over k!, at 0, and r is that of order n somewhere between 0 and t. The
same holds for each entry of q. The derivatives are those of the implicit function, as power series, at a
point or over the box at once in ball arithmetic. Thus roots that are double or triple up to rounding are
decided with some tens of parts of one unknown, instead of thousands of boxes of four unknowns.

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
from workhold.proof.singular_frame import SingularFrame, cut_in_thirds, is_smaller, take_newton_step

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
    """A function of one unknown t about 0: terms[0] + terms[1] t + ... + last t^n.

    Parameters
    ----------
    terms : n balls, the coefficients at 0.
    last : a ball with the coefficient of order n anywhere in the range.
    """

    terms: Sequence[arb]
    last: arb

    def evaluate(self, t: arb) -> arb:
        """Return an enclosure of the values on a ball in the range."""
        value = self.last
        for term in reversed(self.terms):
            value = value * t + term
        return value

    def evaluate_slope(self, t: arb) -> arb:
        """Return an enclosure of the derivatives on a ball in the range.

        The remainder of the derivative has the same derivative of order n.
        """
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
    unknowns : the three well determined coordinates, as functions of the fourth minus ``center``.
    rest : the fourth combined equation on the curve, as such a function.
    """

    center: arb
    unknowns: Sequence[TaylorForm]
    rest: TaylorForm

    def find_place(self, t: arb) -> list[arb]:
        """Return an enclosure of the frame's coordinates on the curve
        while the fourth coordinate is in the ball t.
        """
        return [*(unknown.evaluate(t - self.center) for unknown in self.unknowns), t]

    def evaluate_equation(self, t: arb) -> arb:
        """Return an enclosure of the fourth equation on a ball t of the fourth coordinate."""
        return self.rest.evaluate(t - self.center)

    def evaluate_slope(self, t: arb) -> arb:
        """Return an enclosure of the derivative of the fourth equation on a ball t of the fourth
        coordinate.
        """
        return self.rest.evaluate_slope(t - self.center)

    def has_zero(self, t: arb) -> bool:
        """Return whether the fourth equation may be 0 somewhere in a ball t, by its values and by the mean
        value theorem."""
        middle = arb(t.mid())
        return bool(
            self.evaluate_equation(t).contains(0)
            and (self.evaluate_equation(middle) + self.evaluate_slope(t) * (t - middle)).contains(0)
        )

    def is_blurred(self, t: arb) -> bool:
        """Return whether the fourth equation's error at the midpoint of a ball t exceeds ``BLUR`` times its
        variation over t."""
        return bool(self.evaluate_equation(arb(t.mid())).rad() > BLUR * self.evaluate_equation(t).rad())


@contextmanager
def set_series_terms(count: int) -> Iterator[None]:
    """Limit python-flint's power series to ``count`` terms within a ``with`` block."""
    before, ctx.cap = ctx.cap, count
    try:
        yield
    finally:
        ctx.cap = before


def find_roots_on_curve(frame: SingularFrame, limits: Limits) -> list[list[arb]] | None:
    """Return parts of a box in the frame's coordinates, one for each solution that may be a fixture; each
    part has exactly one solution.

    Return None if it is not shown that the three well determined coordinates are a function of the fourth, or
    if the fourth equation is so near zero along the curve that ``MOST_PARTS`` parts do not decide.
    """
    *well, t = frame.make_start_box()
    well, is_curve = bound_along_curve(frame, well, t)
    whole = find_curve_about(frame, well, t) if is_curve else None
    if whole is None:
        return None
    waiting, roots = [(whole, t)], list[tuple[SolutionCurve, arb]]()
    for _ in range(MOST_PARTS):
        if not waiting:
            return [sharpen_root(frame, curve.find_place(root)) for curve, root in roots]
        curve, t = waiting.pop()
        if not curve.has_zero(t):
            continue
        found = isolate_root(curve, t)
        if found is None:
            place = curve.find_place(t)
            if not is_empty(frame.box, frame.compute_contacts(place), limits):
                if curve.is_blurred(t):
                    curve = find_curve_about(frame, place[:3], t) or curve
                waiting += [(curve, part) for (part,) in cut_in_thirds([t])]
        elif not any(is_same(whole, known, root) for _, known in roots for root in found):
            roots += [(curve, root) for root in found]
    return None


def is_same(curve: SolutionCurve, one: arb, other: arb) -> bool:
    """Return whether two balls with one root each certainly have the same root, which lies in both."""
    return bool(one.overlaps(other)) and not curve.evaluate_slope(one.union(other)).contains(0)


def isolate_root(curve: SolutionCurve, t: arb) -> list[arb] | None:
    """Return [a smaller ball around the one root in the ball t], an empty list where t has no root, None if
    undecided."""
    if curve.evaluate_slope(t).contains(0):
        return None
    is_root = False
    for _ in range(REFINEMENTS):
        middle = arb(t.mid())
        image = middle - curve.evaluate_equation(middle) / curve.evaluate_slope(t)
        if not image.overlaps(t):
            return []
        is_root = is_root or t.contains_interior(image)
        smaller = image if t.contains(image) else t.intersection(image)
        if not is_smaller([smaller], [t]):
            break
        t = smaller
    return [t] if is_root else None


def sharpen_root(frame: SingularFrame, place: list[arb]) -> list[arb]:
    """Return a smaller box around the one root in a place (four balls), found on the curve expanded anew
    about the place."""
    for _ in range(SHARPENINGS):
        curve = find_curve_about(frame, place[:3], place[3])
        found = isolate_root(curve, place[3]) if curve is not None and place[3].rad() > SHARP else None
        if curve is None or not found:
            break
        place = curve.find_place(found[0])
    return place


def find_curve_about(frame: SingularFrame, well: list[arb], t: arb) -> SolutionCurve | None:
    """Return the solution curve for the fourth coordinate in the ball t; None where no power series is found.

    ``well`` are balls of the other three coordinates, which must hold the curve over t.
    """
    middle = arb(t.mid())
    whole, begun = bound_along_curve(frame, well, t)[0], bound_along_curve(frame, well, middle)[0]
    with set_series_terms(ORDER + 1):
        at_middle, anywhere = expand_power_series(frame, begun, middle), expand_power_series(frame, whole, t)
    if at_middle is None or anywhere is None:
        return None
    forms = [TaylorForm(near[:ORDER], far[ORDER]) for near, far in zip(at_middle, anywhere, strict=True)]
    return SolutionCurve(middle, forms[:3], forms[3])


def bound_along_curve(frame: SingularFrame, well: list[arb], t: arb) -> tuple[list[arb], bool]:
    """Return (1) the part of the three other coordinates that solutions may have while the fourth is in the
    ball t, and (2) whether a curve of such points certainly exists there.

    It exists where a step of Hansen and Sengupta in three unknowns maps the part into its own inside, for
    every t alike: there is exactly one point for each t. By the implicit function theorem these points make a
    smooth curve.
    """
    is_curve, middle_t = False, arb(t.mid())
    for _ in range(MOST_STEPS):
        middle = [arb(p.mid()) for p in well]
        slopes = frame.evaluate_jacobian(frame.compute_contacts([*well, t]))
        values = frame.evaluate_equations([*middle, middle_t])
        inverse = invert_jacobian(slopes, middle=True)
        if inverse is None:
            break
        off = inverse * arb_mat(3, 1, [values[k] + slopes[k][3] * (t - middle_t) for k in range(3)])
        matrix = inverse * arb_mat([row[:3] for row in slopes[:3]])
        if any(matrix[k, k].contains(0) for k in range(3)):
            break
        out, inside = take_newton_step(well, off.entries(), matrix.tolist())
        if out is None:
            break
        is_curve, before, well = is_curve or inside, well, out
        if not is_smaller(well, before):
            break
    return well, is_curve


def invert_jacobian(slopes: Sequence[Sequence[arb]], middle: bool = False) -> Any:
    """Return the inverse of the Jacobian of the first three equations by three coordinates; None where it
    cannot be shown to be regular.

    With ``middle``, return instead an exact matrix near the inverse of the Jacobian's midpoint.
    """
    matrix = arb_mat([row[:3] for row in slopes[:3]])
    try:
        return matrix.mid().inv().mid() if middle else matrix.inv()
    except ZeroDivisionError:
        return None


def expand_power_series(frame: SingularFrame, well: list[arb], t: arb) -> list[list[arb]] | None:
    """Return four power series in the fourth coordinate: of the three well determined coordinates, and of the
    fourth equation.

    They are about a point of the curve, or about all points in a part of it (``well`` and t); ORDER + 1
    coefficients each. Return None where the Jacobian is singular. The residual of order k of the three
    equations is linear in the coefficients of order k. So these are found one after the other.
    """
    inverse = invert_jacobian(frame.evaluate_jacobian(frame.compute_contacts([*well, t])))
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
    """Return the four combined contact equations at power series of the frame's coordinates."""
    turn, *steps = multiply_series(frame.turning, place)
    unknowns = [m + s for m, s in zip(frame.box.middle, [turn / frame.length, *steps], strict=True)]
    return multiply_series(frame.combining, compute_contact_values(frame.box, unknowns))


def multiply_series(matrix: Any, vector: Sequence[Any]) -> list[Any]:
    """Return the product of a 4 x 4 matrix of balls with a vector of four power series."""
    rows = matrix.tolist()
    return [sum((a * b for a, b in zip(row, vector, strict=True)), arb_series([0])) for row in rows]
