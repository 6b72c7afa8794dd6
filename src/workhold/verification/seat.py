"""A seat, three locators that fix the pose by themselves, and two clamps that press the part against them, in balls.

With the wrenches w_i = (n_i, q_i x n_i) of the locators and W = [w_1 w_2 w_3], the locators take up a = -W^-1 w per unit
of force on the face of a clamp with the wrench w, and b = a / p per unit of its own force, p being its push: the share of
that along its direction. With forces f1, f2 of two clamps they carry b1 f1 + b2 f2. None of this depends on the point that
moments are taken about or, but for det W, on their scale.

Glossary
--------
taken : a, what the locators take up of a unit on a clamp's face.
reactions : b, their forces per unit of a clamp's own.
ratio : the open interval of f2 / f1 in which all three locators are pressed.
freedom : how far apart the ends of that interval are as angles, in degrees.
working ratio : its middle as an angle.
closure margin : the largest least entry of null vectors of all five wrenches that sum to 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations

from attrs import frozen
from flint import arb

from workhold.verification.balls import Point, cross, least
from workhold.verification.rules import NO_REACTION

__all__ = ["Push", "Ratio", "Seat", "closure_margin", "ratio_of"]

LOCATORS = 3


@frozen(eq=False)
class Seat:
    """Three locators.

    Parameters
    ----------
    points, normals : their centres in mm, or the points that touch a wall, and the outward unit normals there, in the
        workpiece's frame.
    """

    points: Sequence[Point]
    normals: Sequence[Point]

    @cached_property
    def wrenches(self) -> list[tuple[arb, arb, arb]]:
        """Normals, and moments about the workpiece's origin in mm."""
        return [(*n, cross(q, n)) for q, n in zip(self.points, self.normals, strict=True)]

    @cached_property
    def determinant(self) -> arb:
        """Of the three wrenches, in mm."""
        return determinant(self.wrenches)

    def taken(self, point: Point, normal: Point) -> tuple[arb, arb, arb]:
        """What the locators take up per unit of force on the face of a clamp at a point, by Cramer's rule."""
        own = (*normal, cross(point, normal))
        replaced = (determinant([*self.wrenches[:k], own, *self.wrenches[k + 1 :]]) for k in range(LOCATORS))
        a, b, c = (-value / self.determinant for value in replaced)
        return a, b, c


def determinant(vectors: Sequence[tuple[arb, arb, arb]]) -> arb:
    """The determinant of three vectors."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = vectors
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


@frozen(eq=False)
class Push:
    """A clamp at a seat.

    Parameters
    ----------
    taken : by the locators per unit of force on its face.
    push : the share of its own force that a unit on its face is.
    """

    taken: tuple[arb, arb, arb]
    push: arb

    @cached_property
    def reactions(self) -> list[arb]:
        """Forces of the locators per unit of the clamp's own."""
        return [entry / self.push for entry in self.taken]

    @cached_property
    def alone(self) -> arb:
        """The least that a locator takes up as a share of all forces: above zero where the clamp holds the part alone."""
        a, b, c = self.taken
        return a.min(b).min(c) / (1 + abs(a) + abs(b) + abs(c))


@frozen(eq=False)
class Ratio:
    """The open interval of the second clamp's force over the first's in which all locators are pressed.

    Parameters
    ----------
    low : its lower end.
    high : its upper end, None where there is none.
    """

    low: arb
    high: arb | None

    @property
    def angles(self) -> tuple[arb, arb]:
        """Its ends as angles in radians."""
        return self.low.atan(), arb.pi() / 2 if self.high is None else self.high.atan()

    @property
    def freedom(self) -> arb:
        """The angle in degrees between its ends, negative where no ratio is in it."""
        low, high = self.angles
        return (high - low) * 180 / arb.pi()

    @property
    def forces(self) -> tuple[arb, arb]:
        """The forces of both clamps per unit of their sum at the working ratio."""
        low, high = self.angles
        sine, cosine = ((low + high) / 2).sin_cos()
        return cosine / (cosine + sine), sine / (cosine + sine)


def ratio_of(one: Push, other: Push) -> Ratio | None:
    """The interval for two clamps; None where a reaction is exactly at the edge of what counts as none."""
    low, high = arb(0), None
    for first, second in zip(one.reactions, other.reactions, strict=True):
        a, b = settled(first), settled(second)
        if a is None or b is None:
            return None
        if b > 0:
            low = low.max(-a / b)
        elif b < 0:
            high = -a / b if high is None else high.min(-a / b)
        elif not a > 0:
            high = arb(0)
    return Ratio(low, high)


def settled(reaction: arb) -> arb | None:
    """A reaction, 0 for one that counts as none; None where that is not certain."""
    size = abs(reaction)
    return arb(0) if size < NO_REACTION else reaction if size > NO_REACTION else None


def closure_margin(one: Push, other: Push) -> arb:
    """The largest least entry of null vectors of all five wrenches that sum to 1; 0 or less where none is positive.

    They are (1 - s) (a1, 1, 0) + s (a2, 0, 1), scaled. Over 0 <= s <= 1 every entry is linear before scaling, so the least
    of them is the largest where two are equal. Two whose difference may be constant are equal nowhere or everywhere, and
    then another two are where it counts.
    """
    ends = list(zip((*one.taken, arb(1), arb(0)), (*other.taken, arb(0), arb(1)), strict=True))
    best = arb(0)
    for (a, b), (c, d) in combinations(ends, 2):
        before, behind = a - c, b - d
        slope = before - behind
        if not (slope > 0 or slope < 0):
            continue
        share = before / slope
        if share < 0 or share > 1:
            continue
        entries = [p + share * (q - p) for p, q in ends]
        total = sum(entries, arb(0))
        if total > 0:
            best = best.max(least(entries) / total)
    return best
