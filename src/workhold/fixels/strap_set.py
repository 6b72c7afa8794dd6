"""The straps of a plate and the holes for their bolts, as data for all who search, verify and draw."""

from __future__ import annotations

from attrs import frozen

from workhold.fixels.carrier import Carrier

__all__ = ["StrapSet"]


@frozen
class StrapSet:
    """The straps that press a part down on a plate; lengths in mm.

    Parameters
    ----------
    count : how many press on the part, 1 to 4.
    tip_radius : of a strap's round tip.
    reach : the least and the greatest distance of the tip from the middle of the bolt's hole.
    max_force : that a strap is rated for, in N; None where nobody says.
    bolts : the lattice of holes for bolts; the plate itself where the dowels' own holes take them.
    over : what the part lies on under the tips, "plate" or "supports".
    standout : how high a strap stands above the face that it presses on, with nut and stud.
    """

    count: int
    tip_radius: float
    reach: tuple[float, float]
    max_force: float | None
    bolts: Carrier
    over: str
    standout: float

    @property
    def is_over_supports(self) -> bool:
        """Whether the part lies on three supports, and each tip presses over one of them."""
        return self.over == "supports"

    @property
    def is_on_dowel_holes(self) -> bool:
        """Whether bolts and dowels share one lattice."""
        return self.bolts.peg != "bolt"
