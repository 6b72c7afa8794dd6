"""Where a fixture lies: what its file writes, and the place that is proven near it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import radians

from flint import arb, arb_mat

from workhold.model import fixture as model
from workhold.verification.contacts import Contact, Pose
from workhold.verification.findings import Finding, number, rule
from workhold.verification.krawczyk import certified_zero
from workhold.verification.rules import AGREEMENT

__all__ = ["gap_findings", "proven_places", "written_pose"]


def degree() -> arb:
    """One degree in radians."""
    return arb.pi() / 180


def written_pose(written: model.Pose, travel: float) -> Pose:
    """All poses that agree with the file's, with travels that agree with one in mm likewise."""
    off = arb(0, AGREEMENT)
    theta = (written.theta_deg + off) * degree()
    return Pose.of(theta, written.x + off, written.y + off, travel + off)


def gap_findings(touching: Sequence[tuple[str, Contact, int]], poses: Sequence[Pose]) -> Iterator[Finding]:
    """Whether any pose that agrees with the file's, and a travel likewise, could touch all faces; a pose for each peg.

    The gaps are enclosed over all of them at once; a gap that is certainly not the peg radius refutes the fixture.
    """
    for (name, contact, face), around in zip(touching, poses, strict=True):
        off = contact.side.gap(contact.in_part(around)) - contact.radius
        if off > 0 or off < 0:
            yield Finding(True, f"{name} is {number(off)} mm away from touching face {face}")


def proven_places(
    system: Callable[[arb_mat], tuple[arb_mat, arb_mat]],
    written: model.Pose,
    travels: Mapping[str, float],
    touched: str,
) -> tuple[list[arb] | None, list[Finding]]:
    """The proven solution (angle in radians, x, y and travels in mm) near the file's, if there is one, and what is wrong.

    Parameters
    ----------
    travels : of the file, by what each is called.
    touched : what the solution touches, in words.
    """
    zero = certified_zero(system, [radians(written.theta_deg), written.x, written.y, *travels.values()])
    if zero is None:
        words = "the contact equations have no single solution that can be proven near the pose in the file"
        return None, [Finding(False, words)]
    findings: list[Finding] = []
    names = [("angle", "degrees"), ("x", "mm"), ("y", "mm"), *((name, "mm") for name in travels)]
    values = [written.theta_deg, written.x, written.y, *travels.values()]
    for (name, unit), derived, value in zip(names, [zero[0] / degree(), *zero[1:]], values, strict=True):
        off = abs(derived - value)
        if not off < AGREEMENT:
            words = f"the {name} in the file is {number(off)} {unit} from the one that touches {touched}"
            findings += rule(AGREEMENT - off, words, words)
    return zero, findings
