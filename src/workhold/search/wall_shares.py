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
from workhold.conventions import GAP_SLACK, LEAST_SPAN
from workhold.fixels.toolkit import Carrier
from workhold.listing.clamp_contacts import contacts_on_wall
from workhold.listing.clamp_placement import last_holes
from workhold.listing.results import RankedTable, Work
from workhold.listing.seats import ClampedSeats, Seats, seats_of
from workhold.listing.wall_fixtures import WallFixtures, first_of_each, turned
from workhold.model.fixture_table import FixtureTable, unknown_quality
from workhold.model.query import Query
from workhold.model.search_report import AT_AN_EDGE, Undecided, no_fixture_notes, no_pair_note, no_place_note
from workhold.proof.deciding import Account
from workhold.search.broken_rules import line_in_the_way
from workhold.search.flush_search import FlushSearch
from workhold.search.lattice_pairs import LatticePairs, are_pressed, closure_of, pairs_on
from workhold.search.shares import has_body_to_pass, one_clamp
from workhold.search.wall_search import fixtures_on, searches_of

__all__ = ["LatticePairSearch", "WallShares"]

Array = NDArray[np.float64]


@define(eq=False)
class LatticePairSearch(FlushSearch):
    """The pairs of pegs of a sliding lattice that press a part against a wall."""

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
        for pairs in pairs_on(lying, self.lattice.pitch, last_holes(self.lattice), problem.contact_margin):
            good, open_, sharpened = are_pressed(pairs, edge, lying, problem)
            self.examined += len(pairs)
            self.verified += len(good)
            self.escalated += sharpened
            self.undecided += [self.entry(pairs, k, edge) for k in open_.tolist()]
            if self.explains:
                self.look_at(closure_of(pairs, lying, problem)[0], edge)
            yield good

    def look_at(self, pairs: LatticePairs, edge: int) -> None:
        """Keeps the nearest of pairs on a hull edge, given with their forces."""
        # Forces are given per unit of the lattice's, which there has to be.
        is_none = np.abs(pairs.null[:, :2].sum(axis=1)) < LEAST_SPAN
        first = np.zeros(1, np.int64)
        self.look_nearer(pairs.null, is_none, lambda chosen: self.table(pairs.take(chosen), edge, first))

    def placed(self, parts: list[LatticePairs], edge: int) -> FixtureTable:
        """Pairs as the lattice holds them, each once.

        Its lowest peg is in row 0, or farther back where it opens no wider.
        """
        pairs = listed_once(LatticePairs.joined(parts))
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
        searches = searches_of(one_clamp(query, toolkit.ways[0]) if pairing else query, toolkit.ways, pairing)
        collector = (ClampedSeats if pairing else RankedTable)(query, searches[0].problem)
        return cls(searches, partial(fixtures_on, searches), collector, cancel)

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
                contacts_on_wall(WallFixtures.joined(parts), search.problem)
                for search, parts in found.items()
                if parts
            ]
            return [seats_of(contacts, self.searches[0].problem)] if contacts else [], is_whole
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

    def why_none(self) -> str:
        """Why a search that came to its end has no fixture."""
        query, search, verified = self.collector.query, self.searches[0], self.total("verified")
        never, apart, square, loose = no_fixture_notes(query.toolkit.wording, line_in_the_way(query))
        if isinstance(self.collector, RankedTable) and verified:
            return no_place_note(verified, query.toolkit.wording, has_body_to_pass(query))
        if not self.edges:
            return never
        if not search.touches:
            return apart
        if isinstance(self.collector, ClampedSeats):
            return no_pair_note(self.collector.looked_at, verified)
        return square if search.is_square else loose
