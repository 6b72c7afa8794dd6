"""The search beside a wall, in shares: one hull edge of the part after the other lies on the wall."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

import numpy as np
from attrs import define

from workhold.contact.problem import Problem, Progress
from workhold.listing.clamp_contacts import contacts_on_wall
from workhold.listing.clamped_seats import ClampedSeats
from workhold.listing.listed import Work
from workhold.listing.seats import Seats, seats_of
from workhold.listing.wall_fixtures import WallCollector, WallFixtures
from workhold.model.notes import no_fixture_notes, no_pair_note, no_place_note
from workhold.model.proof import AT_AN_EDGE, Undecided
from workhold.model.query import Query
from workhold.proof.deciding import Account
from workhold.proof.flush import Candidate
from workhold.search.shares import one_clamp
from workhold.search.wall_search import WallSearch, fixtures_on, searches_of

__all__ = ["WallShares"]


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
        ways, pairing = query.toolkit.ways, query.toolkit.needs_pairs
        searches = searches_of(one_clamp(query, ways[0]) if pairing else query, ways, pairing)
        problems = [search.problem for search in searches]
        collector = ClampedSeats(query, problems[0]) if pairing else WallCollector(query, problems)
        return cls(searches, collector, searches[0].edges, cancel)

    @property
    def shares(self) -> int:
        """How many hull edges there are."""
        return len(self.edges)

    def look(self, share: int, progress: Progress | None) -> tuple[list[WallFixtures | None] | Seats | None, bool]:
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
            return [joined.get(search) for search in self.searches], is_whole
        contacts = [contacts_on_wall(part, search.problem, direction_of(search)) for search, part in joined.items()]
        return seats_of(contacts, self.searches[0].problem) if contacts else None, is_whole

    def account(self) -> Account:
        """What became of all pairs of contacts so far."""
        undecided = tuple(entry(one, search.problem) for search in self.searches for one in search.undecided)
        return Account(self.total("examined"), self.total("verified"), self.total("escalated"), 0, undecided)

    def total(self, name: str) -> int:
        """A number of all directions together."""
        return sum(getattr(search, name) for search in self.searches)

    def work(self, done: int, complete: bool) -> Work:
        """How the search went; with one clamp each direction counts as a search of its own."""
        times = 1 if self.collector.query.toolkit.needs_pairs else len(self.searches)
        statistics = {
            "features": times * len(self.searches[0].problem.rows),
            "hull_edges": times * done,
            "locator_places": times * self.searches[0].locators,
            "contacts_examined": self.total("examined"),
        }
        return Work(complete, statistics, cells=times * done)

    def why_none(self) -> str:
        """Why a search that came to its end has no fixture."""
        search, verified, wording = self.searches[0], self.total("verified"), self.collector.query.toolkit.wording
        never, no_locator, square, loose = no_fixture_notes(wording)
        if isinstance(self.collector, WallCollector) and verified:
            return no_place_note(verified, wording)
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
