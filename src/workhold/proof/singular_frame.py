"""A frame for a candidate's box that separates the badly determined direction from the well determined ones.

At a nearly double solution three directions of the box are well determined and one is not. So the box is
turned into the directions of the Jacobian's singular vectors, where the interval Newton method makes it
smaller.

Reference: E. Hansen, S. Sengupta, "Bounding solutions of systems of equations using interval analysis",
BIT 21 (1981) 203-211.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import frozen
from flint import arb, arb_mat
from numpy.typing import NDArray

from workhold.kernels.base.tables import Limits
from workhold.proof.ball_contacts import BoxContacts, CandidateBox, compute_contact_values, place_contacts

__all__ = ["SingularFrame", "decouple_equations", "is_smaller", "take_newton_step", "cut_in_thirds"]

# The exact solution of a box may lie on its rim, so boxes are made larger by this part.
RIM = 0.1
# A place is looked at again when a step leaves less than this of a side.
SMALLER = 0.7
# The middle one of three parts has this part of a side, and each part is so much larger than its share.
MIDDLE, OVERLAP = 0.125, 1.0002


@frozen(eq=False)
class SingularFrame:
    """A frame along the singular vectors of the Jacobian at the middle of a box.

    Coordinates are in mm from the middle.

    Parameters
    ----------
    box : the candidate.
    right : (4, 4) directions of the unknowns (psi scaled by L), one in each column, the worst determined
        last.
    combining : combinations of the contact equations, one in each row, as exact balls (balls: midpoint and
        radius).
    turning : ``right`` as exact balls.
    length : L in mm.
    """

    box: CandidateBox
    right: NDArray[np.float64]
    combining: arb_mat
    turning: arb_mat
    length: float

    @classmethod
    def from_box(cls, box: CandidateBox, limits: Limits) -> SingularFrame:
        """Return the frame of a candidate's box."""
        slopes = place_contacts(box, [arb(m) for m in box.middle]).slopes
        jacobian = np.array([[float(s.mid()) for s in row] for row in slopes])
        jacobian[:, 0] /= limits.wrench_length
        u, _, v = np.linalg.svd(jacobian)
        left, right = (arb_mat(4, 4, [float(e) for e in matrix.T.ravel()]) for matrix in (u, v))
        return cls(box, v.T, left, right, limits.wrench_length)

    def make_start_box(self) -> list[arb]:
        """Return the whole box in the frame's coordinates, four balls in mm, enlarged by the share
        ``RIM``."""
        reach = [self.box.reach[0] * self.length, *self.box.reach[1:]]
        spans = np.abs(self.right.T) @ np.array(reach)
        return [arb(0, float(span) * (1.0 + RIM)) for span in spans]

    def compute_unknowns(self, place: Sequence[arb]) -> list[arb]:
        """Return balls of (psi, tail x, tail y, separation) at a place, four balls of the frame's
        coordinates."""
        turn, *rest = (self.turning * arb_mat(4, 1, place)).entries()
        steps = turn / self.length, *rest
        return [m + s for m, s in zip(self.box.middle, steps, strict=True)]

    def compute_contacts(self, place: Sequence[arb]) -> BoxContacts:
        """Return the contacts at a place in the frame's coordinates."""
        return place_contacts(self.box, self.compute_unknowns(place))

    def evaluate_equations(self, place: Sequence[arb]) -> list[arb]:
        """Return the combined contact equations in mm at a place in the frame's coordinates."""
        values = compute_contact_values(self.box, self.compute_unknowns(place))
        return list((self.combining * arb_mat(4, 1, values)).entries())

    def evaluate_jacobian(self, here: BoxContacts) -> list[list[arb]]:
        """Return the Jacobian (4, 4) of the combined contact equations
        over the frame's coordinates, from the contacts.
        """
        scaled = [[row[0] / self.length, *row[1:]] for row in here.slopes]
        slopes: list[list[arb]] = (self.combining * arb_mat(scaled) * self.turning).tolist()
        return slopes

    def narrow(
        self, place: list[arb], here: BoxContacts, regular: bool = False
    ) -> tuple[list[arb] | None, bool]:
        """Return (part of a place that may hold solutions or None for no part, whether it certainly holds
        exactly one).

        This is a step of the interval Newton method; ``here`` are the contacts at the place. A ``regular``
        step combines the equations by the inverse of their own Jacobian at the place's middle, if it has one.
        Near a simple solution next to a double one, the Jacobian at the whole box's middle does not separate
        the directions.
        """
        middle = [arb(p.mid()) for p in place]
        values, slopes = self.evaluate_equations(middle), self.evaluate_jacobian(here)
        if regular:
            combined = decouple_equations(values, slopes)
            if combined is None:
                return place, False
            values, slopes = combined
        return take_newton_step(place, values, slopes)


def decouple_equations(
    values: Sequence[arb], slopes: Sequence[Sequence[arb]]
) -> tuple[list[arb], list[list[arb]]] | None:
    """Return N equations and their Jacobian (N, N), both multiplied by the inverse of the Jacobian's
    midpoint.

    Return None where that matrix is singular.
    """
    jacobian = arb_mat(slopes)
    try:
        inverse = jacobian.mid().inv().mid()
    except ZeroDivisionError:
        return None
    return list((inverse * arb_mat(len(values), 1, values)).entries()), (inverse * jacobian).tolist()


def take_newton_step(
    place: Sequence[arb], values: Sequence[arb], slopes: Sequence[Sequence[arb]]
) -> tuple[list[arb] | None, bool]:
    """Return (part of a place that may hold solutions or None for no part, whether it certainly holds exactly
    one).

    This is the step of Hansen and Sengupta: ``values`` are those of N equations at the place's middle, and
    ``slopes`` (N, N) enclose their Jacobian over the place.
    """
    middle = [arb(p.mid()) for p in place]
    out, inside = list(place), True
    off = [one - at for one, at in zip(out, middle, strict=True)]
    for k, row in enumerate(slopes):
        rest = values[k] + sum([row[j] * off[j] for j in range(len(out)) if j != k], arb(0))
        if row[k].contains(0):
            inside = False
            if not (rest + row[k] * off[k]).contains(0):
                return None, False
            continue
        image = middle[k] - rest / row[k]
        if not image.overlaps(out[k]):
            return None, False
        inside = inside and out[k].contains_interior(image)
        out[k] = image if out[k].contains(image) else out[k].intersection(image)
        off[k] = out[k] - middle[k]
    return out, inside


def is_smaller(part: list[arb], place: list[arb], share: float = SMALLER) -> bool:
    """Return whether some side of ``part`` is shorter than ``share`` times the same side of ``place``."""
    return any(one.rad() < share * whole.rad() for one, whole in zip(part, place, strict=True))


def cut_in_thirds(place: list[arb]) -> list[list[arb]]:
    """Return a place cut in three parts across its longest side, all slightly enlarged; the narrow middle
    part comes last.

    In most boxes a double solution is in the middle. Cut in two there, it would be on the rim of both halves.
    """
    widths = [float(p.rad()) for p in place]
    whole, side = max(widths), (1.0 - MIDDLE) / 2.0
    cut = widths.index(whole)
    parts = (side - 1.0, side), (1.0 - side, side), (0.0, MIDDLE)
    middles = [((place[cut].mid() + center * whole).mid(), half * whole * OVERLAP) for center, half in parts]
    return [[*place[:cut], arb(*middle), *place[cut + 1 :]] for middle in middles]
