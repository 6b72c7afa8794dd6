"""The pose of a fixture, proven to be unique near the one in its file, and the check of restrictions.

Theorem (Krawczyk 1969): let f be continuously differentiable on a box X with midpoint m, J(X) an enclosure of
its Jacobian on X and Y any matrix. If

    K = m - Y f(m) + (I - Y J(X)) (X - m)

lies in the interior of X, then f has exactly one zero in X, and it lies in K.

Restrictions are faces to avoid, keep-out zones, angles, blocked holes and bodies. They are not claims of
existence, so the written pose is enough. A restriction is broken when it is missed by more than
``tolerances.AGREEMENT``.

References
----------
R. Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken", Computing 4 (1969), pp.
187-201.
S. M. Rump, "Verification methods", Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import inf, radians

from flint import arb, arb_mat, ctx

from workhold.model.fixture import Fixture, Peg
from workhold.model.pose import Pose
from workhold.model.query import Query
from workhold.model.requirements import Zone
from workhold.model.workpiece import Workpiece
from workhold.verification.ball_geometry import (
    ArcSide,
    Point,
    Side,
    compute_dot_product,
    cross,
    find_least,
    make_exact_point,
    make_loop_sides,
    subtract,
    turn_vector,
)
from workhold.verification.contacts import BallContact, BallPose, evaluate_contact_system, make_joint_outline
from workhold.verification.rules.hardware import ToolkitRules
from workhold.verification.rules.wall import WallContact
from workhold.verification.tolerances import AGREEMENT, Finding, format_middle, judge_slack

__all__ = [
    "find_broken_restriction",
    "enclose_zero",
    "find_avoided_faces",
    "judge_gaps",
    "prove_pose",
    "enclose_written_pose",
    "compute_zone_distance",
]

# Values (N x 1) and Jacobian (N x N) of a system on a box (N x 1) of unknowns.
System = Callable[[arb_mat], tuple[arb_mat, arb_mat]]

MOST_STEPS = 12


def enclose_zero(system: System, start: Sequence[float]) -> list[arb] | None:
    """Return proven balls for the only zero of ``system`` near ``start``; None if the precision does not
    prove it.

    Newton's method on midpoints finds the zero, and Krawczyk's theorem proves it. The box around it has a
    radius of 2^(-bits/2).
    """
    size = len(start)
    middle = arb_mat(size, 1, list(start))
    small = arb(2) ** (-ctx.prec // 2)
    try:
        for _ in range(MOST_STEPS):
            values, jacobian = system(middle)
            step = jacobian.mid().solve(values.mid()).mid()
            middle = (middle - step).mid()
            if all(abs(entry) < small * small * 2**16 for entry in step.entries()):
                break
        values, jacobian = system(middle)
        inverse = jacobian.mid().inv().mid()
    except ZeroDivisionError:
        return None
    around = arb_mat(size, 1, [arb(0, small)] * size)
    box = middle + around
    identity = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
    image = middle - inverse * values + (identity - inverse * system(box)[1]) * around
    inner = zip(box.entries(), image.entries(), strict=True)
    return image.entries() if all(outer.contains_interior(k) for outer, k in inner) else None


def enclose_written_pose(written: Pose, travels: Sequence[float]) -> BallPose:
    """Return a ball (an enclosure) of all poses whose numbers differ from the written ones by at most
    ``AGREEMENT``.

    ``travels`` are the written travels in mm.
    """
    off = arb(0, AGREEMENT)
    theta = (written.theta_deg + off) * arb.pi() / 180
    return BallPose.from_turn_and_place(
        theta, written.x + off, written.y + off, *(travel + off for travel in travels)
    )


def judge_gaps(touching: Sequence[tuple[str, BallContact, int]], around: BallPose) -> Iterator[Finding]:
    """Yield a definite finding for each contact that certainly does not touch, at any pose near the written
    one.

    ``touching`` holds (name, contact, face number); ``around`` is the ball of poses near the written one.
    """
    for name, contact, face in touching:
        off = contact.side.compute_gap(contact.compute_center_in_part(around)) - contact.radius
        if off > 0 or off < 0:
            yield Finding(True, f"{name} is {format_middle(off)} mm away from touching face {face}")


def prove_pose(
    contacts: Sequence[BallContact], written: Pose, travels: Mapping[str, float]
) -> tuple[BallPose | None, list[Finding]]:
    """Return (pose, findings against the file), where the pose solves the contact equations near the file's
    pose.

    The pose is a proven enclosure, or None where it is not proven. ``travels`` are the file's in mm, by name.
    """
    values = [written.theta_deg, written.x, written.y, *travels.values()]
    zero = enclose_zero(partial(evaluate_contact_system, contacts), [radians(written.theta_deg), *values[1:]])
    if zero is None:
        words = "the contact equations have no single solution that can be proven near the pose in the file"
        return None, [Finding(False, words)]
    findings: list[Finding] = []
    names = [("angle", "degrees"), ("x", "mm"), ("y", "mm"), *((name, "mm") for name in travels)]
    touched = f"all {'five' if len(contacts) > 4 else 'four'} faces"
    found = [zero[0] * 180 / arb.pi(), *zero[1:]]
    for (name, unit), derived, value in zip(names, found, values, strict=True):
        off = abs(derived - value)
        words = f"the {name} in the file is {format_middle(off)} {unit} from the one that touches {touched}"
        findings += judge_slack(AGREEMENT - off, words)
    return BallPose.from_turn_and_place(*zero), findings


def find_broken_restriction(fixture: Fixture, query: Query, hardware: ToolkitRules) -> str:
    """Return a sentence, without full stop, on the first restriction that a fixture breaks; "" if it
    satisfies all.
    """
    restrictions = query.restrictions
    avoided = find_avoided_faces(query)
    bare = find_faces_without_band(query.workpiece)
    for name, peg in hardware.list_placed(fixture):
        if peg.face in bare:
            return f"{name} touches face {peg.face}, over which no upright face of the solid stands"
        if peg.face in avoided:
            return f"{name} touches face {peg.face}, which is to be avoided"
        reach = hardware.carriers[peg.carrier].body_radius - AGREEMENT
        if any(
            compute_zone_distance(zone, map_peg_to_part(fixture, peg)) < reach for zone in restrictions.zones
        ):
            return f"{name} stands over a keep-out zone"
    theta = fixture.pose.theta_deg
    inside = (
        (theta - low + AGREEMENT) % 360.0 <= high - low + 2 * AGREEMENT for low, high in restrictions.angles
    )
    if restrictions.angles and not any(inside):
        return f"the part lies at {theta:g} degrees, which is outside the angles asked for"
    broken = find_restriction_broken_at_wall(
        fixture, query, hardware, avoided | bare
    ) or hardware.find_crowding(fixture)
    return broken or find_untouched_face(fixture, query, hardware) or find_imprecision(fixture, query)


def find_untouched_face(fixture: Fixture, query: Query, hardware: ToolkitRules) -> str:
    """Return a sentence on the first face that the query requires and the fixture does not touch; "" for
    none.
    """
    if not query.restrictions.touch:
        return ""
    touched = {face for peg in fixture.pegs for face in (peg.face, peg.beside) if face is not None}
    for contact in hardware.make_contacts(fixture, make_joint_outline(query.workpiece)):
        touched |= set(contact.faces) if isinstance(contact, WallContact) else set()
    for face in query.workpiece.numbered.faces:
        if not set(face.segments).isdisjoint(query.restrictions.touch) and face.number not in touched:
            return f"nothing touches face {face.number}, which is to be touched"
    return ""


def find_imprecision(fixture: Fixture, query: Query) -> str:
    """Return a sentence if the fixture's written location error is above the query's limit, else ""."""
    most, error = query.max_location_error, fixture.quality.get("location_error", inf)
    if most is None or error <= most + AGREEMENT:
        return ""
    return f"its location error is {error:g} mm, and at most {most:g} mm is asked for"


def find_faces_without_band(workpiece: Workpiece) -> set[int]:
    """Return the numbers of the faces that have a segment at which the solid has no upright face; empty for a
    prism.
    """
    bands = workpiece.numbered.bands
    return {
        face.number
        for face in workpiece.numbered.faces
        if any(bands[k] is None for k in face.segments if bands)
    }


def find_avoided_faces(query: Query) -> set[int]:
    """Return the numbers of the faces that no peg may touch, in all outlines of the part.

    A face of a further outline is avoided if it comes from the same face of the solid as an avoided segment.
    """
    avoid, every = set(query.restrictions.avoid), query.workpiece.numbered
    if query.workpiece.outlines and every.over:
        cut = {face for segment in avoid for face in every.over[segment]}
        avoid |= {segment for segment, over in enumerate(every.over) if cut.intersection(over)}
    return {face.number for face in every.faces if avoid.intersection(face.segments)}


def find_restriction_broken_at_wall(
    fixture: Fixture, query: Query, hardware: ToolkitRules, avoided: set[int]
) -> str:
    """Return a sentence if an avoided face lies on a wall, or a wall is in a keep-out zone; else "".

    ``avoided`` are the numbers of the avoided faces.
    """
    sine, cosine = (arb(fixture.pose.theta_deg) / 180).sin_cos_pi()
    for wall in hardware.walls:
        # Of a corner on a wall both faces are to be avoided.
        contacts = hardware.make_contacts(fixture, make_joint_outline(query.workpiece)) if avoided else []
        for contact in contacts:
            if isinstance(contact, WallContact) and avoided.issuperset(contact.faces):
                return (
                    f"the part lies on the {wall.noun} with face {contact.faces[0]}, which is to be avoided"
                )
        for zone in query.restrictions.zones:
            if compute_zone_low(zone, cosine, sine) + fixture.pose.y < -AGREEMENT:
                return f"the {wall.noun} stands in a keep-out zone"
    return ""


def map_peg_to_part(fixture: Fixture, peg: Peg) -> Point:
    """Return a peg's centre in the part's frame in mm, in ball arithmetic; independent
    of the class ``Pose``.
    """
    sine, cosine = (arb(fixture.pose.theta_deg) / 180).sin_cos_pi()
    return turn_vector(make_exact_point(peg.x - fixture.pose.x, peg.y - fixture.pose.y), cosine, -sine)


def compute_zone_low(zone: Zone, cosine: arb, sine: arb) -> arb:
    """Return the lowest y in mm of a zone turned about the part's origin by
    the angle with this cosine and sine.
    """
    heights = []
    for side in make_loop_sides(zone.loop):
        heights += [turn_vector(point, cosine, sine)[1] for point in (side.start, side.end)]
        if isinstance(side, ArcSide) and not side.measure_within((-sine, -cosine)) < 0:
            heights.append(turn_vector(side.center, cosine, sine)[1] - side.radius)
    return find_least(heights)


def compute_zone_distance(zone: Zone, point: Point) -> arb:
    """Return the distance in mm from a point to a zone, 0 inside it; both in the part's frame."""
    sides = make_loop_sides(zone.loop)
    nearest = find_least([side.compute_distance(point) for side in sides])
    # On the chord of an arc, as at a circle's centre, turns are not certain. Nearer than any side all is
    # inside, or none is.
    reach = nearest.abs_lower()
    for across, along in ((0.0, 0.0), (0.5, 0.25), (-0.25, 0.5)):
        turns = compute_turn_around(sides, (point[0] + across * reach, point[1] + along * reach))
        if turns > arb.pi():
            return arb(0)
        if turns < arb.pi():
            break
    return nearest


def compute_turn_around(sides: Sequence[Side], point: Point) -> arb:
    """Return the angle in radians by which a closed chain of sides winds around a point not on it: 2 pi
    inside, 0 outside.

    An arc winds around the point by the same angle as its chord, or by a whole turn more or less if the point
    lies between arc and chord.
    """
    total = arb(0)
    for side in sides:
        a, b = subtract(side.start, point), subtract(side.end, point)
        total += arb.atan2(cross(a, b), compute_dot_product(a, b))
        if isinstance(side, ArcSide):
            beside = side.sign * cross(a, b) < 0
            ray = side.measure_from_center(point)
            if beside and compute_dot_product(ray, ray) < side.radius * side.radius:
                total += side.sign * 2 * arb.pi()
    return total
