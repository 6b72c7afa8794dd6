"""The paper's own algorithm: generate candidate quartets and pegs, solve their polynomials, test (section 3).

It serves what the paper is about: two carriers alike, of which a half turn makes the other, with two pegs on
each or with three and one. Its left and right pegs, Types I and II are those of the frame of the search.

A system is undecided when its resultant vanishes at every orientation although no known reason applies
(``sliding_pairs``), or when its roots cannot be separated at 1,024 bits. Only fixtures with these pegs on
these faces may then be missing, and a note names them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from threading import Event

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.algebra.candidates import (
    Systems,
    are_parallel,
    list_peg_pairs,
    list_type_one_systems,
    list_type_two_systems,
)
from workhold.algebra.conditions import SimultaneousContacts, find_fourth_pegs, make_records
from workhold.algebra.poses import find_poses_at, locate_peg_centers, orientations
from workhold.algebra.resultants import ContactSystems
from workhold.algebra.sliding_pairs import (
    alike,
    find_level_orientations,
    find_sliding_pairs,
    three_and_one_sliding_pairs,
    two_and_two_sliding_pairs,
)
from workhold.contact.problem import Frame, Problem, Progress
from workhold.conventions import SAME_CENTER
from workhold.errors import InputError
from workhold.kernels.base.feature import SEGMENT_LENGTH
from workhold.listing.results import Work, join_ways, list_result
from workhold.model.notes import MoreSystems, Note, UndecidedSystem
from workhold.model.query import Query
from workhold.model.result import Result

__all__ = ["find_fixtures_by_algebra", "write_undecided_notes"]

# Systems named; the others are counted.
MOST_NAMED = 20


def write_undecided_notes(undecided: Sequence[Systems], faces: NDArray[np.int64]) -> Iterator[Note]:
    """A note for each undecided system; ``faces`` has the number of each feature's face."""
    named = [
        UndecidedSystem(*(tuple(numbers.tolist()) for numbers in (faces[feature], column, row)))
        for systems in undecided
        for feature, column, row in zip(systems.feature, systems.column, systems.row, strict=True)
    ]
    yield from named[:MOST_NAMED]
    if len(named) > MOST_NAMED:
        yield MoreSystems(len(named) - MOST_NAMED)


Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Case = tuple[int, int]

# Systems are solved this many at a time.
BATCH = 4096
# The systems and the sliding pairs of each arrangement of pegs.
GENERATORS: dict[
    tuple[int, ...], tuple[Callable[..., Iterator[Systems]], Callable[..., list[SimultaneousContacts]]]
] = {
    (2, 2): (list_type_one_systems, two_and_two_sliding_pairs),
    (3, 1): (list_type_two_systems, three_and_one_sliding_pairs),
}


@define(eq=False)
class ResultantSolver:
    """Solves systems of one workpiece in one toolkit.

    Parameters
    ----------
    rows : (F, 12) features about the centre of the part, with the slack of their ends.
    frame : the toolkit as the search sees it.
    margin : smallest distance in mm from a contact to the end of its feature.
    diameter : largest distance in mm between two peg centres: lengths are measured in it.
    counts : how many systems, orientations and simultaneous contacts there were.
    undecided : systems that their resultants leave undecided.
    """

    rows: Array
    frame: Frame
    margin: float
    diameter: float
    counts: dict[str, int] = field(
        factory=lambda: dict.fromkeys(("systems", "orientations", "simultaneous_contacts"), 0)
    )
    undecided: list[Systems] = field(factory=list)

    def offsets(self, systems: Systems) -> NDArray[np.complex128]:
        """Pegs from the first peg, right pegs with the separation left out, in mm, (N, K)."""
        right = (np.arange(systems.feature.shape[1]) >= 2) * (systems.feature.shape[1] == 4)
        height = systems.row * self.frame.lattice.pitch_y + right * self.frame.lattice.row_offset
        return np.asarray(systems.column * self.frame.lattice.pitch_x + 1j * height)

    @property
    def scaled(self) -> Array:
        """The features (F, 10) with lengths in parts of the diameter."""
        scaled = np.array(self.rows[:, :SEGMENT_LENGTH])
        scaled[:, 1:3] /= self.diameter
        scaled[:, 6] /= self.diameter
        scaled[scaled[:, 0] == 0.0, 5] /= self.diameter
        return scaled

    def solve(self, systems: Systems, case: Case) -> SimultaneousContacts:
        """Simultaneous contacts of systems of one case (section 4): three or four pegs."""
        contacts = ContactSystems(self.scaled[systems.feature], self.offsets(systems) / self.diameter)
        owner, psi = self.orientations(contacts, case, systems)
        poses = find_poses_at(contacts, case, owner, psi)
        self.counts["systems"] += len(systems)
        self.counts["orientations"] += len(psi)
        chosen = systems.take(poses.owner)
        # Systems of three pegs are those of the standing pegs alone.
        standing = 2 if systems.feature.shape[1] == 4 else 3
        center = locate_peg_centers(contacts, poses) * self.diameter
        return SimultaneousContacts(
            standing, chosen.feature, chosen.column, chosen.row, poses.psi, poses.reach, center
        )

    def orientations(self, contacts: ContactSystems, case: Case, systems: Systems) -> tuple[IntArray, Array]:
        """Indices of systems and their orientations in radians."""
        special = alike(contacts) if contacts.rows.shape[1] == 4 else np.zeros(len(systems), np.bool_)
        plain, other = np.flatnonzero(~special), np.flatnonzero(special)
        owner, psi, undecided = orientations(contacts.take(plain), case, systems.sectors[plain])
        mirrored, level = find_level_orientations(contacts.take(other))
        self.undecided.append(systems.take(plain[undecided]))
        return np.concatenate([plain[owner], other[mirrored]]), np.concatenate([psi, level])

    def fixtures(self, held: SimultaneousContacts) -> Array:
        """Records of the fixtures among simultaneous contacts; three pegs are completed by a fourth first."""
        if held.feature.shape[1] == 3:
            held = find_fourth_pegs(held, self.rows, self.frame, self.margin, self.diameter / 2)
        self.counts["simultaneous_contacts"] += len(held.psi)
        return make_records(held, self.rows, self.frame, self.margin, self.diameter / 2)


def order_arcs_first(systems: Systems, rows: Array) -> Systems:
    """Pegs of each jaw with arcs before lines; the first peg is the characteristic point."""
    line = (rows[systems.feature, 0] == 0.0).astype(np.int64)
    jaw = (np.arange(line.shape[1]) >= 2) * (line.shape[1] == 4)
    order = np.argsort(2 * jaw + line, axis=1, kind="stable")
    feature, column, row = (
        np.take_along_axis(v, order, axis=1) for v in (systems.feature, systems.column, systems.row)
    )
    first = column[:, :1] if line.shape[1] == 3 else np.repeat(column[:, ::2], 2, axis=1)
    return Systems(feature, column - first, row - row[:, :1], systems.sectors)


def three_meet_in_a_point(systems: Systems, rows: Array) -> NDArray[np.bool_]:
    """Which systems have three concentric arcs: their normals meet, and never close."""
    center = rows[systems.feature, 1] + 1j * rows[systems.feature, 2]
    arc = rows[systems.feature, 0] != 0.0
    same = (
        (np.abs(center[:, :, None] - center[:, None, :]) <= SAME_CENTER) & arc[:, :, None] & arc[:, None, :]
    )
    return np.asarray((same.sum(axis=2) >= 3).any(axis=1))


def generic(systems: Systems, rows: Array) -> Systems:
    """The systems that their resultant decides."""
    keep = ~three_meet_in_a_point(systems, rows)
    if systems.feature.shape[1] == 3:
        for k, m in ((0, 1), (0, 2), (1, 2)):
            keep &= ~are_parallel(rows, systems.feature[:, k], systems.feature[:, m])
    return order_arcs_first(systems.take(keep), rows)


def batch_by_case(stream: Iterable[Systems], rows: Array) -> Iterator[tuple[Systems, Case]]:
    """Systems gathered into batches of one case."""
    waiting: dict[Case, list[Systems]] = {}
    for systems in stream:
        chosen = generic(systems, rows)
        arcs = rows[chosen.feature, 0] != 0.0
        left = arcs[:, :2].sum(axis=1) if arcs.shape[1] == 4 else arcs.sum(axis=1)
        right = arcs[:, 2:].sum(axis=1) if arcs.shape[1] == 4 else np.full(len(arcs), -1)
        for case in sorted(set(zip(left.tolist(), right.tolist(), strict=True))):
            held = waiting.setdefault(case, [])
            held.append(chosen.take((left == case[0]) & (right == case[1])))
            if sum(map(len, held)) >= BATCH:
                yield Systems.joined(waiting.pop(case)), case
    for case, held in waiting.items():
        yield Systems.joined(held), case


def refuse_unlike(frame: Frame) -> None:
    """Refuses a toolkit of which the paper does not treat."""
    one, other = ((c.columns, c.rows, c.peg_radius, c.body_radius, c.flat, c.heights) for c in frame.carriers)
    if one != other or not (frame.swapped or all(each.pegs == (3, 1) for each in frame.toolkit.arrangements)):
        raise InputError(
            f"the paper's polynomials cannot search a {frame.toolkit.kind}, because its carriers are "
            "not alike: search with curves."
        )


def stages(solver: ResultantSolver, arrangements: Sequence[str]) -> Iterator[Array]:
    """Records of fixtures, a batch at a time."""
    rows, frame = solver.rows, solver.frame
    pairs = list_peg_pairs(rows[:, :SEGMENT_LENGTH], frame, solver.diameter)
    sliding_pairs = find_sliding_pairs(pairs, solver.scaled, frame, solver.diameter)
    for name in arrangements:
        systems, sliding = GENERATORS[frame.toolkit.find_arrangement(name).pegs]
        held = sliding(pairs, sliding_pairs, rows, frame)
        if held:
            yield solver.fixtures(SimultaneousContacts.joined(held))
        for batch, case in batch_by_case(systems(pairs, rows[:, :SEGMENT_LENGTH], frame), rows):
            yield solver.fixtures(solver.solve(batch, case))


def find_fixtures_by_algebra(
    query: Query,
    *,
    progress: Progress | None = None,
    cancel: Event | None = None,
    is_part: bool = False,
) -> Result:
    """Finds every fixture that a query asks for as the paper does, by resultants.

    Parameters
    ----------
    query : what is asked but its seating, see ``search.seated``; all fixtures are found also where only the
        best are.
    progress : called as ``progress(fraction done, fixtures found so far)``; the fraction is a guess.
    cancel : when set, the search stops soon and the result, marked incomplete, holds what was found.
    is_part : whether others are joined with it before they are ranked.

    Returns
    -------
    Result
        As ``workhold.answer`` lists them; ``statistics`` counts features, systems solved, orientations,
        simultaneous contacts, and systems that their resultants leave undecided (none in any part tried). Of
        these, ``notes`` name faces and holes.

    Raises
    ------
    InputError
        As ``workhold.answer``, and for a toolkit whose carriers are not alike.
    """
    ways = query.toolkit.ways
    if len(ways) > 1:
        alone = [evolve(query, toolkit=way) for way in ways]
        part = partial(find_fixtures_by_algebra, progress=progress, cancel=cancel, is_part=True)
        return join_ways(list(map(part, alone)), query)
    problem = Problem.of(query)
    refuse_unlike(problem.frame)
    solver = ResultantSolver(problem.rows, problem.frame, query.contact_margin, problem.diameter)
    records: list[Array] = []
    complete = True
    for found in stages(solver, query.types):
        records.append(found)
        if progress is not None:
            progress(1.0 - 0.9 ** len(records), sum(map(len, records)))
        if cancel is not None and cancel.is_set():
            complete = False
            break
    statistics = {
        "features": len(problem.rows),
        **solver.counts,
        "undecided": sum(map(len, solver.undecided)),
    }
    result = list_result(problem, records, Work(complete, statistics), cancel=cancel, is_part=is_part)
    return evolve(result, notes=(*result.notes, *write_undecided_notes(solver.undecided, problem.faces)))
