"""Whether a locator and a clamp press a part against the wall: null vectors of the four wrenches in doubles,
with bounds of their error."""

from __future__ import annotations

from math import inf

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import LEAST_CLAMPING, LEAST_CLOSURE, LEAST_PUSH, LEAST_SEAT, LEAST_SPAN
from workhold.kernels.contact.closure import ROUNDING
from workhold.listing.wall_fixtures import WallFixtures
from workhold.search.pin_contacts import PartOnWall, PinContacts

__all__ = ["ContactPairs", "closure", "may_oppose", "reaction_doubts", "seating"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@frozen(eq=False)
class ContactPairs:
    """M pairs of a contact of a clamp and one of the locator.

    Parameters
    ----------
    places : contacts of the tip; their lines are rows, or columns counted from the locator's.
    which : (M,) index of the tip's contact.
    locator : (M,) index of the locator's contact.
    """

    places: PinContacts
    which: IntArray
    locator: IntArray

    def __len__(self) -> int:
        return len(self.locator)

    def take(self, order: IntArray | BoolArray) -> ContactPairs:
        """The pairs of an index array or mask, in its order."""
        return ContactPairs(self.places, self.which[order], self.locator[order])


def may_oppose(lying: PartOnWall, one: PinContacts, clamps: ContactPairs, problem: Problem) -> BoolArray:
    """Which pairs (M,) :func:`closure` may find to press the part: those of whose normals a, b the parts
    along the wall are opposed, for the locator's force is -b_u sign a_u times the length of the hull edge;
    about half of all."""
    length, two = problem.wrench_length, clamps.places
    reach, swing = (
        max(x.max(initial=0.0), y.max(initial=0.0)) for x, y in ((one.reach, two.reach), (one.swing, two.swing))
    )
    band = 20.0 * swing + 4.0 * (reach + lying.off) / length + ROUNDING
    ahead = -two.normal[clamps.which, 0] * np.copysign(1.0, one.normal[:, 0])[clamps.locator]
    return np.asarray(~(ahead * (lying.length / length) < -1.2 * band))


def seating(
    lying: PartOnWall,
    one: PinContacts,
    two: PinContacts,
    locator: IntArray,
    push: tuple[float, float],
    problem: Problem,
) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Null vectors, pushes and verdicts as of :func:`closure`, of one of two clamps: wall and locator must
    fix the part, and the clamp must push.

    The null vectors (M, 4) are the forces of the wall's two ends and the locator per unit of that on the
    clamp's face. With the notation there the locator's is -b_u / a_u, and the determinant of the three
    wrenches is |a_u| l.
    """
    length = problem.wrench_length
    a, b = one.normal[locator], two.normal
    p, q = one.point[locator] / length, two.point / length
    wall = lying.length / length
    with np.errstate(divide="ignore", invalid="ignore"):
        force = -b[:, 0] / a[:, 0]
        last = (force * (p[:, 0] * a[:, 1] - p[:, 1] * a[:, 0]) + q[:, 0] * b[:, 1] - q[:, 1] * b[:, 0]) / wall
        null = np.stack([force * a[:, 1] + b[:, 1] - last, last, force, np.ones(len(force))], axis=1)
        reach = np.maximum(one.reach[locator], two.reach)
        swing = np.maximum(one.swing[locator], two.swing)
        pushes = -(b[:, 0] * push[0] + b[:, 1] * push[1])
        slack = np.minimum(one.slack[locator], two.slack) - problem.contact_margin
        fixed = np.abs(a[:, 0]) * wall - LEAST_SEAT
        band = 2.0 * swing + ROUNDING
        worst = np.minimum(
            slack / (1.2 * reach + 1e-12), np.minimum((pushes - LEAST_PUSH) / band, fixed / (wall * band))
        )
    held = worst > 1.0
    return null, pushes, held, ~held & ~(worst < -1.0)


def reaction_doubts(
    pressed: WallFixtures, lying: PartOnWall, one: PinContacts, two: PinContacts, locator: IntArray, problem: Problem
) -> Array:
    """How far the forces of wall and locator (M,) may be off, from how far places and normals may be."""
    reach = np.maximum(one.reach[locator], two.reach)
    swing = np.maximum(one.swing[locator], two.swing)
    across = np.abs(one.normal[locator, 0])
    size = 1.0 + np.abs(pressed.null).sum(axis=1)
    wall = lying.length / problem.wrench_length
    with np.errstate(invalid="ignore"):
        doubt = 4.0 * size * (20.0 * swing + 4.0 * (reach + lying.off) / problem.wrench_length + ROUNDING)
        return np.asarray(np.nan_to_num(doubt / (across * min(wall, 1.0)), nan=inf))


def closure(
    lying: PartOnWall,
    one: PinContacts,
    two: PinContacts,
    locator: IntArray,
    push: tuple[float, float] | None,
    problem: Problem,
) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Null vectors (M, 4) of the wall's two ends, locator and clamp, not scaled; how much (M,) of its force
    the clamp passes on in its direction; which pairs (M,) press the part, and of which that is open.

    Where both pegs move towards the wall, ``push`` is None: they pass on what the wall takes up, in parts of
    the second one's force. With normals a, b and moments m, M of locator and clamp about the start of the
    hull edge of length l, lengths in parts of L, and p = -b_u sign a_u, q = |a_u|, the null vector is (l (p
    a_v + q b_v) - t, t, p l, q l) with t = p m + q M.
    """
    length = problem.wrench_length
    a, b = one.normal[locator], two.normal
    p = one.point[locator] / length
    q = two.point / length
    across, ahead = np.abs(a[:, 0]), -b[:, 0] * np.copysign(1.0, a[:, 0])
    wall = lying.length / length
    last = ahead * (p[:, 0] * a[:, 1] - p[:, 1] * a[:, 0]) + across * (q[:, 0] * b[:, 1] - q[:, 1] * b[:, 0])
    both = wall * (ahead * a[:, 1] + across * b[:, 1])
    forces = both - last, last, ahead * wall, across * wall
    null = np.stack(forces, axis=1)
    reach = np.maximum(one.reach[locator], two.reach)
    swing = np.maximum(one.swing[locator], two.swing)
    with np.errstate(divide="ignore", invalid="ignore"):
        pushes = (both / (across * wall)) if push is None else -(b[:, 0] * push[0] + b[:, 1] * push[1])
        band = 20.0 * swing + 4.0 * (reach + lying.off) / length + ROUNDING
        size = sum(map(np.abs, forces))
        smallest = np.minimum(np.minimum(*forces[:2]), np.minimum(*forces[2:]))
        least = np.minimum(smallest - LEAST_CLOSURE * size, size - LEAST_SPAN)
        force = (both if push is None else null[:, 3] * pushes) - LEAST_CLAMPING * size
        slack = np.minimum(one.slack[locator], two.slack) - problem.contact_margin
        worst = np.minimum(least / band, force / (3.0 * band + size * swing))
        worst = np.minimum(worst, slack / np.maximum(1.2 * reach, 1e-300))
    held = worst > 1.1
    return null, pushes, held, ~held & ~(worst < -1.1)
