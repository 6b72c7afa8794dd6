"""The straps of a plate and the holes for their bolts, as data for all who search, verify and draw."""

from __future__ import annotations

from attrs import frozen

from workhold.fixels.carrier import Carrier

__all__ = ["USUAL_STANDOUT", "StrapSet"]

# How high a strap with its nut and stud stands above the face that it presses on, in radii of its tip: a bar as thick as
# the tip is wide, a washer, a nut as high as its bolt is thick, and some of the stud.
USUAL_STANDOUT = 6.0


@frozen
class StrapSet:
    """The straps of a plate, and the holes for their bolts; lengths in mm.

    Parameters
    ----------
    count : number of straps that press on the part, 1 to 4.
    tip_radius : radius of a strap's round tip.
    reach : the least and the greatest distance of a tip from the middle of its bolt's hole.
    max_force : rated force of a strap in N; None if not known.
    bolts : the lattice of holes for bolts; the plate itself if bolts use the dowel holes.
    over : the rest of the part below the tips: "plate" or "supports".
    standout : height of a strap, with nut and stud, above the face that it presses on.
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
        """Whether the part lies on three supports, with each tip over one of them."""
        return self.over == "supports"

    @property
    def is_on_dowel_holes(self) -> bool:
        """Whether bolts use the same holes as dowels."""
        return self.bolts.peg != "bolt"
