"""A part that lies flush on a wall: its hull edges there, its features in the wall's frame, and the counts of
a search.

In the wall's frame a part lies on a hull edge: u runs along it from its start, v up from it. A locator and a
clamp press it there (``search.wall_search``), or two pegs of a lattice that slides toward the wall
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
from workhold.geometry.segment import compute_bounding_box
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.model.fixture_table import FixtureTable
from workhold.model.pose import Pose
from workhold.model.requirements import lie_in_angle_ranges
from workhold.model.search_report import UndecidedCandidate

__all__ = ["FlushSearch", "PartOnWall", "lay_part_on_wall"]

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
    rows : (F, 12) kernel rows of F features in the wall's frame: u along the hull edge from its start, v up
        from the edge, in mm.
    length : length of the hull edge, in mm.
    turn : error bound of the hull edge's direction, in radians.
    off : error bound of lengths, in mm.
    """

    rows: Array
    length: float
    turn: float
    off: float


def lay_part_on_wall(problem: Problem, edge: int) -> PartOnWall:
    """Return a problem's features in the wall's frame, with hull edge number ``edge`` on the wall."""
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
    """Return the indices of the hull edges on which a part may lie, ascending.

    These are left out: edges at a forbidden angle, edges that only faces to avoid touch, edges with a
    keep-out zone that reaches into the wall, and edges where the program's tools come too near the wall.
    """
    part, asked = problem.workpiece, problem.restrictions
    avoided, carriers = list_avoided_faces(part, asked), problem.toolkit.carriers
    swept, out = problem.find_swept_spans(next(one for one in carriers if one.contact is WALL_END)), []
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
        if swept is not None and swept[0].find_reach_below_line(theta, -pose.y)[0] < swept[1] - GAP_SLACK:
            continue
        zones = [pose.carry(segment) for zone in asked.zones for segment in zone.segments]
        if all(compute_bounding_box(segment)[1] >= -CLEARANCE for segment in zones):
            out.append(number)
    return out


@define(eq=False)
class FlushSearch:
    """A search for pairs of contacts that press a part against a wall,
    one hull edge after the other, with counts.

    A pair is a locator and a clamp, or two pegs of a sliding lattice.

    Parameters
    ----------
    problem : the problem that is searched.
    explains : whether to keep the nearest miss: the pair that comes nearest to pressing the part.
    locators : number of contacts of locators found so far.
    examined : number of pairs of contacts so far.
    verified : number of these pairs that were proven to press the part.
    escalated : number of these pairs that were decided in ball arithmetic.
    undecided : pairs that ball arithmetic leaves undecided, for the search report.
    is_square : whether every face met so far is straight, and parallel or square to the wall.
    nearest : the pair that comes nearest to pressing the part, as (score, table of one row); None while no
        pair is known. The score is the pair's smallest entry of the null vector, whose absolute values sum to
        1. Kept only with ``explains`` and while no pair is verified.
    """

    problem: Problem
    explains: bool = False
    locators: int = field(default=0, init=False)
    examined: int = field(default=0, init=False)
    verified: int = field(default=0, init=False)
    escalated: int = field(default=0, init=False)
    undecided: list[UndecidedCandidate] = field(factory=list, init=False)
    is_square: bool = field(default=True, init=False)
    nearest: tuple[float, FixtureTable] | None = field(default=None, init=False)

    @property
    def edges(self) -> list[int]:
        """Indices of the hull edges on which the part may lie, ascending."""
        return list_allowed_edges(self.problem)

    @property
    def pair_toolkit(self) -> Toolkit:
        """Toolkit in which the nearest pair stands."""
        return self.problem.toolkit

    @property
    def can_touch(self) -> bool:
        """Whether pegs can touch the part, once the search has run."""
        raise NotImplementedError

    def iterate_fixtures(self, edge: int) -> Iterator[Any]:
        """Yield the pairs that press the part as it lies on hull edge ``edge``, in batches.

        The type of a batch depends on the subclass. The counts are updated while the iteration runs.
        """
        raise NotImplementedError

    def place_fixtures(self, parts: list[Any], edge: int) -> FixtureTable:
        """Return the table of those pairs that have a place in the toolkit, each once.

        ``parts`` are batches that :meth:`iterate_fixtures` yields for hull edge ``edge``, at least one.
        """
        raise NotImplementedError

    def lay_on_edge(self, edge: int) -> PartOnWall:
        """Return the part as it lies on hull edge ``edge``.

        Sets ``is_square`` to False where a face is round or oblique to the wall.
        """
        lying = lay_part_on_wall(self.problem, edge)
        tilted = np.minimum(np.abs(lying.rows[:, AXIS_X]), np.abs(lying.rows[:, AXIS_Y])) > PARALLEL
        self.is_square &= bool(((lying.rows[:, IS_ARC] == 0.0) & ~tilted).all())
        return lying

    def keep_nearest(
        self, null: Array, is_none: BoolArray, table: Callable[[IntArray], FixtureTable]
    ) -> None:
        """Update ``nearest`` with the best of M pairs, as long as no pair is verified.

        The best pair has the largest smallest entry in its null vector.

        Parameters
        ----------
        null : (M, 4) null vectors of pairs.
        is_none : (M,) True for pairs to leave out: the force by which a fixture's forces are divided is zero.
        table : returns the fixture table of the pairs with given indices.
        """
        if self.verified or len(null) == 0:
            return
        size = np.abs(null).sum(axis=1)
        share = np.where(size > LEAST_SPAN, null.min(axis=1) / np.maximum(size, LEAST_SPAN), -inf)
        share[is_none] = -inf
        best = int(share.argmax())
        if share[best] > (-inf if self.nearest is None else self.nearest[0]):
            self.nearest = float(share[best]), table(np.array([best]))
