"""Every fixture of a workpiece on a fence, or the best of them."""

from __future__ import annotations

from threading import Event

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.geometry.symmetry import rotations_onto_itself
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
    kept = {search: Kept(search.problem) for search in searches}
    edges, done = searches[0].edges, 0
    for edge in edges:
        if cancel is not None and cancel.is_set():
            break
        for search, part in pressed_by(searches, edge):
            kept[search].waiting.append(part)
            if cancel is not None and cancel.is_set():
                break
        else:
            done += 1
        for one in kept.values():
            one.list_many()
        if progress is not None:
            progress(done / len(edges), sum(one.count for one in kept.values()))
    results = [result_of(search, kept[search], done, len(edges)) for search in searches]
    return results[0] if len(results) == 1 else joined_ways(results, query)


def result_of(search: FenceSearch, kept: Kept, done: int, edges: int) -> Result:
    """The result of one direction of the clamp, once so many of the hull edges are done."""
    kept.list_waiting()
    query, found = search.problem.query, kept.sets.found
    undecided = tuple(entry(candidate, search.problem) for candidate in search.undecided)
    account = Account(search.examined, search.verified, search.escalated, 0, undecided)
    statistics = {
        "features": len(search.problem.rows),
        "hull_edges": done,
        "locator_places": search.locators,
        "contacts_examined": search.examined,
    }
    work = Work(done == edges, statistics, cells=done)
    name = query.toolkit.arrangements[0].name
    return Result(
        query=query,
        table=kept.table,
        found={name: found},
        distinct={name: kept.sets.count},
        complete=work.complete,
        notes=tuple(notes_of(search, found, edges)) if work.complete else (),
        statistics=statistics,
        proof=proof_of(account, work),
    )


@define(eq=False)
class Kept:
    """The fixtures of one direction of the clamp, no more of them than are asked for.

    Parameters
    ----------
    problem : what is searched.
    sets : the fixtures listed so far, as sets of those that a rotation of the part carries into each other.
    table : the fixtures listed so far, best first.
    waiting : pairs that are not listed yet, those of one hull edge after those of the other.
    """

    problem: Problem
    sets: Sets = field(init=False)
    table: FixtureTable = field(factory=FixtureTable.empty, init=False)
    waiting: list[Pressed] = field(factory=list, init=False)

    def __attrs_post_init__(self) -> None:
        self.sets = Sets(self.problem)

    @property
    def count(self) -> int:
        """How many there are, with those that wait."""
        return self.sets.found + sum(map(len, self.waiting))

    def list_many(self) -> None:
        """List what waits once it is much, and all of a hull edge."""
        if sum(map(len, self.waiting)) > WAITING:
            self.list_waiting()

    def list_waiting(self) -> None:
        """List what waits."""
        if not self.waiting:
            return
        fresh, pressed = listed_on_fence(Pressed.joined(self.waiting), self.problem)
        self.waiting = []
        self.sets.add(pressed)
        query, table = self.problem.query, FixtureTable.joined([self.table, measured(fresh, self.problem)])
        order = listing_order(table)
        order = order[rank(table.quality[order], query.ranking, query.tolerance)]
        self.table = table.take(order[: query.best])


class Sets:
    """How many sets fixtures form when those count once that a rotation of the part carries into each other."""

    def __init__(self, problem: Problem) -> None:
        part = problem.workpiece
        self.problem, self.found = problem, 0
        self.rotations = rotations_onto_itself([face.segment for face in part.faces])
        self.keys: list[NDArray[np.int64]] = []
        self.places: list[NDArray[np.float64]] = []
        if len(self.rotations) > 1:
            self.images = [images_of(part.flush, rotation.angle) for rotation in self.rotations]

    def add(self, pressed: Pressed) -> None:
        """Take the fixtures of some hull edges."""
        self.found += len(pressed)
        if len(self.rotations) == 1:
            return
        numbers = np.array([face.number for face in self.problem.workpiece.faces])
        index = np.searchsorted(numbers, self.problem.faces[pressed.feature])
        images = np.array([image[pressed.edge] for image in self.images])
        # No rotation but the identity leaves a hull edge where it is, so one alone makes it the first of its images.
        turn = images.argmin(axis=0)
        faces = np.array([rotation.image for rotation in self.rotations])[turn[:, None], index]
        self.keys.append(np.column_stack([images.min(axis=0), pressed.row, pressed.line, faces]))
        self.places.append(np.column_stack([pressed.locator[:, 0], pressed.tip]))

    @property
    def count(self) -> int:
        """How many sets there are."""
        if len(self.rotations) == 1 or not self.keys:
            return self.found
        keys = np.column_stack([np.concatenate(self.keys), np.round(np.concatenate(self.places), 4)])
        order = np.lexsort(keys.T[::-1])
        return int((np.abs(np.diff(keys[order], axis=0)) > 2e-4).any(axis=1).sum()) + 1


def images_of(flush: Flush, angle: float) -> NDArray[np.int64]:
    """The hull edge (E,) that each is carried to when the part turns onto itself by an angle in radians."""
    return flush.number(flush.theta - angle)


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
