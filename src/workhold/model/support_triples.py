"""Supports of a planar fixture: sets of three with their figures, and the set that is chosen.

Supports may be in holes before column A or row 1 of a listed fixture, or nearer the opening than its pegs.
Then the whole set-up is shifted in the same plates, by some columns and rows. The part, its pegs and its
supports keep their relative places. So the holes of a chosen triple are renumbered from the plates' first
holes, so that all have names.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve, frozen

from workhold.conventions import STEADY
from workhold.errors import InputError
from workhold.fixels.carrier import Carrier, find_carrier_letter, make_hole_name
from workhold.fixels.toolkit import Toolkit
from workhold.model.fixture import Fixture
from workhold.model.moved_setup import find_move_to_middle, move_to, shift_hole_numbers
from workhold.model.query import Query
from workhold.model.support_request import SpatialLoad, SupportRequest

__all__ = [
    "ChosenSupports",
    "ClampFigures",
    "RecountedSupports",
    "SupportPad",
    "Supports",
    "Triple",
    "recount_holes",
]

Point = tuple[float, float]
# Set-ups are moved by no more columns and rows than this.
FARTHEST = 60

Hole = tuple[int, int]


@frozen
class ClampFigures:
    """A clamp on top at one point, with its figures.

    Parameters
    ----------
    at : point (x, y) where it presses, in mm in the part's coordinates.
    clamp_needed : force in N at which no support loses contact under any load.
    support_force : the largest force on a support at that force, in N; None without loads.
    arm : distance in mm from the nearest side of the supports' triangle: the tipping moment resisted per N.
    share : smallest share of the clamp force on a support.
    lift : clamp force needed for each N of jaw force when nothing else acts.
    hangs : whether the material under the point does not reach down to the plane on which the part lies, as
        under a lip.
    """

    at: Point
    clamp_needed: float
    support_force: float | None
    arm: float
    share: float
    lift: float
    hangs: bool = False


@frozen
class SupportPad:
    """A support in a hole.

    Parameters
    ----------
    carrier : name of its carrier.
    column, row : hole, numbered as in the planar fixture; it may lie beyond the end of the plate, or be
        negative.
    x, y : in mm in the part's coordinates.
    """

    carrier: str
    column: int
    row: int
    x: float
    y: float

    @property
    def hole(self) -> str:
        """Name of the hole; where its column or row is negative, its numbers in brackets, A1 being (1,1).

        >>> SupportPad("left", 2, 3, 0.0, 0.0).hole, SupportPad("plate", -1, 3, 0.0, 0.0).hole
        ('L-C4', '(0,4)')
        """
        if min(self.column, self.row) >= 0:
            return make_hole_name(self.carrier, self.column, self.row)
        letter = find_carrier_letter(self.carrier)
        return f"{letter}{'-' if letter else ''}({self.column + 1},{self.row + 1})"


@frozen
class Triple:
    """Three supports and the clamp over them.

    Parameters
    ----------
    supports : in order of carrier, column and row.
    travel : opening of the moving jaw in mm with these supports; None if no lattice moves.
    marginal : whether a rule is satisfied so narrowly that another computation may reject the set.
    standing : distance in mm of the centre of area inside the triangle; positive where the part stands
        unclamped.
    overhang : largest distance in mm of a load's point beyond a side of the triangle; None without such a
        point.
    arm, arm_at : the largest tipping arm in mm, and the clamp's point for it.
    best : the clamp at the place with the least force.
    given : the clamp at the requested point; None if none was requested or the clamp may not stand there.
    """

    supports: tuple[SupportPad, ...]
    travel: float | None
    marginal: bool
    standing: float
    overhang: float | None
    arm: float
    arm_at: Point
    best: ClampFigures
    given: ClampFigures | None

    @property
    def stands(self) -> bool:
        """Whether the part stands on the supports unclamped with a margin,
        so that a touch does not tip it.
        """
        return self.standing >= STEADY

    @property
    def clamp(self) -> ClampFigures:
        """The clamp at the requested point, if it may stand there; else the clamp that needs the least force.

        If no force is needed anywhere, the latter is at the place with the largest tipping arm.
        """
        return self.given or self.best


@frozen(repr=False)
class Supports:
    """The supports of one planar fixture.

    Parameters
    ----------
    query : query of the planar fixture, with part and toolkit.
    fixture : the planar fixture that the supports belong to.
    request : the request that the supports answer.
    loads : the loads, with all heights filled in.
    jaw_force : force in N on the moving carrier, for which all figures hold.
    positions : number of holes that may hold a support.
    count : number of valid triples; None if not all were examined.
    triples : the listed triples, the best first.
    stopped : whether the search was stopped; then ``triples`` are the best of those examined.
    """

    query: Query
    fixture: Fixture
    request: SupportRequest
    loads: tuple[SpatialLoad, ...]
    jaw_force: float
    positions: int
    count: int | None
    triples: tuple[Triple, ...]
    stopped: bool = False

    @property
    def words(self) -> str:
        """Phrase with the number of listed sets, and the part."""
        whole = "" if self.count is None else f" of {self.count:,}"
        sets = f"the best {len(self.triples):,}{whole} sets of three" if self.triples else "no set of three"
        return f"{sets} under {self.query.workpiece.name}"

    def __repr__(self) -> str:
        return f"<Supports: {self.words}>"

    def _repr_html_(self) -> str:
        from workhold.presenting.notebook import render_supports_html

        return render_supports_html(self)

    @property
    def complete(self) -> bool:
        """Whether every valid triple is listed."""
        return self.count == len(self.triples)

    def find_triple(self, rank: int) -> Triple:
        """Return the set of three with this rank, from 1; raise InputError if there is none."""
        count = len(self.triples)
        if not 1 <= rank <= count:
            there = f"{count} are listed" if count else "there is no set of three"
            raise InputError(f"there is no set {rank} of supports: {there}.")
        return self.triples[rank - 1]

    def bound_clamp_force(self, friction: float, rank: int = 1) -> float:
        """Return a lower bound in N of the clamp force needed if friction helps as much as it can to balance
        the loads.

        The bound is at most the force without friction. It is optimistic and not used for ranking; see
        ``supports.friction``.

        Parameters
        ----------
        friction : Coulomb's coefficient of all contacts.
        rank : of the set of three, from 1.

        Raises
        ------
        InputError
            For an impossible coefficient, without loads, and when there is no such set.
        """
        from workhold.supports.friction import compute_clamp_force

        return compute_clamp_force(self, self.find_triple(rank), friction)

    def keep_best(self, count: int) -> Supports:
        """Return a copy with only the first ``count`` triples."""
        return evolve(self, triples=self.triples[:count])


@frozen
class RecountedSupports:
    """A fixture and its supports, with holes renumbered so that all have names.

    Parameters
    ----------
    fixture : the set-up with renumbered holes; its coordinates in mm are still measured from the same hole as
        before.
    supports : the three, in their order; ``x`` and ``y`` stay those in the part's coordinates.
    columns, rows : numbers of columns and rows of the first plate by which part and pegs are moved from the
        listed set-up.
    """

    fixture: Fixture
    supports: tuple[SupportPad, ...]
    columns: int
    rows: int

    @property
    def move(self) -> Hole:
        """(columns, rows) by which the set-up is moved."""
        return self.columns, self.rows


def recount_holes(
    fixture: Fixture, toolkit: Toolkit, triple: Triple, start: Hole = (0, 0)
) -> RecountedSupports:
    """Return a fixture and three supports renumbered into holes that exist, as near as possible to ``start``.

    Parameters
    ----------
    start : preferred (columns, rows) by which to move the set-up; the nearest possible move is taken.

    Raises
    ------
    InputError
        When there are no such holes, as for supports that do not fit the toolkit.
    """
    plates = [plate for plate in toolkit.carriers if plate.has_lattice]
    travel = fixture.travel if triple.travel is None else triple.travel
    for columns, rows in iterate_moves(toolkit, start):
        shifts = {
            plate.name: compute_shift(plate, plates[0], (columns, rows), travel - fixture.travel)
            for plate in plates
        }
        if all(are_holes_free(plate, shifts[plate.name], fixture, toolkit, triple) for plate in plates):
            return move_setup(fixture, toolkit, triple, (columns, rows), shifts, travel)
    raise InputError("the supports have no holes in the plates of the toolkit: list them again.")


def iterate_moves(toolkit: Toolkit, start: Hole) -> Iterator[Hole]:
    """Yield (columns, rows) to move a set-up by, in order of |columns| + |rows| counted from ``start``.

    Neither number differs from ``start`` by more than :data:`FARTHEST`; rows stay at ``start`` where a wall
    fixes them.
    """
    # A wall stays where it is.
    most_rows = 0 if toolkit.datum.fixes_rows or toolkit.ends_on_walls else FARTHEST
    for steps in range(FARTHEST + most_rows + 1):
        for columns in range(-min(steps, FARTHEST), min(steps, FARTHEST) + 1):
            rows = steps - abs(columns)
            if rows <= most_rows:
                yield from ((start[0] + columns, start[1] + row) for row in sorted({-rows, rows}))


def compute_shift(plate: Carrier, first: Carrier, move: Hole, opened: float) -> Hole:
    """Return (columns, rows) to add to a plate's hole numbers when part and pegs move.

    They move by ``move`` columns and rows of the plate ``first``. A plate that slides has travelled
    ``opened`` mm more than before, and its holes with it.
    """
    shift = [
        round((steps * own - (0.0 if plate.travel is None else opened * along)) / pitch)
        for steps, own, along, pitch in zip(
            move,
            first.pitch,
            (0.0, 0.0) if plate.travel is None else plate.travel.unit,
            plate.pitch,
            strict=True,
        )
    ]
    return shift[0], shift[1]


def list_taken_holes(
    plate: Carrier, fixture: Fixture, toolkit: Toolkit, triple: Triple
) -> Iterator[tuple[int | None, int | None]]:
    """Yield (column, row) on a plate of each peg, clamp and support; None for a number that is measured, not
    counted.
    """
    for peg in fixture.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        if carrier.stands_on == plate.name:
            in_column, in_row = carrier.counted_axes
            yield (peg.column if in_column else None), (peg.row if in_row else None)
    for pad in triple.supports:
        if pad.carrier == plate.name:
            yield pad.column, pad.row


def are_holes_free(plate: Carrier, shift: Hole, fixture: Fixture, toolkit: Toolkit, triple: Triple) -> bool:
    """Return whether all holes of pegs, clamps and supports on a plate, moved by ``shift``, exist and are not
    blocked.
    """
    for column, row in list_taken_holes(plate, fixture, toolkit, triple):
        new = [None if old is None else old + by for old, by in zip((column, row), shift, strict=True)]
        for number, most in zip(new, (plate.columns, plate.rows), strict=True):
            if number is not None and not 0 <= number < (number + 1 if most is None else most):
                return False
        if new[0] is not None and new[1] is not None and plate.is_blocked(new[0], new[1]):
            return False
    return True


def move_setup(
    fixture: Fixture,
    toolkit: Toolkit,
    triple: Triple,
    move: Hole,
    shifts: dict[str, Hole],
    travel: float,
) -> RecountedSupports:
    """Return the set-up moved by ``move`` columns and rows of the first plate.

    Hole numbers on each plate are changed by ``shifts[plate name]``.
    """
    first = next(plate for plate in toolkit.carriers if plate.has_lattice)
    dx, dy = move[0] * first.pitch[0], move[1] * first.pitch[1]
    new = shift_hole_numbers(fixture, toolkit, (dx, dy), shifts, travel)
    pads = tuple(
        evolve(pad, column=pad.column + shifts[pad.carrier][0], row=pad.row + shifts[pad.carrier][1])
        for pad in triple.supports
    )
    return RecountedSupports(new, pads, *move)


@frozen
class ChosenSupports:
    """One set of three of the supports that were found, to be built.

    Parameters
    ----------
    supports : all that is known of them.
    number : of the set, from 1.
    recounted : the set-up in holes with names.
    """

    supports: Supports
    number: int
    recounted: RecountedSupports

    @classmethod
    def from_supports(cls, supports: Supports, number: int = 1) -> ChosenSupports:
        """Return the set with this number, from 1, in holes with names,
        as near as possible to the middle of the plate.
        """
        if not isinstance(supports, Supports):
            raise InputError("supports are what the fixture's own method of that name returns: give these.")
        triple = supports.find_triple(number)
        query = supports.query
        start = find_move_to_middle(supports.fixture, query.toolkit, query.workpiece)
        return cls(supports, number, recount_holes(supports.fixture, query.toolkit, triple, start))

    @classmethod
    def from_fixture(cls, fixture: Fixture, supports: Supports, number: int = 1) -> ChosenSupports:
        """Return the set with this number, from 1, for a fixture of a result;
        the supports must be this fixture's own.

        Raises
        ------
        InputError
            When there is no such set, or the supports are of another fixture, part or toolkit.
        """
        chosen, query = cls.from_supports(supports, number), fixture.listing.result.query
        belongs = (
            query.workpiece.is_alike(supports.query.workpiece) and query.toolkit == supports.query.toolkit
        )
        if not belongs or supports.fixture != fixture:
            raise InputError(
                "the supports are of another fixture: take those that this fixture's own method returns."
            )
        return chosen

    def move_to_hole(self, name: str) -> ChosenSupports:
        """Return the set-up moved so that the lowest column and row of its pegs and clamps are those of a
        hole, such as "D4".

        Raises
        ------
        InputError
            For text that names no hole, and where pegs or supports would have no hole.
        """
        query, fixture = self.supports.query, self.supports.fixture
        start = move_to(fixture, query.toolkit, name)
        found = recount_holes(fixture, query.toolkit, self.triple, start)
        if found.move != start:
            raise InputError(
                f"the supports have no holes with the set-up at {name.strip()[:40]}: leave the place out, or "
                "give another one."
            )
        return evolve(self, recounted=found)

    @property
    def triple(self) -> Triple:
        """The set with its figures, and with its holes as they were listed."""
        return self.supports.find_triple(self.number)

    @property
    def clamp(self) -> ClampFigures:
        """The clamp over the set, see :attr:`Triple.clamp`."""
        return self.triple.clamp

    @property
    def pads(self) -> tuple[SupportPad, ...]:
        """Supports in holes that have names."""
        return self.recounted.supports
