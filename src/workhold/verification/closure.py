"""Force closure without friction, and the forces, in balls (model: conditions 4 and 5).

The null vector of four wrenches (n, q x n) is given by the signed 3 x 3 minors. It depends neither on the point that moments
are taken about nor on their scale, because both change the matrix by invertible row operations only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from attrs import frozen
from flint import arb

from workhold.verification.balls import Point, cross, dot, turned
from workhold.verification.contacts import Contact, Pose
from workhold.verification.findings import Finding, number, rule
from workhold.verification.hardware import Hardware
from workhold.verification.rules import LEAST_SHARE, LEAST_SPAN

__all__ = ["Balance", "closure_findings", "minors", "span"]


def minors(points: Sequence[Point], normals: Sequence[Point]) -> list[arb]:
    """The null vector of four wrenches, not scaled: (-1)^i det of the wrenches other than i, in mm; in balls."""
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


def span(vector: Sequence[arb], wrench_length: float) -> arb:
    """Sizes of the minors summed, moments in parts of L in mm: how far the wrenches are from lying in one plane."""
    return sum((abs(entry) for entry in vector), arb(0)) / wrench_length


@frozen(eq=False)
class Balance:
    """How four contacts press on the workpiece when nothing else does.

    Parameters
    ----------
    points, normals : the pegs' centres in mm and the outward unit normals, in the workpiece's frame.
    vector : the null vector of the wrenches, not scaled, see :func:`minors`.
    shares : the null vector scaled to sum 1; no numbers where the sum may be 0.
    clamp : the force that what moves passes on in the direction in which it clamps, for these shares.
    """

    points: tuple[Point, ...]
    normals: tuple[Point, ...]
    vector: tuple[arb, ...]
    shares: tuple[arb, ...]
    clamp: arb

    @classmethod
    def of(cls, contacts: Sequence[Contact], pose: Pose, clamping: int) -> Balance:
        """The balance of four contacts; ``clamping`` is 1 where less travel clamps, -1 where more does."""
        points = tuple(contact.in_part(pose) for contact in contacts)
        normals = tuple(contact.outward(pose) for contact in contacts)
        vector = tuple(minors(points, normals))
        total = sum(vector, arb(0))
        shares = tuple(entry / total for entry in vector)
        # A peg pushes along -n, and clamps against its way.
        ways = [turned(contact.way, pose.cosine, -pose.sine) for contact in contacts]
        push = sum((s * dot(way, n) for s, way, n in zip(shares, ways, normals, strict=True)), arb(0))
        return cls(points, normals, vector, shares, clamping * push)

    @property
    def forces(self) -> list[arb]:
        """Force of each peg per unit of clamping force."""
        return [share / self.clamp for share in self.shares]


def closure_findings(balance: Balance, wrench_length: float, hardware: Hardware) -> Iterator[Finding]:
    """Whether four contacts close, and whether what moves clamps.

    ``wrench_length`` is L, half the diameter of the peg-centre locus, in mm.
    """
    vector, spanned = balance.vector, span(balance.vector, wrench_length)
    words = f"the contacts do not hold the part: their wrenches span only {number(spanned)}"
    yield from rule(spanned - LEAST_SPAN, words, words)
    total = sum(vector, arb(0))
    if not (total > 0 or total < 0):
        opposed = any(entry > 0 for entry in vector) and any(entry < 0 for entry in vector)
        yield Finding(opposed, "the contacts do not hold the part: their forces do not close")
        return
    for name, share in zip(hardware.names, balance.shares, strict=True):
        yield from rule(
            share - LEAST_SHARE,
            f"the contacts do not hold the part: the share of {name} in the closure is {number(share)}",
            f"the share of {name} in the closure is exactly at its limit",
        )
    yield from rule(
        balance.clamp - hardware.least_clamping,
        f"{hardware.slack_words}: the clamping force is {number(balance.clamp)}",
        "the clamping force is exactly at its limit",
    )
