"""The four contact equations of a fixture in its unknowns theta, x, y and jaw separation.

A workpiece point q lies at R(theta) q + t, t = (x, y), and a right peg at its hole's place for S = 0 plus (S, 0). With u the
vector from t to the peg's centre, N = R n and C = R c, a peg of radius rho touches

- a line with outward normal n and level l when N · u - l - rho = 0;
- an arc about c when (|u - C|² - reach²) / 2 = 0, reach = r + rho on a convex and r - rho on a concave arc.
"""

from __future__ import annotations

from collections.abc import Sequence

from attrs import frozen
from flint import arb, arb_mat

from workhold.verification.balls import Point, turned
from workhold.verification.sides import LineSide, Side

__all__ = ["Contact", "Pose", "contact_system"]


@frozen(eq=False)
class Pose:
    """Unknowns of a fixture: orientation in radians (cosine and sine with it), place and jaw separation in mm."""

    theta: arb
    x: arb
    y: arb
    separation: arb
    cosine: arb
    sine: arb

    @classmethod
    def of(cls, theta: arb, x: arb, y: arb, separation: arb) -> Pose:
        """The pose with its cosine and sine."""
        return cls(theta, x, y, separation, theta.cos(), theta.sin())


@frozen(eq=False)
class Contact:
    """A peg that touches a side.

    Parameters
    ----------
    hole : place of its hole in mm when the jaw separation is 0.
    right : 1 on the right jaw, which moves with the jaw separation, 0 on the left one.
    side : the face touched.
    radius : of the peg, in mm.
    """

    hole: Point
    right: int
    side: Side
    radius: arb

    def from_origin(self, pose: Pose) -> Point:
        """Vector in the vise frame from the workpiece's origin to the peg's centre, in mm."""
        return self.hole[0] + self.right * pose.separation - pose.x, self.hole[1] - pose.y

    def in_part(self, pose: Pose) -> Point:
        """The peg's centre in the workpiece's frame, in mm."""
        return turned(self.from_origin(pose), pose.cosine, -pose.sine)

    def equation(self, pose: Pose) -> tuple[arb, list[arb]]:
        """Value of the contact equation, and its derivatives by theta, x, y and separation."""
        u, side = self.from_origin(pose), self.side
        if isinstance(side, LineSide):
            n = turned(side.normal, pose.cosine, pose.sine)
            value = n[0] * u[0] + n[1] * u[1] - side.level - self.radius
            return value, [n[0] * u[1] - n[1] * u[0], -n[0], -n[1], self.right * n[0]]
        c = turned(side.center, pose.cosine, pose.sine)
        w = u[0] - c[0], u[1] - c[1]
        value = (w[0] * w[0] + w[1] * w[1] - side.reach(self.radius) ** 2) / 2
        return value, [w[0] * c[1] - w[1] * c[0], -w[0], -w[1], self.right * w[0]]


def contact_system(contacts: Sequence[Contact], unknowns: arb_mat) -> tuple[arb_mat, arb_mat]:
    """Values (4 x 1) and Jacobian (4 x 4) of the contact equations on a box (4 x 1) of unknowns."""
    pose = Pose.of(*unknowns.entries())
    rows = [contact.equation(pose) for contact in contacts]
    return arb_mat(4, 1, [value for value, _ in rows]), arb_mat([slopes for _, slopes in rows])
