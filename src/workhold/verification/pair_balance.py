"""How three locators and two clamps press on the workpiece when nothing else does, in balls."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from attrs import frozen
from flint import arb

from workhold.verification.balls import Point, dot, turned
from workhold.verification.closure import inverted
from workhold.verification.contacts import Contact, Pose
from workhold.verification.seat import Push, Ratio, Seat, closure_margin
from workhold.verification.wrench_radius import radius_of_five

__all__ = ["PairBalance", "push_of", "seat_of"]

LOCATORS = 3


def seat_of(contacts: Sequence[Contact], pose: Pose) -> Seat:
    """The seat of three locators, or of the two ends of a wall's contact and one."""
    return Seat([contact.in_part(pose) for contact in contacts], [contact.outward(pose) for contact in contacts])


def push_of(contact: Contact, pose: Pose, seat: Seat) -> Push:
    """What a clamp does at a seat; it pushes along -n, and clamps against its way."""
    point = contact.in_part(pose)
    normal = contact.side.outward(point)
    return Push(seat.taken(point, normal), dot(turned(contact.way, pose.cosine, -pose.sine), normal))


@frozen(eq=False)
class PairBalance:
    """How five contacts press.

    Parameters
    ----------
    points, normals : the pegs' centres in mm and the outward unit normals, in the workpiece's frame.
    seat : the locators, of which a wall's ends are two.
    pushes : both clamps.
    ratio : in which their forces may be.
    """

    points: Sequence[Point]
    normals: Sequence[Point]
    seat: Seat
    pushes: tuple[Push, Push]
    ratio: Ratio

    @cached_property
    def reactions(self) -> list[tuple[arb, arb]]:
        """Of each peg its force per unit of the first clamp's, and of the second's."""
        one, other = self.pushes
        own = [(1 / one.push, arb(0)), (arb(0), 1 / other.push)]
        return [*zip(one.reactions, other.reactions, strict=True), *own]

    @cached_property
    def forces(self) -> list[arb]:
        """Force of each peg per unit of both clamps' at the working ratio."""
        first, second = self.ratio.forces
        return [first * a + second * b for a, b in self.reactions]

    @cached_property
    def shares(self) -> list[arb]:
        """The forces scaled to sum 1."""
        total = sum(self.forces, arb(0))
        return [force / total for force in self.forces]

    @cached_property
    def margin(self) -> arb:
        """The closure margin."""
        return closure_margin(*self.pushes)

    def inverse(self, contacts: Sequence[Contact], pose: Pose) -> list[list[arb]] | None:
        """The inverse of the locators' wrenches, which alone tell where the part is; None where there may be none."""
        return inverted([list(wrench) for wrench in self.seat.wrenches])

    def of_all(self, row: Sequence[arb]) -> Sequence[arb]:
        """A number for each peg, from a row of the inverse: clamps that keep their force take nothing of a load."""
        return [*row, arb(0), arb(0)]

    def kept_by_closing(self, forces: Sequence[arb]) -> list[arb]:
        """The part of some forces that lies in the plane of those with which both clamps press."""
        ones, others = zip(*self.reactions, strict=True)
        aa, ab, bb = inner(ones, ones), inner(ones, others), inner(others, others)
        fa, fb, area = inner(forces, ones), inner(forces, others), aa * bb - ab * ab
        u, v = (fa * bb - fb * ab) / area, (fb * aa - fa * ab) / area
        return [u * a + v * b for a, b in self.reactions]

    def wrench_radius(self, center: Point, length: float) -> arb | None:
        """The wrench radius, about a centre with L in mm; None where all wrenches may lie in one line."""
        return radius_of_five(center, length, self.points, self.normals)


def inner(a: Sequence[arb], b: Sequence[arb]) -> arb:
    """Scalar product of two rows."""
    return sum((p * q for p, q in zip(a, b, strict=True)), arb(0))
