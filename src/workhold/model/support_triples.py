"""What is known of the supports of a planar fixture: triples with their figures, and one that is chosen.

Supports may stand in holes before column A or row 1 of a fixture as it was listed, or nearer the opening than
its pegs. Then all of the set-up stands elsewhere in the same plates: so many columns and rows further on. The
part, its pegs and its supports keep their places to one another. So a chosen triple is counted anew from the
plates' first holes, in which all holes have names.
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

__all__ = ["ChosenSupports", "ClampFigures", "Recounted", "SupportPad", "Supports", "Triple", "recounted"]

Point = tuple[float, float]
# Set-ups are moved by no more columns and rows than this.
FARTHEST = 60

Hole = tuple[int, int]


@frozen
class ClampFigures:
    """The clamp at one point, and how good it is there.

    Parameters
    ----------
    at : where it presses, in mm in the part's coordinates.
    clamp_needed : force in N above which no support loses contact under any load.
    support_force : the largest force on a support at that force, in N; None without loads.
    arm : distance in mm from the nearest side: tipping moment resisted per N.
    share : the smallest share of the clamp force that a support takes.
    lift : clamp force that each N of jaw force asks for when nothing else acts.
    hangs : whether the material under the point does not reach down to where the part lies, as of a web under
        a lip.
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
    carrier : name of what it stands on.
    column, row : as the planar fixture counts them; its plates may end before.
    x, y : in mm in the part's coordinates.
    """

    carrier: str
    column: int
    row: int
    x: float
    y: float

    @property
    def hole(self) -> str:
        """The hole's name; one before column A or row 1 by its numbers, where A1 is (1,1).

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
    travel : what the moving jaw is opened to with these supports, in mm; None where no lattice moves.
    marginal : whether a rule is kept by so little that another list may leave it out.
    standing : how far in mm the centre of area is inside the triangle; positive: it stands unclamped.
    overhang : farthest in mm that a load's point lies beyond a side; None without such a point.
    arm, arm_at : the largest tipping arm in mm, and the clamp's point for it.
    best : the clamp where it needs the least force.
    given : the clamp at the point asked for; None where none was asked for or it may not stand there.
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
        """Whether the part stands on them unclamped, so that no touch tips it."""
        return self.standing >= STEADY

    @property
    def clamp(self) -> ClampFigures:
        """The clamp at the point asked for, where it may stand there, else at its best.

        Where it needs no force its best place has the largest tipping arm.
        """
        return self.given or self.best


@frozen(repr=False)
class Supports:
    """The supports of one planar fixture.

    Parameters
    ----------
    query : part and toolkit, with what else the planar fixture was asked for.
    fixture : the planar fixture.
    request : what was asked.
    loads : with their heights written out.
    jaw_force : on what moves, in N, that all figures hold for.
    positions : how many holes may hold a support.
    count : how many triples are valid; None where not all were looked at.
    triples : those listed, the best first.
    stopped : whether the search was stopped: then they are the best of those it had looked at.
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
        """What is listed, of which part, in a few words."""
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

    def ranked(self, rank: int) -> Triple:
        """The set of three of a rank from 1."""
        count = len(self.triples)
        if not 1 <= rank <= count:
            there = f"{count} are listed" if count else "there is no set of three"
            raise InputError(f"there is no set {rank} of supports: {there}.")
        return self.triples[rank - 1]

    def clamp_with_friction(self, friction: float, rank: int = 1) -> float:
        """The least clamp force in N for which friction could balance the loads, if all goes well.

        It is optimistic, ranks nothing and is at most that without friction; see ``supports.friction``.

        Parameters
        ----------
        friction : Coulomb's coefficient of all contacts.
        rank : of the set of three, from 1.

        Raises
        ------
        InputError
            For a coefficient that is none, without loads, and when there is no such set.
        """
        from workhold.supports.friction import clamp_with_friction

        return clamp_with_friction(self, self.ranked(rank), friction)

    def best(self, count: int) -> Supports:
        """A copy with the first triples only."""
        return evolve(self, triples=self.triples[:count])


@frozen
class Recounted:
    """A fixture and its supports in holes that all have names.

    Parameters
    ----------
    fixture : the set-up, with its places in mm from the same hole as ever.
    supports : the three, in their order; ``x`` and ``y`` stay those in the part's coordinates.
    columns, rows : by how many of the first plate part and pegs stand further on than they were listed.
    """

    fixture: Fixture
    supports: tuple[SupportPad, ...]
    columns: int
    rows: int

    @property
    def move(self) -> Hole:
        return self.columns, self.rows


def recounted(fixture: Fixture, toolkit: Toolkit, triple: Triple, start: Hole = (0, 0)) -> Recounted:
    """The set-up of a fixture and three supports in the holes nearest to where it may stand.

    Parameters
    ----------
    start : columns and rows by which it is to stand further on if supports have holes there.

    Raises
    ------
    InputError
        When there are no such holes, as of supports that do not fit the toolkit.
    """
    plates = [plate for plate in toolkit.carriers if plate.has_lattice]
    travel = fixture.travel if triple.travel is None else triple.travel
    for columns, rows in moves(toolkit, start):
        shifts = {
            plate.name: shift_of(plate, plates[0], (columns, rows), travel - fixture.travel)
            for plate in plates
        }
        if all(fits(plate, shifts[plate.name], fixture, toolkit, triple) for plate in plates):
            return moved(fixture, toolkit, triple, (columns, rows), shifts, travel)
    raise InputError("the supports have no holes in the plates of the toolkit: list them again.")


def moves(toolkit: Toolkit, start: Hole) -> Iterator[Hole]:
    """Columns and rows by which part and pegs may stand further on, the nearest to a start first."""
    # A wall stays where it is.
    most_rows = 0 if toolkit.datum.fixes_rows or toolkit.ends_on_walls else FARTHEST
    for steps in range(FARTHEST + most_rows + 1):
        for columns in range(-min(steps, FARTHEST), min(steps, FARTHEST) + 1):
            rows = steps - abs(columns)
            if rows <= most_rows:
                yield from ((start[0] + columns, start[1] + row) for row in sorted({-rows, rows}))


def shift_of(plate: Carrier, first: Carrier, move: Hole, opened: float) -> Hole:
    """Columns and rows by which a plate's holes count further on.

    All stands ``move`` columns and rows of the first plate further on, and the plate that slides has
    travelled by ``opened`` mm more than before.
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


def holes_on(
    plate: Carrier, fixture: Fixture, toolkit: Toolkit, triple: Triple
) -> Iterator[tuple[int | None, int | None]]:
    """Columns and rows on a plate that pegs, clamps and supports take up; None for what says nothing."""
    for peg in fixture.pegs:
        carrier = toolkit.find_carrier(peg.carrier)
        if carrier.stands_on == plate.name:
            in_column, in_row = carrier.counted
            yield (peg.column if in_column else None), (peg.row if in_row else None)
    for pad in triple.supports:
        if pad.carrier == plate.name:
            yield pad.column, pad.row


def fits(plate: Carrier, shift: Hole, fixture: Fixture, toolkit: Toolkit, triple: Triple) -> bool:
    """Whether all holes of a plate exist and are open, counted further on by a shift."""
    for column, row in holes_on(plate, fixture, toolkit, triple):
        new = [None if old is None else old + by for old, by in zip((column, row), shift, strict=True)]
        for number, most in zip(new, (plate.columns, plate.rows), strict=True):
            if number is not None and not 0 <= number < (number + 1 if most is None else most):
                return False
        if new[0] is not None and new[1] is not None and plate.is_blocked(new[0], new[1]):
            return False
    return True


def moved(
    fixture: Fixture,
    toolkit: Toolkit,
    triple: Triple,
    move: Hole,
    shifts: dict[str, Hole],
    travel: float,
) -> Recounted:
    """The set-up with its holes counted further on."""
    first = next(plate for plate in toolkit.carriers if plate.has_lattice)
    dx, dy = move[0] * first.pitch[0], move[1] * first.pitch[1]
    new = shift_hole_numbers(fixture, toolkit, (dx, dy), shifts, travel)
    pads = tuple(
        evolve(pad, column=pad.column + shifts[pad.carrier][0], row=pad.row + shifts[pad.carrier][1])
        for pad in triple.supports
    )
    return Recounted(new, pads, *move)


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
    recounted: Recounted

    @classmethod
    def of(cls, supports: Supports, number: int = 1) -> ChosenSupports:
        if not isinstance(supports, Supports):
            raise InputError("supports are what the fixture's own method of that name returns: give these.")
        triple = supports.ranked(number)
        query = supports.query
        start = find_move_to_middle(supports.fixture, query.toolkit, query.workpiece)
        return cls(supports, number, recounted(supports.fixture, query.toolkit, triple, start))

    @classmethod
    def under(cls, fixture: Fixture, supports: Supports, number: int = 1) -> ChosenSupports:
        """The set of a number that holds up a fixture of a result.

        Raises
        ------
        InputError
            When there is none, or the supports are of another fixture, part or toolkit.
        """
        chosen, query = cls.of(supports, number), fixture.listing.result.query
        belongs = (
            query.workpiece.is_alike(supports.query.workpiece) and query.toolkit == supports.query.toolkit
        )
        if not belongs or supports.fixture != fixture:
            raise InputError(
                "the supports are of another fixture: take those that this fixture's own method returns."
            )
        return chosen

    def standing_at(self, name: str) -> ChosenSupports:
        """The set with the lowest column and row of pegs and clamps at a hole's of a name, such as "D4".

        Raises
        ------
        InputError
            For what is no hole, and where pegs or supports have none then.
        """
        query, fixture = self.supports.query, self.supports.fixture
        start = move_to(fixture, query.toolkit, name)
        found = recounted(fixture, query.toolkit, self.triple, start)
        if found.move != start:
            raise InputError(
                f"the supports have no holes with the set-up at {name.strip()[:40]}: leave the place out, or "
                "give another one."
            )
        return evolve(self, recounted=found)

    @property
    def triple(self) -> Triple:
        """The set with its figures, its holes as they were listed."""
        return self.supports.ranked(self.number)

    @property
    def clamp(self) -> ClampFigures:
        return self.triple.clamp

    @property
    def pads(self) -> tuple[SupportPad, ...]:
        """The supports in holes that have names."""
        return self.recounted.supports
