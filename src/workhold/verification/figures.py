"""The figures of quality, in balls and from the outline alone.

They are defined in docs/quality.md and, as formulas, in the model ("Quality"). Let A be the matrix of the
rows (n_x, n_y, q x n, n . w) of a fixture's contacts at q with outward unit normals n. They are in the
workpiece's frame and about its origin. The vector w is the way of a peg that moves, such as x on the right
jaw, and 0 of one that stands still.

- When peg i stands delta_i too far towards the workpiece, A y = -delta. Here y is the workpiece's movement,
  its turn and how far what moves gives way.
- Forces f that balance a load (g_x, g_y, moment) while what moves is not pushed are
  A^-T (g_x, g_y, moment, 0).

Neither the movements of points nor the forces depend on the point that moments are taken about, or on their
scale. The figures are those of ``statics.quality``, of which nothing is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations, product

from attrs import field, frozen
from flint import arb, arb_mat

from workhold.model.fixture import Fixture
from workhold.model.quality import (
    CLAMP_FREEDOM,
    FIGURES,
    JAW_CONTACT,
    JAW_FORCE_NEEDED,
    LOAD_REACTION,
    PIN_KEYS,
)
from workhold.model.query import Query
from workhold.model.requirements import Load
from workhold.verification.ball_geometry import (
    ArcSide,
    BallOutline,
    Point,
    box_center,
    cross,
    dot,
    exact_point,
    largest,
    least,
    minus,
    norm,
    root,
)
from workhold.verification.contacts import (
    Balance,
    BallContact,
    BallPose,
    every_outline,
    parts_spared,
    wrench_radius,
)
from workhold.verification.force_walk import ForceWalk, force_walk_of
from workhold.verification.judging import main_direction, penalty, tilt, warnings
from workhold.verification.pins import PegBeam, stated_force
from workhold.verification.seat import SeatBalance
from workhold.verification.tolerances import (
    FILLED,
    HAIR,
    PIN_MOVEMENT_LIMIT,
    PIN_STRESS_LIMIT,
    SAME_END,
    TANGENT,
    Finding,
    written,
)
from workhold.verification.touching import Barrier, barriers, edge_distances, length_of

__all__ = ["Measure", "figure_missing", "written_numbers"]

# Figures of which any number in a range may be right.
COUNTS = ("warnings", "penalty")
RANGES = ("end_distance", "edge_distance", "tilt", *COUNTS)


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
        """Largest scalar product of (x, y) with a direction in the range."""
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
    wrench_length : L in mm.
    diameter : of the part, in mm.
    center : of the part's bounding box.
    arcs : the convex arcs of the outer loop, each face whole.
    centers : (A, 4) rows 1, x² + y², x, y of the centres of these arcs, in mm.
    corners : (C, 4) such rows of the joints of the outer loop that may be farthest from some point.
    peg, face : how far they may be off, in mm.
    loads : as asked for.
    walk : along the program, where that has forces.
    direction : main direction of the part in degrees (``verification.judging``).
    jaw_force : in N, None where none was said.
    has_ends : whether the part lies on a wall that has ends.
    stated_force : the jaw force in N for which bending is stated.
    bending : largest stress of a pin in MPa, and farthest that pins may move the part in mm.
    beside : the barriers on the contact feature of each face and radius, as far as known
        (``verification.touching``).
    """

    outline: BallOutline
    wrench_length: float
    diameter: float
    center: Point
    arcs: tuple[ArcSide, ...]
    centers: arb_mat
    corners: arb_mat
    peg: arb
    face: arb
    loads: tuple[DirectedLoad, ...]
    walk: ForceWalk | None
    direction: arb
    jaw_force: float | None
    has_ends: bool
    stated_force: arb
    bending: tuple[float, float]
    beside: dict[tuple[int, float, float], list[Barrier]] = field(factory=dict, init=False)

    @classmethod
    def of(cls, wrench_length: float, diameter: float, query: Query) -> Measure:
        """The measure at the precision in force."""
        outline, outer = every_outline(query.workpiece), query.workpiece.outer_count
        silhouette = [side for face, side in outline.faces.items() if face < outer]
        arcs = tuple(side for side in silhouette if isinstance(side, ArcSide) and side.sign > 0)
        joints = [side.start for side in outline.segments[:outer]]
        return cls(
            outline,
            wrench_length,
            diameter,
            box_center(outline),
            arcs,
            moment_rows([arc.center for arc in arcs]),
            moment_rows(hull(joints)),
            arb(query.tolerance.peg),
            arb(query.tolerance.face),
            tuple(DirectedLoad.of(load) for load in query.loads),
            None if query.program is None else force_walk_of(query.program),
            main_direction([side for face, side in outline.faces.items() if face < len(outline.segments)]),
            query.jaw_force,
            has_ends(query),
            stated_force(query),
            bending_of(query),
        )

    def figures(
        self,
        contacts: Sequence[BallContact],
        faces: Sequence[int],
        pose: BallPose,
        balance: Balance | SeatBalance,
        beams: Sequence[PegBeam | None] | None = None,
        states_bending: bool = True,
    ) -> Mapping[str, arb]:
        """The figures of a fixture by their keys; no load reaction without loads.

        Parameters
        ----------
        beams : of the contacts, see ``verification.pins``; None where it is not known how far pegs bend.
        states_bending : whether the file says how far they do.
        """
        out = {"closure_margin": balance.margin, "clamp_amplification": largest(balance.forces)}
        if isinstance(balance, SeatBalance):
            out["clamp_freedom"] = balance.ratio.freedom
        if balance.inverse is None:
            # The pose is not known well enough for any figure but those of the forces.
            return out
        pegs = [
            (contact, face, point)
            for contact, face, point in zip(contacts, faces, balance.points, strict=True)
            if not contact.is_flush
        ]
        edges = [edge for peg in pegs if (edge := self.edge_distance(*peg)) is not None]
        radius = wrench_radius(self.center, self.wrench_length, balance.points, balance.normals)
        if radius is not None:
            out["wrench_radius"] = radius
        out |= {
            "location_error": self.location_error(balance.inverse, faces),
            "end_distance": least([self.end_distance(*peg) for peg in pegs]),
            "edge_distance": least([arb(self.wrench_length), *edges]),
            "tilt": tilt(pose, self.direction),
            "smallest_face": least([contact.size for contact in contacts]),
        }
        if self.has_ends:
            out["jaw_contact"] = next(contact.size for contact in contacts if contact.is_flush)
        if self.loads or self.walk is not None:
            out["load_reaction"] = self.load_reaction(balance)
            out["jaw_force_needed"] = self.jaw_force_needed(balance)
        if beams is not None:
            out |= self.bent(beams, balance.forces, balance.inverse)
        part = parts_spared(balance.forces)
        off = self.peg + self.face
        out["warnings"] = warnings(out, edges, off, self.jaw_force, part, self.bending, states_bending)
        out["penalty"] = penalty(out, self.peg + self.face, self.diameter, part)
        return out

    def bent(
        self, beams: Sequence[PegBeam | None], forces: Sequence[arb], inverse: Sequence[Sequence[arb]]
    ) -> dict[str, arb]:
        """The largest deflection and stress of a peg, and the farthest that all of them move a point."""
        pressed = [abs(force) * self.stated_force for force in forces]
        pairs = list(zip(beams, pressed, strict=True))
        ways = [arb(0) if beam is None else beam.gives_way(force) for beam, force in pairs]
        moved = [sum((row[k] * ways[k] for k in range(len(row))), arb(0)) for row in inverse[:3]]
        return {
            "pin_deflection": largest(ways),
            "pin_stress": largest([beam.stress(force) for beam, force in pairs if beam is not None]),
            "pin_movement": self.farthest([moved]),
        }

    def barriers(self, contact: BallContact, face: int) -> list[Barrier]:
        """The barriers on the contact feature of a face that a peg touches."""
        key = face, float(contact.radius), float(contact.clear_radius)
        if key not in self.beside:
            others = (other for _, other in self.outline.others[face])
            self.beside[key] = barriers(contact.side, contact.radius, contact.clear_radius, others)
        return self.beside[key]

    def end_distance(self, contact: BallContact, face: int, center: Point) -> arb:
        """Distance in mm of a peg on a face from the nearer end of its contact feature.

        A whole circle has no end; half its circumference counts.
        """
        side, radius = contact.side, contact.radius
        ends = edge_distances(side, radius, self.barriers(contact, face), center, (False, False))
        return arb.pi() * side.reach(radius) if isinstance(side, ArcSide) and side.whole else least(ends)

    def edge_distance(self, contact: BallContact, face: int, center: Point) -> arb | None:
        """Distance in mm of a peg on a face from the nearer edge of its contact feature; None for no edge.

        A tangent joint is none, unless it is with a hollow that leaves a peg no way on. Where either is in
        doubt, any distance between the two is right.
        """
        beside, outline, radius = self.barriers(contact, face), self.outline, contact.radius
        readings: list[tuple[bool, bool]] = []
        joined = outline.smooth_ends(face, contact.body is not None)
        for side, smooth, turn in zip(outline.neighbours[face], joined, outline.turns[face], strict=True):
            length, sure = length_of(side, radius), bool(turn > 2 * TANGENT or turn * radius < SAME_END)
            reach = side.reach(radius) if isinstance(side, ArcSide) else arb(1)
            open_way = smooth and bool(length > HAIR) and not reach < FILLED
            sure &= not (
                smooth and bool(HAIR / 10 < length < 10 * HAIR or 0.99 * FILLED < reach < 1.01 * FILLED)
            )
            readings.append((open_way, open_way) if sure else (False, True))
        found = []
        for one, two in zip(*readings, strict=True):
            ways = edge_distances(contact.side, radius, beside, center, (one, two))
            found.append(least(ways) if ways else None)
        near, far = found
        if near is None:
            return None
        return near if near is far else near.union(arb(self.wrench_length) if far is None else far)

    def jaw_force_needed(self, balance: Balance | SeatBalance) -> arb:
        """Jaw force in N above which no peg of a screw vise lets go, and never less than 0.

        Let f0 balance a load while the jaw keeps its force, and let P project on the forces of the jaw, or of
        both clamps. Locking leaves f0 - P f0, so the figure is the largest of ((P f0)_i - f0_i) / h_i.
        """
        most, rows = arb(0), balance.responses
        pairs = list(zip(map(balance.kept_by_closing, rows), rows, strict=True))
        for i, force in enumerate(balance.forces):
            most = self.under_loads(most, *((kept[i] - row[i]) / force for kept, row in pairs))
        return most

    def under_loads(self, most: arb, a: arb, b: arb, c: arb) -> arb:
        """The largest of ``most`` and of a f_x + b f_y + c m under all loads and the program."""
        for load in self.loads:
            for x, y in load.points:
                most = most.max(load.moment * c + load.force * load.largest(a - y * c, b + x * c))
        return (
            most if self.walk is None else most.max(self.walk.worst(a, b, c, max(float(most.lower()), 0.0)))
        )

    def location_error(self, inverse: Sequence[Sequence[arb]], faces: Sequence[int]) -> arb:
        """Largest movement in mm of a point of the silhouette, over all corners of the box of tolerances.

        A point q moves by v + t (-q_y, q_x), t being the turn. The square |v|² + t² |q|² + 2 t (q x v) is a
        convex function of q. So the movement is largest at a joint, or where a convex arc about m is farthest
        along the movement of m: there it is |v(m)| + r |t|. Both signs of all errors move alike, so the last
        error keeps its sign.
        """
        generators, located = [], range(len(inverse[0]))
        for face in {faces[k] for k in located}:
            pegs = [k for k in located if faces[k] == face]
            if len(pegs) > 1:
                generators.append([self.face * sum((row[k] for k in pegs), arb(0)) for row in inverse[:3]])
            own = self.peg if len(pegs) > 1 else self.peg + self.face
            generators += [[own * row[k] for row in inverse[:3]] for k in pegs]
        *free, last = generators
        movements = [
            [sum((s * g[m] for s, g in zip(signs, free, strict=True)), last[m]) for m in range(3)]
            for signs in product((1, -1), repeat=len(free))
        ]
        return self.farthest(movements)

    def farthest(self, movements: Sequence[Sequence[arb]]) -> arb:
        """Largest movement in mm of a point of the silhouette over some: shifts of the origin, and turns."""
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

    def load_reaction(self, balance: Balance | SeatBalance) -> arb:
        """Largest peg force in N under some load, with the least clamping that leaves no force negative.

        Forces that balance a load are f0 + k lambda. The least k without a negative one is the largest
        -f0_i / lambda_i. So peg j presses with the largest over i of f0_j - f0_i lambda_j / lambda_i. This is
        linear in the load's direction for each i.
        """
        most, rows = arb(0), balance.responses
        for i, j in permutations(range(len(balance.shares)), 2):
            ratio = balance.shares[j] / balance.shares[i]
            most = self.under_loads(most, *(row[j] - ratio * row[i] for row in rows))
        return most


def bending_of(query: Query) -> tuple[float, float]:
    """The largest stress of a pin in MPa and the farthest movement by pins in mm, of the toolkit or the usual."""
    own = query.toolkit.pins
    stress, movement = (None, None) if own is None else (own.stress_limit, own.movement_limit)
    return stress or PIN_STRESS_LIMIT, movement or PIN_MOVEMENT_LIMIT


def moved_arc(arc: ArcSide, x: arb, y: arb, turn: arb, known: arb) -> arb:
    """The largest movement of a point inside a convex arc, or the ``known`` one where an end moves most."""
    way = x - turn * arc.center[1], y + turn * arc.center[0]
    moved = norm(way) + abs(turn) * arc.radius
    within = arc.within((way[1], -way[0]) if turn > 0 else (-way[1], way[0]))
    return moved if arc.whole or within > 0 else known if within < 0 else known.union(moved)


def moment_rows(points: Sequence[Point]) -> arb_mat:
    """Rows 1, x² + y², x, y of points, (N, 4)."""
    return arb_mat([(1, x * x + y * y, x, y) for x, y in points])


def hull(points: Sequence[Point]) -> list[Point]:
    """Points that may be corners of the convex hull of all (Andrew's monotone chain, 1979)."""
    ordered = sorted(points, key=lambda point: (float(point[0]), float(point[1])))
    chain: list[Point] = []
    for run in (ordered, ordered[::-1]):
        first = len(chain)
        for point in run:
            while len(chain) - first >= 2:
                before, last = chain[-2:]
                if not cross(minus(last, before), minus(point, last)) < 0:
                    break
                chain.pop()
            chain.append(point)
    return chain


def figure_missing(fixture: Fixture, query: Query) -> str:
    """A sentence on a figure of quality that is missing or superfluous, without a full stop; or nothing."""
    for figure in FIGURES:
        of_loads = figure in (FIGURES[LOAD_REACTION], FIGURES[JAW_FORCE_NEEDED])
        wanted, why = query.is_loaded or not of_loads, "no loads"
        if figure is FIGURES[CLAMP_FREEDOM]:
            wanted, why = len(fixture.travels) > 1, "no two clamps"
        if figure is FIGURES[JAW_CONTACT]:
            wanted, why = has_ends(query), "no ends of a jaw"
        if figure.key in PIN_KEYS:
            # Of files from before there was this figure none states it.
            is_stated = any(key in fixture.quality for key in PIN_KEYS)
            wanted, why = is_stated and query.knows_heights, "no heights at which pegs press"
        if wanted != (figure.key in fixture.quality):
            return f"its {figure.words} is " + ("missing" if wanted else f"given, and there are {why}")
    return ""


def has_ends(query: Query) -> bool:
    """Whether the part lies on a wall that has ends."""
    return any(carrier.width is not None for carrier in query.toolkit.carriers)


def written_numbers(
    fixture: Fixture, names: Sequence[str], balance: Balance | SeatBalance, figures: Mapping[str, arb]
) -> Iterator[Finding]:
    """Whether the forces of pegs of some names and the figures of quality of the file are the derived ones.

    The file's numbers were computed in double precision from a rounded pose. A derived end distance is a
    range where the clearance passes slowly through zero, and so is a count beside the edge of what it counts.
    Any number in the range is right.
    """
    part = parts_spared(balance.forces)
    for name, peg, force in zip(names, fixture.pegs, balance.forces, strict=True):
        yield from written(f"the force of {name}", peg.force, force, part * abs(force))
    for key, derived in figures.items():
        if key in fixture.quality:
            if key in COUNTS and not fixture.quality[key].is_integer():
                yield Finding(
                    True, f"its {key} is {fixture.quality[key]:.12g} in the file, which is no whole number"
                )
            spare = part * abs(derived) + (2 * derived.rad() if key in RANGES else 0)
            yield from written(f"its {key.replace('_', ' ')}", fixture.quality[key], derived, spare)
