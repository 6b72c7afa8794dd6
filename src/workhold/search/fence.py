"""Every fixture of a workpiece on a fence, or the best of them."""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

import numpy as np
from attrs import define, evolve, field

from workhold.contact.problem import Problem, Progress
from workhold.geometry.symmetry import Rotation
from workhold.listing.distinct import one_of_each_set, rotations_of
from workhold.listing.listed import Work, proof_of
from workhold.listing.on_fence import Pressed, listed_on_fence, listing_order
from workhold.listing.ranking import measured, rank
from workhold.listing.ways import joined_ways
from workhold.model.notes import no_fixture_notes, no_place_note, undecided_note
from workhold.model.proof import AT_AN_EDGE, Undecided
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result
from workhold.model.wall import Flush
from workhold.proof.deciding import Account
from workhold.proof.flush import Candidate
from workhold.search.fence_search import FenceSearch, pressed_by, searches_of

__all__ = ["answer_on_fence"]

# Pairs that wait to be listed and measured together.
WAITING = 1 << 14


def answer_on_fence(query: Query, progress: Progress | None, cancel: Event | None) -> Result:
    """The answer on a fence with one clamp, see ``search.design.answer``: one hull edge after the other lies on the wall."""
    searches = searches_of(query, query.toolkit.ways)
    kept = Kept.of(searches, query)
    edges, done = searches[0].edges, 0
    for edge in edges:
        if cancel is not None and cancel.is_set():
            break
        for search, part in pressed_by(searches, edge):
            kept.waiting[search].append(part)
            if cancel is not None and cancel.is_set():
                break
        else:
            done += 1
        if kept.waiting_count > WAITING:
            kept.list_waiting()
        if progress is not None:
            progress(done / len(edges), sum(one.found for one in kept.sets.values()) + kept.waiting_count)
    kept.list_waiting()
    result = joined_ways([result_of(search, kept.sets[search], done, len(edges)) for search in searches], query)
    return evolve(result, table=kept.table)


def result_of(search: FenceSearch, sets: Sets, done: int, edges: int) -> Result:
    """The result of one direction of the clamp without its fixtures, once so many of the hull edges are done."""
    undecided = tuple(entry(candidate, search.problem) for candidate in search.undecided)
    account = Account(search.examined, search.verified, search.escalated, 0, undecided)
    statistics = {
        "features": len(search.problem.rows),
        "hull_edges": done,
        "locator_places": search.locators,
        "contacts_examined": search.examined,
    }
    work = Work(done == edges, statistics, cells=done)
    name = search.problem.toolkit.arrangements[0].name
    return Result(
        query=search.problem.query,
        table=FixtureTable.empty(),
        found={name: sets.found},
        distinct={name: sets.count},
        complete=work.complete,
        notes=tuple(notes_of(search, sets.found, edges)) if work.complete else (),
        statistics=statistics,
        proof=proof_of(account, work),
    )


@define(eq=False)
class Kept:
    """The fixtures of all directions of the clamp, no more of them than are asked for.

    Parameters
    ----------
    problem : that of all directions.
    sets : of each direction those listed so far, as sets of what a rotation of the part carries into each other.
    waiting : of each direction pairs that are not listed yet, those of one hull edge after those of the other.
    table : the fixtures listed so far, best first.
    """

    problem: Problem
    sets: dict[FenceSearch, Sets]
    waiting: dict[FenceSearch, list[Pressed]]
    table: FixtureTable = field(factory=FixtureTable.empty, init=False)

    @classmethod
    def of(cls, searches: Sequence[FenceSearch], query: Query) -> Kept:
        """None yet, of the searches of a query's directions."""
        problem = searches[0].problem
        (plate, clamp), rotations = problem.loci, rotations_of(query.workpiece)
        return cls(
            evolve(problem, query=query, loci=(plate, *(clamp for _ in searches))),
            {search: Sets(query.workpiece.flush, rotations) for search in searches},
            {search: [] for search in searches},
        )

    @property
    def waiting_count(self) -> int:
        """How many pairs wait."""
        return sum(len(part) for parts in self.waiting.values() for part in parts)

    def list_waiting(self) -> None:
        """List and measure what waits, all of a hull edge."""
        tables = [FixtureTable.empty()]
        for number, (search, parts) in enumerate(self.waiting.items()):
            if parts:
                table, pressed = listed_on_fence(Pressed.joined(parts), search.problem)
                tables.append(evolve(table, arrangement=table.arrangement + np.int8(number)))
                self.sets[search].add(pressed)
                parts.clear()
        fresh = measured(FixtureTable.joined(tables), self.problem)
        query, table = self.problem.query, FixtureTable.joined([self.table, fresh])
        order = listing_order(table)
        order = order[rank(table.quality[order], query.ranking, query.tolerance)]
        self.table = table.take(order[: query.best])


class Sets:
    """How many sets fixtures form when those count once that a rotation of the part carries into each other."""

    def __init__(self, flush: Flush, rotations: Sequence[Rotation]) -> None:
        self.found, self.is_symmetric = 0, len(rotations) > 1
        self.image = np.min([flush.number(flush.theta - rotation.angle) for rotation in rotations], axis=0)
        self.keys, self.places = [np.zeros((0, 3), np.int64)], [np.zeros((0, 3))]

    def add(self, pressed: Pressed) -> None:
        """Take the fixtures of some hull edges."""
        self.found += len(pressed)
        if self.is_symmetric:
            self.keys.append(np.column_stack([self.image[pressed.edge], pressed.row, pressed.line]))
            # Places count from the start of the hull edge, so that they are those of every image.
            self.places.append(np.column_stack([pressed.locator[:, 0], pressed.tip]))

    @property
    def count(self) -> int:
        """How many sets there are."""
        if not self.is_symmetric:
            return self.found
        return len(one_of_each_set(list(np.concatenate(self.keys).T), np.concatenate(self.places)))


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


def notes_of(search: FenceSearch, found: int, edges: int) -> list[str]:
    """What is to be said of a search that came to its end: what is undecided, or why there is no fixture."""
    wording = search.problem.toolkit.wording
    never, no_locator, square, loose = no_fixture_notes(wording)
    if search.undecided:
        return [undecided_note(len(search.undecided))]
    if found:
        return []
    if search.verified:
        return [no_place_note(search.verified, wording)]
    if edges == 0:
        return [never]
    return [no_locator if search.locators == 0 else square if search.is_square else loose]
