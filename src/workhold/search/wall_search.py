"""The search beside a wall: part flush on it, a locator in a row of holes, and a clamp on a row or a column.

There is one orientation for each hull edge. Every row then meets every feature in closed form, which are the
locator's places, and the clamp's lines do likewise. The null vector of the four wrenches decides whether a
pair presses the part against the wall. In words (Overmars et al. 1995): the line of the joint force of
locator and clamp meets the hull edge strictly between its ends. What the bounds of its error leave open is
decided in balls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, floor, inf

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.features import avoided_faces
from workhold.contact.problem import Problem
from workhold.conventions import (
    ANGLE_SLACK,
    CLEARANCE,
    FORCES_OFF,
    GAP_SLACK,
    LEAST_CLAMPING,
    LEAST_SPAN,
    PARALLEL,
    SAME_PLACE,
)
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.geometry.segment import bounding_box
from workhold.geometry.symmetry import rotated
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC
from workhold.kernels.contact.rules import ROUNDING
from workhold.listing.clamp_placement import axis_of
from workhold.listing.wall_fixtures import WallFixtures, placed_on_wall, wall_table
from workhold.model.fixture_table import FixtureTable
from workhold.model.pose import Pose
from workhold.model.query import Query
from workhold.proof.flush import Candidate, pressing, reactions_on_fence, sharp_contacts, sharp_place
from workhold.search.wall_contacts import (
    ContactPairs,
    PartOnWall,
    PinContacts,
    closure,
    may_oppose,
    part_on_wall,
    pin_contacts_on,
    seating,
)

__all__ = ["WallSearch", "allowed_edges", "faces_are_square", "fixtures_on", "lying_on", "searches_of"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Forces that may be off by more are computed in balls: whether two clamps close is often a matter of an exact
# zero.
DOUBTFUL = 1e-10
# Pairs of locator and clamp looked at together.
TOGETHER = 1 << 17


@define(eq=False)
class WallSearch:
    """The pairs of locator and clamp that press a part against a wall, with one direction of the clamp.

    Parameters
    ----------
    problem : what is searched.
    explains : whether it is to say what comes nearest.
    plate, clamp : in whose holes the locator stands, and the clamp.
    push : unit vector along which the clamp moves as it clamps.
    locators, examined, verified, escalated : how many contacts of the locator and pairs there were, how many
        pairs were proven to press the part, and how many needed balls.
    undecided : the pairs that not even they decide, with the number of their hull edge.
    is_square : whether every face that was offered is parallel or square to the wall.
    nearest : the smallest share of the four contacts in the pair in which it is the largest, and that pair.
        It is known where it is asked for, and as long as none is proven.
    """

    problem: Problem
    explains: bool = False
    plate: Carrier = field(init=False)
    clamp: Carrier = field(init=False)
    push: tuple[float, float] = field(init=False)
    locators: int = field(default=0, init=False)
    examined: int = field(default=0, init=False)
    verified: int = field(default=0, init=False)
    escalated: int = field(default=0, init=False)
    undecided: list[Candidate] = field(factory=list, init=False)
    is_square: bool = field(default=True, init=False)
    nearest: tuple[float, WallFixtures] | None = field(default=None, init=False)

    def __attrs_post_init__(self) -> None:
        toolkit = self.problem.toolkit
        self.plate, self.clamp = toolkit.carriers[0], toolkit.moving
        x, y = toolkit.moving_axis
        self.push = 0.0 - x, 0.0 - y

    @property
    def edges(self) -> list[int]:
        """The numbers of the hull edges on which the part may lie."""
        return allowed_edges(self.problem)

    def fixtures(self, edge: int) -> Iterator[WallFixtures]:
        """The pairs that press the part as it lies on a hull edge, some at a time."""
        return (part for _, part in fixtures_on([self], edge))

    def tables(self, edge: int) -> Iterator[FixtureTable]:
        """Tables of the fixtures whose clamps have a place, some at a time."""
        return (placed_on_wall(part, self.problem) for part in self.fixtures(edge))

    def nearest_alone(self) -> tuple[FixtureTable, Problem]:
        """The pair that comes nearest, with a clamp that is its tip alone, and the search of such clamps."""
        assert self.nearest is not None
        toolkit = self.problem.toolkit.changed({"travel": None})
        problem = evolve(self.problem, query=evolve(self.problem.query, toolkit=toolkit))
        return wall_table(self.nearest[1], np.zeros(1, np.int64), problem), problem

    def on_rows(self, edge: int, lying: PartOnWall, chosen: tuple[int, int], rows: Array) -> PinContacts:
        """Contacts of pegs in rows of holes; balls decide those where a row grazes an arc."""
        problem = self.problem
        places = pin_contacts_on(lying, chosen, rows, False, problem.contact_margin)
        near = np.flatnonzero(places.reach > SAME_PLACE / 2)
        kept = np.ones(len(places), np.bool_)
        for k in near.tolist():
            numbers = int(places.line[k]), int(places.feature[k]), float(places.branch[k])
            sharp = sharp_place(edge, *numbers, problem, self.plate)
            kept[k] = sharp is not None
            if sharp is not None:
                places.point[k], places.normal[k], places.slack[k] = sharp
                places.reach[k], places.swing[k] = 4.0 * lying.off, 4.0 * lying.turn
        return places.take(kept)

    def rows_of(self, lying: PartOnWall, chosen: tuple[int, int]) -> Array:
        """v of the rows of holes, from the first one on, that some features reach."""
        first, pitch = self.plate.offset[1], self.plate.pitch[1]
        _, high = reach_of(lying.rows[slice(*chosen)], upward=True)
        count = max(floor((high - first) / pitch + 1e-9) + 1, 0)
        rows = np.arange(count if self.plate.rows is None else min(count, self.plate.rows), dtype=np.float64)
        return np.asarray(first + pitch * rows)

    def of_rows(self, places: PinContacts, locators: PinContacts) -> Iterator[ContactPairs]:
        """Contacts of the clamp on rows, each with every locator, some at a time."""
        chosen = np.flatnonzero(self.may_press(places))
        together = max(TOGETHER // max(len(chosen), 1), 1)
        for start in range(0, len(locators), together):
            numbers = np.arange(start, min(start + together, len(locators)))
            yield ContactPairs(places, np.tile(chosen, len(numbers)), np.repeat(numbers, len(chosen)))

    def on_columns(self, lying: PartOnWall, locators: PinContacts) -> Iterator[ContactPairs]:
        """Contacts of pegs on columns of holes, some at a time, with the locators that these are counted
        from."""
        problem = self.problem
        low, high = reach_of(lying.rows[slice(*problem.moving)], upward=False)
        pitch, columns = self.plate.pitch[0], self.plate.columns
        most = inf if columns is None else columns - 1
        u = locators.point[:, 0]
        first, last = ceil((low - u.max()) / pitch - 1e-9), floor((high - u.min()) / pitch + 1e-9)
        steps = np.arange(int(max(first, -most)), int(min(last, most)) + 1)
        features = problem.moving[1] - problem.moving[0]
        together = max(TOGETHER // max(len(steps) * features, 1), 1)
        for start in range(0, len(locators) if len(steps) else 0, together):
            some = u[start : start + together]
            levels = (some[:, None] + pitch * steps).ravel()
            places = pin_contacts_on(lying, problem.moving, levels, True, problem.contact_margin)
            locator, step = np.divmod(places.line, len(steps))
            locator += start
            # The column is as uncertain as the locator it is counted from.
            grown = places.reach + 4.0 * locators.reach[locator] * (
                1.0 + (places.reach + lying.off) / lying.off
            )
            yield ContactPairs(evolve(places, line=steps[step], reach=grown), np.arange(len(places)), locator)

    def may_press(self, places: PinContacts) -> BoolArray:
        """Which contacts (M,) of the tip are clear of the wall, and push the part."""
        x, y = self.push
        push = -(places.normal[:, 0] * x + places.normal[:, 1] * y)
        above = places.point[:, 1] >= self.clamp.peg_radius - GAP_SLACK
        return np.asarray(above & (push > -2.0 * places.swing))

    def closing(self, edge: int, lying: PartOnWall, one: PinContacts, clamps: ContactPairs) -> WallFixtures:
        """The pairs of locators and clamps that press the part against the wall."""
        self.examined += len(clamps)
        pairing = self.problem.pairing
        if not (pairing or self.explains):
            clamps = clamps.take(may_oppose(lying, one, clamps, self.problem))
        two, locator = clamps.places.take(clamps.which), clamps.locator
        null, push, held, doubtful = (seating if pairing else closure)(
            lying, one, two, locator, self.push, self.problem
        )
        open_ = np.flatnonzero(doubtful)
        for k in open_.tolist():
            candidate = self.candidate(edge, one, two, locator, k)
            verdict = pressing(candidate, self.problem, self.plate, self.push)
            held[k] = verdict is True
            if verdict is None:
                self.undecided.append(candidate)
        self.escalated += len(open_)

        def pairs(chosen: IntArray) -> WallFixtures:
            behind = locator[chosen]
            return WallFixtures(
                edge=np.full(len(chosen), edge),
                row=one.line[behind],
                line=two.line[chosen],
                locator=one.point[behind],
                tip=two.point[chosen],
                feature=np.stack([one.feature[behind], two.feature[chosen]], axis=1),
                null=null[chosen],
                push=push[chosen],
            )

        good = np.flatnonzero(held)
        self.verified += len(good)
        found = self.sharpened(pairs(good), edge, lying, one, two.take(good), locator[good])
        if self.explains and self.verified == 0:
            size = np.abs(null).sum(axis=1)
            share = np.where(size > LEAST_SPAN, null.min(axis=1) / np.maximum(size, LEAST_SPAN), -inf)
            # Forces are given per clamp force, which there has to be.
            least = np.minimum(np.abs(null.sum(axis=1)), np.abs(null[:, 3] * push))
            share[least < LEAST_CLAMPING * size] = -inf
            best = int(share.argmax())
            if share[best] > (-inf if self.nearest is None else self.nearest[0]):
                self.nearest = float(share[best]), pairs(np.array([best]))
        return found

    def sharpened(
        self,
        pressed: WallFixtures,
        edge: int,
        lying: PartOnWall,
        one: PinContacts,
        two: PinContacts,
        locator: IntArray,
    ) -> WallFixtures:
        """Pairs computed in balls where doubles are too coarse.

        Of two clamps this gives how far their forces may be off, too.
        """
        places = self.placed(pressed, edge, one, two, locator)
        if not self.problem.pairing:
            return places
        null, push = places.null.copy(), places.push.copy()
        doubt = reaction_doubts(places, lying, one, two, locator, self.problem)
        grazes = two.swing > FORCES_OFF * push
        for k in np.flatnonzero((doubt > DOUBTFUL) | grazes).tolist():
            candidate = self.candidate(edge, one, two, locator, k)
            sharp = reactions_on_fence(candidate, self.problem, self.plate, self.push)
            if sharp is not None:
                null[k, :3], doubt[k] = sharp.taken, sharp.doubt
                push[k] = sharp.push if grazes[k] else push[k]
        return evolve(places, null=null, doubt=doubt, push=push)

    def placed(
        self, pressed: WallFixtures, edge: int, one: PinContacts, two: PinContacts, locator: IntArray
    ) -> WallFixtures:
        """Contacts computed in balls where doubles may not say well enough where they are, or how they press.

        Such contacts are near a row or a column that grazes an arc.
        """
        far = np.flatnonzero(np.maximum(one.reach[locator], two.reach) > SAME_PLACE / 2)
        places, tip, null = pressed.locator.copy(), pressed.tip.copy(), pressed.null.copy()
        for k in far.tolist():
            sharp = sharp_contacts(self.candidate(edge, one, two, locator, k), self.problem, self.plate)
            if sharp is not None:
                places[k], tip[k] = sharp.points
                null[k] = null[k] if self.problem.pairing else sharp.null
        return evolve(pressed, locator=places, tip=tip, null=null) if len(far) else pressed

    def candidate(
        self, edge: int, one: PinContacts, two: PinContacts, locator: IntArray, k: int
    ) -> Candidate:
        """A pair as balls decide it."""
        behind = int(locator[k])
        return Candidate(
            edge=edge,
            row=int(one.line[behind]),
            line=int(two.line[k]),
            is_upright=axis_of(self.clamp) == 1,
            features=(int(one.feature[behind]), int(two.feature[k])),
            branches=(float(one.branch[behind]), float(two.branch[k])),
        )


def reaction_doubts(
    pressed: WallFixtures,
    lying: PartOnWall,
    one: PinContacts,
    two: PinContacts,
    locator: IntArray,
    problem: Problem,
) -> Array:
    """How far the forces of wall and locator (M,) may be off, from how far places and normals may be."""
    reach = np.maximum(one.reach[locator], two.reach)
    swing = np.maximum(one.swing[locator], two.swing)
    across = np.abs(one.normal[locator, 0])
    size = 1.0 + np.abs(pressed.null).sum(axis=1)
    wall = lying.length / problem.wrench_length
    with np.errstate(invalid="ignore"):
        doubt = 4.0 * size * (20.0 * swing + 4.0 * (reach + lying.off) / problem.wrench_length + ROUNDING)
        return np.asarray(np.nan_to_num(doubt / (across * min(wall, 1.0)), nan=inf))


def allowed_edges(problem: Problem) -> list[int]:
    """The numbers of the hull edges on which a part may lie.

    There it is at an angle that is allowed, on faces that may be touched. No keep-out zone reaches into the
    wall, and the program's tools pass clear of it.
    """
    part, asked = problem.workpiece, problem.restrictions
    avoided, carriers = avoided_faces(part, asked), problem.toolkit.carriers
    swept, out = problem.swept(next(one for one in carriers if one.contact is WALL_END)), []
    for number, (theta, touching) in enumerate(
        zip(part.flush.theta.tolist(), part.flush.touching, strict=True)
    ):
        if any(avoided.issuperset(end.faces) for end in touching):
            continue
        turned = float(np.degrees(theta))
        off = [
            ((turned - low + ANGLE_SLACK) % 360.0, high - low + 2 * ANGLE_SLACK) for low, high in asked.angles
        ]
        if off and not any(ahead <= width for ahead, width in off):
            continue
        x, y = part.flush.ends[number, 0].tolist()
        pose = Pose(turned, 0.0, -float(rotated(x, y, theta)[1]))
        if swept is not None and swept[0].above(theta, -pose.y)[0] < swept[1] - GAP_SLACK:
            continue
        zones = [pose.carry(segment) for zone in asked.zones for segment in zone.segments]
        if all(bounding_box(segment)[1] >= -CLEARANCE for segment in zones):
            out.append(number)
    return out


def lying_on(problem: Problem, edge: int) -> PartOnWall:
    """The features as the part lies on a hull edge."""
    ends = problem.workpiece.flush.ends[edge] - np.array(problem.workpiece.center)
    return part_on_wall(problem.rows, ends[0], ends[1])


def faces_are_square(lying: PartOnWall) -> bool:
    """Whether every face that is offered is straight, and parallel or square to the wall."""
    tilted = np.minimum(np.abs(lying.rows[:, AXIS_X]), np.abs(lying.rows[:, AXIS_Y])) > PARALLEL
    return bool(((lying.rows[:, IS_ARC] == 0.0) & ~tilted).all())


def searches_of(query: Query, ways: Sequence[Toolkit], pairing: bool = False) -> list[WallSearch]:
    """The searches of a query in the ways of a toolkit with a wall, which differ in the clamp's direction
    alone."""
    one, *others = (evolve(query, toolkit=way) for way in ways)
    problem = Problem.of(one, pairing=pairing)
    return [WallSearch(problem), *(WallSearch(evolve(problem, query=other)) for other in others)]


def fixtures_on(searches: Sequence[WallSearch], edge: int) -> Iterator[tuple[WallSearch, WallFixtures]]:
    """The pairs that press the part as it lies on a hull edge, some at a time, each with its search.

    What does not depend on the clamp's direction is looked at once for all searches (``searches_of``). This
    is where the part lies, the locators, and what pegs touch on rows and on columns.
    """
    one = searches[0]
    problem = one.problem
    lying = lying_on(problem, edge)
    locators = one.on_rows(edge, lying, problem.standing, one.rows_of(lying, problem.standing))
    for search in searches:
        search.is_square = search.is_square and faces_are_square(lying)
        search.locators += len(locators)
    if len(locators) == 0:
        return
    along, upright = ([search for search in searches if axis_of(search.clamp) == axis] for axis in (0, 1))
    if along:
        places = locators
        if problem.moving != problem.standing:
            places = one.on_rows(edge, lying, problem.moving, one.rows_of(lying, problem.moving))
        for search in along:
            for part in search.of_rows(places, locators):
                if len(part):
                    yield search, search.closing(edge, lying, locators, part)
    for part in one.on_columns(lying, locators) if upright else ():
        for search in upright:
            pushing = part.take(search.may_press(part.places))
            if len(pushing):
                yield search, search.closing(edge, lying, locators, pushing)


def reach_of(rows: Array, upward: bool) -> tuple[float, float]:
    """Least and largest v, or u, of features (F, 12)."""
    place = rows[:, 2 if upward else 1]
    extent = np.where(
        rows[:, IS_ARC] != 0.0, rows[:, 6], rows[:, 5] * np.abs(rows[:, AXIS_Y if upward else AXIS_X])
    )
    return float((place - extent).min()), float((place + extent).max())
