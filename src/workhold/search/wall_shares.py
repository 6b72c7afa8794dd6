"""The search beside a wall, in shares: one hull edge of the part after the other lies on the wall.

What presses the part there is a locator and a clamp (``search.wall_search``), or two pegs of a lattice that
slides toward the wall (``search.lattice_pairs``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf
from threading import Event

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.conventions import GAP_SLACK, LEAST_SPAN
from workhold.fixels.toolkit import Carrier
from workhold.listing.clamp_contacts import contacts_on_wall
from workhold.listing.clamp_placement import last_holes
from workhold.listing.results import RankedTable, Work
from workhold.listing.seats import ClampedSeats, Seats, seats_of
from workhold.listing.wall_fixtures import WallCollector, WallFixtures, first_of_each, turned
from workhold.model.fixture_table import FixtureTable, unknown_quality
from workhold.model.query import Query
from workhold.model.search_report import AT_AN_EDGE, Undecided, no_fixture_notes, no_pair_note, no_place_note
from workhold.proof.deciding import Account
from workhold.proof.flush import Candidate
from workhold.search.in_the_way import has_body_to_pass
from workhold.search.lattice_pairs import LatticePairs, are_pressed, closure_of, pairs_on
from workhold.search.shares import one_clamp
from workhold.search.wall_search import (
    WallSearch,
    allowed_edges,
    faces_are_square,
    fixtures_on,
    lying_on,
    searches_of,
)

__all__ = ["LatticePairSearch", "LatticePairShares", "WallShares"]


@define(eq=False)
class WallShares:
    """Hull edges on the wall, see ``search.shares.Locating``.

    Parameters
    ----------
    searches : of each direction of the clamp.
    collector : takes the fixtures of each direction, or the seats that they make with two clamps.
    edges : numbers of the hull edges.
    cancel : when set, no further pairs of contacts are looked at.
    """

    searches: Sequence[WallSearch]
    collector: WallCollector | ClampedSeats
    edges: Sequence[int]
    cancel: Event | None

    @classmethod
    def of(cls, query: Query, cancel: Event | None) -> WallShares:
        """The shares of a query, with one clamp or two."""
        ways, pairing = query.toolkit.ways, query.toolkit.travels > 1
        searches = searches_of(one_clamp(query, ways[0]) if pairing else query, ways, pairing)
        problems = [search.problem for search in searches]
        collector = ClampedSeats(query, problems[0]) if pairing else WallCollector(query, problems)
        return cls(searches, collector, searches[0].edges, cancel)

    @property
    def shares(self) -> int:
        """How many hull edges there are."""
        return len(self.edges)

    def look(
        self, share: int, progress: Progress | None
    ) -> tuple[list[list[WallFixtures | None] | Seats], bool]:
        """The fixtures of each direction, or the seats, on a hull edge."""
        found: dict[WallSearch, list[WallFixtures]] = {search: [] for search in self.searches}
        is_whole = True
        for search, part in fixtures_on(self.searches, self.edges[share]):
            found[search].append(part)
            if self.cancel is not None and self.cancel.is_set():
                is_whole = False
                break
        joined = {search: WallFixtures.joined(parts) for search, parts in found.items() if parts}
        if isinstance(self.collector, WallCollector):
            return [[joined.get(search) for search in self.searches]], is_whole
        contacts = [
            contacts_on_wall(part, search.problem, direction_of(search)) for search, part in joined.items()
        ]
        return [seats_of(contacts, self.searches[0].problem)] if contacts else [], is_whole

    def account(self) -> Account:
        """What became of all pairs of contacts so far."""
        undecided = tuple(entry(one, search.problem) for search in self.searches for one in search.undecided)
        return Account(self.total("examined"), self.total("verified"), self.total("escalated"), 0, undecided)

    def total(self, name: str) -> int:
        """A number of all directions together."""
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

    def why_none(self) -> str:
        """Why a search that came to its end has no fixture."""
        search, verified, wording = (
            self.searches[0],
            self.total("verified"),
            self.collector.query.toolkit.wording,
        )
        never, no_locator, square, loose = no_fixture_notes(wording)
        if isinstance(self.collector, WallCollector) and verified:
            return no_place_note(verified, wording, has_body_to_pass(self.collector.query))
        if not self.edges:
            return never
        if search.locators == 0:
            return no_locator
        if isinstance(self.collector, ClampedSeats):
            return no_pair_note(self.collector.looked_at, verified)
        return square if search.is_square else loose


def direction_of(search: WallSearch) -> str:
    """The direction of a search's clamp."""
    return search.problem.toolkit.arrangements[0].direction or ""


def entry(candidate: Candidate, problem: Problem) -> Undecided:
    """A candidate that is not decided, for the account."""
    flush, faces = problem.workpiece.flush, problem.faces[list(candidate.features)].tolist()
    one, other = flush.face[candidate.edge].tolist()
    line = (candidate.line, 0) if candidate.is_upright else (0, candidate.line)
    return Undecided(
        problem.toolkit.arrangements[0].title,
        (faces[0], one, other, faces[1]),
        (0, 0, 0, line[0]),
        (candidate.row, 0, 0, line[1]),
        float(np.degrees(flush.theta[candidate.edge])),
        AT_AN_EDGE,
        0.0,
    )


Array = NDArray[np.float64]


@define(eq=False)
class LatticePairSearch:
    """The pairs of pegs of a sliding lattice that press a part against a wall.

    Parameters
    ----------
    problem : what is searched.
    explains : whether it is to say what comes nearest.
    examined, verified, escalated : how many pairs touch the part, how many are proven to press it, and how
        many needed balls.
    undecided : pairs that not even these decide, for the account.
    nearest : the largest share that the least contact of a pair has in its forces, and that pair with its
        hull edge. It is known where it is asked for and none is proven.
    """

    problem: Problem
    explains: bool = False
    examined: int = field(default=0, init=False)
    verified: int = field(default=0, init=False)
    escalated: int = field(default=0, init=False)
    undecided: list[Undecided] = field(factory=list, init=False)
    nearest: tuple[float, FixtureTable] | None = field(default=None, init=False)

    @property
    def edges(self) -> list[int]:
        """The numbers of the hull edges on which the part may lie."""
        return allowed_edges(self.problem)

    @property
    def lattice(self) -> Carrier:
        """The lattice that slides."""
        return self.problem.toolkit.moving

    def fixtures(self, edge: int) -> Iterator[LatticePairs]:
        """The pairs that press the part as it lies on a hull edge, some at a time."""
        problem, lying = self.problem, lying_on(self.problem, edge)
        for pairs in pairs_on(lying, self.lattice.pitch, last_holes(self.lattice), problem.contact_margin):
            good, open_, sharpened = are_pressed(pairs, edge, lying, problem)
            self.examined += len(pairs)
            self.verified += len(good)
            self.escalated += sharpened
            self.undecided += [self.entry(pairs, k, edge) for k in open_.tolist()]
            if self.explains and self.verified == 0 and len(pairs):
                self.look_nearer(closure_of(pairs, lying, problem)[0], edge)
            yield good

    def tables(self, edge: int) -> Iterator[FixtureTable]:
        """Tables of the pairs that have a place, some at a time."""
        return (self.placed(pairs, edge) for pairs in self.fixtures(edge))

    def nearest_alone(self) -> tuple[FixtureTable, Problem]:
        """The pair that comes nearest, as a table, and its search."""
        assert self.nearest is not None
        return self.nearest[1], self.problem

    def look_nearer(self, pairs: LatticePairs, edge: int) -> None:
        """Keeps the pair that is nearest to pressing the part."""
        null = pairs.null
        size = np.abs(null).sum(axis=1)
        share = np.where(size > LEAST_SPAN, null.min(axis=1) / np.maximum(size, LEAST_SPAN), -inf)
        # Forces are given per unit of the lattice's, which there has to be.
        share[np.abs(null[:, :2].sum(axis=1)) < LEAST_SPAN] = -inf
        best = int(share.argmax())
        if share[best] > (-inf if self.nearest is None else self.nearest[0]):
            chosen = pairs.take(np.array([best]))
            self.nearest = float(share[best]), self.table(chosen, edge, np.zeros(1, np.int64))

    def placed(self, pairs: LatticePairs, edge: int) -> FixtureTable:
        """Pairs as the lattice holds them.

        Its lowest peg is in row 0, or farther back where it opens no wider.
        """
        pairs = listed_once(pairs)
        travel, rows = self.lattice.travel, last_holes(self.lattice)[1]
        assert travel is not None
        pitch = self.lattice.pitch[1]
        separation = pairs.point[:, :, 1].min(axis=1)
        back = np.zeros(len(pairs), np.int64)
        if travel.most is not None:
            back = np.maximum(np.ceil((separation - travel.most - GAP_SLACK) / pitch), 0.0).astype(np.int64)
        fits = (separation - back * pitch >= travel.least - GAP_SLACK) & (
            np.abs(pairs.step[:, 1]) + back <= rows
        )
        return self.table(pairs.take(fits), edge, back[fits])

    def table(self, pairs: LatticePairs, edge: int, back: NDArray[np.int64]) -> FixtureTable:
        """The table of pairs on a hull edge, their lowest rows so far (N,) back.

        Only the closure margin is known.
        """
        flush, problem, count = self.problem.workpiece.flush, self.problem, len(pairs)
        column, row = np.zeros((count, 4), np.int32), np.zeros((count, 4), np.int32)
        column[:, 3] = pairs.step[:, 0]
        row[:, 2], row[:, 3] = np.maximum(-pairs.step[:, 1], 0) + back, np.maximum(pairs.step[:, 1], 0) + back
        theta = np.full(count, flush.theta[edge])
        start = turned(np.tile(flush.ends[edge, 0], (count, 1)), theta)
        _, first = self.lattice.place(0, 0)
        share = pairs.null / pairs.null.sum(axis=1, keepdims=True)
        wall = np.tile(flush.face[edge], (count, 1))
        return FixtureTable(
            arrangement=np.zeros(count, np.int8),
            column=column,
            row=row,
            face=np.concatenate([wall, problem.faces[pairs.feature]], axis=1).astype(np.int32),
            theta=theta,
            position=np.stack([-pairs.point[:, 0, 0], np.zeros(count)], axis=1) - start,
            jaw_separation=pairs.point[:, 0, 1] - row[:, 2] * self.lattice.pitch[1] - first,
            force=share / share[:, :2].sum(axis=1, keepdims=True),
            quality=unknown_quality(share.min(axis=1, initial=1.0)),
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
    return pairs.take(first_of_each((*pairs.step.T,), place, pairs.feature))


@define(eq=False)
class LatticePairShares:
    """Hull edges on the wall, see ``search.shares.Locating``.

    Parameters
    ----------
    search : of the query.
    collector : takes the fixtures.
    edges : numbers of the hull edges.
    cancel : when set, no further pairs are looked at.
    """

    search: LatticePairSearch
    collector: RankedTable
    edges: Sequence[int]
    cancel: Event | None

    @classmethod
    def of(cls, query: Query, cancel: Event | None) -> LatticePairShares:
        """The shares of a query."""
        search = LatticePairSearch(Problem.of(query))
        return cls(search, RankedTable(query, search.problem), search.edges, cancel)

    @property
    def shares(self) -> int:
        """How many hull edges there are."""
        return len(self.edges)

    def look(self, share: int, progress: Progress | None) -> tuple[list[FixtureTable], bool]:
        """The fixtures on a hull edge."""
        parts = []
        for pairs in self.search.fixtures(self.edges[share]):
            parts.append(pairs)
            if self.cancel is not None and self.cancel.is_set():
                return self.together(parts, share), False
        return self.together(parts, share), True

    def together(self, parts: list[LatticePairs], share: int) -> list[FixtureTable]:
        """The fixtures of some pairs on a hull edge, where there are any, each once."""
        return [self.search.placed(LatticePairs.joined(parts), self.edges[share])] if parts else []

    def account(self) -> Account:
        """What became of all pairs so far."""
        search = self.search
        return Account(search.examined, search.verified, search.escalated, 0, tuple(search.undecided))

    def work(self, done: int, complete: bool) -> Work:
        """How the search went, when so many hull edges were looked at to their end."""
        search = self.search
        statistics = {
            "features": len(search.problem.rows),
            "hull_edges": done,
            "locator_places": 0,
            "contacts_examined": search.examined,
        }
        return Work(complete, statistics, cells=done)

    def why_none(self) -> str:
        """Why a search that came to its end has no fixture."""
        search, wording = self.search, self.collector.query.toolkit.wording
        never, apart, square, loose = no_fixture_notes(wording)
        if search.verified:
            return no_place_note(search.verified, wording)
        if not self.edges:
            return never
        if all(faces_are_square(lying_on(search.problem, edge)) for edge in self.edges):
            return square
        return loose if search.examined else apart
