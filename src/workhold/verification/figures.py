"""The figures of quality, in ball arithmetic and from the outline alone.

They are defined in docs/quality.md and, as formulas, in the model ("Quality"). Let A be the matrix of the
rows (n_x, n_y, q x n, n . w) of a fixture's contacts at q with outward unit normals n. They are in the
workpiece's frame and about its origin. The vector w is the way of a moving peg, such as x on the right jaw,
and 0 for a fixed peg.

- If peg i is delta_i too far towards the workpiece, A y = -delta. Here y is the workpiece's movement, its
  turn, and the distance by which the moving carrier gives way.
- Forces f that balance a load (g_x, g_y, moment) without a push on the moving carrier are A^-T (g_x, g_y,
  moment, 0).

Neither the movements of points nor the forces depend on the reference point of moments or on their scale. The
figures are those of ``statics.quality``, but its code is not used.
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
    compute_box_center,
    compute_dot_product,
    compute_norm,
    compute_square_root,
    cross,
    find_largest,
    find_least,
    make_exact_point,
    subtract,
)
from workhold.verification.contacts import (
    Balance,
    BallContact,
    BallPose,
    bound_relative_error,
    compute_wrench_radius,
    make_joint_outline,
)
from workhold.verification.force_walk import ForceWalk, make_force_walk
from workhold.verification.judging import compute_penalty, compute_tilt, count_warnings, find_main_direction
from workhold.verification.pins import PegBeam, find_stated_force
from workhold.verification.seat import SeatBalance
from workhold.verification.tolerances import (
    FILLED,
    HAIR,
    PIN_MOVEMENT_LIMIT,
    PIN_STRESS_LIMIT,
    SAME_END,
    TANGENT,
    Finding,
    judge_written_number,
)
from workhold.verification.touching import Barrier, find_barriers, measure_edge_distances, measure_feature

__all__ = ["FigureMeasure", "find_missing_figure", "judge_written_numbers"]

# Figures of which any number in a range may be right.
COUNTS = ("warnings", "penalty")
RANGES = ("end_distance", "edge_distance", "tilt", *COUNTS)


@frozen(eq=False)
class DirectedLoad:
    """A load in ball arithmetic.

    Parameters
    ----------
    points : where its force acts, in mm in the part's frame.
    force, moment : in N and N mm.
    low, high, middle : unit vectors of the first, the last and the middle direction of the force.
    half_cosine : cosine of half the range of directions; -1 for any direction.
    """

    points: tuple[Point, ...]
    force: arb
    moment: arb
    low: Point
    high: Point
    middle: Point
    half_cosine: arb

    @classmethod
    def from_load(cls, load: Load) -> DirectedLoad:
        """Return a load at the current precision; without points its force acts at the origin."""
        low, high = (arb(angle) for angle in load.directions)
        points = tuple(make_exact_point(x, y) for x, y in load.points) or (make_exact_point(0.0, 0.0),)
        sides = compute_direction(low), compute_direction(high), compute_direction((low + high) / 2)
        return cls(points, arb(load.force), arb(load.moment), *sides, compute_direction((high - low) / 2)[0])

    def find_largest_product(self, x: arb, y: arb) -> arb:
        """Return the largest scalar product of (x, y) with a unit vector in the load's range of
        directions.
        """
        size, at_ends = (
            compute_norm((x, y)),
            compute_dot_product(self.low, (x, y)).max(compute_dot_product(self.high, (x, y))),
        )
        within = compute_dot_product(self.middle, (x, y)) - size * self.half_cosine
        return size if within > 0 else at_ends if within < 0 else at_ends.union(size)


def compute_direction(degrees: arb) -> Point:
    """Return the unit vector at an angle in degrees."""
    sine, cosine = (degrees / 180).sin_cos_pi()
    return cosine, sine


@frozen(eq=False)
class FigureMeasure:
    """The data common to the figures of quality of all fixtures of a result, at one precision.

    Parameters
    ----------
    outline : of the workpiece.
    wrench_length : L in mm.
    diameter : of the part, in mm.
    center : of the part's bounding box.
    arcs : the convex arcs of the outer loop, one per face.
    centers : (A, 4) rows (1, x² + y², x, y), one for the centre of each of the A arcs, in mm.
    corners : (C, 4) such rows, one for each of the C joints of the outer loop that may be farthest from some
        point.
    peg, face : tolerances in mm of peg places and of faces.
    loads : loads of the query.
    walk : along the program; None where the program has no forces.
    direction : main direction of the part in degrees (``verification.judging``).
    jaw_force : jaw force in N, None if none was given.
    has_ends : whether the part lies on a wall that has ends.
    stated_force : the jaw force in N for which bending is stated.
    bending : limits above which a warning counts: stress of a pin in MPa, movement of the part by bent pins
        in mm.
    beside : barriers found so far, by (face number, contact radius, body radius); see
        ``verification.touching``.
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
    def from_query(cls, wrench_length: float, diameter: float, query: Query) -> FigureMeasure:
        """Return the measure at the precision in force."""
        outline, outer = make_joint_outline(query.workpiece), query.workpiece.outer_count
        silhouette = [side for face, side in outline.faces.items() if face < outer]
        arcs = tuple(side for side in silhouette if isinstance(side, ArcSide) and side.sign > 0)
        joints = [side.start for side in outline.segments[:outer]]
        return cls(
            outline,
            wrench_length,
            diameter,
            compute_box_center(outline),
            arcs,
            make_moment_rows([arc.center for arc in arcs]),
            make_moment_rows(find_hull_candidates(joints)),
            arb(query.tolerance.peg),
            arb(query.tolerance.face),
            tuple(DirectedLoad.from_load(load) for load in query.loads),
            None if query.program is None else make_force_walk(query.program),
            find_main_direction(
                [side for face, side in outline.faces.items() if face < len(outline.segments)]
            ),
            query.jaw_force,
            has_ends(query),
            find_stated_force(query),
            find_bending_limits(query),
        )

    def compute_figures(
        self,
        contacts: Sequence[BallContact],
        faces: Sequence[int],
        pose: BallPose,
        balance: Balance | SeatBalance,
        beams: Sequence[PegBeam | None] | None = None,
        states_bending: bool = True,
    ) -> Mapping[str, arb]:
        """Return the figures of quality of a fixture by key.

        Without loads and program forces, the figures of loads are left out. If the pose is not known well
        enough, all figures but those of the balance's forces are left out.

        Parameters
        ----------
        beams : one for each contact, see ``verification.pins``; None if the bending of pegs is not known.
        states_bending : whether the file states how far pegs bend.
        """
        out = {"closure_margin": balance.margin, "clamp_amplification": find_largest(balance.forces)}
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
        edges = [edge for peg in pegs if (edge := self.compute_edge_distance(*peg)) is not None]
        radius = compute_wrench_radius(self.center, self.wrench_length, balance.points, balance.normals)
        if radius is not None:
            out["wrench_radius"] = radius
        out |= {
            "location_error": self.compute_location_error(balance.inverse, faces),
            "end_distance": find_least([self.compute_end_distance(*peg) for peg in pegs]),
            "edge_distance": find_least([arb(self.wrench_length), *edges]),
            "tilt": compute_tilt(pose, self.direction),
            "smallest_face": find_least([contact.size for contact in contacts]),
        }
        if self.has_ends:
            out["jaw_contact"] = next(contact.size for contact in contacts if contact.is_flush)
        if self.loads or self.walk is not None:
            out["load_reaction"] = self.compute_load_reaction(balance)
            out["jaw_force_needed"] = self.compute_needed_jaw_force(balance)
        if beams is not None:
            out |= self.compute_bending(beams, balance.forces, balance.inverse)
        part = bound_relative_error(balance.forces)
        off = self.peg + self.face
        out["warnings"] = count_warnings(out, edges, off, self.jaw_force, part, self.bending, states_bending)
        out["penalty"] = compute_penalty(out, self.peg + self.face, self.diameter, part)
        return out

    def compute_bending(
        self, beams: Sequence[PegBeam | None], forces: Sequence[arb], inverse: Sequence[Sequence[arb]]
    ) -> dict[str, arb]:
        """Return "pin_deflection" in mm, "pin_stress" in MPa and "pin_movement" in mm at the stated jaw
        force.

        Deflection and stress are the largest of any peg. The movement is the largest of a point of the part
        when all pegs bend.

        Parameters
        ----------
        beams : one for each contact; None for a contact that does not bend.
        forces : of the contacts, per unit of jaw force.
        inverse : of the balance: rows for x, y and turn (and more), a column for each contact.
        """
        pressed = [abs(force) * self.stated_force for force in forces]
        pairs = list(zip(beams, pressed, strict=True))
        ways = [arb(0) if beam is None else beam.compute_deflection(force) for beam, force in pairs]
        moved = [sum((row[k] * ways[k] for k in range(len(row))), arb(0)) for row in inverse[:3]]
        return {
            "pin_deflection": find_largest(ways),
            "pin_stress": find_largest(
                [beam.compute_stress(force) for beam, force in pairs if beam is not None]
            ),
            "pin_movement": self.find_farthest_movement([moved]),
        }

    def find_barriers(self, contact: BallContact, face: int) -> list[Barrier]:
        """Return the ranges (from, to) in which a peg that slides along a face would enter another side.

        Ends are arc lengths in mm along the path of the peg's centre, see ``touching.find_barriers``. Results
        are cached by face and radii of the contact.
        """
        key = face, float(contact.radius), float(contact.clear_radius)
        if key not in self.beside:
            others = (other for _, other in self.outline.others[face])
            self.beside[key] = find_barriers(contact.side, contact.radius, contact.clear_radius, others)
        return self.beside[key]

    def compute_end_distance(self, contact: BallContact, face: int, center: Point) -> arb:
        """Return the distance in mm from a peg's centre to the nearer end of its path along a face.

        The path ends at the end of the face, or where the peg would enter another side. A whole circle has no
        end: the distance is then half the path's circumference. ``center`` is the peg's centre in the part's
        frame.
        """
        side, radius = contact.side, contact.radius
        ends = measure_edge_distances(side, radius, self.find_barriers(contact, face), center, (False, False))
        return (
            arb.pi() * side.compute_offset_radius(radius)
            if isinstance(side, ArcSide) and side.whole
            else find_least(ends)
        )

    def compute_edge_distance(self, contact: BallContact, face: int, center: Point) -> arb | None:
        """Return the distance in mm from a peg's centre to the nearer edge of its path along a face.

        An end of the path is an edge unless it is a tangent joint; a tangent joint to a concave arc that is
        too tight for the peg is an edge too. In doubt the ball holds the results for both readings. Returns
        None where the path has no edge. ``center`` is the peg's centre in the part's frame.
        """
        beside, outline, radius = self.find_barriers(contact, face), self.outline, contact.radius
        readings: list[tuple[bool, bool]] = []
        joined = outline.find_smooth_ends(face, contact.body is not None)
        for side, smooth, turn in zip(outline.neighbours[face], joined, outline.turns[face], strict=True):
            length, sure = measure_feature(side, radius), bool(turn > 2 * TANGENT or turn * radius < SAME_END)
            reach = side.compute_offset_radius(radius) if isinstance(side, ArcSide) else arb(1)
            open_way = smooth and bool(length > HAIR) and not reach < FILLED
            sure &= not (
                smooth and bool(HAIR / 10 < length < 10 * HAIR or 0.99 * FILLED < reach < 1.01 * FILLED)
            )
            readings.append((open_way, open_way) if sure else (False, True))
        found = []
        for one, two in zip(*readings, strict=True):
            ways = measure_edge_distances(contact.side, radius, beside, center, (one, two))
            found.append(find_least(ways) if ways else None)
        near, far = found
        if near is None:
            return None
        return near if near is far else near.union(arb(self.wrench_length) if far is None else far)

    def compute_needed_jaw_force(self, balance: Balance | SeatBalance) -> arb:
        """Return the least jaw force in N, 0 or more, at which no load makes a peg of a screw vise lose
        contact.

        Let the peg forces f0 balance a load with a jaw that keeps its force, let h be the peg forces per unit
        of jaw force, and let P be the projection onto the closing forces of the jaw, or of both clamps. With
        a locked jaw the peg forces are f0 - P f0, so the result is the largest of ((P f0)_i - f0_i) / h_i
        over all pegs i and loads.
        """
        most, rows = arb(0), balance.responses
        pairs = list(zip(map(balance.project_on_closing, rows), rows, strict=True))
        for i, force in enumerate(balance.forces):
            most = self.find_largest_under_loads(most, *((kept[i] - row[i]) / force for kept, row in pairs))
        return most

    def find_largest_under_loads(self, most: arb, a: arb, b: arb, c: arb) -> arb:
        """Return the largest value of a f_x + b f_y + c m, or ``most`` if that is larger.

        (f_x, f_y) is the force in N and m the moment in N mm about the part's origin, over all loads and all
        tool forces along the program.
        """
        for load in self.loads:
            for x, y in load.points:
                most = most.max(
                    load.moment * c + load.force * load.find_largest_product(a - y * c, b + x * c)
                )
        return (
            most
            if self.walk is None
            else most.max(self.walk.find_worst(a, b, c, max(float(most.lower()), 0.0)))
        )

    def compute_location_error(self, inverse: Sequence[Sequence[arb]], faces: Sequence[int]) -> arb:
        """Return the largest movement in mm of a point of the silhouette over all signs of the peg and face
        tolerances.

        ``inverse`` has a column for each contact. ``faces`` has a number for each contact; pegs with the same
        number share the error of a face. With shift v of the part's origin and turn t, a point q moves by v +
        t (-q_y, q_x). The square |v|² + t² |q|² + 2 t (q x v) is a convex function of q. So the movement is
        largest at a joint, or on a convex arc with centre m and radius r at the point in the direction in
        which m moves: there it is |v(m)| + r |t|. Opposite signs of all errors move points equally far, so
        one sign is fixed.
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
        return self.find_farthest_movement(movements)

    def find_farthest_movement(self, movements: Sequence[Sequence[arb]]) -> arb:
        """Return the largest movement in mm of any point of the silhouette under any of the given rigid
        movements.

        Each movement is (x, y, turn): the shift of the origin in mm and a small turn in radians.
        """
        terms = arb_mat([[x * x + y * y, t * t, 2 * t * y, -2 * t * x] for x, y, t in movements]).transpose()
        most = compute_square_root(find_largest((self.corners * terms).entries()))
        if self.arcs:
            speeds = (self.centers * terms).tolist()
            for column, (x, y, t) in enumerate(movements):
                size = abs(t)
                for arc, row in zip(self.arcs, speeds, strict=True):
                    spare = most - size * arc.radius
                    if not (spare > 0 and row[column] < spare * spare):
                        most = most.max(bound_arc_movement(arc, x, y, t, most))
        return most

    def compute_load_reaction(self, balance: Balance | SeatBalance) -> arb:
        """Return the largest peg force in N over all loads, at the least clamping that keeps every peg force
        at 0 or more.

        Let f0 be peg forces that balance a load and lambda the closing forces. All peg forces that balance
        the load are f0 + k lambda. The least k that leaves no force negative is the largest of -f0_i /
        lambda_i, so peg j presses with the largest over i of f0_j - f0_i lambda_j / lambda_i. For each i this
        is linear in the load.
        """
        most, rows = arb(0), balance.responses
        for i, j in permutations(range(len(balance.shares)), 2):
            ratio = balance.shares[j] / balance.shares[i]
            most = self.find_largest_under_loads(most, *(row[j] - ratio * row[i] for row in rows))
        return most


def find_bending_limits(query: Query) -> tuple[float, float]:
    """Return (largest allowed pin stress in MPa, largest allowed movement of the part in mm).

    Each is the toolkit's own limit, or the default where the toolkit has none.
    """
    own = query.toolkit.pins
    stress, movement = (None, None) if own is None else (own.stress_limit, own.movement_limit)
    return stress or PIN_STRESS_LIMIT, movement or PIN_MOVEMENT_LIMIT


def bound_arc_movement(arc: ArcSide, x: arb, y: arb, turn: arb, known: arb) -> arb:
    """Return the largest movement in mm of a convex arc's interior points, or ``known`` where an end moves
    farther.

    (x, y) is the shift of the part's origin in mm and ``turn`` a small turn in radians. ``known`` is the
    largest movement of the arc's ends. In doubt the ball holds both values.
    """
    way = x - turn * arc.center[1], y + turn * arc.center[0]
    moved = compute_norm(way) + abs(turn) * arc.radius
    within = arc.measure_within((way[1], -way[0]) if turn > 0 else (-way[1], way[0]))
    return moved if arc.whole or within > 0 else known if within < 0 else known.union(moved)


def make_moment_rows(points: Sequence[Point]) -> arb_mat:
    """Return the matrix (N, 4) with a row 1, x² + y², x, y for each point."""
    return arb_mat([(1, x * x + y * y, x, y) for x, y in points])


def find_hull_candidates(points: Sequence[Point]) -> list[Point]:
    """Return all points that may be corners of the convex hull, lower chain
    first (Andrew's monotone chain, 1979).
    """
    ordered = sorted(points, key=lambda point: (float(point[0]), float(point[1])))
    chain: list[Point] = []
    for run in (ordered, ordered[::-1]):
        first = len(chain)
        for point in run:
            while len(chain) - first >= 2:
                before, last = chain[-2:]
                if not cross(subtract(last, before), subtract(point, last)) < 0:
                    break
                chain.pop()
            chain.append(point)
    return chain


def find_missing_figure(fixture: Fixture, query: Query) -> str:
    """Return a sentence, without full stop, on the first figure of quality that is missing or should not be
    there; else "".
    """
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
    """Return whether the toolkit has a wall or jaw of finite width."""
    return any(carrier.width is not None for carrier in query.toolkit.carriers)


def judge_written_numbers(
    fixture: Fixture, names: Sequence[str], balance: Balance | SeatBalance, figures: Mapping[str, arb]
) -> Iterator[Finding]:
    """Yield a finding for each peg force and figure of quality in the file that differs from the derived one.

    ``names`` are those of the pegs. The file's numbers were computed in double precision from a rounded pose.
    A derived figure may be a range, such as a count at the edge of its rule; then any number in the range is
    right.
    """
    part = bound_relative_error(balance.forces)
    for name, peg, force in zip(names, fixture.pegs, balance.forces, strict=True):
        yield from judge_written_number(f"the force of {name}", peg.force, force, part * abs(force))
    for key, derived in figures.items():
        if key in fixture.quality:
            if key in COUNTS and not fixture.quality[key].is_integer():
                yield Finding(
                    True, f"its {key} is {fixture.quality[key]:.12g} in the file, which is not a whole number"
                )
            spare = part * abs(derived) + (2 * derived.rad() if key in RANGES else 0)
            yield from judge_written_number(
                f"its {key.replace('_', ' ')}", fixture.quality[key], derived, spare
            )
