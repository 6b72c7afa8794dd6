"""The four contact equations of a fixture in its unknowns theta, x, y and travel.

A workpiece point q lies at R(theta) q + t, t = (x, y), and a peg that moves at its hole's place plus S times its way, S
being the travel: of a vise the jaw separation, of a clamp how far its tip is from its hole. With u the vector from t to the
peg's centre, N = R n and C = R c, a peg of radius rho touches

- a line with outward normal n and level l when N · u - l - rho = 0;
- an arc about c when (|u - C|² - reach²) / 2 = 0, reach = r + rho on a convex and r - rho on a concave arc.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from attrs import field, frozen
from flint import arb, arb_mat

from workhold.model.flat import Flat
from workhold.verification.balls import Point, cross, dot, turned
from workhold.verification.sides import LineSide, Side

__all__ = ["Contact", "Pose", "contact_system", "standing_contact", "standoff"]


@frozen(eq=False)
class Pose:
    """Unknowns of a fixture: orientation in radians (cosine and sine with it), place and travel in mm."""

    theta: arb
    x: arb
    y: arb
    travel: arb
    cosine: arb
    sine: arb

    @classmethod
    def of(cls, theta: arb, x: arb, y: arb, travel: arb) -> Pose:
        """The pose with its cosine and sine."""
        return cls(theta, x, y, travel, theta.cos(), theta.sin())


@frozen(eq=False)
class Contact:
    """A peg that touches a side.

    Parameters
    ----------
    hole : where it is in mm without any travel.
    way : unit vector along which it moves as the travel grows; (0, 0) where it stands still.
    side : the face touched.
    radius : in mm, how far the peg's centre is from the side: its radius, or of a flat on a line the flat's distance.
    body : radius of the peg in mm where it has a flat, which its body keeps of all else; None where that is ``radius``.
    """

    hole: Point
    way: Point
    side: Side
    radius: arb
    body: arb | None = field(default=None, kw_only=True)

    is_flush: ClassVar[bool] = False

    @property
    def clear_radius(self) -> arb:
        """Radius in mm of what must be clear of all else."""
        return self.radius if self.body is None else self.body

    @property
    def size(self) -> arb:
        """Of the side: the length of a straight one, an arc's radius; in mm."""
        return self.side.length if isinstance(self.side, LineSide) else self.side.radius

    def outward(self, pose: Pose) -> Point:
        """The outward unit normal at the contact, in the workpiece's frame."""
        return self.side.outward(self.in_part(pose))

    def from_origin(self, pose: Pose) -> Point:
        """Vector in the toolkit's frame from the workpiece's origin to the peg's centre, in mm."""
        x, y = self.place(pose)
        return x - pose.x, y - pose.y

    def place(self, pose: Pose) -> Point:
        """The peg's centre in the toolkit's frame, in mm."""
        return self.hole[0] + self.way[0] * pose.travel, self.hole[1] + self.way[1] * pose.travel

    def in_part(self, pose: Pose) -> Point:
        """The peg's centre in the workpiece's frame, in mm."""
        return turned(self.from_origin(pose), pose.cosine, -pose.sine)

    def equation(self, pose: Pose) -> tuple[arb, list[arb]]:
        """Value of the contact equation, and its derivatives by theta, x, y and travel."""
        u, side = self.from_origin(pose), self.side
        if isinstance(side, LineSide):
            n = turned(side.normal, pose.cosine, pose.sine)
            value = dot(n, u) - side.level - self.radius
            return value, [cross(n, u), -n[0], -n[1], dot(self.way, n)]
        c = turned(side.center, pose.cosine, pose.sine)
        w = u[0] - c[0], u[1] - c[1]
        value = (dot(w, w) - side.reach(self.radius) ** 2) / 2
        return value, [cross(w, c), -w[0], -w[1], dot(self.way, w)]


def standing_contact(hole: Point, way: Point, side: Side, peg_radius: float, flat: Flat | None) -> Contact:
    """The contact of a peg, round or with a flat, which lies on lines."""
    return Contact(hole, way, side, standoff(side, peg_radius, flat), body=None if flat is None else arb(peg_radius))


def standoff(side: Side, peg_radius: float, flat: Flat | None) -> arb:
    """Distance in mm from a side to the centre of a peg that touches it, round or with a flat."""
    return arb(flat.distance if flat is not None and isinstance(side, LineSide) else peg_radius)


def contact_system(contacts: Sequence[Contact], unknowns: arb_mat) -> tuple[arb_mat, arb_mat]:
    """Values (4 x 1) and Jacobian (4 x 4) of the contact equations on a box (4 x 1) of unknowns."""
    pose = Pose.of(*unknowns.entries())
    rows = [contact.equation(pose) for contact in contacts]
    return arb_mat(4, 1, [value for value, _ in rows]), arb_mat([slopes for _, slopes in rows])
