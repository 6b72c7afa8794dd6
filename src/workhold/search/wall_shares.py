"""The search beside a wall, in shares: one hull edge of the part after the other lies on the wall.

A locator and a clamp press the part there (``search.wall_search``), or two pegs of a lattice that slides
toward the wall (``search.lattice_pairs``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import repeat
from threading import Event
from typing import Any

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.conventions import GAP_SLACK, LEAST_SPAN, SAME_PLACE
from workhold.fixels.toolkit import Carrier, Toolkit
from workhold.listing.clamp_contacts import make_contacts_on_wall
from workhold.listing.clamp_placement import find_last_holes
from workhold.listing.results import RankedTable, SearchWork
from workhold.listing.seats import ClampedSeats, Seats, make_seats
from workhold.listing.wall_fixtures import WallFixtures, find_lowest_of_each, turn_points
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.notes import NoFixture, NoPair, NoPlace, Note
from workhold.model.query import Query
from workhold.model.search_report import AT_AN_EDGE, UndecidedCandidate
from workhold.model.wall_ends import find_common_stretch, find_wall_ends, list_hull_touches
from workhold.proof.deciding import SearchReport
from workhold.search.broken_rules import find_program_line_in_the_way
from workhold.search.flush_search import FlushSearch
from workhold.search.lattice_pairs import (
    LatticePairs,
    compute_pair_closure,
    find_pairs_on_edge,
    select_pressed_pairs,
)
from workhold.search.shares import has_body_to_pass, make_one_clamp_query
from workhold.search.wall_search import find_fixtures_on_edge, make_searches

__all__ = ["LatticePairSearch", "WallShares"]

Array = NDArray[np.float64]

# Pairs, columns of the first peg and what touches the wall that are looked at together.
TOGETHER = 1 << 20


@define(eq=False)
class LatticePairSearch(FlushSearch):
    """The search for pairs of pegs of a sliding lattice that press a part against a wall."""

    @property
    def pair_toolkit(self) -> Toolkit:
        """The toolkit, with a wall that has no ends."""
        toolkit = self.problem.toolkit
        return toolkit.without_limits([limit for limit in toolkit.limits if limit.bounds == "reach"])

    @property
    def can_touch(self) -> bool:
        """Whether two pegs can touch the part.

        Also True if all faces met so far are square or parallel to the wall, since then only closure is
        missing.
        """
        return self.is_square or self.examined > 0

    @property
    def lattice(self) -> Carrier:
        """The sliding lattice."""
        return self.problem.toolkit.moving

    def iterate_fixtures(self, edge: int) -> Iterator[LatticePairs]:
        """Yield, in batches, the pairs of pegs that press the part as it lies on a hull edge."""
        problem, lying = self.problem, self.lay_on_edge(edge)
        for pairs in find_pairs_on_edge(
            lying, self.lattice.pitch, find_last_holes(self.lattice), problem.contact_margin
        ):
            good, open_, sharpened = select_pressed_pairs(pairs, edge, lying, problem)
            self.examined += len(pairs)
            self.verified += len(good)
            self.escalated += sharpened
            self.undecided += [self.make_undecided(pairs, k, edge) for k in open_.tolist()]
            if self.explains:
                self.keep_nearest_of(compute_pair_closure(pairs, lying, problem)[0], edge)
            yield good

    def keep_nearest_of(self, pairs: LatticePairs, edge: int) -> None:
        """Keep the pair on hull edge ``edge`` that comes nearest to pressing the part, if it is nearer than
        the one kept so far.

        The pairs must have their forces. See :meth:`FlushSearch.keep_nearest`.
        """
        # Forces are given per unit of the lattice's, which there has to be.
        is_none = np.abs(pairs.null[:, :2].sum(axis=1)) < LEAST_SPAN
        first = np.zeros(1, np.int64)
        self.keep_nearest(
            pairs.null, is_none, lambda chosen: self.make_table(pairs.take(chosen), edge, first, first)
        )

    def place_fixtures(self, parts: list[LatticePairs], edge: int) -> FixtureTable:
        """Return the table of the pairs that the lattice can hold within its travel and rows, each once.

        The lower peg of a pair is in row 0, or in a later row where the lattice cannot open so wide.
        ``parts`` are batches of pairs on hull edge ``edge``.
        """
        pairs = list_pairs_once(LatticePairs.concatenate(parts))
        travel, rows = self.lattice.travel, find_last_holes(self.lattice)[1]
        assert travel is not None
        pitch = self.lattice.pitch[1]
        separation = pairs.point[:, :, 1].min(axis=1)
        back = np.zeros(len(pairs), np.int64)
        if travel.most is not None:
            back = np.maximum(np.ceil((separation - travel.most - GAP_SLACK) / pitch), 0.0).astype(np.int64)
        fits = (separation - back * pitch >= travel.least - GAP_SLACK) & (
            np.abs(pairs.step[:, 1]) + back <= rows
        )
        pairs, back, first = pairs.take(fits), back[fits], np.zeros(int(fits.sum()), np.int64)
        wall = self.problem.toolkit.wall_with_ends
        if wall is not None and wall.reach is not None:
            first, pairs = self.choose_jaw_columns(pairs, edge, wall.reach)
            holds = first >= 0
            pairs, back, first = pairs.take(holds), back[holds], first[holds]
        return self.make_table(pairs, edge, back, first)

    def choose_jaw_columns(
        self, pairs: LatticePairs, edge: int, reach: tuple[float, float]
    ) -> tuple[NDArray[np.int64], LatticePairs]:
        """Return (the column of each pair's first peg at which a wall with ends holds the part best (N,), the
        pairs).

        The column is -1 if none holds the part: the wall's force must act inside the common stretch of wall
        and part. The best column has the longest common stretch; among equal ones, that with the stretch
        nearest to the wall's middle. The returned pairs have the forces at the ends of that stretch.
        ``reach`` is (begin, end) of the wall in mm.
        """
        flush, pitch = self.problem.workpiece.flush, self.lattice.pitch[0]
        columns, first = self.lattice.column_count, np.full(len(pairs), -1, np.int64)
        null, touches = pairs.null.copy(), list_hull_touches(self.problem.workpiece, edge)
        both, middle = null[:, :2].sum(axis=1), (reach[0] + reach[1]) / 2.0
        acts = flush.length[edge] * null[:, 1] / both
        together = max(TOGETHER // (columns * len(touches)), 1)
        for begin in range(0, len(pairs), together):
            some = slice(begin, begin + together)
            # How far x is from u, for each column of the first peg.
            shift = np.arange(columns) * pitch - pairs.point[some, 0, 0, None]
            low, high = ((end - shift).ravel() for end in reach)
            common = find_common_stretch(touches, low, high)
            start, end = (values.reshape(shift.shape) for values in (common.start, common.end))
            inside = np.minimum(acts[some, None] - start, end - acts[some, None]) > SAME_PLACE
            inside &= np.arange(columns) + pairs.step[some, :1] < columns
            length = np.where(inside, end - start, -np.inf)
            longest = inside & (length >= length.max(axis=1, keepdims=True) - SAME_PLACE)
            with np.errstate(invalid="ignore"):
                off = np.where(longest, np.abs((start + end) / 2.0 + shift - middle), np.inf)
            chosen = (off <= off.min(axis=1, keepdims=True) + SAME_PLACE).argmax(axis=1)
            rows = np.arange(len(chosen))
            held = inside[rows, chosen]
            first[some] = np.where(held, chosen, -1)
            start, end = start[rows, chosen], end[rows, chosen]
            with np.errstate(divide="ignore", invalid="ignore"):
                share = np.where(held, (acts[some] - start) / (end - start), 0.5)
            null[some, :2] = both[some, None] * np.stack([1.0 - share, share], axis=1)
        return first, evolve(pairs, null=null)

    def make_table(
        self, pairs: LatticePairs, edge: int, back: NDArray[np.int64], first: NDArray[np.int64]
    ) -> FixtureTable:
        """Return the table of N pairs on hull edge ``edge``.

        Lower pegs stand in rows ``back`` (N,), first pegs in columns ``first`` (N,). Of the figures of
        quality only the closure margin is known, the others are NaN.
        """
        flush, problem, count = self.problem.workpiece.flush, self.problem, len(pairs)
        column, row = np.zeros((count, 4), np.int32), np.zeros((count, 4), np.int32)
        column[:, 2], column[:, 3] = first, first + pairs.step[:, 0]
        row[:, 2], row[:, 3] = np.maximum(-pairs.step[:, 1], 0) + back, np.maximum(pairs.step[:, 1], 0) + back
        theta = np.full(count, flush.theta[edge])
        start = turn_points(np.tile(flush.ends[edge, 0], (count, 1)), theta)
        across, level = self.lattice.compute_hole_center(first, 0)
        share = pairs.null / pairs.null.sum(axis=1, keepdims=True)
        position = np.stack([across - pairs.point[:, 0, 0], np.zeros(count)], axis=1) - start
        wall = find_wall_ends(problem.workpiece, problem.toolkit, theta, position).face
        return FixtureTable(
            arrangement=np.zeros(count, np.int8),
            column=column,
            row=row,
            face=np.concatenate([wall, problem.faces[pairs.feature]], axis=1).astype(np.int32),
            theta=theta,
            position=position,
            jaw_separation=pairs.point[:, 0, 1] - row[:, 2] * self.lattice.pitch[1] - level,
            force=share / share[:, :2].sum(axis=1, keepdims=True),
            quality=make_unknown_quality(share.min(axis=1, initial=1.0)),
        )

    def make_undecided(self, pairs: LatticePairs, number: int, edge: int) -> UndecidedCandidate:
        """Return the entry of the search report for pair number ``number``, which is undecided."""
        flush, step = self.problem.workpiece.flush, pairs.step[number].tolist()
        one, other = self.problem.faces[pairs.feature[number]].tolist()
        title, rows = self.problem.toolkit.arrangements[0].title, (0, 0, max(-step[1], 0), max(step[1], 0))
        faces, columns = (*flush.face[edge].tolist(), one, other), (0, 0, 0, step[0])
        return UndecidedCandidate(
            title, faces, columns, rows, float(np.degrees(flush.theta[edge])), AT_AN_EDGE, 0.0
        )


def list_pairs_once(pairs: LatticePairs) -> LatticePairs:
    """Return the pairs, each once.

    Contacts at a tangent joint are found on both features that meet there; one of them is kept.
    """
    place = pairs.point.reshape(-1, 4) @ np.array([1.0, 0.7548776662, 0.5698402910, 0.4301597090])
    return pairs.take(find_lowest_of_each((*pairs.step.T,), place, pairs.feature))


@define(eq=False)
class WallShares:
    """The search beside a wall by hull edges, a ``search.shares.ShareSearch``.

    Parameters
    ----------
    searches : one search for each direction of the clamp, or the single search of a sliding lattice.
    fixtures : called with the index of a hull edge; yields (search, batch of pairs that press the part).
    collector : takes the fixtures, or with two clamps the seats.
    cancel : when set, no further pairs of contacts are examined.
    edges : indices of the hull edges on which the part may lie.
    """

    searches: Sequence[FlushSearch]
    fixtures: Callable[[int], Iterator[tuple[FlushSearch, Any]]]
    collector: RankedTable | ClampedSeats
    cancel: Event | None
    edges: Sequence[int] = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.edges = self.searches[0].edges

    @classmethod
    def from_query(cls, query: Query, cancel: Event | None) -> WallShares:
        """Return the shares of a query whose toolkit has a sliding lattice, one clamp, or two clamps."""
        toolkit, pairing = query.toolkit, query.toolkit.travel_count > 1
        if toolkit.moving.on is None:
            search = LatticePairSearch(Problem.from_query(query))
            ranked = RankedTable(query, search.problem)
            return cls(
                [search], lambda edge: zip(repeat(search), search.iterate_fixtures(edge)), ranked, cancel
            )
        searches = make_searches(
            make_one_clamp_query(query, toolkit.ways[0]) if pairing else query, toolkit.ways, pairing
        )
        collector = (ClampedSeats if pairing else RankedTable)(query, searches[0].problem)
        return cls(searches, partial(find_fixtures_on_edge, searches), collector, cancel)

    @property
    def share_count(self) -> int:
        """Number of hull edges."""
        return len(self.edges)

    def search_share(self, share: int, progress: Progress | None) -> tuple[list[FixtureTable | Seats], bool]:
        """Search one hull edge; return (findings, whether the search came to its end).

        With one closing movement the findings are a table of fixtures for each search that found any. With
        two clamps they are the seats.
        """
        edge, is_whole = self.edges[share], True
        found: dict[FlushSearch, list[Any]] = {search: [] for search in self.searches}
        for search, part in self.fixtures(edge):
            found[search].append(part)
            if self.cancel is not None and self.cancel.is_set():
                is_whole = False
                break
        if isinstance(self.collector, ClampedSeats):
            contacts = [
                make_contacts_on_wall(WallFixtures.concatenate(parts), search.problem)
                for search, parts in found.items()
                if parts
            ]
            return [make_seats(contacts, self.searches[0].problem)] if contacts else [], is_whole
        tables: list[FixtureTable | Seats] = []
        for number, (search, parts) in enumerate(found.items()):
            if parts:
                table = search.place_fixtures(parts, edge)
                tables.append(evolve(table, arrangement=table.arrangement + np.int8(number)))
        return tables, is_whole

    def make_account(self) -> SearchReport:
        """Return the report on all pairs of contacts so far."""
        undecided = tuple(one for search in self.searches for one in search.undecided)
        return SearchReport(
            self.sum_statistic("examined"),
            self.sum_statistic("verified"),
            self.sum_statistic("escalated"),
            0,
            undecided,
        )

    def sum_statistic(self, name: str) -> int:
        """Return a count summed over all searches; ``name`` is the attribute that holds the count."""
        return sum(getattr(search, name) for search in self.searches)

    def describe_work(self, done: int, complete: bool) -> SearchWork:
        """Return the statistics of the search after ``done`` hull edges.

        Counts that all directions of the clamp share are multiplied by the number of directions, except with
        two clamps.
        """
        times = 1 if self.searches[0].problem.pairing else len(self.searches)
        statistics = {
            "features": times * len(self.searches[0].problem.rows),
            "hull_edges": times * done,
            "locator_places": times * self.searches[0].locators,
            "contacts_examined": self.sum_statistic("examined"),
        }
        return SearchWork(complete, statistics, cells=times * done)

    def explain_no_fixture(self) -> Note:
        """Return the note that says why a search that came to its end has no fixture."""
        query, search, verified = self.collector.query, self.searches[0], self.sum_statistic("verified")
        wording, line = query.toolkit.wording, find_program_line_in_the_way(query)
        if isinstance(self.collector, RankedTable) and verified:
            return NoPlace(verified, wording, has_body_to_pass(query))
        if not self.edges:
            return NoFixture("shape", wording, line)
        if not search.can_touch:
            return NoFixture("pair", wording, line)
        if isinstance(self.collector, ClampedSeats):
            return NoPair(self.collector.looked_at, verified)
        return NoFixture("set" if search.is_square else "hold", wording, line)
