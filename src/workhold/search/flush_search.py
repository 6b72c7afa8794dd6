"""A part that lies flush on a wall: on which hull edges, how it lies there, and what a search counts there.

In the wall's frame a part lies on a hull edge: u runs along it from its start, v up from it. What presses it
there is a locator and a clamp (``search.wall_search``), or two pegs of a lattice that slides toward the wall
(``search.wall_shares``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.contact.features import list_avoided_faces
from workhold.contact.problem import Problem
from workhold.conventions import CLEARANCE, GAP_SLACK, LEAST_SPAN, PARALLEL
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import bounding_box
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.model.fixture_table import FixtureTable
from workhold.model.pose import Pose
from workhold.model.requirements import lie_in_angle_ranges
from workhold.model.search_report import Undecided

__all__ = ["FlushSearch", "PartOnWall", "part_on_wall"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Half a unit in the last place of a double.
UNIT_ROUNDOFF = 1.2e-16


@frozen(eq=False)
class PartOnWall:
    """Features of a part that lies on a hull edge.

    Parameters
    ----------
    rows : (F, 12) kernel rows in the wall's frame.
    length : of the hull edge, in mm.
    turn : by how many radians its direction may be off.
    off : by how many mm lengths may be off.
    """

    rows: Array
    length: float
    turn: float
    off: float


def part_on_wall(problem: Problem, edge: int) -> PartOnWall:
    """The features of a part that lies on a hull edge, by the edge's number."""
    rows = problem.rows
    start, end = problem.workpiece.flush.ends[edge] - np.array(problem.workpiece.center)
    step = end - start
    length = float(np.hypot(*step))
    (tx, ty), out = step / length, rows.copy()
    dx, dy = rows[:, X] - start[0], rows[:, Y] - start[1]
    out[:, X], out[:, Y] = dx * tx + dy * ty, dy * tx - dx * ty
    out[:, AXIS_X] = rows[:, AXIS_X] * tx + rows[:, AXIS_Y] * ty
    out[:, AXIS_Y] = rows[:, AXIS_Y] * tx - rows[:, AXIS_X] * ty
    size = float(np.abs(out[:, [X, Y, RADIUS]]).max(initial=length) + np.abs([start, end]).max())
    turn = 8 * UNIT_ROUNDOFF * (1.0 + size / length)
    return PartOnWall(out, length, turn, 16 * UNIT_ROUNDOFF * size + turn * size)


def list_allowed_edges(problem: Problem) -> list[int]:
    """The numbers of the hull edges on which a part may lie.

    There it is at an angle that is allowed, on faces that may be touched. No keep-out zone reaches into the
    wall, and the program's tools pass clear of it.
    """
    part, asked = problem.workpiece, problem.restrictions
    avoided, carriers = list_avoided_faces(part, asked), problem.toolkit.carriers
    swept, out = problem.swept(next(one for one in carriers if one.contact is WALL_END)), []
    for number, (theta, touching) in enumerate(
        zip(part.flush.theta.tolist(), part.flush.touching, strict=True)
    ):
        if any(map(avoided.issuperset, touching)):
            continue
        turned = float(np.degrees(theta))
        if not lie_in_angle_ranges(turned, asked.angles):
            continue
        x, y = part.flush.ends[number, 0].tolist()
        pose = Pose(turned, 0.0, -float(rotate_vectors(x, y, theta)[1]))
        if swept is not None and swept[0].above(theta, -pose.y)[0] < swept[1] - GAP_SLACK:
            continue
        zones = [pose.carry(segment) for zone in asked.zones for segment in zone.segments]
        if all(bounding_box(segment)[1] >= -CLEARANCE for segment in zones):
            out.append(number)
    return out


@define(eq=False)
class FlushSearch:
    """A search of what presses a part against a wall, one hull edge after the other, and what it counts.

    Parameters
    ----------
    problem : what is searched.
    explains : whether it is to say what comes nearest.
    locators, examined, verified, escalated : how many contacts of a locator and pairs of contacts there were,
        how many pairs were proven to press the part, and how many needed balls.
    undecided : the pairs that not even they decide, for the account.
    is_square : whether every face that was offered is straight, and parallel or square to the wall.
    nearest : the smallest share of the four contacts in the pair in which it is the largest, and that pair.
        It is known where it is asked for, and as long as none is proven.
    """

    problem: Problem
    explains: bool = False
    locators: int = field(default=0, init=False)
    examined: int = field(default=0, init=False)
    verified: int = field(default=0, init=False)
    escalated: int = field(default=0, init=False)
    undecided: list[Undecided] = field(factory=list, init=False)
    is_square: bool = field(default=True, init=False)
    nearest: tuple[float, FixtureTable] | None = field(default=None, init=False)

    @property
    def edges(self) -> list[int]:
        """The numbers of the hull edges on which the part may lie."""
        return list_allowed_edges(self.problem)

    @property
    def alone(self) -> Toolkit:
        """The toolkit in which the pair that comes nearest stands."""
        return self.problem.toolkit

    @property
    def touches(self) -> bool:
        """Whether pegs can touch the part."""
        raise NotImplementedError

    def fixtures(self, edge: int) -> Iterator[Any]:
        """The pairs that press the part as it lies on a hull edge, some at a time."""
        raise NotImplementedError

    def placed(self, parts: list[Any], edge: int) -> FixtureTable:
        """The table of those pairs on a hull edge that have a place, each once; at least one part."""
        raise NotImplementedError

    def lying_on(self, edge: int) -> PartOnWall:
        """The part as it lies on a hull edge."""
        lying = part_on_wall(self.problem, edge)
        tilted = np.minimum(np.abs(lying.rows[:, AXIS_X]), np.abs(lying.rows[:, AXIS_Y])) > PARALLEL
        self.is_square &= bool(((lying.rows[:, IS_ARC] == 0.0) & ~tilted).all())
        return lying

    def look_nearer(self, null: Array, is_none: BoolArray, table: Callable[[IntArray], FixtureTable]) -> None:
        """Keeps the pair that is nearest to pressing the part, as long as none is proven.

        Parameters
        ----------
        null : (M, 4) null vectors of pairs.
        is_none : (M,) which of them have no force by which forces could be given.
        table : gives the table of the pairs of an index array.
        """
        if self.verified or len(null) == 0:
            return
        size = np.abs(null).sum(axis=1)
        share = np.where(size > LEAST_SPAN, null.min(axis=1) / np.maximum(size, LEAST_SPAN), -inf)
        share[is_none] = -inf
        best = int(share.argmax())
        if share[best] > (-inf if self.nearest is None else self.nearest[0]):
            self.nearest = float(share[best]), table(np.array([best]))
