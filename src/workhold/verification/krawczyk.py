"""A proof that a square system of equations has exactly one solution in a box.

Theorem (Krawczyk 1969): let f be continuously differentiable on a box X with midpoint m, J(X) an enclosure of its Jacobian
on X and Y any matrix. If

    K = m - Y f(m) + (I - Y J(X)) (X - m)

lies in the interior of X, then f has exactly one zero in X, and it lies in K.

References
----------
R. Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken", Computing 4 (1969) 187-201.
S. M. Rump, "Verification methods", Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import arb, arb_mat, ctx

__all__ = ["certified_zero"]

# Values (N x 1) and Jacobian (N x N) of a system on a box (N x 1) of unknowns.
System = Callable[[arb_mat], tuple[arb_mat, arb_mat]]

MOST_STEPS = 12


def certified_zero(system: System, start: Sequence[float]) -> list[arb] | None:
    """A proven enclosure of the one zero near a start, or None when there is no proof at the precision in force.

    Newton's method on midpoints finds a place; the proof does not depend on how it was found. The box around it has half
    the digits of the precision as its radius.
    """
    size = len(start)
    middle = arb_mat(size, 1, list(start))
    small = arb(2) ** (-ctx.prec // 2)
    try:
        for _ in range(MOST_STEPS):
            values, jacobian = system(middle)
            step = jacobian.mid().solve(values.mid()).mid()
            middle = (middle - step).mid()
            if all(abs(entry) < small * small * 2**16 for entry in step.entries()):
                break
        values, jacobian = system(middle)
        inverse = jacobian.mid().inv().mid()
    except ZeroDivisionError:
        return None
    around = arb_mat(size, 1, [arb(0, small) for _ in range(size)])
    box = middle + around
    identity = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
    image = middle - inverse * values + (identity - inverse * system(box)[1]) * around
    inner = zip(box.entries(), image.entries(), strict=True)
    return image.entries() if all(outer.contains_interior(k) for outer, k in inner) else None
