"""The contact equations of a fixture in its unknowns theta, x, y and the travels of what moves.

A workpiece point q lies at R(theta) q + t, t = (x, y), and a peg that moves at its hole's place plus S times its way, S
being its travel: of jaws the separation, of a clamp how far its tip is from its hole. With u the vector from t to the
peg's centre, N = R n and C = R c, a peg of radius rho touches

- a line with outward normal n and level l when N · u - l - rho = 0;
- an arc about c when (|u - C|² - reach²) / 2 = 0, reach = r + rho on a convex and r - rho on a concave arc.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from attrs import field, frozen
from flint import arb, arb_mat

from workhold.fixels.flat import Flat
from workhold.model import fixture as model
from workhold.verification.balls import Point, cross, dot, turned
from workhold.verification.sides import LineSide, Side

__all__ = ["BallContact", "BallPose", "contact_system", "standoff"]


@frozen(eq=False)
class BallPose:
    """Unknowns of a fixture: orientation in radians (cosine and sine with it), place and travels in mm."""

    theta: arb
    x: arb
    y: arb
    travels: tuple[arb, ...]
    cosine: arb
    sine: arb

    @classmethod
    def of(cls, theta: arb, x: arb, y: arb, *travels: arb) -> BallPose:
        """The pose with its cosine and sine."""
        return cls(theta, x, y, travels, theta.cos(), theta.sin())

    @classmethod
    def written(cls, pose: model.Pose) -> BallPose:
        """The pose of a file as the numbers that it is, without any travel."""
        return cls.of(arb(pose.theta_deg) * arb.pi() / 180, arb(pose.x), arb(pose.y), arb(0))


@frozen(eq=False)
class BallContact:
    """A peg that touches a side.

    Parameters
    ----------
    hole : where it is in mm without any travel.
    way : unit vector along which it moves as the travel grows; (0, 0) where it stands still.
    side : the face touched.
    radius : in mm, how far the peg's centre is from the side: its radius, or of a flat on a line the flat's distance.
    body : radius of the peg in mm where it has a flat, which its body keeps of all else; None where that is ``radius``.
    travel : the number of its travel among those of a pose.
    """

    hole: Point
    way: Point
    side: Side
    radius: arb
    body: arb | None = field(default=None, kw_only=True)
    travel: int = field(default=0, kw_only=True)

    is_flush: ClassVar[bool] = False

    @property
    def clear_radius(self) -> arb:
        """Radius in mm of what must be clear of all else."""
        return self.radius if self.body is None else self.body

    @property
    def size(self) -> arb:
        """Of the side: the length of a straight one, an arc's radius; in mm."""
        return self.side.length if isinstance(self.side, LineSide) else self.side.radius

    def outward(self, pose: BallPose) -> Point:
        """The outward unit normal at the contact, in the workpiece's frame."""
        return self.side.outward(self.in_part(pose))

    def from_origin(self, pose: BallPose) -> Point:
        """Vector in the toolkit's frame from the workpiece's origin to the peg's centre, in mm."""
        x, y = self.place(pose)
        return x - pose.x, y - pose.y

    def place(self, pose: BallPose) -> Point:
        """The peg's centre in the toolkit's frame, in mm."""
        travelled = pose.travels[self.travel]
        return self.hole[0] + self.way[0] * travelled, self.hole[1] + self.way[1] * travelled

    def in_part(self, pose: BallPose) -> Point:
        """The peg's centre in the workpiece's frame, in mm."""
        return turned(self.from_origin(pose), pose.cosine, -pose.sine)

    def equation(self, pose: BallPose) -> tuple[arb, list[arb]]:
        """Value of the contact equation, and its derivatives by theta, x, y and its travel."""
        u, side = self.from_origin(pose), self.side
        if isinstance(side, LineSide):
            n = turned(side.normal, pose.cosine, pose.sine)
            value = dot(n, u) - side.level - self.radius
            return value, [cross(n, u), -n[0], -n[1], dot(self.way, n)]
        c = turned(side.center, pose.cosine, pose.sine)
        w = u[0] - c[0], u[1] - c[1]
        value = (dot(w, w) - side.reach(self.radius) ** 2) / 2
        return value, [cross(w, c), -w[0], -w[1], dot(self.way, w)]


def standoff(side: Side, peg_radius: float, flat: Flat | None) -> arb:
    """Distance in mm from a side to the centre of a peg that touches it, round or with a flat."""
    return arb(flat.distance if flat is not None and isinstance(side, LineSide) else peg_radius)


def contact_system(contacts: Sequence[BallContact], unknowns: arb_mat) -> tuple[arb_mat, arb_mat]:
    """Values (N x 1) and Jacobian (N x N) of the contact equations on a box (N x 1) of angle, x, y and travels."""
    pose = BallPose.of(*unknowns.entries())
    values, rows = [], []
    for contact in contacts:
        value, (*slopes, along) = contact.equation(pose)
        values.append(value)
        rows.append([*slopes, *(along if k == contact.travel else arb(0) for k in range(len(pose.travels)))])
    return arb_mat(len(values), 1, values), arb_mat(rows)
