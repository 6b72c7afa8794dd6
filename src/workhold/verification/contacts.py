"""The contacts of a fixture in ball arithmetic: equations, frictionless force closure, forces, wrench radius.

The equations (model: condition 1) are in the unknowns theta, x, y and the travels of the moving carriers. A
workpiece point q lies at R(theta) q + t, t = (x, y). A moving peg is at its hole's place plus its travel S
times its way, a unit vector. For jaws the travel is the separation; for a clamp it is the distance of its tip
from its hole. With u the vector from t to the peg's centre, N = R n and C = R c, a peg of radius rho touches

- a line with outward normal n and level l when N · u - l - rho = 0;
- an arc about c when (|u - C|² - reach²) / 2 = 0, reach = r + rho on a convex and r - rho on a concave arc.

Force closure and forces (model: conditions 4 and 5) follow from the null vector of four wrenches (n, q x n),
which the signed 3 x 3 minors give. It does not depend on the reference point of moments nor on their scale,
because both change the matrix by invertible row operations only.

Carriers with heights of their own touch further outlines of the part. The segments of these have numbers
above those of the first outline; equal outlines share their numbers. So a face's number says which outline
the face is of, and a table by face number holds the faces of all outlines. A peg keeps clear of its own
carrier's outline.

Glossary
--------
wrench radius : distance from the origin to the nearest facet of the hull of the wrenches, no unit. A wrench
    here is (n, (q - c) x n / L), c being the centre of the part's bounding box.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations
from typing import Any, ClassVar

from attrs import evolve, field, frozen
from flint import arb, arb_mat

from workhold.fixels.pegs import PegFlat
from workhold.model.pose import Pose
from workhold.model.workpiece import Workpiece
from workhold.verification.ball_geometry import (
    BallOutline,
    LineSide,
    Point,
    Side,
    compute_dot_product,
    compute_square_root,
    cross,
    find_largest,
    find_least,
    subtract,
    turn_vector,
)
from workhold.verification.tolerances import (
    FIGURE_AGREEMENT,
    FLAT,
    LEAST_CLAMPING,
    LEAST_SHARE,
    LEAST_SPAN,
    ROUNDING,
    Finding,
    format_middle,
    judge_slack,
)

__all__ = [
    "Balance",
    "BallContact",
    "BallPose",
    "judge_closure",
    "evaluate_contact_system",
    "make_joint_outline",
    "compute_inner_product",
    "invert_matrix",
    "select_outline_for",
    "compute_minors",
    "bound_relative_error",
    "measure_wrench_span",
    "compute_standoff",
    "compute_wrench_radius",
]


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
    def from_turn_and_place(cls, theta: arb, x: arb, y: arb, *travels: arb) -> BallPose:
        """Return the pose with theta in radians, x, y and travels in mm, and its cosine and sine."""
        return cls(theta, x, y, travels, theta.cos(), theta.sin())

    @classmethod
    def from_written(cls, pose: Pose) -> BallPose:
        """Return the pose of a file as exact numbers, with one travel of 0."""
        return cls.from_turn_and_place(arb(pose.theta_deg) * arb.pi() / 180, arb(pose.x), arb(pose.y), arb(0))


@frozen(eq=False)
class BallContact:
    """A peg that touches a side.

    Parameters
    ----------
    hole : centre of the peg's hole in the toolkit's frame, in mm, at travel 0.
    way : unit vector along which the peg moves as the travel grows; (0, 0) for a fixed peg.
    side : the face touched.
    radius : distance in mm of the peg's centre from the side: the peg radius or, for a flat that lies on a
        line, the distance of the flat from the centre.
    body : for a peg with a flat, the radius in mm to be kept clear of all other sides; None if that is
        ``radius``.
    travel : index, from 0, of the peg's travel among the travels of a pose.
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
        """The radius in mm around the peg's centre that must be clear of all other sides."""
        return self.radius if self.body is None else self.body

    @property
    def size(self) -> arb:
        """The length of a straight side, or the radius of an arc, in mm."""
        return self.side.length if isinstance(self.side, LineSide) else self.side.radius

    def compute_outward_normal(self, pose: BallPose) -> Point:
        """Return the outward unit normal at the contact, in the workpiece's frame."""
        return self.side.compute_outward_normal(self.compute_center_in_part(pose))

    def measure_from_origin(self, pose: BallPose) -> Point:
        """Return the vector from the part's origin to the peg's centre, along the toolkit's axes, in mm."""
        x, y = self.compute_point(pose)
        return x - pose.x, y - pose.y

    def compute_point(self, pose: BallPose) -> Point:
        """Return the peg's centre in the toolkit's frame, in mm."""
        # Under straps nothing moves.
        travelled = pose.travels[self.travel] if pose.travels else arb(0)
        return self.hole[0] + self.way[0] * travelled, self.hole[1] + self.way[1] * travelled

    def compute_center_in_part(self, pose: BallPose) -> Point:
        """Return the peg's centre in the workpiece's frame, in mm."""
        return turn_vector(self.measure_from_origin(pose), pose.cosine, -pose.sine)

    def evaluate_equation(self, pose: BallPose) -> tuple[arb, list[arb]]:
        """Return the value of the contact equation and its four derivatives by
        theta, x, y and the contact's own travel.

        The value is in mm for a line and in mm² for an arc; it is 0 where the peg touches.
        """
        u, side = self.measure_from_origin(pose), self.side
        if isinstance(side, LineSide):
            n = turn_vector(side.normal, pose.cosine, pose.sine)
            value = compute_dot_product(n, u) - side.level - self.radius
            return value, [cross(n, u), -n[0], -n[1], compute_dot_product(self.way, n)]
        c = turn_vector(side.center, pose.cosine, pose.sine)
        w = subtract(u, c)
        value = (compute_dot_product(w, w) - side.compute_offset_radius(self.radius) ** 2) / 2
        return value, [cross(w, c), -w[0], -w[1], compute_dot_product(self.way, w)]


def compute_standoff(side: Side, peg_radius: float, flat: PegFlat | None) -> arb:
    """Return the distance in mm from a side to the centre of a peg that touches it.

    Two cases: (a) a peg with a flat on a straight side: the distance of the flat from the peg's centre; (b)
    otherwise: the peg radius.
    """
    return arb(flat.distance if flat is not None and isinstance(side, LineSide) else peg_radius)


def evaluate_contact_system(contacts: Sequence[BallContact], unknowns: arb_mat) -> tuple[arb_mat, arb_mat]:
    """Return (values (N, 1), Jacobian (N, N)) of the equations of N contacts on a box of unknowns (N, 1).

    The unknowns are theta in radians, then x, y and the travels in mm, each a ball; so the results enclose
    all values on the box.
    """
    pose = BallPose.from_turn_and_place(*unknowns.entries())
    values, rows = [], []
    for contact in contacts:
        value, (*slopes, along) = contact.evaluate_equation(pose)
        values.append(value)
        rows.append([*slopes, *(along if k == contact.travel else arb(0) for k in range(len(pose.travels)))])
    return arb_mat(len(values), 1, values), arb_mat(rows)


def compute_minors(points: Sequence[Point], normals: Sequence[Point]) -> list[arb]:
    """Return the null vector in mm of the four wrenches (n, q x n), one for each point q and unit normal n.

    Entry i is (-1)^i times the determinant of the three wrenches other than wrench i.
    """
    wrenches = [(*n, cross(q, n)) for q, n in zip(points, normals, strict=True)]
    return [(-1) ** i * arb_mat([*wrenches[:i], *wrenches[i + 1 :]]).det() for i in range(4)]


def measure_wrench_span(vector: Sequence[arb], wrench_length: float) -> arb:
    """Return the sum of the absolute values of ``vector``, divided by ``wrench_length`` (L in mm).

    ``vector`` holds the four minors from :func:`compute_minors`. The result has no unit and is 0 where the
    four wrenches span less than three dimensions.
    """
    return sum((abs(entry) for entry in vector), arb(0)) / wrench_length


@frozen(eq=False)
class Balance:
    """The forces with which four contacts press on the workpiece when no load acts.

    Parameters
    ----------
    points, normals : the pegs' centres in mm and the outward unit normals, in the workpiece's frame.
    vector : the null vector of the wrenches, not scaled, see :func:`compute_minors`.
    shares : the null vector scaled to sum 1; no numbers where the sum may be 0.
    clamp : the clamping force that the moving contacts exert in total, for these shares.
    ways : for each peg the unit vector of its motion as the travel grows, in the workpiece's frame; (0, 0) if
        fixed.
    """

    points: tuple[Point, ...]
    normals: tuple[Point, ...]
    vector: tuple[arb, ...]
    shares: tuple[arb, ...]
    clamp: arb
    ways: tuple[Point, ...]

    @classmethod
    def from_contacts(cls, contacts: Sequence[BallContact], pose: BallPose, clamping: int) -> Balance:
        """Return the balance of four contacts; ``clamping`` is 1 where less
        travel clamps, -1 where more does.
        """
        points = tuple(contact.compute_center_in_part(pose) for contact in contacts)
        normals = tuple(contact.compute_outward_normal(pose) for contact in contacts)
        vector = tuple(compute_minors(points, normals))
        total = sum(vector, arb(0))
        shares = tuple(entry / total for entry in vector)
        # A peg pushes along -n, and clamps against its way.
        ways = tuple(turn_vector(contact.way, pose.cosine, -pose.sine) for contact in contacts)
        push = sum(
            (s * compute_dot_product(way, n) for s, way, n in zip(shares, ways, normals, strict=True)), arb(0)
        )
        return cls(points, normals, vector, shares, clamping * push, ways)

    @property
    def forces(self) -> list[arb]:
        """The force of each peg per unit of clamping force."""
        return [share / self.clamp for share in self.shares]

    @property
    def margin(self) -> arb:
        """The closure margin: the least of the shares."""
        return find_least(self.shares)

    @cached_property
    def inverse(self) -> list[list[arb]] | None:
        """The inverse of the 4 x 4 matrix of rows (n_x, n_y, q x n, n · w), see
        ``figures``; None if it may be singular.
        """
        contacts = zip(self.points, self.normals, self.ways, strict=True)
        return invert_matrix(
            [
                [*normal, cross(point, normal), compute_dot_product(way, normal)]
                for point, normal, way in contacts
            ]
        )

    @property
    def responses(self) -> list[list[arb]]:
        """Three rows: the force of each peg per unit of g_x, of g_y and of the moment of a load; [] if
        ``inverse`` is None.
        """
        return [] if self.inverse is None else self.inverse[:3]

    def project_on_closing(self, forces: Sequence[arb]) -> list[arb]:
        """Return the orthogonal projection of peg forces, one per peg, on the direction of the closing
        forces.

        It is the part of ``forces`` that a locked jaw takes up.
        """
        own = self.forces
        share = compute_inner_product(forces, own) / compute_inner_product(own, own)
        return [share * force for force in own]


def bound_relative_error(forces: Sequence[arb]) -> arb:
    """Return the relative error within which forces and figures in the file must agree with the derived ones.

    ``forces`` are the peg forces per unit of clamping force. The rounding of the written pose is amplified by
    the square of the largest of them.
    """
    amplification = find_largest(forces)
    return FIGURE_AGREEMENT + ROUNDING * amplification * amplification


def compute_inner_product(a: Sequence[arb], b: Sequence[arb]) -> arb:
    """Return the inner product of two vectors of equal length."""
    return sum((p * q for p, q in zip(a, b, strict=True)), arb(0))


def invert_matrix(rows: list[list[arb]]) -> list[list[arb]] | None:
    """Return the inverse of a square matrix; None if it may be singular."""
    try:
        inverse: list[list[arb]] = arb_mat(rows).inv().tolist()
    except ZeroDivisionError:
        return None
    return inverse


def judge_closure(
    balance: Balance, wrench_length: float, names: Sequence[str], slack_words: str
) -> Iterator[Finding]:
    """Yield a finding for each condition of force closure that four contacts break, or that is at its limit.

    Three conditions: the wrenches span space, all shares are positive, the moving contacts clamp.

    Parameters
    ----------
    wrench_length : L in mm, half the diameter of the peg-centre locus.
    names : of the four contacts, for the messages.
    slack_words : first words of the message where the clamping force is too small.
    """
    vector, spanned = balance.vector, measure_wrench_span(balance.vector, wrench_length)
    yield from judge_slack(
        spanned - LEAST_SPAN,
        f"the contacts do not hold the part: their wrenches span only {format_middle(spanned)}",
    )
    total = sum(vector, arb(0))
    if not (total > 0 or total < 0):
        opposed = any(entry > 0 for entry in vector) and any(entry < 0 for entry in vector)
        yield Finding(opposed, "the contacts do not hold the part: their forces do not close")
        return
    for name, share in zip(names, balance.shares, strict=True):
        yield from judge_slack(
            share - LEAST_SHARE,
            f"the contacts do not hold the part: the share of {name} in the closure is {format_middle(share)}",
            f"the share of {name} in the closure is exactly at its limit",
        )
    yield from judge_slack(
        balance.clamp - LEAST_CLAMPING,
        f"{slack_words}: the clamping force is {format_middle(balance.clamp)}",
        "the clamping force is exactly at its limit",
    )


Wrench = tuple[arb, arb, arb]


def compute_wrench_radius(
    center: Point, length: float, points: Sequence[Point], normals: Sequence[Point]
) -> arb | None:
    """Return the wrench radius: the distance, without unit, from the origin to the nearest facet of the
    wrenches' hull.

    A wrench is (n, (q - c) x n / L) for each of the ``points`` q and ``normals`` n, with c = ``center`` and L
    = ``length`` in mm. A facet is a plane through three wrenches with all others on one side. Wrenches may be
    coplanar or equal to within ``FLAT``; in doubt the ball holds both cases. Returns None if the wrenches may
    lie on one line.
    """
    (x, y), nearest = center, None
    arms = [(px - x, py - y) for px, py in points]
    wrenches = [(*normal, cross(arm, normal) / length) for arm, normal in zip(arms, normals, strict=True)]
    for corners in combinations(range(len(wrenches)), 3):
        a, b, c = (wrenches[k] for k in corners)
        across = compute_vector_product(subtract_wrenches(b, a), subtract_wrenches(c, a))
        size = compute_square_root(compute_inner_product(across, across))
        if size < FLAT or not size > 0:
            continue
        others = (wrench for k, wrench in enumerate(wrenches) if k not in corners)
        sides = [compute_inner_product(across, subtract_wrenches(wrench, a)) / size for wrench in others]
        if any(side > FLAT for side in sides) and any(side < -FLAT for side in sides):
            continue
        height = abs(compute_inner_product(across, a)) / size
        sure = all(side > -FLAT for side in sides) or all(side < FLAT for side in sides)
        found = height if nearest is None else nearest.min(height)
        nearest = found if sure or nearest is None else found.union(nearest)
    return nearest


def compute_vector_product(a: Wrench, b: Wrench) -> Wrench:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def subtract_wrenches(a: Wrench, b: Wrench) -> Wrench:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def make_joint_outline(workpiece: Workpiece) -> BallOutline:
    """Return the outline of the whole part at the current precision, with the faces of its further outlines.

    Its tables by face number hold the faces of all outlines that carriers touch at heights of their own.
    """
    whole = BallOutline.from_workpiece(workpiece)
    if not workpiece.outlines:
        return whole
    own = {
        "": whole,
        **{role: BallOutline.from_workpiece(*workpiece.find_outline(role)) for role, _ in workpiece.outlines},
    }
    tables: dict[str, Any] = {
        name: {face: value for one in own.values() for face, value in getattr(one, name).items()}
        for name in ("faces", "others", "neighbours", "turns")
    }
    return evolve(whole, **tables, own=own)


def select_outline_for(outline: BallOutline, carrier: str) -> BallOutline:
    """Return the outline that the pegs of a carrier must keep clear of.

    ``carrier`` is its name; a clamp's name ends with its direction, as in "clamp +x".
    """
    return outline.own.get(carrier.split(" ")[0], outline.own[""]) if outline.own else outline
