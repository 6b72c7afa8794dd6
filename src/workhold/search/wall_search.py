"""The search beside a wall: part flush on it, a locator in a row of holes, and a clamp on a row or a column.

There is one orientation for each hull edge. For each, the crossings of rows of holes with features, in closed
form, are the locator's places; the crossings of the clamp's lines are the places of its tip. The null vector
of the four wrenches decides whether a pair presses the part against the wall: geometrically (Overmars et al.
1995), the line of the joint force of locator and clamp must meet the hull edge strictly between its ends.
Pairs that the error bounds leave undecided are decided in ball arithmetic.
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
from workhold.model.search_report import AT_AN_EDGE, UndecidedCandidate
from workhold.proof.flush import (
    WallCandidate,
    compute_fence_reactions,
    is_pressing,
    locate_contact_exactly,
    locate_contacts_exactly,
)
from workhold.search.flush_search import FlushSearch, PartOnWall
from workhold.search.wall_contacts import (
    ContactPairs,
    PinContacts,
    find_pin_contacts,
    judge_closure,
    judge_seating,
    may_oppose,
)

__all__ = ["WallSearch", "find_fixtures_on_edge", "make_searches"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Forces with a larger error bound are computed in ball arithmetic, as two clamps often close by an exact
# zero.
DOUBTFUL = 1e-10
# Pairs of locator and clamp looked at together.
TOGETHER = 1 << 17


@define(eq=False)
class WallSearch(FlushSearch):
    """The search for pairs of locator and clamp that press a part
    against a wall, for one direction of the clamp.
    """

    @property
    def plate(self) -> Carrier:
        """Plate in whose holes the locator stands."""
        return self.problem.toolkit.carriers[0]

    @property
    def clamp(self) -> Carrier:
        """Moving clamp."""
        return self.problem.toolkit.moving

    @property
    def push(self) -> tuple[float, float]:
        """Unit vector of the clamp's movement as it clamps."""
        x, y = self.problem.toolkit.moving_axis
        return 0.0 - x, 0.0 - y

    @property
    def pair_toolkit(self) -> Toolkit:
        """Toolkit whose clamp is its tip alone, without travel."""
        return self.problem.toolkit.with_fields({"travel": None})

    @property
    def can_touch(self) -> bool:
        """Whether a locator can touch the part on one of the hull edges searched so far."""
        return self.locators > 0

    def iterate_fixtures(self, edge: int) -> Iterator[WallFixtures]:
        """Yield, in batches, the pairs that press the part as it lies on a hull edge."""
        return (part for _, part in find_fixtures_on_edge([self], edge))

    def place_fixtures(self, parts: list[WallFixtures], edge: int) -> FixtureTable:
        """Return the table of those pairs whose clamps have a place, each pair once.

        ``edge`` is not used.
        """
        return place_on_wall(WallFixtures.concatenate(parts), self.problem)

    def find_contacts_on_rows(
        self, edge: int, lying: PartOnWall, chosen: tuple[int, int], rows: Array
    ) -> PinContacts:
        """Return the contacts of pegs in rows of holes with the features ``chosen[0]`` to ``chosen[1] - 1``.

        ``rows`` (K,) are the rows' coordinates v in mm. Contacts of rows that graze an arc are computed in
        ball arithmetic, and left out where it finds none. ``edge`` is the index of the hull edge on the wall.
        """
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

    def list_row_heights(self, lying: PartOnWall, chosen: tuple[int, int]) -> Array:
        """Return the coordinates v (K,) in mm of the rows of holes that
        may meet some features, from the first row up.

        The features are ``chosen[0]`` to ``chosen[1] - 1``.
        """
        first, pitch = self.plate.offset[1], self.plate.pitch[1]
        _, high = bound_reach(lying.rows[slice(*chosen)], upward=True)
        count = max(floor((high - first) / pitch + 1e-9) + 1, 0)
        rows = np.arange(count if self.plate.rows is None else min(count, self.plate.rows), dtype=np.float64)
        return np.asarray(first + pitch * rows)

    def pair_contacts_on_rows(self, places: PinContacts, locators: PinContacts) -> Iterator[ContactPairs]:
        """Yield, in batches, every pair of a clamp contact and a locator contact.

        Clamp contacts are taken from ``places``, which are on rows of holes; those that cannot push the part
        are left out.
        """
        chosen = np.flatnonzero(self.find_pressing_tips(places))
        together = max(TOGETHER // max(len(chosen), 1), 1)
        for start in range(0, len(locators), together):
            numbers = np.arange(start, min(start + together, len(locators)))
            yield ContactPairs(places, np.tile(chosen, len(numbers)), np.repeat(numbers, len(chosen)))

    def pair_contacts_on_columns(self, lying: PartOnWall, locators: PinContacts) -> Iterator[ContactPairs]:
        """Yield, in batches, every pair of a locator contact and a clamp
        contact a whole number of columns from it.

        The clamp's tip moves along a column of holes.
        """
        problem = self.problem
        low, high = bound_reach(lying.rows[slice(*problem.moving)], upward=False)
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

    def find_pressing_tips(self, places: PinContacts) -> BoolArray:
        """Return a mask (M,): True for contacts of the clamp's tip that
        are clear of the wall and may push the part.
        """
        x, y = self.push
        push = -(places.normal[:, 0] * x + places.normal[:, 1] * y)
        above = places.point[:, 1] >= self.clamp.peg_radius - GAP_SLACK
        return np.asarray(above & (push > -2.0 * places.swing))

    def find_closing_pairs(
        self, edge: int, lying: PartOnWall, one: PinContacts, clamps: ContactPairs
    ) -> WallFixtures:
        """Return the pairs that press the part against the wall, decided in
        ball arithmetic where doubles are too coarse.

        ``one`` are the contacts of locators, ``clamps`` the pairs to test. Updates the counts, and with
        ``explains`` the nearest pair.
        """
        self.examined += len(clamps)
        pairing = self.problem.pairing
        if not (pairing or self.explains):
            clamps = clamps.take(may_oppose(lying, one, clamps, self.problem))
        two, locator = clamps.places.take(clamps.which), clamps.locator
        null, push, held, doubtful = (judge_seating if pairing else judge_closure)(
            lying, one, two, locator, self.push, self.problem
        )
        open_ = np.flatnonzero(doubtful)
        for k in open_.tolist():
            candidate = self.make_candidate(edge, one, two, locator, k)
            verdict = is_pressing(candidate, self.problem, self.plate, self.push)
            held[k] = verdict is True
            if verdict is None:
                self.undecided.append(self.make_undecided(candidate))
        self.escalated += len(open_)

        def take_pairs(chosen: IntArray) -> WallFixtures:
            """Return the pairs with these indices."""
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

        def make_tip_table(chosen: IntArray) -> FixtureTable:
            """Return the table of the pairs with these indices, in the
            toolkit whose clamp is its tip alone.
            """
            query = evolve(self.problem.query, toolkit=self.pair_toolkit)
            return make_wall_table(
                take_pairs(chosen), np.zeros(1, np.int64), evolve(self.problem, query=query)
            )

        good = np.flatnonzero(held)
        self.verified += len(good)
        if self.explains:
            # Forces are given per clamp force, which there has to be.
            least = np.minimum(np.abs(null.sum(axis=1)), np.abs(null[:, 3] * push))
            self.keep_nearest(null, least < LEAST_CLAMPING * np.abs(null).sum(axis=1), make_tip_table)
        return self.sharpen_pairs(take_pairs(good), edge, lying, one, two.take(good), locator[good])

    def sharpen_pairs(
        self,
        pressed: WallFixtures,
        edge: int,
        lying: PartOnWall,
        one: PinContacts,
        two: PinContacts,
        locator: IntArray,
    ) -> WallFixtures:
        """Return pairs whose places come from ball arithmetic where doubles are too coarse.

        With two clamps their forces are sharpened as well, and get error bounds (``doubt``). ``two`` (the
        clamp's contacts) and ``locator`` (indices in ``one``) have one entry for each pair of ``pressed``.
        """
        places = self.sharpen_places(pressed, edge, one, two, locator)
        if not self.problem.pairing:
            return places
        null, push = places.null.copy(), places.push.copy()
        doubt = bound_reaction_errors(places, lying, one, two, locator, self.problem)
        grazes = two.swing > FORCES_OFF * push
        for k in np.flatnonzero((doubt > DOUBTFUL) | grazes).tolist():
            candidate = self.make_candidate(edge, one, two, locator, k)
            sharp = compute_fence_reactions(candidate, self.problem, self.plate, self.push)
            if sharp is not None:
                null[k, :3], doubt[k] = sharp.taken, sharp.doubt
                push[k] = sharp.push if grazes[k] else push[k]
        return evolve(places, null=null, doubt=doubt, push=push)

    def sharpen_places(
        self, pressed: WallFixtures, edge: int, one: PinContacts, two: PinContacts, locator: IntArray
    ) -> WallFixtures:
        """Return pairs whose contacts come from ball arithmetic where doubles are too coarse.

        Doubles are too coarse near a row or a column that grazes an arc. With one clamp the forces come from
        ball arithmetic, too. Parameters as in :meth:`sharpen_pairs`.
        """
        far = np.flatnonzero(np.maximum(one.reach[locator], two.reach) > SAME_PLACE / 2)
        places, tip, null = pressed.locator.copy(), pressed.tip.copy(), pressed.null.copy()
        for k in far.tolist():
            sharp = locate_contacts_exactly(
                self.make_candidate(edge, one, two, locator, k), self.problem, self.plate
            )
            if sharp is not None:
                places[k], tip[k] = sharp.points
                null[k] = null[k] if self.problem.pairing else sharp.null
        return evolve(pressed, locator=places, tip=tip, null=null) if len(far) else pressed

    def make_candidate(
        self, edge: int, one: PinContacts, two: PinContacts, locator: IntArray, k: int
    ) -> WallCandidate:
        """Return pair ``k`` in the form that ball arithmetic decides.

        ``two`` and ``locator`` have one entry for each pair; ``one`` are the contacts that ``locator``
        indexes.
        """
        behind = int(locator[k])
        return WallCandidate(
            edge=edge,
            row=int(one.line[behind]),
            line=int(two.line[k]),
            is_upright=find_axis(self.clamp) == 1,
            features=(int(one.feature[behind]), int(two.feature[k])),
            branches=(float(one.branch[behind]), float(two.branch[k])),
        )

    def make_undecided(self, candidate: WallCandidate) -> UndecidedCandidate:
        """Return the entry of the search report for an undecided pair."""
        flush, faces = self.problem.workpiece.flush, self.problem.faces[list(candidate.features)].tolist()
        one, other = flush.face[candidate.edge].tolist()
        line = (candidate.line, 0) if candidate.is_upright else (0, candidate.line)
        return UndecidedCandidate(
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
    """Return error bounds (M,) of the forces of wall and locator of M pairs; inf where unknown.

    They follow from the error bounds of places and normals. Parameters as in
    :meth:`WallSearch.sharpen_pairs`.
    """
    reach = np.maximum(one.reach[locator], two.reach)
    swing = np.maximum(one.swing[locator], two.swing)
    across = np.abs(one.normal[locator, 0])
    size = 1.0 + np.abs(pressed.null).sum(axis=1)
    wall = lying.length / problem.wrench_length
    with np.errstate(invalid="ignore"):
        doubt = 4.0 * size * (20.0 * swing + 4.0 * (reach + lying.off) / problem.wrench_length + ROUNDING)
        return np.asarray(np.nan_to_num(doubt / (across * min(wall, 1.0)), nan=inf))


def make_searches(query: Query, ways: Sequence[Toolkit], pairing: bool = False) -> list[WallSearch]:
    """Return one search for each toolkit of ``ways``, which differ in the direction of the clamp alone.

    ``pairing`` tells that there are two clamps; contacts with one clamp then need no closure.
    """
    one, *others = (evolve(query, toolkit=way) for way in ways)
    problem = Problem.from_query(one, pairing=pairing)
    return [WallSearch(problem), *(WallSearch(evolve(problem, query=other)) for other in others)]


def find_fixtures_on_edge(
    searches: Sequence[WallSearch], edge: int
) -> Iterator[tuple[WallSearch, WallFixtures]]:
    """Yield (search, pairs) in batches: the pairs that press the part as it lies on hull edge ``edge``.

    ``searches`` come from :func:`make_searches`. The lie of the part, locator contacts, and contacts on rows
    and columns are computed once for all searches.
    """
    one = searches[0]
    problem = one.problem
    lying = one.lay_on_edge(edge)
    locators = one.find_contacts_on_rows(
        edge, lying, problem.standing, one.list_row_heights(lying, problem.standing)
    )
    for search in searches:
        search.locators += len(locators)
    if len(locators) == 0:
        return
    along, upright = ([search for search in searches if find_axis(search.clamp) == axis] for axis in (0, 1))
    if along:
        places = locators
        if problem.moving != problem.standing:
            places = one.find_contacts_on_rows(
                edge, lying, problem.moving, one.list_row_heights(lying, problem.moving)
            )
        for search in along:
            for part in search.pair_contacts_on_rows(places, locators):
                if len(part):
                    yield search, search.find_closing_pairs(edge, lying, locators, part)
    for part in one.pair_contacts_on_columns(lying, locators) if upright else ():
        for search in upright:
            pushing = part.take(search.find_pressing_tips(part.places))
            if len(pushing):
                yield search, search.find_closing_pairs(edge, lying, locators, pushing)


def bound_reach(rows: Array, upward: bool) -> tuple[float, float]:
    """Return (the least, the largest) coordinate in mm of the features: v if ``upward``, else u.

    ``rows`` (F, 12) are the kernel rows; an arc counts as its whole circle.
    """
    place = rows[:, 2 if upward else 1]
    extent = np.where(
        rows[:, IS_ARC] != 0.0, rows[:, 6], rows[:, 5] * np.abs(rows[:, AXIS_Y if upward else AXIS_X])
    )
    return float((place - extent).min()), float((place + extent).max())
