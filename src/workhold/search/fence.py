"""Every fixture of a workpiece on a fence, or the best of them."""

from __future__ import annotations

from threading import Event

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.geometry.symmetry import rotations_onto_itself
from workhold.listing.listed import Work, proof_of
from workhold.listing.on_fence import Pressed, in_order, listed_on_fence
from workhold.listing.ranking import measured, rank
from workhold.model.notes import no_fixture_notes, no_place_note, undecided_note
from workhold.model.proof import AT_AN_EDGE, Undecided
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result
from workhold.model.wall import Flush
from workhold.proof.deciding import Account
from workhold.proof.flush import Candidate
from workhold.search.fence_search import FenceSearch

__all__ = ["answer_on_fence"]

# Fixtures that wait to be measured together.
WAITING = 1 << 14


def answer_on_fence(query: Query, progress: Progress | None, cancel: Event | None) -> Result:
    """The answer on a fence of which one clamp moves, see ``search.design.answer``."""
    problem = Problem.of(query)
    search = FenceSearch(problem)
    edges, done, found, sets = search.edges, 0, 0, Sets(problem)
    table, waiting = FixtureTable.empty(), [FixtureTable.empty()]
    for edge in edges:
        if cancel is not None and cancel.is_set():
            break
        parts = []
        for part in search.pressed(edge):
            parts.append(part)
            if cancel is not None and cancel.is_set():
                break
        else:
            done += 1
        if parts:
            fresh, pressed = listed_on_fence(Pressed.joined(parts), problem)
            found += len(fresh)
            sets.add(pressed)
            waiting.append(fresh)
        if sum(map(len, waiting)) > WAITING:
            table, waiting = ranked([table, measured(FixtureTable.joined(waiting), problem)], query), waiting[:1]
        if progress is not None:
            progress(done / len(edges), found)
    table = ranked([table, measured(FixtureTable.joined(waiting), problem)], query)
    complete = done == len(edges)
    undecided = tuple(entry(candidate, problem) for candidate in search.undecided)
    account = Account(search.examined, search.verified, search.escalated, 0, undecided)
    statistics = {
        "features": len(problem.rows),
        "hull_edges": done,
        "locator_places": search.locators,
        "contacts_examined": search.examined,
    }
    work = Work(complete, statistics, cells=done)
    name = query.toolkit.arrangements[0].name
    return Result(
        query=query,
        table=table,
        found={name: found},
        distinct={name: sets.count},
        complete=complete,
        notes=tuple(notes_of(search, found, len(edges))) if complete else (),
        statistics=statistics,
        proof=proof_of(account, work),
    )


def ranked(tables: list[FixtureTable], query: Query) -> FixtureTable:
    """Fixtures in the order of their ranks, no more than are asked for."""
    table = in_order(FixtureTable.joined(tables))
    return table.take(rank(table.quality, query.ranking, query.tolerance)[: query.best])


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
