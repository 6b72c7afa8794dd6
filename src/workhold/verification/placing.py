"""Where a fixture lies: what its file writes, and the one place that is proven near it.

Theorem (Krawczyk 1969): let f be continuously differentiable on a box X with midpoint m, J(X) an enclosure of
its Jacobian on X and Y any matrix. If

    K = m - Y f(m) + (I - Y J(X)) (X - m)

lies in the interior of X, then f has exactly one zero in X, and it lies in K.

References
----------
R. Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken", Computing 4 (1969),
pp. 187-201.
S. M. Rump, "Verification methods", Acta Numerica 19 (2010), section 13.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import radians

from flint import arb, arb_mat, ctx

from workhold.model import fixture as model
from workhold.verification.contacts import BallContact, BallPose, contact_system
from workhold.verification.findings import Finding, number, rule
from workhold.verification.tolerances import AGREEMENT

__all__ = ["certified_zero", "gap_findings", "proven_pose", "written_pose"]

# Values (N x 1) and Jacobian (N x N) of a system on a box (N x 1) of unknowns.
System = Callable[[arb_mat], tuple[arb_mat, arb_mat]]

MOST_STEPS = 12


def certified_zero(system: System, start: Sequence[float]) -> list[arb] | None:
    """A proven enclosure of the one zero near a start, or None without a proof at the precision in force.

    Newton's method on midpoints finds a place; the proof does not depend on how it was found. The box around
    it has half the digits of the precision as its radius.
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
    around = arb_mat(size, 1, [arb(0, small) for _ in range(size)])
    box = middle + around
    identity = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
    image = middle - inverse * values + (identity - inverse * system(box)[1]) * around
    inner = zip(box.entries(), image.entries(), strict=True)
    return image.entries() if all(outer.contains_interior(k) for outer, k in inner) else None


def degree() -> arb:
    """One degree in radians."""
    return arb.pi() / 180


def written_pose(written: model.Pose, travels: Sequence[float]) -> BallPose:
    """All poses that agree with the file's, with travels in mm that agree with some likewise."""
    off = arb(0, AGREEMENT)
    theta = (written.theta_deg + off) * degree()
    return BallPose.of(theta, written.x + off, written.y + off, *(travel + off for travel in travels))


def gap_findings(touching: Sequence[tuple[str, BallContact, int]], around: BallPose) -> Iterator[Finding]:
    """Whether any pose that agrees with the file's, and travels likewise, could touch all faces.

    The gaps are enclosed over all of them at once; one that certainly is not the peg radius refutes.
    """
    for name, contact, face in touching:
        off = contact.side.gap(contact.in_part(around)) - contact.radius
        if off > 0 or off < 0:
            yield Finding(True, f"{name} is {number(off)} mm away from touching face {face}")


def proven_pose(
    contacts: Sequence[BallContact], written: model.Pose, travels: Mapping[str, float]
) -> tuple[BallPose | None, list[Finding]]:
    """The proven solution of the contact equations near the file's pose, if any, and what is wrong with it.

    ``travels`` in mm are those of the file, by what each is called.
    """
    values = [written.theta_deg, written.x, written.y, *travels.values()]
    zero = certified_zero(partial(contact_system, contacts), [radians(written.theta_deg), *values[1:]])
    if zero is None:
        words = "the contact equations have no single solution that can be proven near the pose in the file"
        return None, [Finding(False, words)]
    findings: list[Finding] = []
    names = [("angle", "degrees"), ("x", "mm"), ("y", "mm"), *((name, "mm") for name in travels)]
    touched = f"all {'five' if len(contacts) > 4 else 'four'} faces"
    for (name, unit), derived, value in zip(names, [zero[0] / degree(), *zero[1:]], values, strict=True):
        off = abs(derived - value)
        if not off < AGREEMENT:
            words = f"the {name} in the file is {number(off)} {unit} from the one that touches {touched}"
            findings += rule(AGREEMENT - off, words, words)
    return BallPose.of(*zero), findings
