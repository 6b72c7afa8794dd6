"""Force closure without friction, and the forces, in balls (model: conditions 4 and 5).

The null vector of four wrenches (n, q x n) is given by the signed 3 x 3 minors. It depends neither on the point that moments
are taken about nor on their scale, because both change the matrix by invertible row operations only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from attrs import frozen
from flint import arb, arb_mat

from workhold.verification.balls import Point, cross, dot, least, turned
from workhold.verification.contacts import BallContact, BallPose
from workhold.verification.findings import Finding, number, rule
from workhold.verification.tolerances import LEAST_CLAMPING, LEAST_SHARE, LEAST_SPAN

__all__ = ["Balance", "closure_findings", "inverted", "minors", "span"]


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
    def of(cls, contacts: Sequence[BallContact], pose: BallPose, clamping: int) -> Balance:
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

    @property
    def margin(self) -> arb:
        """The closure margin."""
        return least(self.shares)

    def inverse(self, contacts: Sequence[BallContact], pose: BallPose) -> list[list[arb]] | None:
        """The inverse of the matrix of rows (n, q x n, n . w), see ``figures``; None where there may be none."""
        rows = [
            [*normal, cross(point, normal), dot(turned(contact.way, pose.cosine, -pose.sine), normal)]
            for contact, point, normal in zip(contacts, self.points, self.normals, strict=True)
        ]
        return inverted(rows)

    def of_all(self, row: Sequence[arb]) -> Sequence[arb]:
        """A number for each peg, from a row of the inverse."""
        return row

    def kept_by_closing(self, forces: Sequence[arb]) -> list[arb]:
        """The part of some forces that lies along those with which what moves presses: what locking it takes away."""
        own = self.forces
        share = sum((a * b for a, b in zip(forces, own, strict=True)), arb(0)) / sum((a * a for a in own), arb(0))
        return [share * force for force in own]


def inverted(rows: list[list[arb]]) -> list[list[arb]] | None:
    """The inverse of a square matrix; None where there may be none."""
    try:
        inverse: list[list[arb]] = arb_mat(rows).inv().tolist()
    except ZeroDivisionError:
        return None
    return inverse


def closure_findings(
    balance: Balance, wrench_length: float, names: Sequence[str], slack_words: str
) -> Iterator[Finding]:
    """Whether four contacts of some names close, and whether what moves clamps.

    Parameters
    ----------
    wrench_length : L, half the diameter of the peg-centre locus, in mm.
    slack_words : what is wrong where the clamping force is none.
    """
    vector, spanned = balance.vector, span(balance.vector, wrench_length)
    words = f"the contacts do not hold the part: their wrenches span only {number(spanned)}"
    yield from rule(spanned - LEAST_SPAN, words, words)
    total = sum(vector, arb(0))
    if not (total > 0 or total < 0):
        opposed = any(entry > 0 for entry in vector) and any(entry < 0 for entry in vector)
        yield Finding(opposed, "the contacts do not hold the part: their forces do not close")
        return
    for name, share in zip(names, balance.shares, strict=True):
        yield from rule(
            share - LEAST_SHARE,
            f"the contacts do not hold the part: the share of {name} in the closure is {number(share)}",
            f"the share of {name} in the closure is exactly at its limit",
        )
    yield from rule(
        balance.clamp - LEAST_CLAMPING,
        f"{slack_words}: the clamping force is {number(balance.clamp)}",
        "the clamping force is exactly at its limit",
    )
