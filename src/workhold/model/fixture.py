"""A fixture: four pegs, a pose and a jaw separation, written out as holes that a machinist can count."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from attrs import frozen

from workhold.model.holes import hole_name

__all__ = ["Fixture", "Jaw", "Peg", "Pose"]

Jaw = Literal["left", "right"]


@frozen
class Peg:
    """A peg in a hole.

    Parameters
    ----------
    jaw : "left" or "right".
    column, row : the hole, counted from 0.
    x, y : the peg's centre in the vise frame, in mm.
    segment : number of the face it touches.
    force : contact force per unit of clamping force.
    """

    jaw: Jaw
    column: int
    row: int
    x: float
    y: float
    segment: int
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
    type : "I" for two pegs on each jaw, "II" for three on the left and one on the right.
    pegs : the four pegs, those of the left jaw first.
    pose : where the workpiece lies.
    jaw_separation : x distance in mm from the left jaw's last column to the right jaw's first.
    quality : figures of merit by name.
    """

    type: Literal["I", "II"]
    pegs: tuple[Peg, Peg, Peg, Peg]
    pose: Pose
    jaw_separation: float
    quality: Mapping[str, float]
