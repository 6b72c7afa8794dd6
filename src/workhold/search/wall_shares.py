"""The search beside a wall, in shares: one hull edge of the part after the other lies on the wall.

What presses the part there is a locator and a clamp (``search.wall_search``), or two pegs of a lattice that
slides toward the wall (``search.lattice_pairs``).
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
from workhold.listing.results import RankedTable, Work
from workhold.listing.seats import ClampedSeats, Seats, make_seats
from workhold.listing.wall_fixtures import WallFixtures, find_first_of_each, turn_points
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.notes import NoFixture, NoPair, NoPlace, Note
from workhold.model.query import Query
from workhold.model.search_report import AT_AN_EDGE, Undecided
from workhold.model.wall_ends import find_common_stretch, list_hull_touches, wall_ends
from workhold.proof.deciding import Account
from workhold.search.broken_rules import find_program_line_in_the_way
from workhold.search.flush_search import FlushSearch
from workhold.search.lattice_pairs import (
    LatticePairs,
    compute_pair_closure,
    find_pairs_on_edge,
    select_pressed_pairs,
)
from workhold.search.shares import has_body_to_pass, select_one_clamp
from workhold.search.wall_search import find_fixtures_on_edge, searches_of

__all__ = ["LatticePairSearch", "WallShares"]

Array = NDArray[np.float64]

# Pairs, columns of the first peg and what touches the wall that are looked at together.
TOGETHER = 1 << 20


@define(eq=False)
class LatticePairSearch(FlushSearch):
    """The pairs of pegs of a sliding lattice that press a part against a wall."""

    @property
    def alone(self) -> Toolkit:
        """The toolkit with an endless wall."""
        toolkit = self.problem.toolkit
        return toolkit.without([limit for limit in toolkit.limits if limit.bounds == "reach"])

    @property
    def touches(self) -> bool:
        """Whether two pegs can touch the part: where all faces are square, that is not what is missing."""
        return self.is_square or self.examined > 0

    @property
    def lattice(self) -> Carrier:
        """The lattice that slides."""
        return self.problem.toolkit.moving

    def fixtures(self, edge: int) -> Iterator[LatticePairs]:
        """The pairs that press the part as it lies on a hull edge, some at a time."""
        problem, lying = self.problem, self.lying_on(edge)
        for pairs in find_pairs_on_edge(
            lying, self.lattice.pitch, find_last_holes(self.lattice), problem.contact_margin
        ):
            good, open_, sharpened = select_pressed_pairs(pairs, edge, lying, problem)
            self.examined += len(pairs)
            self.verified += len(good)
            self.escalated += sharpened
            self.undecided += [self.entry(pairs, k, edge) for k in open_.tolist()]
            if self.explains:
                self.look_at(compute_pair_closure(pairs, lying, problem)[0], edge)
            yield good

    def look_at(self, pairs: LatticePairs, edge: int) -> None:
        """Keeps the nearest of pairs on a hull edge, given with their forces."""
        # Forces are given per unit of the lattice's, which there has to be.
        is_none = np.abs(pairs.null[:, :2].sum(axis=1)) < LEAST_SPAN
        first = np.zeros(1, np.int64)
        self.look_nearer(
            pairs.null, is_none, lambda chosen: self.table(pairs.take(chosen), edge, first, first)
        )

    def placed(self, parts: list[LatticePairs], edge: int) -> FixtureTable:
        """Pairs as the lattice holds them, each once.

        Its lowest peg is in row 0, or farther back where it opens no wider.
        """
        pairs = listed_once(LatticePairs.concatenate(parts))
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
        wall = self.problem.toolkit.reaching
        if wall is not None and wall.reach is not None:
            first, pairs = self.on_jaw(pairs, edge, wall.reach)
            holds = first >= 0
            pairs, back, first = pairs.take(holds), back[holds], first[holds]
        return self.table(pairs, edge, back, first)

    def on_jaw(
        self, pairs: LatticePairs, edge: int, reach: tuple[float, float]
    ) -> tuple[NDArray[np.int64], LatticePairs]:
        """The column of each pair's first peg in which a jaw with ends holds the part best, -1 where in none.

        With it come the pairs with the forces at the ends of the common stretch. Where the wall's force acts
        does not depend on how far it reaches, so a column holds whose stretch has that place inside.
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

    def table(
        self, pairs: LatticePairs, edge: int, back: NDArray[np.int64], first: NDArray[np.int64]
    ) -> FixtureTable:
        """The table of pairs on a hull edge, their lowest rows so far (N,) back, first pegs in columns (N,).

        Only the closure margin is known.
        """
        flush, problem, count = self.problem.workpiece.flush, self.problem, len(pairs)
        column, row = np.zeros((count, 4), np.int32), np.zeros((count, 4), np.int32)
        column[:, 2], column[:, 3] = first, first + pairs.step[:, 0]
        row[:, 2], row[:, 3] = np.maximum(-pairs.step[:, 1], 0) + back, np.maximum(pairs.step[:, 1], 0) + back
        theta = np.full(count, flush.theta[edge])
        start = turn_points(np.tile(flush.ends[edge, 0], (count, 1)), theta)
        across, level = self.lattice.place(first, 0)
        share = pairs.null / pairs.null.sum(axis=1, keepdims=True)
        position = np.stack([across - pairs.point[:, 0, 0], np.zeros(count)], axis=1) - start
        wall = wall_ends(problem.workpiece, problem.toolkit, theta, position).face
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

    def entry(self, pairs: LatticePairs, number: int, edge: int) -> Undecided:
        """A pair that is not decided, for the account."""
        flush, step = self.problem.workpiece.flush, pairs.step[number].tolist()
        one, other = self.problem.faces[pairs.feature[number]].tolist()
        title, rows = self.problem.toolkit.arrangements[0].title, (0, 0, max(-step[1], 0), max(step[1], 0))
        faces, columns = (*flush.face[edge].tolist(), one, other), (0, 0, 0, step[0])
        return Undecided(title, faces, columns, rows, float(np.degrees(flush.theta[edge])), AT_AN_EDGE, 0.0)


def listed_once(pairs: LatticePairs) -> LatticePairs:
    """One of the pairs that are the same.

    Contacts at a tangent joint are found on both features that meet there.
    """
    place = pairs.point.reshape(-1, 4) @ np.array([1.0, 0.7548776662, 0.5698402910, 0.4301597090])
    return pairs.take(find_first_of_each((*pairs.step.T,), place, pairs.feature))


@define(eq=False)
class WallShares:
    """Hull edges on the wall, see ``search.shares.Locating``.

    Parameters
    ----------
    searches : of a locator with each direction of the clamp, or of the pegs of a lattice.
    fixtures : the pairs that press the part on a hull edge, some at a time, each with its search.
    collector : takes the fixtures, or the seats that they make with two clamps.
    cancel : when set, no further pairs of contacts are looked at.
    edges : numbers of the hull edges.
    """

    searches: Sequence[FlushSearch]
    fixtures: Callable[[int], Iterator[tuple[FlushSearch, Any]]]
    collector: RankedTable | ClampedSeats
    cancel: Event | None
    edges: Sequence[int] = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.edges = self.searches[0].edges

    @classmethod
    def of(cls, query: Query, cancel: Event | None) -> WallShares:
        """The shares of a query, with a sliding lattice, one clamp or two."""
        toolkit, pairing = query.toolkit, query.toolkit.travels > 1
        if toolkit.moving.on is None:
            search = LatticePairSearch(Problem.of(query))
            ranked = RankedTable(query, search.problem)
            return cls([search], lambda edge: zip(repeat(search), search.fixtures(edge)), ranked, cancel)
        searches = searches_of(
            select_one_clamp(query, toolkit.ways[0]) if pairing else query, toolkit.ways, pairing
        )
        collector = (ClampedSeats if pairing else RankedTable)(query, searches[0].problem)
        return cls(searches, partial(find_fixtures_on_edge, searches), collector, cancel)

    @property
    def shares(self) -> int:
        """How many hull edges there are."""
        return len(self.edges)

    def look(self, share: int, progress: Progress | None) -> tuple[list[FixtureTable | Seats], bool]:
        """The fixtures of each search, or the seats, on a hull edge."""
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
                table = search.placed(parts, edge)
                tables.append(evolve(table, arrangement=table.arrangement + np.int8(number)))
        return tables, is_whole

    def account(self) -> Account:
        """What became of all pairs of contacts so far."""
        undecided = tuple(one for search in self.searches for one in search.undecided)
        return Account(self.total("examined"), self.total("verified"), self.total("escalated"), 0, undecided)

    def total(self, name: str) -> int:
        """A number of all searches together."""
        return sum(getattr(search, name) for search in self.searches)

    def work(self, done: int, complete: bool) -> Work:
        """How the search went; with one clamp each direction counts as a search of its own."""
        times = 1 if self.searches[0].problem.pairing else len(self.searches)
        statistics = {
            "features": times * len(self.searches[0].problem.rows),
            "hull_edges": times * done,
            "locator_places": times * self.searches[0].locators,
            "contacts_examined": self.total("examined"),
        }
        return Work(complete, statistics, cells=times * done)

    def why_none(self) -> Note:
        """Why a search that came to its end has no fixture."""
        query, search, verified = self.collector.query, self.searches[0], self.total("verified")
        wording, line = query.toolkit.wording, find_program_line_in_the_way(query)
        if isinstance(self.collector, RankedTable) and verified:
            return NoPlace(verified, wording, has_body_to_pass(query))
        if not self.edges:
            return NoFixture("shape", wording, line)
        if not search.touches:
            return NoFixture("pair", wording, line)
        if isinstance(self.collector, ClampedSeats):
            return NoPair(self.collector.looked_at, verified)
        return NoFixture("set" if search.is_square else "hold", wording, line)
