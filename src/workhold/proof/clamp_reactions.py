"""What locators take up of a clamp's force, to the last digit: in ball arithmetic, where doubles are not enough.

Whether two clamps close is often a matter of an exact zero, as where a clamp's line of force passes through the point in
which those of two locators meet. Rounding a drawing's numbers once more leaves such a zero far below what decides. And a
clamp that nearly grazes an arc has its place, and so the share of its force that pushes, off by rounding over that share.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from attrs import frozen
from flint import arb, ctx

from workhold.kernels.base.given import Limits
from workhold.proof.interval_newton import PRECISIONS, BoxContacts, CandidateBox, SingularFrame, places, refined

__all__ = ["SharpReactions", "rounded", "sharp_reactions"]

LOCATORS = 3
# Steps in which a box shrinks to one solution, if it ever does.
MOST_STEPS = 24
# Half units in the last place of a double.
ROUNDING = 2.3e-16


@frozen
class SharpReactions:
    """Forces of three locators per unit of a clamp's force on its face, how far each may be off, and the clamp's push.

    The push is the share of the clamp's own force that such a unit is.
    """

    taken: tuple[float, float, float]
    doubt: float
    push: float


def sharp_reactions(box: CandidateBox, limits: Limits) -> SharpReactions | None:
    """The reactions at the one solution of a box of three locators and a clamp; None where it cannot be made out."""
    with ctx.workprec(PRECISIONS[-1]):
        frame = SingularFrame.of(box, limits)
        place: list[arb] | None = frame.start()
        for _ in range(MOST_STEPS):
            assert place is not None
            place, unique = frame.step(place, frame.places(place))
            if place is None:
                return None
            if unique:
                here = places(box, frame.unknowns(refined(frame, place)))
                (x, y), (along, across) = here.normals[LOCATORS], here.axis
                return rounded(reactions(here), int(limits.clamping) * (x * along + y * across))
    return None


def reactions(here: BoxContacts) -> list[arb]:
    """Solution a of w_1 a_1 + w_2 a_2 + w_3 a_3 = -w by Cramer's rule, w the clamp's wrench about the first peg."""
    wrenches = [(n[0], n[1], q[0] * n[1] - q[1] * n[0]) for q, n in zip(here.arms, here.normals, strict=True)]
    whole = determinant(wrenches[:LOCATORS])
    out = []
    for k in range(LOCATORS):
        columns = list(wrenches[:LOCATORS])
        columns[k] = wrenches[LOCATORS]
        out.append(-determinant(columns) / whole)
    return out


def determinant(v: Sequence[tuple[arb, arb, arb]]) -> arb:
    """The determinant of three vectors."""
    one, two, three = v
    return (
        one[0] * (two[1] * three[2] - two[2] * three[1])
        - one[1] * (two[0] * three[2] - two[2] * three[0])
        + one[2] * (two[0] * three[1] - two[1] * three[0])
    )


def rounded(values: Sequence[arb], push: arb) -> SharpReactions:
    """Balls of reactions and of the push as doubles."""
    a, b, c = (float(value.mid()) for value in values)
    doubt = max(float(value.rad()) + ROUNDING * abs(float(value.mid())) for value in values)
    return SharpReactions((a, b, c), doubt if doubt == doubt else inf, float(push.mid()))
