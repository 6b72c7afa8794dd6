"""Three locators that alone fix the pose, and two clamps that press the part on them, in ball arithmetic.

Let w_i = (n_i, q_i x n_i) be the wrenches of the locators, and W = [w_1 w_2 w_3]. Per unit of force on the
face of a clamp with the wrench w, the locators' forces are a = -W^-1 w. Per unit of the clamp's own force
they are b = a / p. Here p is its push, the component of the force on the face along its direction. With
forces f1, f2 of two clamps the locators' forces are b1 f1 + b2 f2. Apart from det W none of this depends on
the scale of moments, or on their reference point.

Glossary
--------
taken : a, the locators' forces per unit of force on a clamp's face.
reactions : b, the locators' forces per unit of a clamp's own force.
ratio : the open interval of f2 / f1 in which all three locators are pressed.
freedom : width of that interval in degrees, its ends taken as angles.
working ratio : its middle as an angle.
closure margin : the least entry of a null vector of all five wrenches with sum 1, maximized over these
    vectors.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import combinations
from math import inf

from attrs import frozen
from flint import arb, arb_mat

from workhold.model.fixture import ClampPair
from workhold.verification.ball_geometry import (
    Point,
    compute_dot_product,
    cross,
    find_largest,
    find_least,
    turn_vector,
)
from workhold.verification.contacts import (
    BallContact,
    BallPose,
    bound_relative_error,
    compute_inner_product,
    invert_matrix,
)
from workhold.verification.tolerances import (
    LEAST_PUSH,
    LEAST_SEAT,
    LEAST_SHARE,
    MOST_FORCE,
    NO_REACTION,
    Finding,
    format_middle,
    judge_slack,
    judge_written_number,
)

__all__ = [
    "CLAMPS",
    "LOCATORS",
    "LocatorWrenches",
    "ClampPush",
    "ClampForceRatio",
    "SeatBalance",
    "compute_closure_margin",
    "find_ratio",
]

LOCATORS = 3
CLAMPS = ("clamp 1", "clamp 2")


@frozen(eq=False)
class LocatorWrenches:
    """Three locators, by the points where they touch.

    Parameters
    ----------
    points : their centres in mm, or the points that touch a wall, in the workpiece's frame.
    normals : the outward unit normals there.
    """

    points: Sequence[Point]
    normals: Sequence[Point]

    @classmethod
    def from_contacts(cls, contacts: Sequence[BallContact], pose: BallPose) -> LocatorWrenches:
        """Return the wrenches of three contacts: three locators, or the two ends
        of a wall's contact and a locator.
        """
        return cls(
            [contact.compute_center_in_part(pose) for contact in contacts],
            [contact.compute_outward_normal(pose) for contact in contacts],
        )

    def make_push(self, contact: BallContact, pose: BallPose) -> ClampPush:
        """Return how the three locators react to a clamp at a pose.

        The clamp presses along -n, n being the face's outward normal, and clamps by moving against its travel
        direction.
        """
        point = contact.compute_center_in_part(pose)
        normal = contact.side.compute_outward_normal(point)
        return ClampPush(
            self.compute_reactions(point, normal),
            compute_dot_product(turn_vector(contact.way, pose.cosine, -pose.sine), normal),
        )

    @cached_property
    def wrenches(self) -> list[tuple[arb, arb, arb]]:
        """Normals, and moments about the workpiece's origin in mm."""
        return [(*n, cross(q, n)) for q, n in zip(self.points, self.normals, strict=True)]

    @cached_property
    def determinant(self) -> arb:
        """The determinant of the three wrenches, in mm."""
        return arb_mat(self.wrenches).det()

    def compute_reactions(self, point: Point, normal: Point) -> tuple[arb, arb, arb]:
        """Return the locators' forces per unit of force on a clamp's face, by Cramer's rule.

        ``point`` and ``normal`` are the clamp's centre and the outward unit normal there, in the part's
        frame.
        """
        own = (*normal, cross(point, normal))
        replaced = (arb_mat([*self.wrenches[:k], own, *self.wrenches[k + 1 :]]) for k in range(LOCATORS))
        a, b, c = (-matrix.det() / self.determinant for matrix in replaced)
        return a, b, c


@frozen(eq=False)
class ClampPush:
    """The reaction of the locators to a clamp's force.

    Parameters
    ----------
    taken : the forces of the three locators per unit of force on the clamp's face.
    push : the clamp's own force per unit of force on its face.
    """

    taken: tuple[arb, arb, arb]
    push: arb

    @cached_property
    def reactions(self) -> list[arb]:
        """The forces of the three locators per unit of the clamp's own force."""
        return [entry / self.push for entry in self.taken]

    @property
    def largest_share(self) -> arb:
        """The largest size of a locator force, per unit of force on the clamp's face."""
        return find_largest([abs(entry) for entry in self.taken])

    @cached_property
    def least_share(self) -> arb:
        """The least locator force divided by the sum of 1 and all sizes of locator forces; above 0 where this
        clamp alone holds the part.
        """
        a, b, c = self.taken
        return a.min(b).min(c) / (1 + abs(a) + abs(b) + abs(c))


@frozen(eq=False)
class ClampForceRatio:
    """The open interval of the second clamp's force over the first's in which all locators are pressed.

    Parameters
    ----------
    low : its lower end.
    high : its upper end, None if there is none.
    """

    low: arb
    high: arb | None

    @property
    def angles(self) -> tuple[arb, arb]:
        """The ends of the interval as angles in radians."""
        return self.low.atan(), arb.pi() / 2 if self.high is None else self.high.atan()

    @property
    def freedom(self) -> arb:
        """The width in degrees of the interval, its ends taken as angles; negative if the interval is empty."""
        low, high = self.angles
        return (high - low) * 180 / arb.pi()

    @property
    def forces(self) -> tuple[arb, arb]:
        """The forces of both clamps per unit of their sum at the working ratio."""
        low, high = self.angles
        sine, cosine = ((low + high) / 2).sin_cos()
        return cosine / (cosine + sine), sine / (cosine + sine)


def find_ratio(one: ClampPush, other: ClampPush) -> ClampForceRatio | None:
    """Return the interval of f2/f1, the second clamp's force over the first's, in which all locators are
    pressed.

    It may be empty (negative ``freedom``). Returns None if it is uncertain whether a reaction counts as 0.
    """
    low, high = arb(0), None
    for first, second in zip(one.reactions, other.reactions, strict=True):
        a, b = round_tiny_reaction_to_zero(first), round_tiny_reaction_to_zero(second)
        if a is None or b is None:
            return None
        if b > 0:
            low = low.max(-a / b)
        elif b < 0:
            high = -a / b if high is None else high.min(-a / b)
        elif not a > 0:
            high = arb(0)
    return ClampForceRatio(low, high)


def round_tiny_reaction_to_zero(reaction: arb) -> arb | None:
    """Return 0 for a reaction smaller in size than ``NO_REACTION``, else the reaction itself.

    Returns None where the precision does not decide between the two.
    """
    size = abs(reaction)
    return arb(0) if size < NO_REACTION else reaction if size > NO_REACTION else None


def compute_closure_margin(one: ClampPush, other: ClampPush) -> arb:
    """Return the closure margin: the least entry of a null vector of the five wrenches with sum 1, maximized
    over these vectors.

    It is 0 if the wrenches do not close. With a_i the locator forces ``taken`` of each clamp, the null
    vectors are (1 - s) (a_1, 1, 0) + s (a_2, 0, 1), scaled to sum 1. Before scaling every entry is linear in
    s, 0 <= s <= 1, so the least entry is greatest where two entries are equal. Pairs of entries whose
    difference may be constant are skipped, because another pair then decides.
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
            best = best.max(find_least(entries) / total)
    return best


@frozen(eq=False)
class SeatBalance:
    """The forces of three locators and two clamps.

    Parameters
    ----------
    points, normals : the pegs' centres in mm and the outward unit normals, in the workpiece's frame.
    seat : the locators; the ends of a wall's contact count as two.
    pushes : both clamps.
    known_ratio : the interval of the clamps' force ratio; None if it is uncertain whether a reaction counts
        as 0.
    """

    points: Sequence[Point]
    normals: Sequence[Point]
    seat: LocatorWrenches
    pushes: tuple[ClampPush, ClampPush]
    known_ratio: ClampForceRatio | None

    @classmethod
    def from_contacts(cls, contacts: Sequence[BallContact], pose: BallPose) -> SeatBalance:
        """Return the balance of five contacts: three fixed ones, then two clamps."""
        seat = LocatorWrenches.from_contacts(contacts[:LOCATORS], pose)
        first, second = (seat.make_push(contact, pose) for contact in contacts[LOCATORS:])
        points, normals = zip(
            *(
                (contact.compute_center_in_part(pose), contact.compute_outward_normal(pose))
                for contact in contacts
            ),
            strict=True,
        )
        return cls(points, normals, seat, (first, second), find_ratio(first, second))

    @property
    def ratio(self) -> ClampForceRatio:
        """The interval of the clamps' force ratio; ``known_ratio`` must not be None."""
        assert self.known_ratio is not None
        return self.known_ratio

    def judge_pushes(self, wrench_length: float) -> Iterator[Finding]:
        """Yield a finding where the locators do not fix the pose, a clamp does not
        push, or one clamp holds the part alone.

        ``wrench_length`` is L in mm.
        """
        spanned = abs(self.seat.determinant) / wrench_length
        yield from judge_slack(
            spanned - LEAST_SEAT,
            f"the locators do not fix the pose: their wrenches have a determinant of only {format_middle(spanned)}",
        )
        for name, push in zip(CLAMPS, self.pushes, strict=True):
            yield from judge_slack(
                push.push - LEAST_PUSH,
                f"{name} does not push the part: its share is {format_middle(push.push)}",
                f"the push of {name} is exactly at its limit",
            )
            yield from judge_slack(
                MOST_FORCE * push.push - push.largest_share,
                f"{name} presses a locator with {format_middle(push.largest_share / push.push)} times its own force",
                f"the force of a locator under {name} is exactly at its limit",
            )
            yield from judge_slack(
                NO_REACTION - push.least_share,
                f"{name} holds the part without the other: its least share is {format_middle(push.least_share)}",
                f"whether {name} holds the part without the other is exactly at its limit",
            )

    def judge_closure(self) -> Iterator[Finding]:
        """Yield a finding if no ratio of the clamps' forces presses all locators, or if that is uncertain."""
        if self.known_ratio is None:
            yield Finding(False, "a locator's force is exactly at the edge of what counts as none")
            return
        words = "the clamps do not hold the part: at no ratio of their forces are all locators pressed"
        freedom = self.ratio.freedom
        if not freedom > 0:
            yield Finding(bool(freedom < 0) or bool(self.margin < LEAST_SHARE), words)
            return
        yield from judge_slack(
            self.margin - LEAST_SHARE,
            f"the clamps do not hold the part: the closure margin is {format_middle(self.margin)}",
            "the closure margin is exactly at its limit",
        )

    @cached_property
    def reactions(self) -> list[tuple[arb, arb]]:
        """For each of the five pegs, its force per unit of the first clamp's
        force and per unit of the second's.
        """
        one, other = self.pushes
        own = [(1 / one.push, arb(0)), (arb(0), 1 / other.push)]
        return [*zip(one.reactions, other.reactions, strict=True), *own]

    @cached_property
    def forces(self) -> list[arb]:
        """The force of each peg at the working ratio, per unit of the sum of both clamps' forces."""
        first, second = self.ratio.forces
        return [first * a + second * b for a, b in self.reactions]

    @cached_property
    def shares(self) -> list[arb]:
        """The forces scaled to sum 1."""
        total = sum(self.forces, arb(0))
        return [force / total for force in self.forces]

    @cached_property
    def margin(self) -> arb:
        """The closure margin, see :func:`compute_closure_margin`."""
        return compute_closure_margin(*self.pushes)

    @cached_property
    def inverse(self) -> list[list[arb]] | None:
        """The inverse (3, 3) of the matrix with rows (n, q x n), one for each locator; None if it may be
        singular.
        """
        return invert_matrix([list(wrench) for wrench in self.seat.wrenches])

    @property
    def responses(self) -> list[list[arb]]:
        """Three rows: the force of each of the five pegs per unit of g_x, of g_y and of the moment of a load.

        The forces of the two clamps are 0.
        """
        return [[*row, arb(0), arb(0)] for row in self.inverse or ()]

    def judge_numbers(self, pair: ClampPair, names: Sequence[str]) -> Iterator[Finding]:
        """Yield a finding for each reaction and each end of the force ratio's interval that differs from the
        file.

        ``pair`` holds the file's numbers, ``names`` the names of the pegs.
        """
        part = bound_relative_error(self.forces)
        for name, said, derived in zip(names, pair.reactions, self.reactions, strict=True):
            for clamp, value, force in zip(CLAMPS, said, derived, strict=True):
                yield from judge_written_number(
                    f"the force of {name} under {clamp}", value, force, part * (1 + abs(force))
                )
        # The ends follow from reactions that are off.
        (low, high), ratio = pair.ratio, self.ratio
        least = [abs(b) for _, b in self.reactions[:LOCATORS] if abs(b) > NO_REACTION]
        part *= 1 + find_largest([1 / b for b in least]) if least else arb(1)
        yield from judge_written_number("the lower end of its ratio", low, ratio.low, part * (1 + ratio.low))
        if (ratio.high is None) != (high == inf):
            end = "has none" if ratio.high is None else f"is {format_middle(ratio.high)}"
            yield Finding(True, f"the upper end of its ratio {end}, and the file says otherwise")
        elif ratio.high is not None:
            yield from judge_written_number(
                "the upper end of its ratio", high, ratio.high, part * (1 + ratio.high)
            )

    def project_on_closing(self, forces: Sequence[arb]) -> list[arb]:
        """Return the orthogonal projection of peg forces on the plane spanned by both clamps' closing
        forces.
        """
        ones, others = zip(*self.reactions, strict=True)
        aa, ab, bb = (
            compute_inner_product(ones, ones),
            compute_inner_product(ones, others),
            compute_inner_product(others, others),
        )
        fa, fb, area = (
            compute_inner_product(forces, ones),
            compute_inner_product(forces, others),
            aa * bb - ab * ab,
        )
        u, v = (fa * bb - fb * ab) / area, (fb * aa - fa * ab) / area
        return [u * a + v * b for a, b in self.reactions]
