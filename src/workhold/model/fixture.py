"""A fixture: four pegs, a pose and a jaw separation, written out as holes that a machinist can count."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from workhold.model.holes import hole_name

__all__ = ["Fixture", "Jaw", "Peg", "Pose"]

Jaw = str


@frozen
class Peg:
    """A peg in a hole.

    Parameters
    ----------
    jaw : name of the carrier it stands on: "left" or "right" of a vise.
    column, row : the hole, counted from 0.
    x, y : the peg's centre in the vise frame, in mm.
    face : number of the face it touches.
    force : contact force per unit of clamping force.
    """

    jaw: str
    column: int
    row: int
    x: float
    y: float
    face: int
    force: float

    @property
    def hole(self) -> str:
        """The hole's name: jaw, column letter, row number from 1, such as ``L-B3``."""
        return hole_name(self.jaw, self.column, self.row)


@frozen
class Pose:
    """The map of a workpiece point q to R(theta) q + (x, y) in the vise frame; theta in degrees, x and y in mm."""

    theta_deg: float
    x: float
    y: float


@frozen
class Fixture:
    """One way to hold the workpiece.

    Parameters
    ----------
    type : name of its arrangement: of a vise "I" for two pegs on each jaw, "II" for three on the left and one on the right.
    pegs : in the order of the arrangement, those of a vise's left jaw first.
    pose : where the workpiece lies.
    jaw_separation : x distance in mm from the left jaw's last column to the right jaw's first.
    quality : figures of merit by name.
    """

    type: str
    pegs: tuple[Peg, ...]
    pose: Pose
    jaw_separation: float
    quality: Mapping[str, float]
