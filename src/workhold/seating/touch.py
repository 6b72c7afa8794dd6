"""What of a part a peg, or a wall, touches."""

from __future__ import annotations

from attrs import frozen

__all__ = ["Touch"]


@frozen
class Touch:
    """A face or a corner.

    Parameters
    ----------
    face : number of the face, or of the face that begins at the corner.
    corner : whether it is the corner rather than the face.
    """

    face: int
    corner: bool
