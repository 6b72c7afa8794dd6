"""Two flat jaws between which a part is held by friction, as data for listing, verification and drawing.

The fixed jaw stands along x at y = 0, its left end at x = 0; the jaw that moves closes along -y. The part lies above
the fixed jaw, on parallels, and its lower side is at z = 0.
"""

from __future__ import annotations

from math import inf, pi

from attrs import frozen

__all__ = ["JawPair"]

# Part of the torque on a vise's screw that moves the jaw; the rest is friction in the thread. Oiled
# trapezoidal threads have 0.2 to 0.4 (K.-H. Decker, Maschinenelemente, on screws that move under load).
SCREW_SHARE = 0.3


@frozen
class JawPair:
    """Two flat jaws; lengths in mm.

    Parameters
    ----------
    width : of both jaws.
    height : of the jaws above the bed; None for any height.
    thickness : how far they reach outward at their top; None for unbounded.
    max_opening : the largest distance between them; None for no limit.
    parallels : heights of the parallels, 0 for the bed alone.
    least_grip : the least height that both must grip.
    stops : positions of the work stop, "left" or "right", one fixture for each; None for no stop.
    stop_offset : how far inward from the end of the jaws the stop touches the part.
    max_force : rated force in N; None where not known.
    screw_lead : travel of the jaw per turn of the screw; None where not known.
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
        """Return the height in mm of the jaws' top above the part's
        lower side, on parallels of this height; inf for any height.
        """
        return inf if self.height is None else self.height - parallels

    def name_outline_role(self, parallels: float) -> str:
        """Return the key of the outline that the jaws meet with the part on parallels of this height."""
        return f"jaws up to {round(self.compute_top(parallels), 6):g} mm"

    def compute_torque(self, force: float) -> float | None:
        """Return the torque in N m on the screw that closes the
        vise with a force in N; None where the lead is not known.
        """
        return None if self.screw_lead is None else force * self.screw_lead / (2 * pi * SCREW_SHARE) / 1000.0
