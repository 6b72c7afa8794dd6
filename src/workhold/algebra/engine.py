"""The paper's own algorithm: generate candidate quartets and pegs, solve their polynomials, test (section 3).

It treats the toolkits of the paper: two equal carriers that a half turn exchanges, with two pegs on each or
with three and one. Left and right pegs, Types I and II refer to the frame of the search.

A system is undecided when its resultant vanishes at every orientation for no known reason
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
    EquationSystems,
    are_parallel,
    list_peg_pairs,
    list_type_one_systems,
    list_type_two_systems,
)
from workhold.algebra.conditions import SimultaneousContacts, find_fourth_pegs, make_records
from workhold.algebra.poses import find_candidate_orientations, find_poses_at, locate_peg_centers
from workhold.algebra.resultants import ContactSystems
from workhold.algebra.sliding_pairs import (
    are_alike_on_both_jaws,
    find_level_orientations,
    find_sliding_pairs,
    find_three_and_one_contacts,
    find_two_and_two_contacts,
)
from workhold.contact.problem import Problem, Progress, SearchFrame
from workhold.conventions import SAME_CENTER
from workhold.errors import InputError
from workhold.kernels.base.feature import SEGMENT_LENGTH
from workhold.listing.results import SearchWork, join_ways, list_result
from workhold.model.notes import MoreSystems, Note, UndecidedSystem
from workhold.model.query import Query
from workhold.model.result import Result

__all__ = ["find_fixtures_by_algebra", "write_undecided_notes"]

# Systems named; the others are counted.
MOST_NAMED = 20


def write_undecided_notes(undecided: Sequence[EquationSystems], faces: NDArray[np.int64]) -> Iterator[Note]:
    """Yield a note for each of the first ``MOST_NAMED`` undecided
    systems, then one with the number of the others.

    ``faces`` has the number of each feature's face.
    """
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
    tuple[int, ...],
    tuple[Callable[..., Iterator[EquationSystems]], Callable[..., list[SimultaneousContacts]]],
] = {
    (2, 2): (list_type_one_systems, find_two_and_two_contacts),
    (3, 1): (list_type_two_systems, find_three_and_one_contacts),
}


@define(eq=False)
class ResultantSolver:
    """A solver for the systems of one workpiece in one toolkit, with counts of its work.

    Parameters
    ----------
    rows : (F, 12) features about the centre of the part, with the slack of their ends.
    frame : the toolkit in the frame of the search.
    margin : smallest distance in mm from a contact to the end of its feature.
    diameter : largest distance in mm between two peg centres: equations are solved with it as the unit of
        length.
    counts : numbers of systems, orientations and simultaneous contacts so far.
    undecided : systems that their resultants leave undecided.
    """

    rows: Array
    frame: SearchFrame
    margin: float
    diameter: float
    counts: dict[str, int] = field(
        factory=lambda: dict.fromkeys(("systems", "orientations", "simultaneous_contacts"), 0)
    )
    undecided: list[EquationSystems] = field(factory=list)

    def compute_peg_offsets(self, systems: EquationSystems) -> NDArray[np.complex128]:
        """Return the places (N, K) of K pegs from the first peg in mm, as complex numbers; the separation is
        not added for right pegs."""
        right = (np.arange(systems.feature.shape[1]) >= 2) * (systems.feature.shape[1] == 4)
        height = systems.row * self.frame.lattice.pitch_y + right * self.frame.lattice.row_offset
        return np.asarray(systems.column * self.frame.lattice.pitch_x + 1j * height)

    @property
    def scaled_features(self) -> Array:
        """The features (F, 10) with lengths divided by the diameter.

        See ``kernels.base.feature`` for the layout of rows.
        """
        scaled = np.array(self.rows[:, :SEGMENT_LENGTH])
        scaled[:, 1:3] /= self.diameter
        scaled[:, 6] /= self.diameter
        scaled[scaled[:, 0] == 0.0, 5] /= self.diameter
        return scaled

    def solve(self, systems: EquationSystems, case: Case) -> SimultaneousContacts:
        """Return the simultaneous contacts, with three or four pegs each, of systems of one case (section 4).

        The case is (arcs on the left, arcs on the right), or (arcs on the left, -1) for three pegs.
        """
        contacts = ContactSystems(
            self.scaled_features[systems.feature], self.compute_peg_offsets(systems) / self.diameter
        )
        owner, psi = self.solve_orientations(contacts, case, systems)
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

    def solve_orientations(
        self, contacts: ContactSystems, case: Case, systems: EquationSystems
    ) -> tuple[IntArray, Array]:
        """Return (indices (M,) of systems, orientations (M,) in radians at which each may be solved).

        Undecided systems are added to ``undecided``.
        """
        special = (
            are_alike_on_both_jaws(contacts)
            if contacts.rows.shape[1] == 4
            else np.zeros(len(systems), np.bool_)
        )
        plain, other = np.flatnonzero(~special), np.flatnonzero(special)
        owner, psi, undecided = find_candidate_orientations(
            contacts.take(plain), case, systems.sectors[plain]
        )
        mirrored, level = find_level_orientations(contacts.take(other))
        self.undecided.append(systems.take(plain[undecided]))
        return np.concatenate([plain[owner], other[mirrored]]), np.concatenate([psi, level])

    def find_fixtures(self, held: SimultaneousContacts) -> Array:
        """Return records (M, 19) of simultaneous contacts that may be
        fixtures; three pegs are completed by a fourth first.

        See ``kernels.contact.record`` for the layout of records.
        """
        if held.feature.shape[1] == 3:
            held = find_fourth_pegs(held, self.rows, self.frame, self.margin, self.diameter / 2)
        self.counts["simultaneous_contacts"] += len(held.psi)
        return make_records(held, self.rows, self.frame, self.margin, self.diameter / 2)


def order_arcs_first(systems: EquationSystems, rows: Array) -> EquationSystems:
    """Return the systems with the pegs of each jaw reordered so that arcs come before lines.

    The new first peg is the characteristic point; columns and rows are counted from the new first pegs.
    """
    line = (rows[systems.feature, 0] == 0.0).astype(np.int64)
    jaw = (np.arange(line.shape[1]) >= 2) * (line.shape[1] == 4)
    order = np.argsort(2 * jaw + line, axis=1, kind="stable")
    feature, column, row = (
        np.take_along_axis(v, order, axis=1) for v in (systems.feature, systems.column, systems.row)
    )
    first = column[:, :1] if line.shape[1] == 3 else np.repeat(column[:, ::2], 2, axis=1)
    return EquationSystems(feature, column - first, row - row[:, :1], systems.sectors)


def have_three_concentric_arcs(systems: EquationSystems, rows: Array) -> NDArray[np.bool_]:
    """Return, for each system, whether it has three concentric arcs,
    whose normals meet in a point and never close.
    """
    center = rows[systems.feature, 1] + 1j * rows[systems.feature, 2]
    arc = rows[systems.feature, 0] != 0.0
    same = (
        (np.abs(center[:, :, None] - center[:, None, :]) <= SAME_CENTER) & arc[:, :, None] & arc[:, None, :]
    )
    return np.asarray((same.sum(axis=2) >= 3).any(axis=1))


def select_generic_systems(systems: EquationSystems, rows: Array) -> EquationSystems:
    """Return the systems that resultants decide, with arcs first: those without three concentric arcs.

    Of systems of three pegs, those with two parallel lines are dropped as well; sliding pairs cover them.
    """
    keep = ~have_three_concentric_arcs(systems, rows)
    if systems.feature.shape[1] == 3:
        for k, m in ((0, 1), (0, 2), (1, 2)):
            keep &= ~are_parallel(rows, systems.feature[:, k], systems.feature[:, m])
    return order_arcs_first(systems.take(keep), rows)


def batch_by_case(stream: Iterable[EquationSystems], rows: Array) -> Iterator[tuple[EquationSystems, Case]]:
    """Yield (systems, case) in batches of about ``BATCH`` or fewer systems of one case each, without those
    that cannot close.

    See :func:`select_generic_systems` for the systems dropped, ``ResultantSolver.solve`` for the case.
    """
    waiting: dict[Case, list[EquationSystems]] = {}
    for systems in stream:
        chosen = select_generic_systems(systems, rows)
        arcs = rows[chosen.feature, 0] != 0.0
        left = arcs[:, :2].sum(axis=1) if arcs.shape[1] == 4 else arcs.sum(axis=1)
        right = arcs[:, 2:].sum(axis=1) if arcs.shape[1] == 4 else np.full(len(arcs), -1)
        for case in sorted(set(zip(left.tolist(), right.tolist(), strict=True))):
            held = waiting.setdefault(case, [])
            held.append(chosen.take((left == case[0]) & (right == case[1])))
            if sum(map(len, held)) >= BATCH:
                yield EquationSystems.concatenate(waiting.pop(case)), case
    for case, held in waiting.items():
        yield EquationSystems.concatenate(held), case


def refuse_unlike(frame: SearchFrame) -> None:
    """Raise InputError for a toolkit with unequal carriers, which the paper does not treat."""
    one, other = ((c.columns, c.rows, c.peg_radius, c.body_radius, c.flat, c.heights) for c in frame.carriers)
    if one != other or not (
        frame.swapped_peg_count or all(each.pegs == (3, 1) for each in frame.toolkit.arrangements)
    ):
        raise InputError(
            f"the paper's polynomials cannot search a {frame.toolkit.kind}, because its carriers are "
            "not alike: search with curves."
        )


def find_fixtures_in_stages(solver: ResultantSolver, arrangements: Sequence[str]) -> Iterator[Array]:
    """Yield records (M, 19) of contacts that may be fixtures, a batch
    at a time; ``arrangements`` are names of types.

    See ``kernels.contact.record`` for the layout of records.
    """
    rows, frame = solver.rows, solver.frame
    pairs = list_peg_pairs(rows[:, :SEGMENT_LENGTH], frame, solver.diameter)
    sliding_pairs = find_sliding_pairs(pairs, solver.scaled_features, frame, solver.diameter)
    for name in arrangements:
        systems, sliding = GENERATORS[frame.toolkit.find_arrangement(name).pegs]
        held = sliding(pairs, sliding_pairs, rows, frame)
        if held:
            yield solver.find_fixtures(SimultaneousContacts.concatenate(held))
        for batch, case in batch_by_case(systems(pairs, rows[:, :SEGMENT_LENGTH], frame), rows):
            yield solver.find_fixtures(solver.solve(batch, case))


def find_fixtures_by_algebra(
    query: Query,
    *,
    progress: Progress | None = None,
    cancel: Event | None = None,
    is_part: bool = False,
) -> Result:
    """Find every fixture that a query asks for by the paper's method, with resultants.

    Parameters
    ----------
    query : the query; its seating is ignored, see ``search.seated``. All fixtures are found even if the query
        asks only for the best.
    progress : called as ``progress(fraction done, fixtures found so far)``; the fraction is a guess.
    cancel : when set, the search stops soon and the result, marked incomplete, holds what was found.
    is_part : whether the result is to be joined with others before fixtures are ranked.

    Returns
    -------
    Result
        As ``workhold.answer`` lists them; ``statistics`` counts features, systems solved, orientations,
        simultaneous contacts, and systems that their resultants leave undecided (none in any part tried). For
        the latter, ``notes`` name faces and holes.

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
    problem = Problem.from_query(query)
    refuse_unlike(problem.frame)
    solver = ResultantSolver(problem.rows, problem.frame, query.contact_margin, problem.diameter)
    records: list[Array] = []
    complete = True
    for found in find_fixtures_in_stages(solver, query.types):
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
    result = list_result(problem, records, SearchWork(complete, statistics), cancel=cancel, is_part=is_part)
    return evolve(result, notes=(*result.notes, *write_undecided_notes(solver.undecided, problem.faces)))
