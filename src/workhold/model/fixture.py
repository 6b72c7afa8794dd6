"""A fixture: four pegs, a pose and a jaw separation, written out as holes that a machinist can count."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan, radians, tan
from typing import Any

from attrs import field, frozen

from workhold.geometry.rotation import rotated
from workhold.geometry.segment import Arc, Line, Segment
from workhold.model.holes import hole_name

__all__ = ["WALL", "Fixture", "Pair", "Peg", "Pose"]

# What stands for a wall among the carriers of pegs.
WALL = "wall"


@frozen
class Peg:
    """A peg in a hole.

    Parameters
    ----------
    carrier : name of what it stands on: "left" or "right" of a vise.
    column, row : the hole, counted from 0.
    x, y : the peg's centre in the vise frame, in mm.
    face : number of the face it touches.
    force : contact force per unit of clamping force; of two clamps per unit of the sum of theirs, at the working ratio.
    place : what its place is called where that is no hole of its carrier: of a clamp its hole or its line.
    beside : number of a second face that it touches: of a corner that lies on a wall; None of all others.
    """

    carrier: str
    column: int
    row: int
    x: float
    y: float
    face: int
    force: float
    place: str | None = None
    beside: int | None = None

    @property
    def is_on_wall(self) -> bool:
        """Whether it is an end of the contact with a wall rather than a peg."""
        return self.carrier == WALL

    @property
    def touched(self) -> str:
        """The number of the face touched, or those of the two that meet at a corner.

        >>> Peg("wall", 0, 0, 12.0, 0.0, 3, 0.4, beside=4).touched
        '3/4'
        """
        return str(self.face) if self.beside is None else f"{self.face}/{self.beside}"

    @property
    def touching(self) -> str:
        """What it touches, in words."""
        return f"face {self.face}" if self.beside is None else f"the corner of faces {self.face} and {self.beside}"

    @property
    def hole(self) -> str:
        """The hole's name: the carrier's letter, column letter, row number from 1, such as ``L-B3``."""
        return self.place or hole_name(self.carrier, self.column, self.row)


@frozen
class Pose:
    """The map of a workpiece point q to R(theta) q + (x, y) in the vise frame; theta in degrees, x and y in mm.

    Points and directions are given by their coordinates, numbers or arrays of them.

    Examples
    --------
    >>> pose = Pose(90.0, 40.0, 5.0)
    >>> [round(float(v), 12) for v in (*pose.apply(3.0, 1.0), *pose.inverse.apply(39.0, 8.0))]
    [39.0, 8.0, 3.0, 1.0]
    """

    theta_deg: float
    x: float
    y: float

    @property
    def inverse(self) -> Pose:
        """The way back, from the vise frame to the workpiece's."""
        x, y = rotated(-self.x, -self.y, -radians(self.theta_deg))
        return Pose(-self.theta_deg, float(x), float(y))

    def turn(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Directions of the workpiece as they point in the vise frame."""
        return rotated(x, y, radians(self.theta_deg))

    def apply(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Points of the workpiece, in mm, in the vise frame."""
        turned_x, turned_y = self.turn(x, y)
        return turned_x + self.x, turned_y + self.y

    def carry(self, segment: Segment) -> Segment:
        """A segment of the workpiece in the vise frame."""
        if isinstance(segment, Line):
            return Line(self.apply(*segment.start), self.apply(*segment.end))
        middle = segment.mid_angle + radians(self.theta_deg)
        return Arc(self.apply(*segment.center), segment.radius, middle, segment.half_sweep, segment.sign)


@frozen
class Pair:
    """What is particular to a fixture with two clamps.

    Parameters
    ----------
    travels : how far each clamp has travelled from its hole, in mm.
    ratio : the open interval of the second clamp's force over the first's in which all locators are pressed; the upper end
        may be infinite.
    reactions : of each peg its force per unit of the force of the first clamp, and of the second.
    count : how many pairs of clamps there are at this seat, of which this one is listed.
    """

    travels: tuple[float, float]
    ratio: tuple[float, float]
    reactions: tuple[tuple[float, float], ...]
    count: int

    @property
    def working_ratio(self) -> float:
        """The second clamp's force over the first's, in the middle of the interval as an angle."""
        return tan((atan(self.ratio[0]) + atan(self.ratio[1])) / 2)


@frozen
class Fixture:
    """One way to hold the workpiece.

    Parameters
    ----------
    type : name of its arrangement: of a vise "I" for two pegs on each jaw, "II" for three on the left and one on the right.
    pegs : in the order of the arrangement, those of a vise's left jaw first.
    pose : where the workpiece lies.
    jaw_separation : x distance in mm from the left jaw's last column to the right jaw's first; of another toolkit the travel
        of what moves.
    quality : figures of merit by name.
    direction : in which the clamp moves when it clamps, such as "-x", or two clamps do, "-x -y"; None of a vise.
    pair : what is particular to two clamps; None of other fixtures.
    """

    type: str
    pegs: tuple[Peg, ...]
    pose: Pose
    jaw_separation: float
    quality: Mapping[str, float] = field(eq=lambda quality: tuple(sorted(quality.items())))
    direction: str | None = None
    pair: Pair | None = None
