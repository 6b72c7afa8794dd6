"""Two flat jaws between which a part is held by friction, as data for all who list, verify and draw.

The fixed jaw stands along x at y = 0, its left end at x = 0; the jaw that moves closes along -y. The part lies above
the fixed jaw, on parallels, and its lower side is at z = 0.
"""

from __future__ import annotations

from math import inf, pi

from attrs import frozen

__all__ = ["JawPair"]

# Of the torque on a vise's screw, what moves the jaw; the rest is friction in the thread. Of trapezoidal threads that
# are oiled this is usual: 0.2 to 0.4 (K.-H. Decker, Maschinenelemente, of screws that move under load).
SCREW_SHARE = 0.3


@frozen
class JawPair:
    """Two flat jaws; lengths in mm.

    Parameters
    ----------
    width : of both jaws.
    height : how high they stand above the bed; None for any height.
    thickness : how far they reach outward at their top; None for any.
    max_opening : the largest distance between them; None for any.
    parallels : their heights, 0 for the bed alone.
    least_grip : the least height that both must grip.
    stops : where the work stop is, one fixture for each; None for none.
    stop_offset : how far inward from the end of the jaws the stop touches the part.
    max_force : what the vise is rated for, in N; None where nobody says.
    screw_lead : how far a turn of the screw moves the jaw; None where nobody says.
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

    def compute_top(self, parallels: float) -> float:
        """Return how high the jaws stand above the part's lower side on parallels of a height."""
        return inf if self.height is None else self.height - parallels

    def name_outline_role(self, parallels: float) -> str:
        """Return what the outline is called that the jaws meet with the part on parallels of a height."""
        return f"jaws up to {round(self.compute_top(parallels), 6):g} mm"

    def compute_torque(self, force: float) -> float | None:
        """Return the torque in N m on the screw that closes with a force in N; None where the lead is not known."""
        return None if self.screw_lead is None else force * self.screw_lead / (2 * pi * SCREW_SHARE) / 1000.0
