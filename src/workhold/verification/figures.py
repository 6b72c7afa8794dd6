"""The figures of quality, in balls and from the outline alone (model: "Quality"; what they mean is in docs/quality.md).

With A the matrix of rows (n_x, n_y, q x n, n . x on the right jaw and 0 on the left) of a fixture's contacts at q with
outward unit normals n, in the workpiece's frame and about its origin:

- when peg i stands delta_i too far towards the workpiece, A y = -delta, y being the workpiece's movement, its turn and how
  far the jaw closes;
- forces f that balance a load (g_x, g_y, moment) while the right jaw is not pushed are A^-T (g_x, g_y, moment, 0).

Neither the movements of points nor the forces depend on the point that moments are taken about, or on their scale. These are
the figures of ``statics.quality``, and nothing of it is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from attrs import field, frozen
from flint import arb, arb_mat

from workhold.model.fixture import Fixture
from workhold.model.load import Load
from workhold.verification.asked import Asked
from workhold.verification.balls import Point, cross, dot, exact_point, norm, root
from workhold.verification.closure import Balance
from workhold.verification.contacts import Contact, Pose
from workhold.verification.ends import Barrier, barriers, end_distance
from workhold.verification.findings import Finding, rule
from workhold.verification.outline import Outline
from workhold.verification.rules import FIGURE_AGREEMENT, HAIR, ROUNDING
from workhold.verification.sides import ArcSide

__all__ = ["Measure", "box_center", "written_numbers"]

END_DISTANCE = "end_distance"


@frozen(eq=False)
class DirectedLoad:
    """A load in balls.

    Parameters
    ----------
    points : where its force acts, in mm.
    force, moment : in N and N mm.
    low, high, middle : unit vectors of the first, the last and the middle direction.
    half_cosine : cosine of half the range; -1 for any direction.
    """

    points: tuple[Point, ...]
    force: arb
    moment: arb
    low: Point
    high: Point
    middle: Point
    half_cosine: arb

    @classmethod
    def of(cls, load: Load) -> DirectedLoad:
        """A load at the precision in force."""
        low, high = (arb(angle) for angle in load.directions)
        points = tuple(exact_point(x, y) for x, y in load.points) or (exact_point(0.0, 0.0),)
        sides = direction(low), direction(high), direction((low + high) / 2)
        return cls(points, arb(load.force), arb(load.moment), *sides, direction((high - low) / 2)[0])

    def largest(self, x: arb, y: arb) -> arb:
        """Largest scalar product of (x, y) with a direction: its length within the range, otherwise that with an end."""
        size, at_ends = norm((x, y)), dot(self.low, (x, y)).max(dot(self.high, (x, y)))
        within = dot(self.middle, (x, y)) - size * self.half_cosine
        return size if within > 0 else at_ends if within < 0 else at_ends.union(size)


def direction(degrees: arb) -> Point:
    """The unit vector at an angle in degrees."""
    sine, cosine = (degrees / 180).sin_cos_pi()
    return cosine, sine


@frozen(eq=False)
class Measure:
    """What the figures of quality of all fixtures of a result have in common, at one precision.

    Parameters
    ----------
    outline : of the workpiece.
    radius : of the pegs in mm.
    wrench_length : L in mm.
    center : of the part's bounding box.
    arcs : the convex arcs of the outer loop, each face whole.
    centers, corners : (A, 4) and (C, 4) rows 1, x² + y², x, y of their centres, and of the joints of the outer loop that may
        be farthest from some point; in mm.
    peg, face : how far they may be off, in mm.
    loads : as asked for.
    beside : the barriers on each face's contact feature, as far as they are known (``verification.ends``).
    """

    outline: Outline
    radius: arb
    wrench_length: float
    center: Point
    arcs: tuple[ArcSide, ...]
    centers: arb_mat
    corners: arb_mat
    peg: arb
    face: arb
    loads: tuple[DirectedLoad, ...]
    beside: dict[int, list[Barrier]] = field(factory=dict, init=False)

    @classmethod
    def of(cls, outline: Outline, outer: int, radius: float, wrench_length: float, asked: Asked) -> Measure:
        """The measure at the precision in force; the outer loop has the first ``outer`` segments."""
        silhouette = [side for number, side in outline.faces.items() if number < outer]
        arcs = tuple(side for side in silhouette if isinstance(side, ArcSide) and side.sign > 0)
        joints = [side.start for side in outline.segments[:outer]]
        return cls(
            outline,
            arb(radius),
            wrench_length,
            box_center(outline),
            arcs,
            moment_rows([arc.center for arc in arcs]),
            moment_rows(hull(joints)),
            arb(asked.tolerance.peg),
            arb(asked.tolerance.face),
            tuple(DirectedLoad.of(load) for load in asked.loads),
        )

    def figures(
        self, contacts: Sequence[Contact], faces: Sequence[int], pose: Pose, balance: Balance
    ) -> Mapping[str, arb]:
        """The figures of a fixture by their keys; no load reaction without loads."""
        across = pose.cosine, -pose.sine
        rows = [
            [*normal, cross(point, normal), contact.right * dot(across, normal)]
            for contact, point, normal in zip(contacts, balance.points, balance.normals, strict=True)
        ]
        inverse = arb_mat(rows).inv().tolist()
        out = {
            "closure_margin": least(balance.shares),
            "clamp_amplification": largest(balance.forces),
            "wrench_radius": self.wrench_radius(balance),
            "location_error": self.location_error(inverse, faces),
            "end_distance": least(
                [self.end_distance(*peg) for peg in zip(contacts, faces, balance.points, strict=True)]
            ),
        }
        return out | {"load_reaction": self.load_reaction(inverse, balance)} if self.loads else out

    def end_distance(self, contact: Contact, face: int, center: Point) -> arb:
        """Distance in mm of a peg on a face from the nearer end of its contact feature."""
        if face not in self.beside:
            others = (side for _, side in self.outline.others[face])
            self.beside[face] = barriers(contact.side, self.radius, others)
        return end_distance(contact.side, self.radius, self.beside[face], center)

    def wrench_radius(self, balance: Balance) -> arb:
        """Distance from the origin to the nearest facet of the tetrahedron of the wrenches w = (n, (q - c) x n / L).

        The volume of a facet's tetrahedron with the origin is a minor of the wrenches, so its height is that minor, in parts
        of L, over the size of w_a x w_b + w_b x w_c + w_c x w_a, which is twice the facet's area.
        """
        wrenches = []
        for (x, y), normal in zip(balance.points, balance.normals, strict=True):
            about = cross((x - self.center[0], y - self.center[1]), normal)
            wrenches.append((*normal, about / self.wrench_length))
        products = {(i, k): vector_product(wrenches[i], wrenches[k]) for i in range(4) for k in range(i + 1, 4)}
        heights = []
        for left_out, minor in enumerate(balance.vector):
            a, b, c = (k for k in range(4) if k != left_out)
            sides = zip(products[a, b], products[b, c], products[a, c], strict=True)
            area = [ab + bc - ac for ab, bc, ac in sides]
            heights.append(abs(minor) / root(sum((entry * entry for entry in area), arb(0))))
        return least(heights) / self.wrench_length

    def location_error(self, inverse: Sequence[Sequence[arb]], faces: Sequence[int]) -> arb:
        """Largest movement in mm of a point of the silhouette, over all corners of the box of tolerances.

        A point q moves by v + t (-q_y, q_x), t being the turn. The square of that, |v|² + t² |q|² + 2 t (q x v), is a convex
        function of q, so it is largest at a joint, or where a convex arc about m is farthest along the movement of m: by
        |v(m)| + r |t|. Both signs of all errors move alike, so the last error keeps its sign.
        """
        generators = []
        for face in set(faces):
            pegs = [k for k in range(4) if faces[k] == face]
            if len(pegs) > 1:
                generators.append([self.face * sum((row[k] for k in pegs), arb(0)) for row in inverse[:3]])
            own = self.peg if len(pegs) > 1 else self.peg + self.face
            generators += [[own * row[k] for row in inverse[:3]] for k in pegs]
        *free, last = generators
        movements = [
            [sum((s * g[m] for s, g in zip(signs, free, strict=True)), last[m]) for m in range(3)]
            for signs in product((1, -1), repeat=len(free))
        ]
        terms = arb_mat([[x * x + y * y, t * t, 2 * t * y, -2 * t * x] for x, y, t in movements]).transpose()
        most = root(largest((self.corners * terms).entries()))
        if self.arcs:
            speeds = (self.centers * terms).tolist()
            for column, (x, y, t) in enumerate(movements):
                size = abs(t)
                for arc, row in zip(self.arcs, speeds, strict=True):
                    spare = most - size * arc.radius
                    if not (spare > 0 and row[column] < spare * spare):
                        most = most.max(moved_arc(arc, x, y, t, most))
        return most

    def load_reaction(self, inverse: Sequence[Sequence[arb]], balance: Balance) -> arb:
        """Largest peg force in N under some load, with the least clamping that leaves no force negative.

        Forces that balance a load are f0 + k lambda. The least k without a negative one is the largest -f0_i / lambda_i, so
        peg j presses with the largest over i of f0_j - f0_i lambda_j / lambda_i, linear in the load's direction for each i.
        """
        most = arb(0)
        for i in range(4):
            for j in range(4):
                if i == j:
                    continue
                ratio = balance.shares[j] / balance.shares[i]
                a, b, c = (row[j] - ratio * row[i] for row in inverse[:3])
                for load in self.loads:
                    for x, y in load.points:
                        most = most.max(load.moment * c + load.force * load.largest(a - y * c, b + x * c))
        return most


def moved_arc(arc: ArcSide, x: arb, y: arb, turn: arb, known: arb) -> arb:
    """How far the point of a convex arc moves that moves most, if it is not one of its ends; else what is known."""
    way = x - turn * arc.center[1], y + turn * arc.center[0]
    moved = norm(way) + abs(turn) * arc.radius
    within = arc.within((way[1], -way[0]) if turn > 0 else (-way[1], way[0]))
    return moved if arc.whole or within > 0 else known if within < 0 else known.union(moved)


def moment_rows(points: Sequence[Point]) -> arb_mat:
    """Rows 1, x² + y², x, y of points, (N, 4)."""
    return arb_mat([(1, x * x + y * y, x, y) for x, y in points])


def least(values: Sequence[arb]) -> arb:
    """The smallest of some numbers."""
    found = values[0]
    for value in values[1:]:
        found = found.min(value)
    return found


def largest(values: Sequence[arb]) -> arb:
    """The largest of some numbers."""
    return -least([-value for value in values])


def vector_product(a: Sequence[arb], b: Sequence[arb]) -> tuple[arb, arb, arb]:
    """Vector product in space."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def hull(points: Sequence[Point]) -> list[Point]:
    """Points without those that certainly lie inside the convex hull of all (Andrew's monotone chain, 1979)."""
    ordered = sorted(points, key=lambda point: (float(point[0]), float(point[1])))
    chain: list[Point] = []
    for run in (ordered, ordered[::-1]):
        first = len(chain)
        for point in run:
            while len(chain) - first >= 2 and turns_right(chain[-2], chain[-1], point):
                chain.pop()
            chain.append(point)
    return chain


def turns_right(a: Point, b: Point, c: Point) -> bool:
    """Whether the way from a to c by b certainly turns clockwise."""
    return bool(cross((b[0] - a[0], b[1] - a[1]), (c[0] - b[0], c[1] - b[1])) < 0)


def box_center(outline: Outline) -> Point:
    """Centre in mm of the bounding box of a workpiece: of its joints, and of the arcs where they run along x or y."""
    middle = []
    for axis in (0, 1):
        places = [side.start[axis] for side in outline.segments]
        for side in outline.segments:
            if isinstance(side, ArcSide):
                for sign in (1, -1):
                    within = side.within((arb(sign), arb(0)) if axis == 0 else (arb(0), arb(sign)))
                    if not within < 0:
                        places.append(side.center[axis] + sign * side.radius)
        middle.append((least(places) + largest(places)) / 2)
    return middle[0], middle[1]


def written_numbers(fixture: Fixture, balance: Balance, figures: Mapping[str, arb]) -> Iterator[Finding]:
    """Whether the forces and the figures of quality of the file are the derived ones.

    They were computed in double precision from a pose that is rounded, which moves a fixture by as much more, and then its
    forces by as much more again, as its forces are larger than the clamping force. A derived end distance is a range where
    the clearance passes slowly through zero, and any number in it is right.
    """
    amplification = largest(balance.forces)
    part = FIGURE_AGREEMENT + ROUNDING * amplification * amplification
    for position, (peg, force) in enumerate(zip(fixture.pegs, balance.forces, strict=True), 1):
        yield from written(f"the force of peg {position}", peg.force, force, part * abs(force))
    for key, derived in figures.items():
        if key in fixture.quality:
            spare = part * abs(derived) + (2 * derived.rad() if key == END_DISTANCE else 0)
            yield from written(f"its {key.replace('_', ' ')}", fixture.quality[key], derived, spare)


def written(name: str, number: float, derived: arb, spare: arb) -> Iterator[Finding]:
    """Whether a number of the file is the derived one, to a hair and what may be spared besides."""
    slack = HAIR + spare - abs(derived - number)
    if not slack > 0:
        words = f"{name} is {number:.12g} in the file and comes to {float(derived.mid()):.12g}"
        yield from rule(slack, words, words)
