"""What every kernel of a search is given, as named records: features, lattice, limits and what a proof needs
besides.

Kernels work in the frame in which the moving carrier of the toolkit slides along +x (``contact.frame``). Pegs
of the carrier that stands still come first.
"""

from __future__ import annotations

from typing import NamedTuple

from workhold.kernels.base.compiling import Array

__all__ = ["Features", "Lattice", "Limits", "Setting"]


class Features(NamedTuple):
    """Contact features; the pegs of each carrier touch a range of them, of their own radius.

    Parameters
    ----------
    loose : (F, 10) rows with ends moved out by a hair, to search.
    rows : (F, 12) rows with the slack of their ends, to check.
    standing, moving : first and past-the-last number of those that pegs of each carrier touch; ranges are the
        same or apart.
    """

    loose: Array
    rows: Array
    standing: tuple[int, int]
    moving: tuple[int, int]


class Lattice(NamedTuple):
    """The lattice of holes, common to both carriers, in mm; ``row_offset`` is the height of the moving
    carrier's row 0 above that of the standing one."""

    pitch_x: float
    pitch_y: float
    row_offset: float


class Limits(NamedTuple):
    """What bounds a fixture.

    Parameters
    ----------
    gap : smallest distance in mm along x from a standing to a moving peg, -inf where there is no such rule.
    contact_margin : smallest distance in mm from a contact to the end of its feature.
    wrench_length : L in mm.
    most_column_steps : largest column difference between pegs of one carrier.
    clamping : 1 when the moving carrier clamps by pushing towards -x, -1 when it clamps by pushing towards
        +x.
    least_margin : smallest closure margin of interest.
    most_listed : how many contacts a block lists when it counts them.
    pairing : 1 when the peg that moves is one of two clamps: nothing need close yet, but the standing pegs
        alone must fix the pose, and the clamp must push. Else 0.
    """

    gap: float
    contact_margin: float
    wrench_length: float
    most_column_steps: float
    clamping: float
    least_margin: float
    most_listed: float
    pairing: float = 0.0


class Setting(NamedTuple):
    """What is common to all records of a search.

    It holds lattice and limits, radii of the standing and the moving pegs in mm, and how far in mm the
    features' rows may be from the drawing.
    """

    lattice: Lattice
    limits: Limits
    standing_radius: float
    moving_radius: float
    backward_error: float
