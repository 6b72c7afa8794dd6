"""Two flat jaws between which a part is held by friction, as data for listing, verification and drawing.

The fixed jaw stands along x at y = 0, its left end at x = 0; the moving jaw closes along -y. The part lies
above the fixed jaw, on parallels, and its lower side is at z = 0.
"""

from __future__ import annotations

from math import inf, pi

from attrs import frozen

__all__ = ["JawPair"]

# Part of the torque on a vise's screw that moves the jaw; the rest is friction in the thread. Oiled
# trapezoidal threads have 0.2 to 0.4 (K.-H. Decker, Maschinenelemente, on screws that move under load).
SCREW_SHARE = 0.3
# How thick parallels are taken to be where nobody says: so many mm, and at most this part of the opening.
USUAL_PARALLEL, PARALLEL_SHARE = 8.0, 0.2


@frozen
class JawPair:
    """Two flat jaws between which a part is held; lengths in mm.

    Parameters
    ----------
    width : of both jaws.
    height : of the jaws above the vise's bed; None for any height.
    thickness : thickness of each jaw at its top, measured away from the part; None for unbounded.
    max_opening : the largest distance between the jaws; None for no limit.
    parallels : heights of the parallels that can be used; (0,) where the part lies on the bed.
    least_grip : the least height over which both jaws must grip the part.
    stops : ends of the jaws at which a work stop can be, "left" or "right"; each gives separate fixtures;
        None for no stop.
    stop_offset : how far inward from the end of the jaws the stop touches the part.
    max_force : rated force in N; None where not known.
    screw_lead : travel of the jaw per turn of the screw; None where not known.
    parallel_thickness : of each parallel; None where not known.
    stop_width : of the work stop, across the jaws.
    """

    width: float
    height: float | None
    thickness: float | None
    max_opening: float | None
    parallels: tuple[float, ...]
    least_grip: float
    stops: tuple[str | None, ...]
    stop_offset: float
    max_force: float | None
    screw_lead: float | None
    parallel_thickness: float | None
    stop_width: float

    def compute_top(self, parallels: float) -> float:
        """Return the height in mm of the jaws' top above the lower side of a part.

        The part stands on parallels that are ``parallels`` mm high. The result is inf if the jaws may have
        any height.
        """
        return inf if self.height is None else self.height - parallels

    def name_outline_role(self, parallels: float) -> str:
        """Return the role under which a workpiece keeps the outline that the jaws touch, for parallels of
        this height in mm.
        """
        return f"jaws up to {round(self.compute_top(parallels), 6):g} mm"

    def compute_parallel_thickness(self, opening: float) -> float:
        """Return the thickness in mm of each parallel between jaws that are ``opening`` mm apart.

        An unknown thickness is taken as 8 mm, but at most a fifth of the opening. Two parallels are never
        thicker than the opening.
        """
        if self.parallel_thickness is None:
            return min(USUAL_PARALLEL, PARALLEL_SHARE * opening)
        return min(self.parallel_thickness, opening / 2)

    def compute_torque(self, force: float) -> float | None:
        """Return the torque in N m on the screw for a clamping force in N; None where the screw's lead is not
        known.
        """
        return None if self.screw_lead is None else force * self.screw_lead / (2 * pi * SCREW_SHARE) / 1000.0
