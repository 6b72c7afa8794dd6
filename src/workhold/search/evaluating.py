"""Evaluation of a given set-up: every pose in which the part touches exactly these pegs and is held.

The toolkit is reduced to the holes of the set-up, all its fixtures are searched, and those in exactly these
holes are taken. So the evaluation of a set-up is as complete as any list.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import dist

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import LEAST_CLOSURE
from workhold.errors import InputError, join_words
from workhold.fixels.carrier import (
    Carrier,
    HoleSelection,
    find_carrier_letter,
    make_column_letters,
    parse_hole_name,
)
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.limits import check_count, choose_thread_count
from workhold.listing.placing import are_placeable, place_candidates
from workhold.model.fixture_table import FixtureTable
from workhold.model.own_outlines import measure_outline_diameter
from workhold.model.query import Query
from workhold.model.requirements import Load, Restrictions, Tolerance
from workhold.model.result import Result
from workhold.model.workpiece import Workpiece
from workhold.search.broken_rules import find_all_contacts
from workhold.search.design import answer

__all__ = ["Evaluation", "evaluate"]

CLAMP = "clamp "


@frozen(repr=False)
class Evaluation:
    """The fixtures of a part on pegs in given holes.

    Parameters
    ----------
    holes : names of the holes, as given by the user.
    result : the fixtures, one for each pose in which the pegs hold the part, best first. Its toolkit has no
        more holes than the set-up needs.
    reason : why there is no fixture, in a sentence; empty where there is one.
    """

    holes: tuple[str, ...]
    result: Result
    reason: str

    @property
    def holds(self) -> bool:
        """Whether the pegs hold the part in some pose."""
        return len(self.result) > 0

    def __repr__(self) -> str:
        count = len(self.result)
        poses = f"held in {count} pose{'s' * (count != 1)}" if count else self.reason
        return f"<Evaluation of {' '.join(self.holes)}: {poses}>"


def evaluate(
    workpiece: Workpiece,
    toolkit: Toolkit,
    holes: Sequence[str],
    *,
    contact_margin: float = 0.0,
    restrictions: Restrictions | None = None,
    tolerance: Tolerance | None = None,
    loads: Sequence[Load] = (),
    jaw_force: float | None = None,
    threads: int | None = None,
) -> Evaluation:
    """Return an evaluation of a set-up: all poses in which the part touches exactly these pegs and is held.

    Parameters
    ----------
    workpiece, toolkit : the part, and the toolkit that holds it; lengths in mm.
    holes : names of the holes of all pegs, as in ``peg.hole``, such as "L-A2" of a vise or "B3" of a plate.
        On a plate the hole of a clamp may be named as well, as "clamp E2"; otherwise the clamp may be bolted
        anywhere. Moving all pegs by the same number of holes does not change a set-up.
    contact_margin, restrictions, tolerance, loads, jaw_force : see :class:`workhold.Query`.
    threads : number of threads; None for one on each processor.

    Raises
    ------
    InputError
        For a name that is not a hole, for more or fewer holes than the toolkit has pegs, and where a query
        raises it.

    Examples
    --------
    >>> import workhold
    >>> vise = workhold.Vise(pitch=8, columns=1, peg_radius=3)
    >>> mine = workhold.evaluate(workhold.load("widget"), vise, ["L-A1", "L-A2", "R-A1", "R-A2"])
    >>> mine.holds, {peg.hole for peg in mine.result[0].pegs} == set(mine.holes)
    (True, True)
    >>> workhold.evaluate(workhold.load("widget"), vise, ["L-A1", "L-A30", "R-A1", "R-A2"]).reason
    'L-A1 and L-A30 are 232 mm apart, and the part is 61.59 mm across: no pose touches both.'
    """
    given = (holes,) if isinstance(holes, str) else tuple(holes)
    setup = GivenSetUp.from_names(given, toolkit)
    query = Query(
        workpiece,
        setup.make_smallest_toolkit(),
        contact_margin=contact_margin,
        restrictions=restrictions,
        tolerance=tolerance,
        loads=loads,
        jaw_force=jaw_force,
        listing="all" if toolkit.travel_count > 1 else None,
    )
    far = setup.describe_distant_peg(measure_outline_diameter(query.workpiece))
    if far:
        return Evaluation(
            given, Result(query, FixtureTable.make_empty(query.toolkit), *make_zero_counts(query)), far
        )
    result = answer(query, threads=threads)
    result = result.choose(setup.find_matching_fixtures(result.table, query.toolkit))
    workers = choose_thread_count(check_count("threads", threads))
    return Evaluation(given, result, "" if len(result) else setup.explain_no_fixture(query, workers))


def make_zero_counts(query: Query) -> tuple[dict[str, int], dict[str, int]]:
    """Return two dicts with a count of 0 for each type of the query:
    fixtures found, and distinct fixtures.
    """
    counts = dict.fromkeys(query.toolkit.types, 0)
    return counts, dict(counts)


@frozen
class GivenSetUp:
    """A set-up given by names: pegs and clamps in holes of a toolkit.

    Parameters
    ----------
    toolkit : the toolkit.
    pegs : holes of the pegs, in the order given.
    clamps : holes in which clamps are bolted, in the order given; empty where the clamps may be bolted
        anywhere.
    """

    toolkit: Toolkit
    pegs: tuple[HoleSelection, ...]
    clamps: tuple[HoleSelection, ...]

    @classmethod
    def from_names(cls, names: Sequence[str], toolkit: Toolkit) -> GivenSetUp:
        """Return the set-up with pegs and clamps in named holes.

        The name of a clamp's hole begins with "clamp ", the name of a peg's hole does not.

        Raises
        ------
        InputError
            For a name that is not a hole, and for more or fewer pegs or clamps than the toolkit has.
        """
        lattices = [carrier for carrier in toolkit.carriers if carrier.has_lattice]
        for name in names:
            if not isinstance(name, str):
                raise InputError(
                    f"a hole cannot be {name!r}: give names, such as {lattices[0].name_place(1, 2)}."
                )
        bolted = [name for name in names if name.lower().startswith(CLAMP)]
        pegs, clamps = (
            tuple(find_named_hole(name.removeprefix(CLAMP), lattices) for name in some)
            for some in ([name for name in names if name not in bolted], [name.lower() for name in bolted])
        )
        moving = toolkit.travel_count if any(carrier.on for carrier in toolkit.carriers) else 0
        walls = sum(2 for carrier in toolkit.carriers if carrier.contact is WALL_END)
        needed = toolkit.peg_count - moving - walls
        if len(set(pegs)) != needed or len(pegs) != needed or len(clamps) not in (0, moving):
            also = f", and of {moving} clamp{'s' * (moving > 1)} if wanted" if moving else ""
            raise InputError(
                f"{join_words(list(names) or ['nothing'])}: give the holes of {needed} pegs{also}."
            )
        return cls(toolkit, pegs, clamps)

    @property
    def has_blocked(self) -> bool:
        """Whether holes of this kind of toolkit can be blocked, as in a vise."""
        return hasattr(self.toolkit, "blocked")

    def make_smallest_toolkit(self) -> Toolkit:
        """Return the toolkit reduced to the holes that the set-up needs, all others blocked or cut off."""
        pegs, changes = [*self.pegs, *self.clamps], dict[str, object]()
        rows = 1 + max(hole.row or 0 for hole in pegs)
        if self.has_blocked:
            lattices = [carrier for carrier in self.toolkit.carriers if carrier.has_lattice]
            # Holes above the set-up are not there; where the jaws have an end, the pegs stand where they stand.
            rows = rows if lattices[0].rows is None else lattices[0].rows
            free = {(hole.carrier, hole.column, hole.row) for hole in pegs}
            changes["blocked"] = [
                HoleSelection(carrier.name, column, row)
                for carrier in lattices
                for column in range(carrier.column_count)
                for row in range(rows)
                if (carrier.name, column, row) not in free
            ]
            changes["rows"] = rows
        elif self.clamps or not any(carrier.on for carrier in self.toolkit.carriers):
            lowest = [0 if self.counts_from_wall else min(hole.row or 0 for hole in pegs)]
            changes["rows"] = rows - lowest[0]
            if not self.is_beside_wall:
                columns = [hole.column for hole in pegs]
                changes["columns"] = max(columns) - min(columns) + 1
        return self.toolkit.with_fields(changes) if changes else self.toolkit

    @property
    def is_beside_wall(self) -> bool:
        """Whether the toolkit has a wall that the part lies on."""
        return WALL_END in self.toolkit.contacts

    @property
    def counts_from_wall(self) -> bool:
        """Whether rows are counted from a wall, so that pegs moved by some rows are another set-up."""
        return self.is_beside_wall and any(carrier.on for carrier in self.toolkit.carriers)

    def find_matching_fixtures(self, table: FixtureTable, toolkit: Toolkit) -> NDArray[np.bool_]:
        """Return a mask (N,): True for fixtures whose pegs and clamps stand in the set-up's holes.

        Where the set-up names no clamps, only pegs are compared. ``toolkit`` is the toolkit of the table.
        """
        wanted = self.make_pattern([*self.pegs, *(evolve(one, carrier=CLAMP) for one in self.clamps)])
        found = np.zeros(len(table), np.bool_)
        for number, (kind, columns, rows) in enumerate(
            zip(table.arrangement.tolist(), table.column.tolist(), table.row.tolist(), strict=True)
        ):
            carriers = [toolkit.carriers[one] for one in toolkit.arrangements[kind].carriers]
            there = [
                HoleSelection(carrier.name if carrier.has_lattice else CLAMP, column, row)
                for carrier, column, row in zip(carriers, columns, rows, strict=True)
                if carrier.has_lattice or (carrier.on is not None and self.clamps)
            ]
            found[number] = self.make_pattern(there) == wanted
        return found

    def make_pattern(self, holes: Sequence[HoleSelection]) -> frozenset[tuple[str, int, int]]:
        """Return the holes as a set of (carrier name, column, row); equal set-ups have equal sets.

        Where holes cannot be blocked (a plate), columns count from the set-up's lowest column, and rows from
        its lowest row, unless rows are counted from a wall.
        """
        column, row = (
            (0, 0)
            if self.has_blocked
            else (min(hole.column for hole in holes), min(hole.row or 0 for hole in holes))
        )
        row = 0 if self.counts_from_wall else row
        return frozenset((hole.carrier, hole.column - column, (hole.row or 0) - row) for hole in holes)

    def describe_distant_peg(self, diameter: float) -> str:
        """Return a sentence on the first peg that is too far from every other peg of its carrier.

        Too far means that no pose of a part of this diameter in mm touches both. Empty where there is no such
        peg.
        """
        for hole in self.pegs:
            carrier = self.toolkit.find_carrier(hole.carrier)
            at = carrier.compute_hole_center(hole.column, hole.row or 0)
            others = [
                (
                    dist(at, carrier.compute_hole_center(one.column, one.row or 0)),
                    make_hole_label(one, carrier),
                )
                for one in self.pegs
                if one.carrier == hole.carrier and one != hole
            ]
            away, nearest = min(others, default=(0.0, ""))
            if away > diameter + 2 * carrier.peg_radius:
                pegs = join_words(sorted((make_hole_label(hole, carrier), nearest)))
                return (
                    f"{pegs} are {away:.4g} mm apart, and the part is {diameter:.4g} mm across: no pose touches "
                    "both."
                )
        return ""

    def explain_no_fixture(self, query: Query, threads: int) -> str:
        """Return a sentence that says why no fixture stands in the set-up's holes.

        ``query`` is the query of the set-up's smallest toolkit, see :meth:`make_smallest_toolkit`.
        """
        named = join_words(
            [make_hole_label(hole, self.toolkit.find_carrier(hole.carrier)) for hole in self.pegs]
        )
        if self.is_beside_wall or query.toolkit.travel_count > 1:
            return f"No pose of {query.workpiece.name} touches {named} and all else, and is held by them."
        poses, pulls = 0, 4
        for way in query.toolkit.ways:
            problem = Problem.from_query(evolve(query, toolkit=way))
            contacts = find_all_contacts(problem, threads)
            contacts = contacts.take(are_placeable(contacts.candidates, problem))
            contacts = contacts.take(
                self.find_matching_fixtures(place_candidates(contacts.candidates, problem), way)
            )
            poses += len(contacts.margin)
            loose = (contacts.null < LEAST_CLOSURE).sum(axis=1)
            pulls = min(pulls, int(loose.min(initial=4)))
        if not poses:
            return f"No pose of {query.workpiece.name} touches {named} at the same time, within their faces."
        how = "in one pose" if poses == 1 else f"in {poses} poses"
        why = (
            "the jaw or clamp would have to pull"
            if pulls == 0
            else f"{'one contact' if pulls == 1 else f'{pulls} contacts'} would have to pull the part instead of "
            "pressing on it"
        )
        return f"{query.workpiece.name} touches {named} {how}, and is held in none: {why}."


def make_hole_label(hole: HoleSelection, carrier: Carrier) -> str:
    """Return the name of a hole on its carrier, such as "L-A2"; a whole
    column is named by its hole in row 1.
    """
    return carrier.name_place(hole.column, hole.row or 0)


def find_named_hole(name: str, lattices: Iterable[Carrier]) -> HoleSelection:
    """Return the hole of a name such as "L-A2" or "B3".

    Raises
    ------
    InputError
        For a name that is not a hole of the lattices, and for the name of a whole column.
    """
    carriers = {carrier.name: carrier for carrier in lattices}
    first = next(iter(carriers.values()))
    if find_carrier_letter(first.name):
        hole = parse_hole_name(name, carriers, first.noun)
    else:
        # The holes of the only lattice are named without a letter for it.
        try:
            hole = evolve(parse_hole_name(f"L-{name}", ("left",), first.noun), carrier=first.name)
        except InputError as error:
            raise InputError(f"{name!r} names no hole: give column letter and row, such as B3.") from error
    carrier = carriers[hole.carrier]
    if hole.row is None:
        raise InputError(
            f"{name} is a column: give a hole of it, such as {carrier.name_place(hole.column, 2)}."
        )
    if hole.column >= (carrier.columns or hole.column + 1) or hole.row >= (carrier.rows or hole.row + 1):
        last = "" if carrier.columns is None else f" up to {make_column_letters(carrier.columns - 1)}"
        raise InputError(f"there is no hole {name}: the {carrier.noun} has columns{last}.")
    return hole
