"""Force closure without friction, and the forces, in balls (model: conditions 4 and 5).

The null vector of four wrenches (n, q x n) is given by the signed 3 x 3 minors. It depends neither on the point that moments
are taken about nor on their scale, because both change the matrix by invertible row operations only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flint import arb

from workhold.model.fixture import Fixture
from workhold.verification.balls import Point, cross, dot
from workhold.verification.contacts import Contact, Pose
from workhold.verification.findings import AGREEMENT, Finding, number, rule

__all__ = ["closure_findings", "minors"]

# The least share of a peg in the closure, and the least clamping force, the shares scaled to sum 1 (model: conditions 4, 5).
# The natural coincidences are 0: three normals through one point, and a double solution of the contact equations, where the
# rounding of a drawing alone leaves a clamping force of up to 1e-7 or so. The edges stand off them.
LEAST_SHARE = 1e-9
LEAST_CLAMPING = 1e-6
# The sizes of the four minors, moments in parts of L, sum to more than this; with less, the normals meet in one point or are
# parallel up to the rounding of the drawing, and four such contacts close nothing.
LEAST_SPAN = 1e-7


def minors(points: Sequence[Point], normals: Sequence[Point]) -> list[arb]:
    """The null vector of four wrenches, not scaled: (-1)^i det of the wrenches other than i."""
    moments = [cross(q, n) for q, n in zip(points, normals, strict=True)]
    vector = []
    for i in range(4):
        a, b, c = (k for k in range(4) if k != i)
        det = (
            cross(normals[a], normals[b]) * moments[c]
            + cross(normals[b], normals[c]) * moments[a]
            + cross(normals[c], normals[a]) * moments[b]
        )
        vector.append(-det if i % 2 else det)
    return vector


def closure_findings(
    fixture: Fixture, contacts: Sequence[Contact], pose: Pose, wrench_length: float
) -> Iterator[Finding]:
    """Whether the four contacts close, whether closing the vise clamps, and whether the file tells the right forces.

    ``wrench_length`` is L, half the diameter of the peg-centre locus, in mm.
    """
    points = [contact.in_part(pose) for contact in contacts]
    normals = [contact.side.outward(point) for contact, point in zip(contacts, points, strict=True)]
    vector = minors(points, normals)
    total = sum(vector, arb(0))
    span = sum((abs(entry) for entry in vector), arb(0)) / wrench_length
    words = f"the contacts do not hold the part: their wrenches span only {number(span)}"
    yield from rule(span - LEAST_SPAN, words, words)
    if not (total > 0 or total < 0):
        opposed = any(entry > 0 for entry in vector) and any(entry < 0 for entry in vector)
        yield Finding(opposed, "the contacts do not hold the part: their forces do not close")
        return
    null = [entry / total for entry in vector]
    for position, entry in enumerate(null, 1):
        yield from rule(
            entry - LEAST_SHARE,
            f"the contacts do not hold the part: the share of peg {position} in the closure is {number(entry)}",
            f"the share of peg {position} in the closure is exactly at its limit",
        )
    # The push of a left peg along the vise's x axis is -n turned into the vise frame.
    across = pose.cosine, -pose.sine
    lefts = [k for k, contact in enumerate(contacts) if not contact.right]
    clamp = -sum((null[k] * dot(across, normals[k]) for k in lefts), arb(0))
    loose = list(
        rule(
            clamp - LEAST_CLAMPING,
            f"closing the vise does not clamp: the clamping force is {number(clamp)}",
            "the clamping force is exactly at its limit",
        )
    )
    yield from loose
    if not loose:
        yield from written_numbers(fixture, null, clamp)


def written_numbers(fixture: Fixture, null: Sequence[arb], clamp: arb) -> Iterator[Finding]:
    """Whether the forces and the closure margin of the file are the derived ones."""
    for position, (peg, entry) in enumerate(zip(fixture.pegs, null, strict=True), 1):
        force = entry / clamp
        words = f"the force of peg {position} is {peg.force:.12g} in the file and {float(force.mid()):.12g} by proof"
        yield from rule(AGREEMENT * force.max(arb(1)) - abs(force - peg.force), words, words)
    if "closure_margin" in fixture.quality:
        written = fixture.quality["closure_margin"]
        least = null[0].min(null[1]).min(null[2]).min(null[3])
        words = f"the closure margin is {written:.12g} in the file and {float(least.mid()):.12g} by proof"
        yield from rule(AGREEMENT - abs(least - written), words, words)
