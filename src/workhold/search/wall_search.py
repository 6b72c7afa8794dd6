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
from attrs import define, evolve
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import (
    FORCES_OFF,
    GAP_SLACK,
    LEAST_CLAMPING,
    SAME_PLACE,
)
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC
from workhold.kernels.contact.rules import ROUNDING
from workhold.listing.clamp_placement import find_axis
from workhold.listing.wall_fixtures import WallFixtures, make_wall_table, place_on_wall
from workhold.model.fixture_table import FixtureTable
from workhold.model.query import Query
from workhold.model.search_report import AT_AN_EDGE, Undecided
from workhold.proof.flush import (
    Candidate,
    compute_fence_reactions,
    locate_contact_exactly,
    locate_contacts_exactly,
    pressing,
)
from workhold.search.flush_search import FlushSearch, PartOnWall
from workhold.search.wall_contacts import (
    ContactPairs,
    PinContacts,
    closure,
    find_pin_contacts,
    may_oppose,
    seating,
)

__all__ = ["WallSearch", "find_fixtures_on_edge", "searches_of"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Forces that may be off by more are computed in balls: whether two clamps close is often a matter of an exact
# zero.
DOUBTFUL = 1e-10
# Pairs of locator and clamp looked at together.
TOGETHER = 1 << 17


@define(eq=False)
class WallSearch(FlushSearch):
    """The pairs of locator and clamp that press a part against a wall, with one direction of the clamp."""

    @property
    def plate(self) -> Carrier:
        """The plate in whose holes the locator stands."""
        return self.problem.toolkit.carriers[0]

    @property
    def clamp(self) -> Carrier:
        """The clamp, which moves."""
        return self.problem.toolkit.moving

    @property
    def push(self) -> tuple[float, float]:
        """Unit vector along which the clamp moves as it clamps."""
        x, y = self.problem.toolkit.moving_axis
        return 0.0 - x, 0.0 - y

    @property
    def alone(self) -> Toolkit:
        """The toolkit with a clamp that is its tip alone."""
        return self.problem.toolkit.changed({"travel": None})

    @property
    def touches(self) -> bool:
        """Whether the locator can touch the part."""
        return self.locators > 0

    def fixtures(self, edge: int) -> Iterator[WallFixtures]:
        """The pairs that press the part as it lies on a hull edge, some at a time."""
        return (part for _, part in find_fixtures_on_edge([self], edge))

    def placed(self, parts: list[WallFixtures], edge: int) -> FixtureTable:
        """The table of those pairs whose clamps have a place, each once."""
        return place_on_wall(WallFixtures.concatenate(parts), self.problem)

    def on_rows(self, edge: int, lying: PartOnWall, chosen: tuple[int, int], rows: Array) -> PinContacts:
        """Contacts of pegs in rows of holes; balls decide those where a row grazes an arc."""
        problem = self.problem
        places = find_pin_contacts(lying, chosen, rows, False, problem.contact_margin)
        near = np.flatnonzero(places.reach > SAME_PLACE / 2)
        kept = np.ones(len(places), np.bool_)
        for k in near.tolist():
            numbers = int(places.line[k]), int(places.feature[k]), float(places.branch[k])
            sharp = locate_contact_exactly(edge, *numbers, problem, self.plate)
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
            places = find_pin_contacts(lying, problem.moving, levels, True, problem.contact_margin)
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
                self.undecided.append(self.entry(candidate))
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

        def alone(chosen: IntArray) -> FixtureTable:
            query = evolve(self.problem.query, toolkit=self.alone)
            return make_wall_table(pairs(chosen), np.zeros(1, np.int64), evolve(self.problem, query=query))

        good = np.flatnonzero(held)
        self.verified += len(good)
        if self.explains:
            # Forces are given per clamp force, which there has to be.
            least = np.minimum(np.abs(null.sum(axis=1)), np.abs(null[:, 3] * push))
            self.look_nearer(null, least < LEAST_CLAMPING * np.abs(null).sum(axis=1), alone)
        return self.sharpened(pairs(good), edge, lying, one, two.take(good), locator[good])

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
        places = self.sharp_places(pressed, edge, one, two, locator)
        if not self.problem.pairing:
            return places
        null, push = places.null.copy(), places.push.copy()
        doubt = bound_reaction_errors(places, lying, one, two, locator, self.problem)
        grazes = two.swing > FORCES_OFF * push
        for k in np.flatnonzero((doubt > DOUBTFUL) | grazes).tolist():
            candidate = self.candidate(edge, one, two, locator, k)
            sharp = compute_fence_reactions(candidate, self.problem, self.plate, self.push)
            if sharp is not None:
                null[k, :3], doubt[k] = sharp.taken, sharp.doubt
                push[k] = sharp.push if grazes[k] else push[k]
        return evolve(places, null=null, doubt=doubt, push=push)

    def sharp_places(
        self, pressed: WallFixtures, edge: int, one: PinContacts, two: PinContacts, locator: IntArray
    ) -> WallFixtures:
        """Contacts computed in balls where doubles may not say well enough where they are, or how they press.

        Such contacts are near a row or a column that grazes an arc.
        """
        far = np.flatnonzero(np.maximum(one.reach[locator], two.reach) > SAME_PLACE / 2)
        places, tip, null = pressed.locator.copy(), pressed.tip.copy(), pressed.null.copy()
        for k in far.tolist():
            sharp = locate_contacts_exactly(
                self.candidate(edge, one, two, locator, k), self.problem, self.plate
            )
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
            is_upright=find_axis(self.clamp) == 1,
            features=(int(one.feature[behind]), int(two.feature[k])),
            branches=(float(one.branch[behind]), float(two.branch[k])),
        )

    def entry(self, candidate: Candidate) -> Undecided:
        """A candidate that is not decided, for the account."""
        flush, faces = self.problem.workpiece.flush, self.problem.faces[list(candidate.features)].tolist()
        one, other = flush.face[candidate.edge].tolist()
        line = (candidate.line, 0) if candidate.is_upright else (0, candidate.line)
        return Undecided(
            self.problem.toolkit.arrangements[0].title,
            (faces[0], one, other, faces[1]),
            (0, 0, 0, line[0]),
            (candidate.row, 0, 0, line[1]),
            float(np.degrees(flush.theta[candidate.edge])),
            AT_AN_EDGE,
            0.0,
        )


def bound_reaction_errors(
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


def searches_of(query: Query, ways: Sequence[Toolkit], pairing: bool = False) -> list[WallSearch]:
    """The searches of a query in the ways of a toolkit with a wall, which differ in the clamp's direction
    alone."""
    one, *others = (evolve(query, toolkit=way) for way in ways)
    problem = Problem.of(one, pairing=pairing)
    return [WallSearch(problem), *(WallSearch(evolve(problem, query=other)) for other in others)]


def find_fixtures_on_edge(
    searches: Sequence[WallSearch], edge: int
) -> Iterator[tuple[WallSearch, WallFixtures]]:
    """The pairs that press the part as it lies on a hull edge, some at a time, each with its search.

    What does not depend on the clamp's direction is looked at once for all searches (``searches_of``). This
    is where the part lies, the locators, and what pegs touch on rows and on columns.
    """
    one = searches[0]
    problem = one.problem
    lying = one.lying_on(edge)
    locators = one.on_rows(edge, lying, problem.standing, one.rows_of(lying, problem.standing))
    for search in searches:
        search.locators += len(locators)
    if len(locators) == 0:
        return
    along, upright = ([search for search in searches if find_axis(search.clamp) == axis] for axis in (0, 1))
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
