"""What double precision leaves open, decided in ball arithmetic (python-flint).

A candidate is a box of the four unknowns (psi, tail x, tail y, separation) that holds the exact contact, if
there is one. ``proof.narrowing`` makes it smaller by two rules of one or two unknowns. At a nearly double
solution three directions of the box are well determined and one is not, so the box is turned into the
directions of the Jacobian's singular vectors. There, boxes in which some contact equation has no zero, or in
which some rule is broken everywhere, are dropped. The interval Newton method (Hansen and Sengupta) makes the
others smaller. It shows that there is none or exactly one solution, which then is judged at rising precision.
What remains is cut in three. What is left after ``MOST_BOXES`` boxes stays undecided.

References: E. Hansen, S. Sengupta, "Bounding solutions of systems of equations using interval analysis",
BIT 21 (1981) 203-211; F. Johansson, "Arb", IEEE Transactions on Computers 66 (2017) 1281-1292.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite, pi

import numpy as np
from attrs import frozen
from flint import arb, arb_mat, ctx
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK, LEAST_CLAMPING, LEAST_CLOSURE, LEAST_PUSH, LEAST_SEAT, LEAST_SPAN
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    REST_X,
    REST_Y,
    SIGN,
    X,
    Y,
)
from workhold.kernels.base.given import Limits
from workhold.model.search_report import AT_AN_EDGE, NEARLY_DOUBLE
from workhold.proof.narrowing import CandidateBox, contact_value, from_origin, narrowed

__all__ = ["BoxOutcome", "solutions_in"]

PRECISIONS = (128, 256, 512)
MOST_BOXES = 10000
# The exact solution of a box may lie on its rim, so boxes are made larger by this part.
RIM = 0.1
# A place is looked at again when a step leaves less than this of a side.
SMALLER = 0.7
# The middle one of three parts has this part of a side, and each part is so much larger than its share.
MIDDLE, OVERLAP = 0.125, 1.0002


@frozen
class BoxOutcome:
    """What became of a box: the middles of solutions proven to be fixtures, and why it is undecided."""

    fixtures: tuple[tuple[float, float, float, float], ...]
    reason: str


@frozen(eq=False)
class BoxContacts:
    """Contacts on a box of unknowns, as balls.

    They are centres, unit normals (outward), arms from the first peg to each, equations and their Jacobian.
    """

    rows: Sequence[Sequence[float]]
    centers: list[tuple[arb, arb]]
    normals: list[tuple[arb, arb]]
    arms: list[tuple[arb, arb]]
    values: list[arb]
    slopes: list[list[arb]]
    axis: tuple[arb, arb]


def places(box: CandidateBox, unknowns: Sequence[arb]) -> BoxContacts:
    """Everything about the four contacts on a box of unknowns."""
    psi, x, y, separation = unknowns
    cosine, sine = psi.cos(), psi.sin()
    centers, normals, arms, values, slopes = [], [], [], [], []
    for k, (row, (dx, dy)) in enumerate(zip(box.features, box.offsets, strict=True)):
        moves = int(k >= box.standing)
        reach = (dx + moves * separation, arb(dy))
        turned = (cosine * reach[0] - sine * reach[1], sine * reach[0] + cosine * reach[1])
        center = (x + turned[0], y + turned[1])
        if row[IS_ARC] == 0.0:
            size = (arb(row[AXIS_X]) ** 2 + arb(row[AXIS_Y]) ** 2).sqrt()
            gradient = (row[AXIS_Y] / size, -row[AXIS_X] / size)
            normal = gradient
        else:
            ray = from_origin(row, center)
            gradient = (ray[0] / row[RADIUS], ray[1] / row[RADIUS])
            normal = (row[SIGN] * gradient[0], row[SIGN] * gradient[1])
        slope = [gradient[1] * turned[0] - gradient[0] * turned[1], gradient[0], gradient[1]]
        slope.append((gradient[0] * cosine + gradient[1] * sine) * moves)
        centers.append(center)
        normals.append(normal)
        arms.append(turned)
        values.append(contact_value(row, center))
        slopes.append(slope)
    return BoxContacts(box.features, centers, normals, arms, values, slopes, (cosine, sine))


def slacks(box: CandidateBox, here: BoxContacts, minors: Sequence[arb], limits: Limits) -> list[arb]:
    """Numbers that are positive for a fixture: ends, gap, span, closure, clamping (for the better sign).

    Of one of two clamps they are ends, the determinant of the standing pegs' wrenches, and its push.
    """
    out = [
        slack
        for row, center in zip(box.features, here.centers, strict=True)
        for slack in end_slacks(row, center, limits.contact_margin)
    ]
    along = [here.axis[0] * x + here.axis[1] * y for x, y in here.centers]
    if isfinite(limits.gap):
        for one in along[: box.standing]:
            out += [other - one - (arb(limits.gap) - GAP_SLACK) for other in along[box.standing :]]
    if limits.pairing:
        x, y = here.normals[3]
        facing = int(limits.clamping) * (x * here.axis[0] + y * here.axis[1])
        return [*out, abs(minors[3]) - LEAST_SEAT, facing - LEAST_PUSH]
    size = sum((abs(minor) for minor in minors), arb(0))
    out.append(size - LEAST_SPAN)
    sign = 1 if sum(float(minor.mid()) for minor in minors) >= 0 else -1
    if any(sign * minor < 0 for minor in minors) and not any(sign * minor > 0 for minor in minors):
        sign = -sign
    for minor in minors:
        out.append(sign * minor - LEAST_CLOSURE * size)
    sign *= int(limits.clamping)
    push = [
        sign * minor * (n[0] * here.axis[0] + n[1] * here.axis[1])
        for minor, n in zip(minors, here.normals, strict=True)
    ]
    # The force is the push of the standing pegs, and as well what the moving pegs take up.
    out.append(-sum(push[: box.standing], arb(0)) - LEAST_CLAMPING * size)
    out.append(sum(push[box.standing :], arb(0)) - LEAST_CLAMPING * size)
    return out


def end_slacks(row: Sequence[float], center: tuple[arb, arb], margin: float) -> list[arb]:
    """Distances in mm of a contact from breaking the rule of ends at both ends of its feature, in balls."""
    dx, dy = from_origin(row, center)
    along, across = dx * row[AXIS_X] + dy * row[AXIS_Y], dy * row[AXIS_X] - dx * row[AXIS_Y]
    place, scale, half = along, 1.0, row[HALF_EXTENT]
    if row[IS_ARC] != 0.0:
        if half >= pi:
            return []
        place, scale = arb.atan2(across, along), row[RADIUS]
    return [
        (half - place) * scale - margin + row[HIGH_SLACK],
        (half + place) * scale - margin + row[LOW_SLACK],
    ]


def wrench_minors(here: BoxContacts, length: float) -> list[arb]:
    """Signed 3 x 3 minors of the wrenches (n, q x n / L); in balls, as no kernel is."""
    n = here.normals
    # The minors do not depend on the point that moments are taken about; from the first peg the others are
    # known best.
    t = [(q[0] * m[1] - q[1] * m[0]) / length for q, m in zip(here.arms, n, strict=True)]

    def cross(i: int, j: int) -> arb:
        one, two = here.rows[i], here.rows[j]
        if one[IS_ARC] == 0.0 or two[IS_ARC] == 0.0:
            return n[i][0] * n[j][1] - n[i][1] * n[j][0]
        # Between arcs only the difference of the rays from their centres counts, which depends on the
        # orientation alone where both pegs are on one carrier: parallel normals stay so wherever the part
        # slides.
        x = here.arms[j][0] - here.arms[i][0] - (arb(two[X]) - one[X]) - (arb(two[REST_X]) - one[REST_X])
        y = here.arms[j][1] - here.arms[i][1] - (arb(two[Y]) - one[Y]) - (arb(two[REST_Y]) - one[REST_Y])
        return (n[i][0] * y - n[i][1] * x) * (two[SIGN] / arb(two[RADIUS]))

    out = []
    for k in range(4):
        a, b, c = (i for i in range(4) if i != k)
        minor = t[a] * cross(b, c) - t[b] * cross(a, c) + t[c] * cross(a, b)
        out.append(-minor if k % 2 else minor)
    return out


@frozen(eq=False)
class SingularFrame:
    """Directions of the Jacobian's singular vectors at the middle of a box.

    Parameters
    ----------
    box : the candidate.
    right : (4, 4) directions of the unknowns (psi scaled by L), one in each column, the worst determined
        last.
    combining, turning : combinations of the contact equations, one in each row, and ``right``, both as exact
        balls.
    length : L in mm.
    """

    box: CandidateBox
    right: NDArray[np.float64]
    combining: arb_mat
    turning: arb_mat
    length: float

    @classmethod
    def of(cls, box: CandidateBox, limits: Limits) -> SingularFrame:
        """The frame of a box."""
        slopes = places(box, [arb(m) for m in box.middle]).slopes
        jacobian = np.array([[float(s.mid()) for s in row] for row in slopes])
        jacobian[:, 0] /= limits.wrench_length
        u, _, v = np.linalg.svd(jacobian)
        left, right = (arb_mat(4, 4, [float(e) for e in matrix.T.ravel()]) for matrix in (u, v))
        return cls(box, v.T, left, right, limits.wrench_length)

    def start(self) -> list[arb]:
        """The whole box, in the frame's coordinates in mm, a little larger."""
        reach = [self.box.reach[0] * self.length, *self.box.reach[1:]]
        spans = np.abs(self.right.T) @ np.array(reach)
        return [arb(0, float(span) * (1.0 + RIM)) for span in spans]

    def unknowns(self, place: Sequence[arb]) -> list[arb]:
        """The unknowns at a place in the frame."""
        turn, *rest = (self.turning * arb_mat(4, 1, place)).entries()
        steps = turn / self.length, *rest
        return [m + s for m, s in zip(self.box.middle, steps, strict=True)]

    def places(self, place: Sequence[arb]) -> BoxContacts:
        """The contacts at a place in the frame."""
        return places(self.box, self.unknowns(place))

    def values(self, here: BoxContacts) -> list[arb]:
        """The combined contact equations."""
        return list((self.combining * arb_mat(4, 1, here.values)).entries())

    def slopes(self, here: BoxContacts) -> list[list[arb]]:
        """The Jacobian of the combined contact equations by the frame's coordinates."""
        scaled = [[row[0] / self.length, *row[1:]] for row in here.slopes]
        slopes = self.combining * arb_mat(scaled) * self.turning
        return [[slopes[i, j] for j in range(4)] for i in range(4)]

    def step(
        self, place: list[arb], here: BoxContacts, regular: bool = False
    ) -> tuple[list[arb] | None, bool]:
        """The part of a place that may hold solutions, None without one, and whether it holds exactly one.

        This is a step of the interval Newton method; ``here`` are the contacts at the place. A ``regular``
        step combines the equations by the inverse of their own Jacobian at the place's middle, if it has
        one. Near a simple solution next to a double one, the Jacobian at the whole box's middle
        does not separate the directions.
        """
        middle = [arb(p.mid()) for p in place]
        values, slopes = self.values(self.places(middle)), self.slopes(here)
        if regular:
            try:
                inverse = arb_mat(slopes).mid().inv().mid()
            except ZeroDivisionError:
                return place, False
            values = list((inverse * arb_mat(4, 1, values)).entries())
            combined = inverse * arb_mat(slopes)
            slopes = [[combined[i, j] for j in range(4)] for i in range(4)]
        out, inside = list(place), True
        for k in range(4):
            rest = values[k] + sum((slopes[k][j] * (out[j] - middle[j]) for j in range(4) if j != k), arb(0))
            if slopes[k][k].contains(0):
                inside = False
                if not (rest + slopes[k][k] * (out[k] - middle[k])).contains(0):
                    return None, False
                continue
            image = middle[k] - rest / slopes[k][k]
            if not image.overlaps(out[k]):
                return None, False
            inside = inside and out[k].contains_interior(image)
            out[k] = image if out[k].contains(image) else out[k].intersection(image)
        return out, inside


def solutions_in(
    box: CandidateBox, limits: Limits, is_stopped: Callable[[], bool] = lambda: False
) -> BoxOutcome | None:
    """Finds every fixture of a box, or says why it is undecided; None when the work was stopped before."""
    with ctx.workprec(PRECISIONS[0]):
        smaller_box = narrowed(box, limits)
        if smaller_box is None:
            return BoxOutcome((), "")
        box = smaller_box
        frame = SingularFrame.of(box, limits)
        waiting = [frame.start()]
        roots: list[list[arb]] = []
        looked_at = 0
        while waiting:
            place = waiting.pop()
            looked_at += 1
            if is_stopped():
                return None
            if looked_at > MOST_BOXES:
                return BoxOutcome((), NEARLY_DOUBLE)
            here = frame.places(place)
            if is_empty(box, here, limits):
                continue
            smaller, unique = frame.step(place, here)
            if smaller is not None and not unique and not is_smaller(smaller, place):
                smaller, unique = frame.step(smaller, frame.places(smaller), regular=True)
            if smaller is not None and unique:
                roots.append(smaller)
            elif smaller is not None:
                waiting += [smaller] if is_smaller(smaller, place) else thirds(smaller)
    return judged(frame, roots, limits)


def is_smaller(part: list[arb], place: list[arb], share: float = SMALLER) -> bool:
    """Whether a step has made a place so much smaller that another is worth it."""
    return any(one.rad() < share * whole.rad() for one, whole in zip(part, place, strict=True))


def is_empty(box: CandidateBox, here: BoxContacts, limits: Limits) -> bool:
    """Whether some contact equation has no zero, or some rule is broken, everywhere in a place."""
    if any(value > 0 or value < 0 for value in here.values):
        return True
    minors = wrench_minors(here, limits.wrench_length)
    if not limits.pairing and any(minor > 0 for minor in minors) and any(minor < 0 for minor in minors):
        # Of opposite signs, so that nothing closes.
        return True
    return any(slack < 0 for slack in slacks(box, here, minors, limits))


def thirds(place: list[arb]) -> list[list[arb]]:
    """A place cut in three where it is longest, a narrow part in the middle, all a little larger.

    A double solution is in the middle of most boxes. Cut there, it would be on the rim of both halves.
    """
    widths = [float(p.rad()) for p in place]
    whole, side = max(widths), (1.0 - MIDDLE) / 2.0
    cut = widths.index(whole)
    parts = (side - 1.0, side), (1.0 - side, side), (0.0, MIDDLE)
    middles = [((place[cut].mid() + center * whole).mid(), half * whole * OVERLAP) for center, half in parts]
    return [[*place[:cut], arb(*middle), *place[cut + 1 :]] for middle in middles]


def judged(frame: SingularFrame, roots: list[list[arb]], limits: Limits) -> BoxOutcome:
    """Judges the solutions of a box by the rules, at rising precision."""
    fixtures: list[tuple[float, float, float, float]] = []
    reason = ""
    for root in roots:
        verdict = 0
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                root = refined(frame, root)
                unknowns = frame.unknowns(root)
                here = places(frame.box, unknowns)
                values = slacks(frame.box, here, wrench_minors(here, limits.wrench_length), limits)
                verdict = -1 if any(v < 0 for v in values) else int(all(v > 0 for v in values))
            if verdict != 0:
                break
        if verdict == 0:
            reason = AT_AN_EDGE
        if verdict > 0:
            psi, x, y, separation = (float(u.mid()) for u in unknowns)
            fixtures.append((psi, x, y, separation))
    return BoxOutcome(tuple(fixtures), reason)


def refined(frame: SingularFrame, root: list[arb]) -> list[arb]:
    """A proven solution to the precision in force, by steps that each find a binary digit or more."""
    for _ in range(12):
        closer, _ = frame.step(root, frame.places(root))
        if closer is not None and not is_smaller(closer, root, 0.5):
            closer, _ = frame.step(root, frame.places(root), regular=True)
        if closer is None or not is_smaller(closer, root, 0.5):
            break
        root = closer
    return root
